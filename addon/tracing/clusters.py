"""Pairs of boxes, pairs of pairs, and so on up to one: the binary tree that a hierarchy of a mesh begins with.

Meister and Bittner 2018, Parallel locally-ordered clustering for bounding volume hierarchy construction:
boxes lie in a row along a space-filling curve, each looks for the neighbour with which it makes the
smallest box, and two that choose each other become one. Every round is a few operations on whole arrays.
"""

import numpy as np

RADIUS = 4
"""How far along the curve a box looks for its partner; looking farther gave trees that rays visit more of."""

_LEAST_SHARE = 1 / 8
"""Of all boxes; where fewer find partners in a round, all join their neighbours."""

_BITS = 21
_ALIGNED = np.float32(1 - 1e-4)


def pair_up(boxes: np.ndarray, balanced: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Children (B - 1, 2) int64 and boxes (2 B - 1, 6) float32 of the tree over boxes (B, 6) float32, B ≥ 1.

    A box is its low corner, negated, and its high corner, so that the greatest of two boxes holds both;
    all lie within a unit cube. Nodes below B are the boxes given, those from B on have children, which come
    before them; the root is the last. `balanced` joins neighbours along the curve, whatever their size: a tree
    as flat as can be.
    """
    ids = np.argsort(_along_curve(0.5 * (boxes[:, 3:] - boxes[:, :3])), kind="stable")
    row = np.ascontiguousarray(boxes[ids].T)
    children, made = [np.zeros((0, 2), np.int64)], [boxes]
    count = len(boxes)
    while len(ids) > 1:
        first, second = _neighbours(len(ids)) if balanced else _couples(row)
        children.append(np.stack([ids[first], ids[second]], axis=1))
        row[:, first] = np.maximum(row[:, first], row[:, second])
        made.append(row[:, first].T)
        ids[first] = count + np.arange(len(first))
        count += len(first)
        left = np.ones(len(ids), bool)
        left[second] = False
        ids, row = ids[left], row[:, left]
    return np.concatenate(children), np.concatenate(made)


def surface(boxes: np.ndarray) -> np.ndarray:
    """Half the surface of boxes (6, ...) as `pair_up` takes them."""
    x, y, z = boxes[:3] + boxes[3:]
    return x * y + y * z + z * x


def _couples(row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    partner = _partners(row)
    here = np.arange(len(partner))
    first = np.flatnonzero((partner > here) & (partner[partner] == here))
    return (first, partner[first]) if len(first) >= _LEAST_SHARE * len(here) else _neighbours(len(here))


def _neighbours(count: int) -> tuple[np.ndarray, np.ndarray]:
    first = np.arange(0, count - 1, 2)
    return first, first + 1


def _partners(row: np.ndarray) -> np.ndarray:
    """Of each box in a row (6, N), the one within RADIUS that it makes the smallest box with; itself if there is none.

    Among equals, as in a grid, the first of an even place and the next go together: else each would choose the next.
    """
    count = row.shape[1]
    least, partner = np.full(count, np.inf, np.float32), np.arange(count)
    for step in range(1, min(RADIUS, count - 1) + 1):
        size = surface(np.maximum(row[:, :-step], row[:, step:]))
        if step == 1:
            size[::2] *= _ALIGNED
        for one, other in ((slice(0, count - step), step), (slice(step, count), -step)):
            better = size < least[one]
            np.copyto(least[one], size, where=better)
            np.copyto(partner[one], np.arange(count)[one] + other, where=better)
    return partner


def _along_curve(points: np.ndarray) -> np.ndarray:
    """Where points (N, 3) of the unit cube lie along Morton's curve: their coordinates' bits in turns."""
    cells = np.clip(points.astype(np.float64) * 2**_BITS, 0, 2**_BITS - 1).astype(np.uint64)
    return _spread(cells[:, 0]) | _spread(cells[:, 1]) << np.uint64(1) | _spread(cells[:, 2]) << np.uint64(2)


def _spread(bits: np.ndarray) -> np.ndarray:
    """Two zeros between each two of 21 bits."""
    for shift, mask in (
        (32, 0x001F00000000FFFF),
        (16, 0x001F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        bits = (bits | bits << np.uint64(shift)) & np.uint64(mask)
    return bits
