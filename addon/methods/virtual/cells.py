"""Which cells of a level-of-detail grid a view needs, and what is searched for them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...tracing import EDGES, MIDDLES, CellTree
from .bundles import Bundle, may_meet

FEW = 16
"""Vertices of a cell that are searched themselves: no more than would be searched for a cell."""

_WIDEST = 64.0
"""Pixels that a cell is seen across at most: where it is wider, its middle may lie right by chance."""

_SURELY, _BENT = 2.0, 0.2
"""How far off something in a cell may lie: so much farther than its middle, and so much of how far edges are bent."""

_BESIDE, _AROUND = 0.25, 2.0
"""How far beyond what was searched of a cell it may be seen: of its width on the screen, and in pixels."""

_SMALL = 0.4
"""Of its distance from where the rays begin: a cell's radius below which it holds nothing but what its corners and
middles show of it."""

_DOUBT = 0.05
"""Of a cell's width on the screen: how far off it counts as where not all of it is reflected, so that none can say."""

_PRICE = 12
"""Searches that a cell takes, at most."""

_STAGE, _LAST = 0.5, 0.03
"""How many of the searches that are left are spent before what was found says where the next are needed most; and of
all, how few are left alone."""

_LOST = 1.5
NOWHERE = 3.0
"""In place of what tells whether a virtual vertex is hidden: there is none, and no triangle that has it is drawn."""

Search = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""The virtual vertices (N, 4) of points (N, 3) in the bundles' parts (N,), as of virtual_published/scattered.vert."""

Pixels = Callable[[np.ndarray], np.ndarray]
"""Where points (..., 3) are on the screen (..., 2), in pixels; infinite behind the camera."""


class Forest:
    """The cell trees of some meshes, one after another: mesh n has the vertices `vertices[n]` to `vertices[n + 1]`.

    `roots` (M,) is the first cell of each. Cells are as of `CellTree`, counted through all meshes, and lie with their
    triangles in balls of `centres` (N, 3) and `radii` (N,); `edges` (N,) are the longest of these triangles, `prices`
    (N,) the searches that cutting a cell takes, at most.
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
        price = np.where(self.children > 0, _PRICE, self.count)
        self.prices = _over(np.add, price, self.child, self.children)
        self.edges = _over(np.maximum, _joined(edges), self.first, self.count)
        self.radii += self.edges


@dataclass(frozen=True, eq=False)
class Refined:
    """What a view searches of some meshes, and what lies between.

    `results` (R, 4) float32 are virtual vertices, the first of them one that is nowhere. `of_vertex` (T,) int32 tells
    of each vertex, bundle by bundle and there mesh by mesh, which cell it lies in, plus 1; or which result is its own,
    below 1. `corners` (C, 12) int32 are the results of cells, as of `CellTree.corners`, `boxes` (C, 2, 3) float32 where
    they lie.
    """

    results: np.ndarray
    of_vertex: np.ndarray
    corners: np.ndarray
    boxes: np.ndarray


def refined(
    forest: Forest,
    bundles: Sequence[Bundle],
    pairs: np.ndarray,
    search: Search,
    pixels: Pixels,
    within: float,
    most: float = np.inf,
) -> Refined:
    """Cut the cells of `pairs` (K, 2), of a bundle and a mesh that it may show, as far as the view asks for.

    What lies in a cell is interpolated between its corners, along edges that are bent as the three of which the middles
    are searched, one along each axis. A cell is left whole where its own middle then is seen so near to its place that
    everything in it is to be expected `within` so many pixels; or where what was found of it is seen beside the
    bundle's pixels, or is not reflected. Nothing is searched that no ray can meet. Of about `most` searches, those are
    done that move most on the screen.
    """
    found = _Found(forest, search)
    begins = first_of(np.diff(forest.vertices)[pairs[:, 1]])
    of_vertex = np.zeros(begins[-1], np.int32)
    rays = _Rays(bundles)
    opened, waiting, kept = np.zeros(len(pairs), _CELL), np.zeros(0, _CELL), []
    opened["row"], opened["cell"] = pairs[:, 0], forest.roots[pairs[:, 1]]
    opened["shift"] = begins[:-1] - forest.vertices[pairs[:, 1]]
    while len(opened):
        opened = opened[rays.meet(opened["row"], forest.centres[opened["cell"]], forest.radii[opened["cell"]])]
        alone = forest.children[opened["cell"]] == 0
        leaves, opened = opened[alone], opened[~alone]
        vertices, of = _vertices_of(forest, leaves)
        of_vertex[vertices + leaves["shift"][of]] = -found.new(leaves["row"][of], forest.positions[vertices])
        opened["results"] = found.corners(opened["row"], opened["cell"])
        opened["off"], opened["wide"], opened["doubtful"] = _judged(
            forest, opened, found.results[opened["results"]], pixels, rays
        )
        enough = (opened["off"] <= within) & ~opened["doubtful"]
        kept.append(opened[enough])
        waiting = np.concatenate([waiting, opened[~enough]])
        chosen = _next(waiting, forest.prices, most - len(found.results), most)
        opened, waiting = _cut(forest, waiting[chosen]), waiting[~chosen]
    whole = np.concatenate([*kept, waiting])
    vertices, of = _vertices_of(forest, whole)
    of_vertex[vertices + whole["shift"][of]] = 1 + of
    boxes = np.stack([forest.low[whole["cell"]], forest.high[whole["cell"]]], axis=1).astype(np.float32)
    return Refined(found.results, of_vertex, whole["results"], boxes)


_CELL = np.dtype(
    [
        ("row", np.int64),  # of its bundle
        ("cell", np.int64),
        ("shift", np.int64),  # from a vertex of the forest to its place in the table
        ("results", np.int32, MIDDLES + 4),
        ("off", np.float64),  # pixels that it may be seen away from its place
        ("wide", np.float64),  # and across
        ("doubtful", bool),  # whether not all of it is reflected, so that none can say
    ]
)


class _Rays:
    """The rays of bundles, as arrays of all."""

    def __init__(self, bundles: Sequence[Bundle]) -> None:
        """Line them up; `bounds` (B, 2, 2) are low and high corners, in pixels."""
        names = ("centre", "radius", "axis", "spread")
        self._parts = [np.array([getattr(one, name) for one in bundles]) for name in names]
        self.centre, self.spread = self._parts[0], self._parts[3]
        self.bounds = np.array([one.bounds for one in bundles], np.float64).reshape(-1, 2, 2)

    def meet(self, row: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> np.ndarray:
        """(N,) bool: whether one of a bundle may meet each of some balls."""
        return may_meet(*(part[row] for part in self._parts), centres, radii)


def _vertices_of(forest: Forest, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vertices that cells hold, and which of the cells each is of."""
    count = forest.count[cells["cell"]]
    return ranges(forest.first[cells["cell"]], count), np.repeat(np.arange(len(cells)), count)


