"""Which cells of a level-of-detail grid a view needs, and what is searched for them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...tracing import EDGES, MIDDLES, CellTree
from .bundles import Bundle, may_meet

FEW = 8
"""Vertices of a cell that are searched themselves: no more than it has corners."""

_WIDEST = 48.0
"""Pixels from a cell's first corner to the others: where it is wider, the middles of its edges may lie right by
chance."""

_SURELY = 1.5
"""How much farther off than in the middles of edges something in a cell may lie."""

_HIDDEN = 1.0
NOWHERE = 3.0
"""In place of what tells whether a virtual vertex is hidden: there is none, and no triangle that has it is drawn."""

Search = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""The virtual vertices (N, 4) of points (N, 3) in the bundles' parts (N,), as of virtual_published/scattered.vert."""

Pixels = Callable[[np.ndarray], np.ndarray]
"""Where points (..., 3) are on the screen (..., 2), in pixels; infinite behind the camera."""


class Forest:
    """The cell trees of some meshes, one after another: mesh n has the vertices `vertices[n]` to `vertices[n + 1]`.

    `roots` (M,) is the first cell of each. Cells are as of `CellTree`, counted through all meshes, and lie with their
    triangles in balls of `centres` (N, 3) and `radii` (N,).
    """

    def __init__(self, trees: Sequence[CellTree], positions: Sequence[np.ndarray], edges: Sequence[np.ndarray]) -> None:
        """`positions` (V, 3) of the meshes' vertices in the trees' order, `edges` (V,) the longest of each vertex."""
        cells = first_of([len(tree.first) for tree in trees])
        points = first_of([len(tree.points) for tree in trees])
        self.vertices = first_of([len(tree.order) for tree in trees])
        self.roots = cells[:-1]
        self.positions = _joined(positions, 3)
        self.points = _joined([tree.points for tree in trees], 3)
        self.low, self.high = (_joined([getattr(tree, name) for tree in trees], 3) for name in ("low", "high"))
        self.count, self.children = (_joined([getattr(tree, name) for tree in trees]) for name in ("count", "children"))
        self.corners = _joined([tree.corners + at for tree, at in zip(trees, points, strict=False)], MIDDLES + 4)
        self.first = _joined([tree.first + at for tree, at in zip(trees, self.vertices, strict=False)])
        self.child = _joined([tree.child + at for tree, at in zip(trees, cells, strict=False)])
        self.centres = (self.low + self.high) / 2.0
        self.radii = np.linalg.norm(self.high - self.low, axis=1) / 2.0
        if len(self.roots):
            ranges = np.stack([self.first, self.first + self.count], axis=1).ravel()
            self.radii += np.maximum.reduceat(np.append(_joined(edges), 0.0), ranges)[::2]


@dataclass(frozen=True, eq=False)
class Refined:
    """What a view searches of some meshes, and what lies between.

    `results` (R, 4) float32 are virtual vertices, the first of them one that is nowhere. `of_vertex` (T,) int32 tells
    of each vertex, bundle by bundle and there mesh by mesh, which cell it lies in, plus 1; or which result is its own,
    below 1. `corners` (C, 8) int32 are the results of cells, `boxes` (C, 2, 3) float32 where they lie.
    """

    results: np.ndarray
    of_vertex: np.ndarray
    corners: np.ndarray
    boxes: np.ndarray


