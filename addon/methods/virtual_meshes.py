"""What a scene's reflectors show, as meshes whose vertices are searched or lie in cells whose corners are."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ..drawing import first_triangles
from ..gl import DataTexture, require
from ..scene import Mesh, Scene
from ..tracing import interpolation_grid


class VirtualMeshes:
    """Instances of a scene, in the world, ready to be drawn as they are mirrored. Lives on the GL thread.

    Instance n of those `shown` has the points `points[n]` to `points[n + 1]`, which are to be searched, the triangles
    likewise, and lies in the ball of `centres` (N, 3) and `radii` (N,).
    """

    def __init__(self, scene: Scene, shown: Sequence[int], share: float) -> None:
        """Upload the instances `shown`; `share` of their vertices are searched, those of grids, or with 0 all."""
        parts = [_placed(scene, index, share) for index in shown]
        points, cells, vertices, triangles, sources = ([part[column] for part in parts] for column in range(5))
        self.has_grid = share > 0.0
        self.points = _first(points)
        self.triangles = _first(triangles)
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
        self._cells, self._sources = DataTexture(corners.reshape(-1, 4)), DataTexture(_joined(sources, _NO_SOURCE))

    def by_point(self, shader: moderngl.Program) -> moderngl.VertexArray:
        """A vertex array of each point to search."""
        return require().vertex_array(shader, [(self._points, "3f", "position")])

    def by_triangle(self, shader: moderngl.Program) -> moderngl.VertexArray:
        """A vertex array of the vertices of each triangle."""
        vertices = (
            (self._vertices, "3f 1i 3f", "position", "cell", "place")
            if self.has_grid
            else (self._vertices, "3f 16x", "position")
        )
        return require().vertex_array(shader, [vertices], self._indices)

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Bind the tables to two texture units from `unit` on."""
        for offset, (name, table) in enumerate({"sources": self._sources, "cells": self._cells}.items()):
            if name in shader:
                table.use(unit + offset)
                shader[name] = unit + offset

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._points, self._vertices, self._indices, self._cells, self._sources):
            part.release()


_VERTEX = np.dtype([("position", np.float32, 3), ("cell", np.int32), ("place", np.float32, 3)])
_NO_SOURCE = np.zeros((1, 2), np.int32)


def _placed(scene: Scene, index: int, share: float) -> tuple[np.ndarray, ...]:
    """World points to search (G, 3), cells (C, 8), vertices (V,), triangles (T, 3) and their sources (T, 2)."""
    instance = scene.instances[index]
    mesh = scene.meshes[instance.mesh]
    points, cells, vertices = _searched(mesh, share)
    vertices["position"] = _moved(instance.matrix, vertices["position"])
    good = np.isfinite(mesh.positions).all(axis=1)
    # A triangle with a corner that is nowhere keeps its number, and no area.
    triangles = np.where(good[mesh.triangles].all(axis=1, keepdims=True), mesh.triangles, 0)
    numbers = first_triangles(scene)[instance.mesh] + np.arange(len(triangles))
    sources = np.stack([numbers, np.full(len(triangles), index)], axis=1).astype(np.int32)
    return _moved(instance.matrix, points), cells, vertices, triangles, sources


def _searched(mesh: Mesh, share: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The points of a mesh that are searched, its cells, and each vertex' cell and place in it."""
    positions = np.where(np.isfinite(mesh.positions), mesh.positions, 0.0)
    vertices = np.zeros(len(positions), _VERTEX)
    vertices["position"] = positions
    if not share:
        return positions, np.zeros((0, 8), np.int64), vertices
    grid = interpolation_grid(positions, share)
    vertices["cell"], vertices["place"] = grid.cell, grid.place
    return grid.corners, grid.cells, vertices


def _moved(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def _first(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Where each begins among all, and in the end how many there are."""
    return np.concatenate([[0], np.cumsum([len(part) for part in parts])]).astype(np.int64)


def _shifted(parts: Sequence[np.ndarray], first: np.ndarray) -> list[np.ndarray]:
    return [part + at for part, at in zip(parts, first, strict=False)]


def _joined(parts: Sequence[np.ndarray], instead: np.ndarray) -> np.ndarray:
    """One after another; `instead` where there is none, since OpenGL has no empty buffers."""
    return np.concatenate(parts) if sum(map(len, parts)) else instead