def _cut(forest: Forest, cells: np.ndarray) -> np.ndarray:
    children = forest.children[cells["cell"]]
    parts = np.repeat(cells, children)
    parts["cell"] = ranges(forest.child[cells["cell"]], children)
    return parts


def _bows(images: np.ndarray) -> np.ndarray:
    """(N, 3, 3) how far off the lines between their ends the middles of the three edges of cells are."""
    return images[:, MIDDLES:-1, :3] - images[:, EDGES, :3].mean(axis=2)


def _next(waiting: np.ndarray, prices: np.ndarray, left: float, most: float) -> np.ndarray:
    """(N,) bool: which cells to cut, of those that are not enough: all, or what is worst for what it takes."""
    price = prices[waiting["cell"]]
    if price.sum() <= left:
        return np.ones(len(waiting), bool)
    chosen = np.zeros(len(waiting), bool)
    if left > _LAST * most:
        order = np.argsort(-waiting["off"] * waiting["wide"] / price, kind="stable")
        chosen[order] = np.cumsum(price[order]) <= _STAGE * left
    return chosen


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


def _judged(
    forest: Forest, cells: np.ndarray, images: np.ndarray, pixels: Pixels, rays: _Rays
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How many pixels off what lies in cells may be seen, if it is interpolated, how many wide, and whether that is in
    doubt; (N,) each.

    `images` (N, 12, 4) are those of corners and middles. What has nothing to show is not off.
    """
    shown, lost = pixels(images[..., :3]), images[..., 3] > _LOST
    some, every = lost.any(axis=1), lost.all(axis=1)
    edge = forest.edges[cells["cell"]]
    radius = forest.radii[cells["cell"]] - edge
    away = np.linalg.norm(forest.centres[cells["cell"]] - rays.centre[cells["row"]], axis=1)
    low, high = rays.bounds[cells["row"], 0], rays.bounds[cells["row"], 1]
    most = (high - low).max(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):  # what is not before the camera is seen nowhere
        least, last = (np.where(lost[..., None], far, shown) for far in (np.inf, -np.inf))
        least, last = least.min(axis=1), last.max(axis=1)
        wide = (last - least).max(axis=1)
        beyond = edge / np.maximum(2.0 * radius, 1e-30) * wide
        around = (_BESIDE * wide + beyond + _AROUND)[:, None]
        beside = ((least - around > high) | (last + around < low)).any(axis=1)
        off = _bent_off(images, shown, pixels)
        doubtful = ~np.isfinite(off) | (wide > _WIDEST)
        # As wide as the bundle's rays say, which are seen so wide.
        by_rays = (radius + edge / 2.0) / away * most / rays.spread[cells["row"]]
        wide = np.fmin(np.where(some, by_rays, wide + beyond), most)
    off = np.where(some, _DOUBT * wide, np.where(doubtful, wide, np.fmin(off, wide)))
    nothing = (every | beside) & (radius <= _SMALL * away)
    return np.where(nothing, 0.0, off), wide, some & ~nothing


def _bent_off(images: np.ndarray, shown: np.ndarray, pixels: Pixels) -> np.ndarray:
    """(N,) how many pixels off something may be where it is interpolated as `refined` says."""
    corners = images[:, :MIDDLES, :3]
    straight = corners[:, EDGES].mean(axis=2)
    middle = corners.mean(axis=1) + _bows(images).sum(axis=1)
    bent = np.linalg.norm(pixels(straight) - shown[:, MIDDLES:-1], axis=2).sum(axis=1)
    return _SURELY * np.linalg.norm(pixels(middle) - shown[:, -1], axis=1) + _BENT * bent


def _over(operation: np.ufunc, values: np.ndarray, first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """(N,) of the values from each `first` on, so many; 0 of none."""
    result, some = np.zeros(len(first)), np.flatnonzero(count)
    if len(some):
        ends = np.stack([first[some], first[some] + count[some]], axis=1).ravel()
        result[some] = operation.reduceat(np.append(values, 0), ends)[::2]
    return result


def ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Whole numbers from each `first`, so many; one range after another."""
    return np.repeat(first - first_of(count)[:-1], count) + np.arange(count.sum())


def first_of(counts: Sequence[int]) -> np.ndarray:
    """Where each of some parts begins among all, and in the end how many there are."""
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)


def _joined(parts: Sequence[np.ndarray], columns: int = 0) -> np.ndarray:
    return np.concatenate(parts) if parts else np.zeros((0, columns) if columns else 0, np.int64)
