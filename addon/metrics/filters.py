"""Filters of pictures along their rows and columns, as products with narrow band matrices: BLAS is fast at those."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

_ALONG, _ASIDE = 32, 128
"""Pixels of a block along a filter and aside of it. OpenBLAS spreads larger products over threads, which wait for each
other for longer than they work wherever the processor has something else to do."""


def across(maps: np.ndarray, kernel: np.ndarray, mode: str = "edge") -> np.ndarray:
    """float32 (..., H, W): each row of `maps` correlated with `kernel` (2 r + 1); pictures go on as of `np.pad`."""
    radius = len(kernel) // 2
    windows, found, blocks = _blocks(maps, (_ASIDE, _ALONG), (0, radius), mode)
    np.matmul(windows, _band(kernel).T, out=blocks)
    return found


def down(maps: np.ndarray, kernel: np.ndarray, mode: str = "edge") -> np.ndarray:
    """float32 (..., H, W): the same along each column."""
    radius = len(kernel) // 2
    windows, found, blocks = _blocks(maps, (_ALONG, _ASIDE), (radius, 0), mode)
    np.matmul(_band(kernel), windows, out=blocks)
    return found


def blurred(maps: np.ndarray, kernel: np.ndarray, mode: str = "edge") -> np.ndarray:
    """float32 (..., H, W): along both."""
    return down(across(maps, kernel, mode), kernel, mode)


def _blocks(maps: np.ndarray, sides: tuple, reach: tuple, mode: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Views of `maps` as blocks of those sides and what they reach around them; and the result, whole and as blocks."""
    shape, whole = maps.shape[-2:], [(0, 0)] * (maps.ndim - 2)
    missing = [-length % side for length, side in zip(shape, sides, strict=True)]
    padded = np.pad(maps, whole + [(r, r) for r in reach], mode)
    if any(missing):
        padded = np.pad(padded, whole + [(0, more) for more in missing])
    grown = [side + 2 * r for side, r in zip(sides, reach, strict=True)]
    windows = sliding_window_view(padded, grown, axis=(-2, -1))[..., :: sides[0], :: sides[1], :, :]
    counts = [(length + more) // side for length, more, side in zip(shape, missing, sides, strict=True)]
    found = np.empty((*maps.shape[:-2], counts[0], sides[0], counts[1], sides[1]), np.float32)
    joined = found.reshape(*maps.shape[:-2], counts[0] * sides[0], counts[1] * sides[1])
    return windows, joined[..., : shape[0], : shape[1]], found.swapaxes(-3, -2)


def _band(kernel: np.ndarray) -> np.ndarray:
    """float32 (_ALONG, _ALONG + 2 r): row i holds the kernel from column i on."""
    band = np.zeros((_ALONG, _ALONG + len(kernel) - 1), np.float32)
    rows = np.arange(_ALONG)[:, None]
    band[rows, rows + np.arange(len(kernel))] = kernel
    return band
