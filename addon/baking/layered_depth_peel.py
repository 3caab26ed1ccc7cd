"""Depth peeling along one axis of an object's box (Zhang et al., 3.4), exact to the last bit."""

from dataclasses import dataclass

import moderngl
import numpy as np

from ..gl import DataTexture, program, require

_NOTHING = 1.5
"""Between any depth (0 to 1) and the shader's mark for "nothing behind", 2."""


@dataclass(frozen=True, eq=False)
class Crossings:
    """Where the lines through the texel centres of one axis cross a mesh. C crossings.

    `texel` (C,) int32, u + columns × v; `depth` (C,) float32, 0 at the low face of the box to 1 at
    the high one; `front` and `back` (C,) int32: the triangle that faces the low face and the one that
    faces away, -1 for none; `turn` (C,) int32: closed surfaces entered less closed surfaces left. All
    in the order of texel, then depth; surfaces that coincide in a texel are one crossing.
    `cut` counts fragments and texels beyond the cap.
    """

    texel: np.ndarray
    depth: np.ndarray
    front: np.ndarray
    back: np.ndarray
    turn: np.ndarray
    cut: tuple[int, int]


class Peeler:
    """A mesh on the GPU, ready to be peeled along any axis of its box; lives on the GL thread."""

    def __init__(self, places: np.ndarray, triangles: np.ndarray, solid: np.ndarray) -> None:
        """`places` (V, 3) float32 in 0..1 of the box, `triangles` (T, 3); `solid` (T,) bool: of a closed surface."""
        context = require()
        self._program = program("peel/peel.vert", "peel/peel.frag")
        self._places, self._triangles, self._solid = places, triangles, solid
        self._buffers = (
            context.buffer(np.ascontiguousarray(places, np.float32)),
            context.buffer(np.ascontiguousarray(triangles, np.int32)),
        )
        self._array = context.vertex_array(self._program, [(self._buffers[0], "3f", "place")], self._buffers[1])

    def peel(self, axis: int, shape: tuple[int, int], most: int) -> Crossings:
        """Every crossing along `axis`, on a face of `shape` (columns along u, rows along v); `most` a texel.

        u lies along axis + 1 and v along axis + 2, modulo 3.
        """
        context = require()
        planes = DataTexture(_planes(self._places, self._triangles, self._solid, axis))
        textures = [context.texture(shape, 4, dtype="f4") for _ in range(2)]
        targets = [context.framebuffer([texture]) for texture in textures]
        try:
            context.enable_only(moderngl.BLEND)
            context.blend_func = moderngl.ONE, moderngl.ONE
            context.blend_equation = moderngl.MAX, moderngl.FUNC_ADD
            self._program["axis"], self._program["shape"] = axis, shape
            planes.use(0)
            self._program["planes"], self._program["previous"] = 0, 1
            return self._passes(textures, targets, most)
        finally:
            context.blend_equation = moderngl.FUNC_ADD
            for part in (planes, *targets, *textures):
                part.release()

    def _passes(self, textures, targets, most: int) -> Crossings:
        layers: list[tuple[np.ndarray, ...]] = []
        targets[1].clear(1.0)  # a depth of -1: nothing has been reached
        depth = np.zeros(0, np.float32)
        for index in range(most + 1):
            picture = self._draw(textures[(index + 1) % 2], targets[index % 2])
            if index:
                texel = np.flatnonzero(depth < _NOTHING)
                front, back, turn = picture[texel, 1:].T.astype(np.int32)
                layers.append((texel.astype(np.int32), depth[texel], front - 1, back - 1, turn))
            depth = -picture[:, 0]
            if not (depth < _NOTHING).any():
                return _in_order(layers, (0, 0))
        query = require().query(samples=True)
        with query:
            self._draw(textures[most % 2], targets[(most + 1) % 2])
        return _in_order(layers, (query.samples, int((depth < _NOTHING).sum())))

    def _draw(self, previous: moderngl.Texture, target: moderngl.Framebuffer) -> np.ndarray:
        """One pass; (texels, 4) float32 of what it found."""
        target.use()
        target.clear(-2.0, 0.0, 0.0, 0.0)
        previous.use(1)
        self._array.render(moderngl.TRIANGLES)
        return np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(-1, 4)

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._array, *self._buffers):
            part.release()


def _planes(places: np.ndarray, triangles: np.ndarray, solid: np.ndarray, axis: int) -> np.ndarray:
    """(2 T, 4) float32: what gpu_shaders/peel/peel.frag computes depth from.

    A corner and two slopes rather than a plane equation, which would lose digits where it is steep.
    """
    corners = places.astype(np.float64)[:, [(axis + 1) % 3, (axis + 2) % 3, axis]][triangles]
    edge1, edge2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(edge1, edge2)
    safe = np.where(normal[:, 2] == 0.0, 1.0, normal[:, 2])
    rows = np.zeros((len(triangles), 2, 4), np.float32)
    rows[:, 0, :3] = corners[:, 0]
    rows[:, 0, 3], rows[:, 1, 2] = corners[..., 2].min(axis=1), corners[..., 2].max(axis=1)
    slopes = np.where(normal[:, 2:] == 0.0, 0.0, -normal[:, :2] / safe[:, None])
    rows[:, 1, :2] = np.clip(slopes, -1e30, 1e30)
    rows[:, 1, 3] = solid
    return rows.reshape(-1, 4)


def _in_order(layers: list[tuple[np.ndarray, ...]], cut: tuple[int, int]) -> Crossings:
    """The passes' finds, one after the other in each texel."""
    empty = [np.zeros(0, dtype) for dtype in (np.int32, np.float32, np.int32, np.int32, np.int32)]
    columns = [np.concatenate(parts) for parts in zip(*layers, strict=True)] if layers else empty
    order = np.argsort(columns[0], kind="stable")
    return Crossings(*(column[order] for column in columns), cut)
