"""Boxes of points wherever a matrix puts them, each found once."""

from collections.abc import Callable
from weakref import WeakKeyDictionary

import numpy as np

_BOXES: "WeakKeyDictionary[object, dict[bytes, np.ndarray]]" = WeakKeyDictionary()


def placed_box(thing: object, points_of: Callable[[], np.ndarray], matrix: np.ndarray, most: int) -> np.ndarray:
    """(2, 3) float64: least and greatest corner of a thing's points (N, 3), N ≥ 1, as `matrix` (4, 4) places them.

    `points_of` is asked for the points of a place that is not known yet; as long as `thing` lives they are the same.
    No more than `most` places are remembered of it, or a drag would fill the memory.
    """
    boxes, key = _BOXES.setdefault(thing, {}), matrix.tobytes()
    if key not in boxes:
        points = matrix[:3, :3] @ points_of().T.astype(np.float64) + matrix[:3, 3:]
        if len(boxes) >= most:
            boxes.clear()
        boxes[key] = np.stack([points.min(axis=1), points.max(axis=1)])
        boxes[key].flags.writeable = False
    return boxes[key]
