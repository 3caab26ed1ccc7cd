"""All that may be seen in reflectors, as triangles small enough that straight pieces make their curved images."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ...baking.reflector_maps_tables import ResidentMaps
from ...drawing import first_triangles
from ...gl import DataTexture, require
from ...scene import Scene
from ...tracing import Near, cut_near

_CHUNK = 64
"""Triangles that are searched, or left out, together."""


_LEAST_CURVED = 0.3
"""Of a reflector's size: a radius of curvature below which it makes no difference; that of a ball is about this."""


class VirtualScene:
    """The scene's triangles in the world, in chunks of what lies together. Lives on the GL thread.

    A triangle that is large for its distance from a reflector is cut; `sources` tells of each piece which triangle
    of which instance it belongs to. Chunk n has the points `points[n]` to `points[n + 1]`, the triangles likewise, and
    lies in the ball of `centres` (C, 3) and `radii` (C,).
    """

    def __init__(self, scene: Scene, maps: ResidentMaps, share: float, least: float) -> None:
        """Upload what reflections see of a scene.

        No edge is longer than `share` of its distance from the nearest part of a reflector, but `least` of the radius
        that the part is curved by is short enough.
        """
        corners, sources = _pieces(scene, _reflectors(maps, least), share)
        chunk = np.arange(len(corners)) // _CHUNK
        points, indices, self.points = _shared_points(corners.astype(np.float32), chunk)
        self.triangles = np.append(np.arange(0, len(corners), _CHUNK), len(corners))
        self.centres, self.radii = _balls(corners, self.triangles[:-1])
        context = require()
        self._points = context.buffer(points if len(points) else np.zeros((1, 3), np.float32))
        self._indices = context.buffer(indices if len(indices) else np.zeros(3, np.int32))
        self._sources = DataTexture(sources)

    def by_point(self, shader: moderngl.Program) -> moderngl.VertexArray:
        """A vertex array of each point, once."""
        return require().vertex_array(shader, [(self._points, "3f", "position")])

    def by_triangle(self, shader: moderngl.Program) -> moderngl.VertexArray:
        """A vertex array of three points for each piece of a triangle."""
        return require().vertex_array(shader, [(self._points, "3f", "position")], self._indices)

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Bind `sources` to a texture unit."""
        self._sources.use(unit)
        shader["sources"] = unit

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._points, self._indices, self._sources):
            part.release()


def _reflectors(maps: ResidentMaps, least: float) -> list[Near]:
    """What triangles must be small for. What shows in a small part of a large reflector shows small there."""
    things = []
    for owner in np.unique(maps.owner):
        boxes = maps.boxes[maps.owner == owner]
        size = np.linalg.norm(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0))
        radii = maps.curvature_radii[maps.owner == owner]
        things.append(Near(boxes, least * np.maximum(radii, _LEAST_CURVED * size)))
    return things


def _pieces(scene: Scene, reflectors: list[Near], share: float) -> tuple[np.ndarray, np.ndarray]:
    """(T, 3, 3) float64 corners in the world and (T, 2) int32 sources; what lies together stands together."""
    pieces, sources = [np.zeros((0, 3, 3))], [np.zeros((0, 2), np.int32)]
    for index, instance in enumerate(scene.instances):
        if not instance.in_reflections:
            continue
        corners = scene.meshes[instance.mesh].corners.astype(np.float64)
        corners = corners @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
        good = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
        cut, piece_of = cut_near(corners[good], reflectors, share)
        order = _by_place(cut)
        triangles = first_triangles(scene)[instance.mesh] + good[piece_of[order]]
        pieces.append(cut[order])
        sources.append(np.stack([triangles, np.full(len(order), index)], axis=1).astype(np.int32))
    return np.concatenate(pieces), np.concatenate(sources)


def _by_place(corners: np.ndarray) -> np.ndarray:
    """(T,) an order of triangles in which neighbours stand together: along Morton's curve."""
    if not len(corners):
        return np.zeros(0, np.int64)
    middles = corners.mean(axis=1)
    low, size = middles.min(axis=0), max(float(np.ptp(middles, axis=0).max()), 1e-30)
    cells = ((middles - low) / size * 1023).astype(np.int64)
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | cells << shift) & mask
    return np.argsort(cells[:, 0] | cells[:, 1] << 1 | cells[:, 2] << 2, kind="stable")


def _shared_points(corners: np.ndarray, chunk: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The points (P, 3) of triangles (T, 3, 3), each once in a chunk; (T, 3) int32 into them; where chunks begin."""
    rows = np.empty(3 * len(corners), [("chunk", np.int32), ("x", np.float32), ("y", np.float32), ("z", np.float32)])
    rows["chunk"] = np.repeat(chunk, 3)
    rows["x"], rows["y"], rows["z"] = (corners.reshape(-1, 3) + np.float32(0.0)).T  # no -0 beside 0
    keys = np.frombuffer(rows.tobytes(), np.dtype((np.void, rows.dtype.itemsize)))
    _, first, indices = np.unique(keys, return_index=True, return_inverse=True)
    order = np.lexsort([first, rows["chunk"][first]])
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order))
    chosen = first[order]
    counts = np.bincount(rows["chunk"][chosen], minlength=int(chunk[-1]) + 1 if len(chunk) else 0)
    points = corners.reshape(-1, 3)[chosen]
    return points, rank[indices].reshape(-1, 3), np.concatenate([[0], np.cumsum(counts)])


def _balls(corners: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Balls that hold the triangles of each chunk: middles of their boxes, half of their diagonals."""
    if not len(first):
        return np.zeros((0, 3)), np.zeros(0)
    low = np.minimum.reduceat(corners.min(axis=1), first, axis=0)
    high = np.maximum.reduceat(corners.max(axis=1), first, axis=0)
    return (low + high) / 2.0, np.linalg.norm(high - low, axis=1) / 2.0


def runs_of(chosen: np.ndarray) -> Sequence[tuple[int, int]]:
    """First and last, plus 1, of every run of chunks in a row that are `chosen` (C,) bool."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], chosen.astype(np.int8), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