def refined(
    forest: Forest, bundles: Sequence[Bundle], pairs: np.ndarray, search: Search, pixels: Pixels, within: float
) -> Refined:
    """Cut the cells of `pairs` (K, 2), of a bundle and a mesh that it may show, as far as the view asks for.

    A cell is left whole where all its corners are reflected, or all are hidden, and the middles of three edges, one
    along each axis, are together seen so near to where they would lie between the corners, and its own middle as well,
    that everything in it is to be expected `within` so many pixels. Nothing is searched that no ray can meet.
    """
    found = _Found(forest, search)
    row, cell = pairs[:, 0], forest.roots[pairs[:, 1]]
    begins = first_of(np.diff(forest.vertices)[pairs[:, 1]])
    of_vertex = np.zeros(begins[-1], np.int32)
    # From a vertex of a pair's mesh to its place in the table.
    shift = begins[:-1] - forest.vertices[pairs[:, 1]]
    rays = [np.array([getattr(one, name) for one in bundles]) for name in ("centre", "radius", "axis", "spread")]
    corners, kept, count = [np.zeros((0, MIDDLES), np.int64)], [np.zeros(0, np.int64)], 0
    while len(cell):
        near = may_meet(*(part[row] for part in rays), forest.centres[cell], forest.radii[cell])
        row, cell, shift = row[near], cell[near], shift[near]
        alone = forest.children[cell] == 0
        vertices = ranges(forest.first[cell[alone]], forest.count[cell[alone]])
        rows, shifts = (np.repeat(part[alone], forest.count[cell[alone]]) for part in (row, shift))
        of_vertex[vertices + shifts] = -found.new(rows, forest.positions[vertices])
        row, cell, shift = row[~alone], cell[~alone], shift[~alone]
        at = found.corners(row, cell)
        enough = _is_enough(found.results[at], pixels, within)
        held = forest.count[cell[enough]]
        vertices = ranges(forest.first[cell[enough]], held) + np.repeat(shift[enough], held)
        of_vertex[vertices] = np.repeat(count + 1 + np.arange(len(held)), held)
        corners.append(at[enough, :MIDDLES])
        kept.append(cell[enough])
        count += len(held)
        cut = cell[~enough]
        row, shift = (np.repeat(part[~enough], forest.children[cut]) for part in (row, shift))
        cell = ranges(forest.child[cut], forest.children[cut])
    chosen = np.concatenate(kept)
    boxes = np.stack([forest.low[chosen], forest.high[chosen]], axis=1).astype(np.float32)
    return Refined(found.results, of_vertex, np.concatenate(corners).astype(np.int32), boxes)


class _Found:
    """What has been searched: `results` (R, 4), and where among them the points of each bundle are."""

    def __init__(self, forest: Forest, search: Search) -> None:
        self._forest, self._search = forest, search
        self.results = np.array([[0.0, 0.0, 0.0, NOWHERE]], np.float32)
        self._keys, self._places = np.zeros(0, np.int64), np.zeros(0, np.int64)

    def new(self, rows: np.ndarray, points: np.ndarray) -> np.ndarray:
        """(N,) the results of points (N, 3), now searched."""
        first = len(self.results)
        if len(rows):
            self.results = np.concatenate([self.results, self._search(rows, points)])
        return first + np.arange(len(rows))

    def corners(self, row: np.ndarray, cell: np.ndarray) -> np.ndarray:
        """(N, 12) the results of the corners and middles of cells; each is searched once for a bundle."""
        forest = self._forest
        keys = row[:, None] * len(forest.points) + forest.corners[cell]
        asked, which = np.unique(keys, return_inverse=True)
        new = np.setdiff1d(asked, self._keys, assume_unique=True)
        rows, points = np.divmod(new, max(len(forest.points), 1))
        places = np.append(self._places, self.new(rows, forest.points[points]))
        known = np.append(self._keys, new)
        order = np.argsort(known, kind="stable")
        self._keys, self._places = known[order], places[order]
        return self._places[np.searchsorted(self._keys, asked)][which.reshape(keys.shape)]


def _is_enough(images: np.ndarray, pixels: Pixels, within: float) -> np.ndarray:
    """(N,) whether what lies in cells may be interpolated between their corners' virtual vertices.

    `images` (N, 12, 4) are those of the corners and middles.
    """
    told = images[..., 3]
    alike = (told == told[:, :1]).all(axis=1) & (told[:, 0] <= _HIDDEN)
    shown = pixels(images[..., :3])
    corners = images[:, :MIDDLES, :3]
    between = pixels(np.concatenate([corners[:, EDGES].mean(axis=2), corners.mean(axis=1, keepdims=True)], axis=1))
    with np.errstate(invalid="ignore"):  # what is not before the camera is not enough
        off = np.linalg.norm(between - shown[:, MIDDLES:], axis=2)
        off = np.maximum(off[:, :-1].sum(axis=1), off[:, -1])
        wide = np.linalg.norm(shown - shown[:, :1], axis=2).max(axis=1)
        return alike & (_SURELY * off <= within) & (wide <= _WIDEST)


def ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Whole numbers from each `first`, so many; one range after another."""
    return np.repeat(first - first_of(count)[:-1], count) + np.arange(count.sum())


def first_of(counts: Sequence[int]) -> np.ndarray:
    """Where each of some parts begins among all, and in the end how many there are."""
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)


def _joined(parts: Sequence[np.ndarray], columns: int = 0) -> np.ndarray:
    return np.concatenate(parts) if parts else np.zeros((0, columns) if columns else 0, np.int64)
