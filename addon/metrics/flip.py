"""FLIP: the difference that a person sees when two pictures alternate in place (Andersson et al. 2020, 2021)."""

from dataclasses import dataclass
from functools import reduce
from math import ceil, log2, sqrt

import numpy as np

from ..scene import LUMINANCE
from .ldr_flip import flip, seen

MOST_EXPOSURES = 10
"""HDR-FLIP looks at about one exposure a stop; a sun in the picture would ask for dozens."""

_ACES = 0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14
"""a to e of (a x² + b x) / (c x² + d x + e), FLIP's fit of the ACES curve."""


@dataclass(frozen=True)
class Exposures:
    """The exposures HDR-FLIP looks at: `count` of them, evenly from `start` to `stop` (stops, i.e. log2)."""

    start: float
    stop: float
    count: int


def exposures_of(reference: np.ndarray) -> Exposures:
    """What HDR-FLIP needs to see of `reference` (H, W, 3), linear; section 3.2 of the HDR paper.

    From the exposure that shows the brightest pixel just short of white to the one that does so
    for the median pixel. Black pixels are left out of the median, else a picture that is mostly
    black would ask for an infinite exposure. Share one result between all methods of a scene:
    errors seen at different exposures do not compare.
    """
    luminance = np.maximum(reference, 0.0).astype(np.float64) @ LUMINANCE
    lit = luminance[luminance > 1e-6]
    if lit.size == 0:
        return Exposures(0.0, 0.0, 2)
    nearly_white = log2(_aces_inverse(0.85))
    start, stop = nearly_white - log2(lit.max()), nearly_white - log2(np.median(lit))
    return Exposures(start, stop, min(max(2, ceil(stop - start)), MOST_EXPOSURES))


def flip_map(test: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """(H, W) float32 in 0..1: FLIP of two linear pictures (H, W, 3) of one shape, as a screen shows them.

    For an observer who sees 67 pixels a degree, FLIP's default.
    """
    return flip(*(seen(np.clip(planes_of(picture), 0.0, 1.0)) for picture in (test, reference)))


def planes_of(picture: np.ndarray) -> np.ndarray:
    """float32 (3, H, W): a picture (H, W, 3) channel by channel, in which arithmetic runs along the pixels."""
    return np.ascontiguousarray(np.moveaxis(picture, -1, 0), np.float32)


def hdr_flip_map(test: np.ndarray, reference: np.ndarray, exposures: Exposures) -> np.ndarray:
    """(H, W) float32 in 0..1: the largest FLIP of each pixel over the exposures, tone-mapped by ACES.

    Takes linear pictures (H, W, 3) of one shape. What is below zero counts as black.
    """
    test, reference = planes_of(test), planes_of(reference)
    stops = np.linspace(exposures.start, exposures.stop, exposures.count)
    errors = (flip(seen(_toned(test, stop)), seen(_toned(reference, stop))) for stop in stops)
    return reduce(np.maximum, errors)


def _toned(linear: np.ndarray, stop: float) -> np.ndarray:
    """float32 (3, H, W) in 0..1: a picture exposed by so many stops, under FLIP's fit of the ACES curve."""
    a, b, c, d, e = _ACES
    exposed = np.maximum(linear, 0.0) * np.float32(2.0**stop)
    return np.clip((exposed * (a * exposed + b)) / (exposed * (c * exposed + d) + e), 0.0, 1.0)


def _aces_inverse(shown: float) -> float:
    """The linear value that FLIP's fit of the ACES curve shows as `shown`."""
    a, b, c, d, e = _ACES
    square, linear, constant = a - shown * c, b - shown * d, -shown * e
    return (-linear + sqrt(linear * linear - 4.0 * square * constant)) / (2.0 * square)
