"""Grids of cells in cells around a mesh, so that each view may take as coarse ones as will do."""

from dataclasses import dataclass

import numpy as np

from .interpolation_grid import CORNERS

MIDDLES = 8
"""The column of `CellTree.corners` from which on there are middles of edges, and that of the cell; before it are the
corners."""

EDGES = np.array([[4, 5], [1, 3], [2, 6]])
"""Corners at the ends of the edges whose middles are kept: one along each axis, all apart from each other."""

_DEEPEST = 10


@dataclass(frozen=True, eq=False)
class CellTree:
    """The cells that hold a mesh's vertices, each cut in up to eight where it holds many (Estalella et al., 8).

    `order` (V,) int64 sorts the mesh's V vertices so that those of a cell stand together. Of each of N cells, the first
    of which holds all: `low` and `high` (N, 3) corners of its box; `corners` (N, 12) int32 which of `points` (P, 3) are
    its corners, x fastest, the middles of its EDGES and its own, -1 for cells that are not cut; `first` and `count`
    (N,) which vertices, in that order, it holds; `child` and `children` (N,) which cells it is cut into, 0 for none.
    """

    order: np.ndarray
    low: np.ndarray
    high: np.ndarray
    corners: np.ndarray
    points: np.ndarray
    first: np.ndarray
    count: np.ndarray
    child: np.ndarray
    children: np.ndarray


def cell_tree(points: np.ndarray, few: int) -> CellTree:
    """Cells around `points` (V, 3), at least one, all finite; those with `few` of them or fewer are not cut.

    Cells are as near cubes as halving allows: a box that is longer than it is wide is cut along its length first.
    """
    points = np.asarray(points, np.float64)
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    waits = _waits(extent)
    place = _lattice(points, low, extent, waits)
    order = np.argsort(_code(place, waits), kind="stable")
    place, code = place[order], _code(place, waits)[order]
    levels, first, end, parent = [], np.zeros(1, np.int64), np.array([len(points)]), np.full(1, -1)
    count = 0
    for level in range(_DEEPEST + 1):
        cut = end - first > few if level < _DEEPEST else np.zeros(len(first), bool)
        levels.append((np.full(len(first), level), first, end, parent, cut))
        numbers = count + np.flatnonzero(cut)
        count += len(first)
        first, end, parent = _halves(code, first[cut], end[cut], numbers, _bits(level + 1, waits))
        if not len(first):
            break
    level, first, end, parent, cut = (np.concatenate(column) for column in zip(*levels, strict=True))
    child, children = np.zeros(len(first), np.int64), np.bincount(parent[1:], minlength=len(first))
    child[parent[1:][::-1]] = np.arange(1, len(first))[::-1]
    boxes = _boxes(place[first], level, waits) * (extent > 0.0)
    corners, kept = _corners(boxes, cut)
    size = extent / (2 << np.maximum(_DEEPEST - waits, 0))
    return CellTree(
        order,
        low + boxes[:, 0] * size,
        low + boxes[:, 1] * size,
        corners,
        low + kept * size,
        first,
        end - first,
        child,
        children,
    )


def _waits(extent: np.ndarray) -> np.ndarray:
    """(3,) how often the longest axis is halved before each is for the first time."""
    with np.errstate(divide="ignore", over="ignore"):
        waits = np.round(np.log2(max(float(extent.max()), 1e-30) / np.maximum(extent, 1e-30)))
    return np.where(extent > 0.0, np.clip(waits, 0, _DEEPEST), _DEEPEST).astype(np.int64)


def _lattice(points: np.ndarray, low: np.ndarray, extent: np.ndarray, waits: np.ndarray) -> np.ndarray:
    """(V, 3) the smallest cell of each point, counted along the axes."""
    cells = 1 << (_DEEPEST - waits)
    at = (points - low) / np.where(extent > 0.0, extent, 1.0) * cells
    return np.clip(np.floor(at), 0, cells - 1).astype(np.int64)


def _bits(level: int, waits: np.ndarray) -> int:
    """How many bits of the code are left below a level."""
    return int(np.maximum(_DEEPEST - np.maximum(waits, level), 0).sum())


def _code(place: np.ndarray, waits: np.ndarray) -> np.ndarray:
    """(V,) numbers whose first bits are those of larger cells."""
    code = np.zeros(len(place), np.int64)
    for level in range(1, _DEEPEST + 1):
        for axis in np.flatnonzero(waits < level):
            code = code << 1 | place[:, axis] >> (_DEEPEST - level) & 1
    return code


def _halves(code: np.ndarray, first: np.ndarray, end: np.ndarray, numbers: np.ndarray, bits: int) -> tuple:
    """Where the parts of some cells begin and end, and in which of the cells they lie."""
    if not len(first):
        return first, end, numbers
    begins = np.flatnonzero(np.diff(code >> bits, prepend=-1))
    low, high = np.searchsorted(begins, first), np.searchsorted(begins, end)
    parent = np.repeat(numbers, high - low)
    chosen = np.concatenate([np.arange(a, b) for a, b in zip(low, high, strict=True)])
    ends = np.append(begins[1:], len(code))
    return begins[chosen], ends[chosen], parent


def _boxes(place: np.ndarray, level: np.ndarray, waits: np.ndarray) -> np.ndarray:
    """(N, 2, 3) low and high corners of cells, in halves of the smallest."""
    side = np.minimum(_DEEPEST - waits, _DEEPEST - level[:, None])
    low = place >> side << side
    return 2 * np.stack([low, low + (1 << side)], axis=1)


def _corners(boxes: np.ndarray, cut: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N, 12) which of (P, 3) points of the lattice are the corners and middles of those cells that are cut."""
    asked = np.where(CORNERS, boxes[cut, 1, None], boxes[cut, 0, None])
    middles = asked[:, EDGES].sum(axis=2) // 2, asked[:, [0, -1]].sum(axis=1, keepdims=True) // 2
    asked = np.concatenate([asked, *middles], axis=1)
    side = (4 << _DEEPEST) * np.ones(3, np.int64)
    names, numbers = np.unique(np.ravel_multi_index(tuple(np.moveaxis(asked, 2, 0)), side), return_inverse=True)
    corners = np.full((len(boxes), asked.shape[1]), -1, np.int32)
    corners[cut] = numbers.reshape(asked.shape[:2])
    return corners, np.stack(np.unravel_index(names, side), axis=1)
