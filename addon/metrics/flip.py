"""FLIP: the difference that a person sees when two pictures alternate in place (Andersson et al. 2020, 2021)."""

from dataclasses import dataclass
from math import ceil, log2, sqrt

import flip_evaluator
import numpy as np

from ..scene import LUMINANCE
from .display import to_display

MOST_EXPOSURES = 10
"""HDR-FLIP looks at about one exposure a stop; a sun in the picture would ask for dozens, at 0.3 s each."""


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
    return _evaluate(to_display(test), to_display(reference), "LDR", {})


def hdr_flip_map(test: np.ndarray, reference: np.ndarray, exposures: Exposures) -> np.ndarray:
    """(H, W) float32 in 0..1: the largest FLIP of each pixel over the exposures, tone-mapped by ACES.

    Takes linear pictures (H, W, 3) of one shape. What is below zero counts as black.
    """
    parameters = {
        "startExposure": exposures.start,
        "stopExposure": exposures.stop,
        "numExposures": exposures.count,
    }
    return _evaluate(np.maximum(test, 0.0), np.maximum(reference, 0.0), "HDR", parameters)


def _evaluate(test: np.ndarray, reference: np.ndarray, kind: str, parameters: dict) -> np.ndarray:
    # flip_evaluator leaves the process on bad arguments, so callers check pictures before they come here.
    pictures = (np.ascontiguousarray(picture, dtype=np.float32) for picture in (reference, test))
    errors, _, _ = flip_evaluator.evaluate(
        *pictures, kind, inputsRGB=True, applyMagma=False, computeMeanError=False, parameters=parameters
    )
    return errors[..., 0]


def _aces_inverse(shown: float) -> float:
    """The linear value that FLIP's fit of the ACES curve, (a x² + b x) / (c x² + d x + e), shows as `shown`."""
    a, b, c, d, e = 0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14
    square, linear, constant = a - shown * c, b - shown * d, -shown * e
    return (-linear + sqrt(linear * linear - 4.0 * square * constant)) / (2.0 * square)
