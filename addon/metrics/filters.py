"""Filters of pictures along their rows and columns, as products with narrow band matrices: BLAS is fast at those."""

import numpy as np

_BLOCK = 32  # rows or columns at a time; wider bands multiply more zeros, narrower ones read more twice


def across(maps: np.ndarray, kernel: np.ndarray, mode: str = "edge") -> np.ndarray:
    """float32 (..., H, W): each row of `maps` correlated with `kernel` (2 r + 1); pictures go on as of `np.pad`."""
    width, radius = maps.shape[-1], len(kernel) // 2
    padded = np.pad(maps, [(0, 0)] * (maps.ndim - 1) + [(radius, radius)], mode)
    found, band = np.empty_like(maps), _band(kernel).T
    for start in range(0, width, _BLOCK):
        count = min(_BLOCK, width - start)
        found[..., start : start + count] = (
            padded[..., start : start + count + 2 * radius] @ band[: count + 2 * radius, :count]
        )
    return found


def down(maps: np.ndarray, kernel: np.ndarray, mode: str = "edge") -> np.ndarray:
    """float32 (..., H, W): the same along each column."""
    height, radius = maps.shape[-2], len(kernel) // 2
    padded = np.pad(maps, [(0, 0)] * (maps.ndim - 2) + [(radius, radius), (0, 0)], mode)
    found, band = np.empty_like(maps), _band(kernel)
    for start in range(0, height, _BLOCK):
        count = min(_BLOCK, height - start)
        rows = padded[..., start : start + count + 2 * radius, :]
        np.matmul(band[:count, : count + 2 * radius], rows, out=found[..., start : start + count, :])
    return found


def blurred(maps: np.ndarray, kernel: np.ndarray, mode: str = "edge") -> np.ndarray:
    """float32 (..., H, W): along both."""
    return down(across(maps, kernel, mode), kernel, mode)


def _band(kernel: np.ndarray) -> np.ndarray:
    """float32 (_BLOCK, _BLOCK + 2 r): row i holds the kernel from column i on."""
    band = np.zeros((_BLOCK, _BLOCK + len(kernel) - 1), np.float32)
    rows = np.arange(_BLOCK)[:, None]
    band[rows, rows + np.arange(len(kernel))] = kernel
    return band
