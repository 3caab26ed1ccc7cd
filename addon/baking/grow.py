"""Values that a picture has only in places, continued over all of it."""

import numpy as np

_SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))

_RINGS = 16
"""Texels from the known ones at which all is trend."""

_FADING = 0.7
"""By how much less a ring goes on than the one before: where two rings meet, what they go on by has faded."""

_STIFF = 1e-3
"""Of the greatest singular value: in directions in which less than this is known, the trend is none."""


def grown(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """`values` (H, W, C) with those that are not `known` (H, W) made up: as smooth as the known ones go on.

    What is far from the known ones follows the quadratic that is nearest to them. What they lie off it fades: ring
    after ring, a texel becomes the mean of what the lines through its neighbours lead to. Where nothing is known all
    is 0.
    """
    if known.all():
        return values
    if not known.any():
        return np.zeros_like(values)
    trend = _trend(values, known)
    off = np.where(known[..., None], values - trend, 0.0)
    faded, there = off.copy(), known.copy()
    for number in range(1, _RINGS):
        total, count = np.zeros_like(off), np.zeros(there.shape)
        for side in _SIDES:
            near, has_near = _moved(off, side), _moved(there, side)
            far, has_far = _moved(off, side, 2), _moved(there, side, 2)
            guess = np.where(has_far[..., None], near + _FADING * (near - far), near)
            weight = np.where(has_near, np.where(has_far, 1.0, 0.01), 0.0)
            total += weight[..., None] * guess
            count += weight
        ring = (count > 0) & ~there
        if not ring.any():
            break
        off[ring] = total[ring] / count[ring][:, None]
        faded[ring] = off[ring] * (1.0 - (number / _RINGS) ** 2)
        there |= ring
    return np.where(known[..., None], values, trend + faded).astype(values.dtype)


def _trend(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """(H, W, C) float64: the quadratic of row and column that is nearest to the known values."""
    y, x = (line / max(len(line) - 1, 1) - 0.5 for line in map(np.arange, known.shape))
    y, x = np.meshgrid(y, x, indexing="ij")
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    chosen = terms[known]
    inverse = np.linalg.pinv(chosen.T @ chosen, rcond=_STIFF**2, hermitian=True)
    return terms @ (inverse @ (chosen.T @ values[known].astype(np.float64)))


def _moved(picture: np.ndarray, side: tuple[int, int], by: int = 1) -> np.ndarray:
    """What stands `by` texels to a side of each texel; nothing beyond the picture."""
    moved = np.zeros_like(picture)
    rows, columns = side[0] * by, side[1] * by
    height, width = picture.shape[:2]
    to = np.s_[max(0, -rows) : height - max(0, rows), max(0, -columns) : width - max(0, columns)]
    source = np.s_[max(0, rows) : height + min(0, rows), max(0, columns) : width + min(0, columns)]
    moved[to] = picture[source]
    return moved
