"""Reflector cube maps on the GPU."""

from collections.abc import Sequence
from functools import cached_property

import moderngl
import numpy as np

from ..drawing import first_triangles
from ..gl import DataTexture
from ..scene import Scene
from ..tracing import Curvature, placed_box
from .reflector_maps import ReflectorMap

UNITS = 2
"""Texture units that the tables take."""

_MOST_PLACES = 1 << 8
"""Of a part, whose boxes are remembered; a mesh may have hundreds of parts."""


class ResidentMaps:
    """The maps of some reflectors as gpu_shaders/virtual/maps.glsl reads them. Lives on the GL thread.

    A part is known by its number among the parts of all reflectors, from 1 on. `owner` (P,) is the instance of each,
    `maps` (P,) its maps, so that part n stands at n - 1.
    """

    def __init__(self, scene: Scene, maps: dict[int, Sequence[ReflectorMap]]) -> None:
        """Upload `maps`, a list for each instance of a reflector; lists of meshes that are the same, once."""
        self._scene = scene
        self.maps = [part for parts in maps.values() for part in parts]
        self.owner = np.repeat(list(maps), [len(parts) for parts in maps.values()]).astype(int)
        first, texels = _texels(self.maps)
        self._uniforms = self._by_part(first)
        self._texels = DataTexture(texels)
        self._numbers = DataTexture(_numbers(scene, maps))
        self._rows: DataTexture | None = None

    def _by_part(self, first: Sequence[int]) -> dict[str, np.ndarray]:
        """The uniforms of gpu_shaders/virtual that say which part it is, a row for each."""
        matrices = np.array([self.to_world(number + 1) for number in range(len(self.maps))]).reshape(-1, 4, 4)
        sizes = [(at, one.size, len(one.positions)) for at, one in zip(first, self.maps, strict=True)]
        # A patch has no such ball, and no search that would ask for it.
        balls = np.array([one.ball if one.is_whole else np.eye(3) for one in self.maps]).reshape(-1, 3, 3)
        return {
            "part_maps": np.array(sizes, np.int32),
            "part_reaches": np.array([one.reach for one in self.maps], np.float32),
            "part_bends": np.array([-1.0 if self.is_concave([n + 1]) else 1.0 for n in range(len(self.maps))], "f4"),
            "part_to_world": np.ascontiguousarray(matrices.transpose(0, 2, 1), np.float32),
            "ball_to_part": np.ascontiguousarray(balls.transpose(0, 2, 1), np.float32),
            "world_to_ball": np.ascontiguousarray(
                np.linalg.inv(matrices[:, :3, :3] @ balls).transpose(0, 2, 1), np.float32
            ),
            # The inverse of the transpose, transposed once more for GL.
            "normal_to_world": np.ascontiguousarray(np.linalg.inv(matrices[:, :3, :3]), np.float32),
        }

    def to_world(self, part: int) -> np.ndarray:
        """(4, 4) float64 from the frame of a part to the world."""
        return self._scene.instances[self.owner[part - 1]].matrix @ self.maps[part - 1].to_mesh

    def directions_of(self, part: int, points: np.ndarray) -> np.ndarray:
        """(N, 3) float32 unit directions from a part's centre, in its frame, to world points (N, 3)."""
        matrix = np.linalg.inv(self.to_world(part))
        ways = points @ matrix[:3, :3].T + matrix[:3, 3]
        return (ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-30)).astype(np.float32)

    @cached_property
    def boxes(self) -> np.ndarray:
        """(P, 2, 3) float64 low and high corners of the parts in the world."""
        placed = ((one, self.to_world(number)) for number, one in enumerate(self.maps, 1))
        boxes = [placed_box(one, one.shown, matrix, _MOST_PLACES) for one, matrix in placed]
        return np.array(boxes).reshape(-1, 2, 3)

    @cached_property
    def curvature_radii(self) -> np.ndarray:
        """(P,) metres: of the ball that turns as much as each part does over its size; infinite for a flat one."""
        sizes = np.linalg.norm(self.boxes[:, 1] - self.boxes[:, 0], axis=1) / 2.0
        turns = np.array([one.turn for one in self.maps])
        return np.divide(sizes, turns, out=np.full(len(sizes), np.inf), where=turns > 0.0)

    def is_concave(self, path: Sequence[int]) -> bool:
        """Whether any of some parts is hollow, so that a point may show more than once in it."""
        return any(self.maps[part - 1].part.curvature is Curvature.CONCAVE for part in path)

    def left_out(self, part: int) -> int:
        """The instance that a ray from a part cannot meet: its own, if that is convex; else -1."""
        return int(self.owner[part - 1]) if self.maps[part - 1].is_whole else -1

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Bind the tables to UNITS texture units from `unit` on."""
        for offset, (name, table) in enumerate({"map_texels": self._texels, "part_numbers": self._numbers}.items()):
            if name in shader:
                table.use(unit + offset)
                shader[name] = unit + offset

    def choose(self, shader: moderngl.Program, path: Sequence[int]) -> None:
        """Have the shader search a path that is reflected at these parts, one after the other."""
        rows = np.array(path) - 1
        for name, values in self._uniforms.items():
            if name in shader:
                shader[name].write(values[rows].tobytes())

    def bind_rows(self, shader: moderngl.Program, unit: int) -> None:
        """Have a shader that is compiled with MANY_PARTS choose parts by itself, by a table on a texture unit."""
        if self._rows is None:
            self._rows = DataTexture(self._by_row())
        self._rows.use(unit)
        shader["part_rows"] = unit

    def _by_row(self) -> np.ndarray:
        """(8 P, 4) float32: first texel in two numbers, size, faces | to the world | of normals; reach and bend."""
        rows = np.zeros((len(self.maps), 8, 4), np.float32)
        first, size, faces = self._uniforms["part_maps"].T
        rows[:, 0] = np.stack([first >> 12, first & 4095, size, faces], axis=1)
        rows[:, 1:5] = self._uniforms["part_to_world"]
        rows[:, 5:, :3] = self._uniforms["normal_to_world"]
        rows[:, 5, 3], rows[:, 6, 3] = self._uniforms["part_reaches"], self._uniforms["part_bends"]
        return rows.reshape(-1, 4)

    @property
    def size_bytes(self) -> int:
        """What the tables take on the GPU."""
        return self._texels.size_bytes + self._numbers.size_bytes

    def release(self) -> None:
        """Give the memory back."""
        for table in (self._texels, self._numbers, self._rows):
            if table:
                table.release()


def _texels(maps: Sequence[ReflectorMap]) -> tuple[list[int], np.ndarray]:
    """Where each part's texels begin, and two rows for each texel of all: position and normal."""
    placed: dict[int, int] = {}
    first, rows, count = [], [np.zeros((2, 4), np.float32)], 1
    for one in maps:
        if id(one) not in placed:
            texels = np.zeros((one.covered.size, 2, 4), np.float32)
            texels[:, 0, :3] = one.positions.reshape(-1, 3)
            texels[:, 0, 3] = one.covered.ravel()
            texels[:, 1, :3] = one.normals.reshape(-1, 3)
            rows.append(texels.reshape(-1, 4))
            placed[id(one)] = count
            count += one.covered.size
        first.append(placed[id(one)])
    return first, np.concatenate(rows)


def _numbers(scene: Scene, maps: dict[int, Sequence[ReflectorMap]]) -> np.ndarray:
    """(N, 2) uint32: a row for each instance: the place of its triangles' parts, less its first triangle, and which
    of the reflectors it is; then the triangles' parts, and whether each is a whole body."""
    starts = np.zeros((len(scene.instances), 2), np.int64)
    rows = [np.zeros((len(scene.instances), 2), np.uint32)]
    first_triangle, number = first_triangles(scene), 1
    for order, (index, parts) in enumerate(maps.items()):
        mesh = scene.instances[index].mesh
        starts[index] = sum(map(len, rows)) - first_triangle[mesh], order
        own = np.zeros((len(scene.meshes[mesh].triangles), 2), np.uint32)
        for part in parts:
            own[part.part.triangles] = number, part.is_whole
            number += 1
        rows.append(own)
    # Where a start would be negative it wraps, and comes back when the triangle is added.
    rows[0] = starts.astype(np.uint32)
    return np.concatenate(rows)
