"""What a scene's reflectors show, as meshes whose vertices are searched or lie in cells whose corners are."""

from collections.abc import Sequence
from enum import Enum

import moderngl
import numpy as np

from ...drawing import first_triangles, world_boxes
from ...gl import DataTexture, require
from ...scene import Scene
from ...tracing import Near, cell_tree, cut_near, interpolation_grid
from .cells import FEW, Forest

TABLES = 3
"""Texture units that the tables take."""

_LEAST = 0.1
"""Of a reflector's size: what is short enough for an edge, however near it is."""


_LEAST_GRID = 27
"""Vertices of a grid of two cells along each axis."""

_SET_ASIDE = 0.25


class Grid(Enum):
    """Where vertices get their images from, as gpu_shaders/virtual_published/mesh.vert knows it."""

    NONE = 0
    PUBLISHED = 1
    REFINED = 2


class VirtualMeshes:
    """Instances of a scene, in the world, ready to be drawn as they are mirrored. Lives on the GL thread.

    Instance n of those `shown` has the points `points[n]` to `points[n + 1]`, which are to be searched, the triangles
    likewise, and lies in the ball of `centres` (N, 3) and `radii` (N,).
    """

    def __init__(
        self, scene: Scene, shown: Sequence[int], grid: float, cut: float = 0.0, refined: bool = False
    ) -> None:
        """Upload the instances `shown`.

        `grid`: how many points are searched for each vertex, those of grids; with 0 all vertices are. `cut`: no edge is
        longer than that share of its distance from the nearest reflector, or a tenth of that one's size; with 0 all
        stay.
        `refined`: instead of grids there are trees of cells, in `forest`, and `points` counts all vertices.
        """
        parts = [one for one in (_placed(scene, index, cut) for index in shown) if len(one[0])]
        shares = shares_of([len(one[0]) for one in parts], grid)
        parts = [
            _in_cells(*one) if refined else _searched(*one, share) for one, share in zip(parts, shares, strict=True)
        ]
        points, cells, vertices, triangles, sources, trees = ([part[column] for part in parts] for column in range(6))
        self.grid = Grid.REFINED if refined else Grid.PUBLISHED if grid else Grid.NONE
        self.points = _first(points)
        self.triangles = _first(triangles)
        if refined:
            self.forest = Forest(trees, points, [_longest(*one) for one in zip(points, triangles, strict=True)])
        self.centres = np.array([(one.min(axis=0) + one.max(axis=0)) / 2.0 for one in points]).reshape(-1, 3)
        gaps = [np.linalg.norm(one - centre, axis=1).max() for one, centre in zip(points, self.centres, strict=True)]
        self.radii = np.array(gaps)
        first_cell, first_vertex = _first(cells), _first(vertices)
        for one, first in zip(vertices, first_cell, strict=False):
            one["cell"] += first
        context = require()
        self._points = context.buffer(_joined(points, np.zeros((1, 3))).astype(np.float32))
        self._vertices = context.buffer(_joined(vertices, np.zeros(1, _VERTEX)))
        self._indices = context.buffer(_joined(_shifted(triangles, first_vertex), np.zeros((1, 3))).astype(np.int32))
        corners = _joined(_shifted(cells, self.points), np.zeros((1, 8))).astype(np.int32)
        self._cells = DataTexture(corners.reshape(-1, 4))
        told = _joined(sources, np.zeros(1, _SOURCE))
        self._sources = DataTexture(np.stack([told["triangle"], told["instance"]], axis=1))
        self._corners = DataTexture(np.ascontiguousarray(told["corners"]).reshape(-1, 2))

    def by_point(self, shader: moderngl.Program) -> moderngl.VertexArray:
        """A vertex array of each point to search."""
        return require().vertex_array(shader, [(self._points, "3f", "position")])

    def by_triangle(self, shader: moderngl.Program) -> moderngl.VertexArray:
        """A vertex array of the vertices of each triangle."""
        vertices = (
            (self._vertices, "3f 1i 3f", "position", "cell", "place")
            if self.grid is Grid.PUBLISHED
            else (self._vertices, "3f 16x", "position")
        )
        return require().vertex_array(shader, [vertices], self._indices)

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Bind the tables to TABLES texture units from `unit` on."""
        tables = {"sources": self._sources, "source_corners": self._corners, "cells": self._cells}
        for offset, (name, table) in enumerate(tables.items()):
            if name in shader:
                table.use(unit + offset)
                shader[name] = unit + offset

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._points, self._vertices, self._indices, self._cells, self._sources, self._corners):
            part.release()


_VERTEX = np.dtype([("position", np.float32, 3), ("cell", np.int32), ("place", np.float32, 3)])
_SOURCE = np.dtype([("triangle", np.int32), ("instance", np.int32), ("corners", np.float32, (3, 2))])
_WHOLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
"""Barycentrics of a triangle's own corners."""


