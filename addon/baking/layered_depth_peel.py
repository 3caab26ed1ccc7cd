"""Depth peeling along one axis of an object's box (Zhang et al., 3.4), exact to the last bit."""

from dataclasses import dataclass
from typing import NamedTuple

import moderngl
import numpy as np

from ..gl import DataTexture, program, read_back, require
from ..progress import Progress, part_of, silent

_NOTHING = 1.5
"""Between any depth (0 to 1) and the shader's mark for "nothing behind", 2."""


class _Side(NamedTuple):
    """What passes from one side have found, the depth behind it in each texel, and the fragments from there on.

    `share` is that of all fragments which were found, 0..1.
    """

    found: list[tuple[np.ndarray, ...]]
    next_depth: np.ndarray
    beyond: int
    share: float


@dataclass(frozen=True, eq=False)
class Crossings:
    """Where the lines through the texel centres of one axis cross a mesh. C crossings.

    `texel` (C,) int32, u + columns × v; `depth` (C,) float32, 0 at the low face of the box to 1 at
    the high one; `front` and `back` (C,) int32: the triangle that faces the low face and the one that
    faces away, -1 for none; `turn` (C,) int32: closed surfaces entered less closed surfaces left. All
    in the order of texel, then depth; surfaces that coincide in a texel are one crossing.
    `cut` counts the fragments left out between what both sides keep, and the texels that miss some.
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

    def peel(self, axis: int, shape: tuple[int, int], most: int, progress: Progress = silent) -> Crossings:
        """Every crossing along `axis`, on a face of `shape` (columns along u, rows along v).

        u lies along axis + 1 and v along axis + 2, modulo 3. Of a texel with more than `most` crossings,
        `most` are kept from either side. `progress` counts fragments, and may stop the work after every pass.
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
            low = self._side(1.0, textures, targets, most, progress)
            if not low.beyond:
                return _ordered(low.found, (0, 0))
            return _joined(low, self._side(-1.0, textures, targets, most, part_of(progress, low.share, 1.0)))
        finally:
            context.blend_equation = moderngl.FUNC_ADD
            for part in (planes, *targets, *textures):
                part.release()

    def _side(self, side: float, textures, targets, most: int, progress: Progress) -> "_Side":
        """The first `most` crossings of every texel, seen from the low face (`side` 1) or the high one (-1)."""
        self._program["side"] = side
        query = require().query(samples=True)
        targets[1].clear(2.0)  # nothing has been reached: the first pass counts all that there is
        with query:
            depth = -self._draw(textures[1], targets[0])[:, 0]
        fragments, share = query.samples, 0.0
        found: list[tuple[np.ndarray, ...]] = []
        for index in range(1, most + 1):
            texel = np.flatnonzero(depth < _NOTHING)
            if not len(texel):
                return _Side(found, depth, 0, share)
            picture = self._draw(textures[(index + 1) % 2], targets[index % 2])
            front, back, turn = picture[texel, 1:].T.astype(np.int32)
            found.append((texel.astype(np.int32), side * depth[texel], front - 1, back - 1, turn))
            depth = -picture[:, 0]
            share = min(1.0, share + len(texel) / fragments)
            progress("peeling layers", share)
        with query:
            self._draw(textures[most % 2], targets[(most + 1) % 2])
        return _Side(found, depth, query.samples, share)

    def _draw(self, previous: moderngl.Texture, target: moderngl.Framebuffer) -> np.ndarray:
        """One pass; (texels, 4) float32 of what it found."""
        target.use()
        target.clear(-2.0, 0.0, 0.0, 0.0)
        previous.use(1)
        self._array.render(moderngl.TRIANGLES)
        return np.frombuffer(read_back(target, components=4, dtype="f4"), np.float32).reshape(-1, 4)

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


def _ordered(found: list[tuple[np.ndarray, ...]], cut: tuple[int, int]) -> Crossings:
    """The passes' finds in the order of texel, then depth."""
    empty = [np.zeros(0, dtype) for dtype in (np.int32, np.float32, np.int32, np.int32, np.int32)]
    columns = [np.concatenate(parts) for parts in zip(*found, strict=True)] if found else empty
    order = np.lexsort((columns[1], columns[0]))
    return Crossings(*(column[order] for column in columns), cut)


def _joined(low: _Side, high: _Side) -> Crossings:
    """What either side has found, once. What both missed is cut."""
    both = _ordered(low.found + high.found, (0, 0))
    fresh = np.concatenate([[True], (np.diff(both.texel) != 0) | (np.diff(both.depth) != 0)])
    nearest = np.full(len(low.next_depth), 2.0, np.float32)
    np.minimum.at(nearest, *(np.concatenate([part[column] for part in high.found]) for column in (0, 1)))
    texels = int((low.next_depth < nearest).sum())
    known = sum(len(part[0]) for part in low.found)
    fragments = max(0, low.beyond - (int(fresh.sum()) - known)) if texels else 0
    columns = (both.texel, both.depth, both.front, both.back, both.turn)
    return Crossings(*(column[fresh] for column in columns), (fragments, texels))
