"""From scene-linear radiance to what a screen shows: the one display transform of metrics, pictures and report."""

import numpy as np

# The colour map "magma" at every 17th of its 256 steps.
_MAGMA_ANCHORS = (
    "000004 0b0924 20114b 3b0f70 57157e 721f81 8c2981 a8327d c43c75 de4968 f1605d fa7f5e fe9f6d febf84 fddea0 fcf9bb"
)


def to_display(linear: np.ndarray) -> np.ndarray:
    """float32 in 0..1, sRGB-encoded (IEC 61966-2-1), of linear radiance of any shape, clamped to 0..1."""
    clamped = np.clip(linear, 0.0, 1.0).astype(np.float32, copy=False)
    encoded = np.where(clamped <= 0.0031308, 12.92 * clamped, 1.055 * clamped ** (1 / 2.4) - 0.055)
    return np.clip(encoded, 0.0, 1.0, dtype=np.float32)


def to_bytes(linear: np.ndarray) -> np.ndarray:
    """uint8 in 0..255: `to_display`, rounded to the nearest of a screen's steps."""
    return stepped(to_display(linear))


def stepped(shown: np.ndarray) -> np.ndarray:
    """uint8 in 0..255 of what `to_display` gives."""
    return (shown * 255.0 + 0.5).astype(np.uint8)


def magma(values: np.ndarray) -> np.ndarray:
    """uint8 sRGB colours (..., 3) of `values` (...) in 0..1, from black over purple and orange to pale yellow."""
    return MAGMA[np.round(np.clip(values, 0.0, 1.0) * 255.0).astype(np.uint8)]


def _interpolated(anchors: str) -> np.ndarray:
    colors = np.array([list(bytes.fromhex(anchor)) for anchor in anchors.split()])
    at = np.linspace(0, 255, len(colors))
    channels = [np.interp(np.arange(256), at, channel) for channel in colors.T]
    return np.round(np.stack(channels, axis=-1)).astype(np.uint8)


MAGMA = _interpolated(_MAGMA_ANCHORS)
"""uint8 (256, 3): the colours of `magma`, all different, so that a value can be read back from a picture."""