def _placed(scene: Scene, index: int, cut: float) -> tuple[np.ndarray, ...]:
    """World positions of vertices (V, 3), triangles (T, 3) and their sources (T,)."""
    instance = scene.instances[index]
    mesh = scene.meshes[instance.mesh]
    good = np.isfinite(mesh.positions).all(axis=1)
    world = np.where(good[:, None], mesh.positions, 0.0) @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
    kept = np.flatnonzero(good[mesh.triangles].all(axis=1))
    triangles, corners = mesh.triangles[kept], np.broadcast_to(_WHOLE, (len(kept), 3, 2))
    if cut:
        world, triangles, piece_of, corners = _cut(world[triangles], _near(scene), cut)
        kept = kept[piece_of]
    sources = np.zeros(len(triangles), _SOURCE)
    sources["triangle"], sources["instance"] = first_triangles(scene)[instance.mesh] + kept, index
    sources["corners"] = corners
    return world, triangles, sources


def _near(scene: Scene) -> list[Near]:
    """The reflectors: an edge of a tenth of one's size is short enough however near it is."""
    boxes = world_boxes(scene, scene.reflectors)
    return [Near(box[None], np.array([_LEAST * np.linalg.norm(box[1] - box[0])])) for box in boxes]


def _cut(corners: np.ndarray, things: Sequence[Near], share: float) -> tuple[np.ndarray, ...]:
    """Triangles (T, 3, 3) in pieces: points (P, 3), triangles (N, 3), which each is of (N,) and where (N, 3, 2)."""
    pieces, piece_of = cut_near(corners, things, share)
    points, triangles = np.unique(pieces.reshape(-1, 3).astype(np.float32), axis=0, return_inverse=True)
    a, b, c = (corners[piece_of, corner][:, None] for corner in range(3))
    normal = np.cross(b - a, c - a)
    area = np.maximum((normal * normal).sum(axis=2), 1e-300)
    v = (np.cross(pieces - a, c - a) * normal).sum(axis=2) / area
    w = (np.cross(b - a, pieces - a) * normal).sum(axis=2) / area
    return points, triangles.reshape(-1, 3), piece_of, np.stack([v, w], axis=2)


def _searched(positions: np.ndarray, triangles: np.ndarray, sources: np.ndarray, share: float) -> tuple:
    """World points to search (G, 3), cells (C, 8), vertices (V,), triangles (T, 3), their sources (T,), and no tree."""
    vertices = _vertices(positions)
    if share == 0.0:
        return positions, np.zeros((0, 8), np.int64), vertices, triangles, sources, None
    if share == 1.0:
        vertices["cell"] = np.arange(len(positions))
        return positions, np.repeat(vertices["cell"][:, None], 8, axis=1), vertices, triangles, sources, None
    grid = interpolation_grid(positions, share)
    vertices["cell"], vertices["place"] = grid.cell, grid.place
    return grid.corners, grid.cells, vertices, triangles, sources, None


def shares_of(counts: Sequence[int], share: float) -> np.ndarray:
    """(N,) what share of the vertices of meshes grids have, for `share` of all together; 1 where each is searched.

    A mesh too small for a grid is searched itself, the smallest first, as far as the part of the searches that is set
    aside for them goes; the others share the rest by their vertices.
    """
    counts = np.array(counts, np.float64)
    order = np.argsort(counts, kind="stable")
    whole = np.zeros(len(counts), bool)
    whole[order] = np.cumsum(counts[order]) <= _SET_ASIDE * share * counts.sum()
    whole &= counts * share < _LEAST_GRID
    rest = max(counts[~whole].sum(), 1.0)
    return np.where(whole, 1.0, min(1.0, (share * counts.sum() - counts[whole].sum()) / rest))


def _in_cells(positions: np.ndarray, triangles: np.ndarray, sources: np.ndarray) -> tuple:
    """The same, in the order of a tree of cells."""
    tree = cell_tree(positions, FEW)
    rank = np.empty(len(tree.order), np.int64)
    rank[tree.order] = np.arange(len(tree.order))
    positions = positions[tree.order]
    return positions, np.zeros((0, 8), np.int64), _vertices(positions), rank[triangles], sources, tree


def _vertices(positions: np.ndarray) -> np.ndarray:
    vertices = np.zeros(len(positions), _VERTEX)
    vertices["position"] = positions
    return vertices


def _longest(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(V,) the longest edge of any triangle that each vertex is a corner of."""
    corners = positions[triangles]
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    longest = np.zeros(len(positions))
    np.maximum.at(longest, triangles.ravel(), np.repeat(edges, 3))
    return longest


def _first(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Where each begins among all, and in the end how many there are."""
    return np.concatenate([[0], np.cumsum([len(part) for part in parts])]).astype(np.int64)


def _shifted(parts: Sequence[np.ndarray], first: np.ndarray) -> list[np.ndarray]:
    return [part + at for part, at in zip(parts, first, strict=False)]


def _joined(parts: Sequence[np.ndarray], instead: np.ndarray) -> np.ndarray:
    """One after another; `instead` where there is none, since OpenGL has no empty buffers."""
    return np.concatenate(parts) if sum(map(len, parts)) else instead
