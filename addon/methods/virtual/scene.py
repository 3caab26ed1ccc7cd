"""All that may be seen in reflectors, as triangles small enough that straight pieces make their curved images."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ...baking.reflector_maps_tables import ResidentMaps
from ...drawing import first_triangles
from ...gl import DataTexture, require
from ...scene import Scene
from ...tracing import Near
from .cuts import Cuts

_LEAST_CURVED = 0.3
"""Of a reflector's size: a radius of curvature below which it makes no difference; that of a ball is about this."""


class VirtualScene:
    """The scene's triangles in the world, in chunks of what lies together. Lives on the GL thread.

    A triangle that is large for its distance from a reflector is cut; `sources` tells of each piece which triangle
    of which instance it belongs to. Chunk n has the points `points[n]` to `points[n + 1]`, the triangles likewise, and
    lies in the ball of `centres` (C, 3) and `radii` (C,).
    """

    def __init__(self, scene: Scene, maps: ResidentMaps, share: float, least: float, cuts: Cuts) -> None:
        """Upload what reflections see of a scene.

        No edge is longer than `share` of its distance from the nearest part of a reflector, but `least` of the radius
        that the part is curved by is short enough. `cuts` spares what an earlier scene was cut into already.
        """
        parts, first = cuts.of(scene, _reflectors(maps, least), share), first_triangles(scene)
        pieces = list(parts.values())
        self.points = _one_after_another([part.first_points for part in pieces])
        self.triangles = _one_after_another([part.first_triangles for part in pieces])
        self.centres = np.concatenate([np.zeros((0, 3)), *(part.centres for part in pieces)])
        self.radii = np.concatenate([np.zeros(0), *(part.radii for part in pieces)])
        begins = np.cumsum([0, *(len(part.points) for part in pieces)])
        corners = [part.corners + np.int32(begin) for part, begin in zip(pieces, begins, strict=False)]
        sources = [
            np.stack([first[scene.instances[index].mesh] + part.sources, np.full(len(part.sources), index)], axis=1)
            for index, part in parts.items()
        ]
        context = require()
        self._points = context.buffer(_joined([part.points for part in pieces], np.float32))
        self._indices = context.buffer(_joined(corners, np.int32))
        self._sources = DataTexture(np.concatenate([np.zeros((0, 2), np.int32), *sources]).astype(np.int32))

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


def _one_after_another(firsts: Sequence[np.ndarray]) -> np.ndarray:
    """Where chunks begin among those of all, from where those of each begin; and the end."""
    ends = np.cumsum([0, *(first[-1] for first in firsts)])
    return np.concatenate([*(first[:-1] + end for first, end in zip(firsts, ends, strict=False)), ends[-1:]])


def _joined(parts: Sequence[np.ndarray], dtype: type) -> np.ndarray:
    """Rows of three of all parts; one of zeros where there is none, so that its buffer exists."""
    rows = np.concatenate([np.zeros((0, 3), dtype), *parts])
    return rows if len(rows) else np.zeros((1, 3), dtype)


def runs_of(chosen: np.ndarray) -> Sequence[tuple[int, int]]:
    """First and last, plus 1, of every run of chunks in a row that are `chosen` (C,) bool."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], chosen.astype(np.int8), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
