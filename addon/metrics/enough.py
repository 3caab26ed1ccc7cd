"""When a reference has samples enough."""

from dataclasses import dataclass

import numpy as np

from .flip import flip_map

_FALL = 2 / 3
"""Noise falls by no greater power of the samples: even sequences cross edges, and those fall by a little less."""


@dataclass(frozen=True, eq=False)
class Enough:
    """Samples until the reference's own noise is no more than `noise`: FLIP, the mean over `pixels` (H, W) bool.

    It is the figure that `noise_maps` gives; over the whole frame where `pixels` has none. There are `least` samples
    at least, and `most` at most.
    """

    pixels: np.ndarray
    noise: float
    least: int
    most: int

    def more(self, first_half: np.ndarray, second_half: np.ndarray) -> float:
        """How many times the samples of two halves (H, W, 3) there must be at least; at most 1 if they are enough."""
        errors = flip_map(first_half, (first_half + second_half) / 2)
        noise = float((errors[self.pixels] if self.pixels.any() else errors).mean())
        return (noise / self.noise) ** (1 / _FALL)
