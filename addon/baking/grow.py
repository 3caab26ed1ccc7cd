"""Values that a picture has only in places, continued over all of it."""

import numpy as np

_SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))


def grown(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """`values` (H, W, C) with those that are not `known` (H, W) made up: as smooth as the known ones go on.

    Ring after ring, a texel becomes the mean of what the lines through its neighbours lead to. Where nothing is
    known all is 0.
    """
    if known.all():
        return values
    filled = np.where(known[..., None], values, 0.0).astype(np.float64)
    known = known.copy()
    while not known.all() and known.any():
        total, count = np.zeros_like(filled), np.zeros(known.shape)
        for side in _SIDES:
            near, has_near = _moved(filled, side), _moved(known, side)
            far, has_far = _moved(filled, side, 2), _moved(known, side, 2)
            guess = np.where(has_far[..., None], 2.0 * near - far, near)
            weight = np.where(has_near, np.where(has_far, 1.0, 0.01), 0.0)
            total += weight[..., None] * guess
            count += weight
        ring = (count > 0) & ~known
        filled[ring] = total[ring] / count[ring][:, None]
        known |= ring
    return filled.astype(values.dtype)


def _moved(picture: np.ndarray, side: tuple[int, int], by: int = 1) -> np.ndarray:
    """What stands `by` texels to a side of each texel; nothing beyond the picture."""
    moved = np.zeros_like(picture)
    rows, columns = side[0] * by, side[1] * by
    height, width = picture.shape[:2]
    to = np.s_[max(0, -rows) : height - max(0, rows), max(0, -columns) : width - max(0, columns)]
    source = np.s_[max(0, rows) : height + min(0, rows), max(0, columns) : width + min(0, columns)]
    moved[to] = picture[source]
    return moved
