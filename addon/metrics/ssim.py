"""SSIM: likeness of structure (Wang et al. 2004)."""

import numpy as np

from .filters import blurred

_DEVIATION, _RADIUS = 1.5, 5  # pixels, of the Gaussian window
_BRIGHT, _CONTRAST = 0.01**2, 0.03**2


def statistics(shown: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and variance in the window around each pixel of `shown` (C, H, W) in 0..1, float32, alike in shape."""
    mean = _windowed(shown)
    return mean, np.maximum(_windowed(shown * shown) - mean * mean, 0.0)


def ssim(shown: np.ndarray, expected: np.ndarray, of_shown: tuple, of_expected: tuple) -> np.ndarray:
    """(H, W) float32 up to 1 (equal): SSIM of two pictures (C, H, W) in 0..1, mean of the channels.

    `of_shown` and `of_expected` are their `statistics`. Past its edge a picture goes on mirrored.
    """
    (mean, variance), (expected_mean, expected_variance) = of_shown, of_expected
    apart, off = shown - expected, mean - expected_mean
    # Both factors of the paper as 1 less what parts the pictures, which is exactly nothing where they are equal.
    spread = np.maximum(_windowed(apart * apart) - off * off, 0.0)
    brightness = 1.0 - off * off / (mean * mean + expected_mean * expected_mean + np.float32(_BRIGHT))
    structure = 1.0 - spread / (variance + expected_variance + np.float32(_CONTRAST))
    return sum(brightness * structure) / np.float32(len(shown))


def _windowed(maps: np.ndarray) -> np.ndarray:
    return blurred(maps, _WINDOW, "symmetric")


_WINDOW = np.exp(-(np.arange(-_RADIUS, _RADIUS + 1) ** 2) / (2.0 * _DEVIATION**2))
_WINDOW /= _WINDOW.sum()
