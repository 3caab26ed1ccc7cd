"""Potential reflection regions (Zhang et al., 3.2 and appendix): which objects a reflector's triangle may show."""

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ..drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility, first_triangles, world_to_clip
from ..gl import DataTexture, on_gl_thread, program, read_back, require, screen, set_uniforms
from ..gl.textures import WIDTH
from ..scene import Camera, Instance, Mesh, Scene

_WORD = 32


@dataclass(frozen=True)
class Removed:
    """What the region test spares, as shares in 0..1 of the reflectors' triangles and of their fragments.

    `triangles` and `fragments` show no object at all; `triangle_searches` and `fragment_searches` count
    pairs of a triangle (fragment) and an object.
    """

    triangles: float
    fragments: float
    triangle_searches: float
    fragment_searches: float


class Regions:
    """The region test of reflectors, all of a scene's unless given, on the GPU; lives on the GL thread.

    Each triangle of a reflector is a small plane mirror. Around the bounding sphere of an object's
    mirror image lies a cone with its apex in the eye; where triangle and cone meet, the object may
    show. Its limits are the paper's: interpolated normals reflect elsewhere than the triangle's plane,
    so that a coarse curved mirror may lose a rim; an orthographic camera has no apex and tests nothing.
    """

    def __init__(self, resident: Resident, reflectors: Sequence[int] | None = None) -> None:
        """Make the table; `update` fills it."""
        context = require()
        scene = resident.scene
        self._resident = resident
        self.words = max(1, -(-len(scene.instances) // _WORD))
        chosen = scene.reflectors if reflectors is None else reflectors
        counts = np.array([len(mesh.triangles) for mesh in scene.meshes], np.int64)
        self._first_triangle = first_triangles(resident.scene)
        self._counts = {index: int(counts[scene.instances[index].mesh]) for index in chosen}
        self._first_row, rows = {}, -(-len(scene.instances) // WIDTH)
        for index, count in self._counts.items():
            self._first_row[index], rows = rows, rows - (-count * self.words // WIDTH)
        self._texture = context.texture((WIDTH, max(1, rows)), 1, dtype="u4")
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._write_starts(scene)
        self._target = context.framebuffer([self._texture])
        self._spheres = DataTexture(bounding_spheres(scene))
        self._shader = program(None, "regions/regions.frag")
        self._screen = screen(self._shader)

    def _write_starts(self, scene: Scene) -> None:
        """The first rows say where each instance's words begin, less its mesh's first triangle, modulo 2³²."""
        starts = np.zeros(-(-len(scene.instances) // WIDTH) * WIDTH, np.int64)
        for index, row in self._first_row.items():
            starts[index] = row * WIDTH - self._first_triangle[scene.instances[index].mesh] * self.words
        rows = len(starts) // WIDTH
        self._texture.write(starts.astype(np.uint32), viewport=(0, 0, WIDTH, rows) if rows else None)

    def update(self, camera: Camera) -> None:
        """Test every triangle of every reflector for the eye of `camera`."""
        self._target.use()
        require().enable_only(moderngl.NOTHING)
        self._resident.bind(self._shader)
        self._spheres.use(FREE_UNIT)
        uniforms = {
            "spheres": FREE_UNIT,
            "objects": len(self._resident.scene.instances),
            "region_words": self.words,
            "eye": tuple(camera.position),
            "orthographic": camera.ortho_scale is not None,
        }
        set_uniforms(self._shader, uniforms)
        for index, count in self._counts.items():
            mesh, row = self._resident.scene.instances[index].mesh, self._first_row[index]
            self._shader["reflector"], self._shader["triangles"] = index, count
            self._shader["first_triangle"], self._shader["first_row"] = int(self._first_triangle[mesh]), row
            require().viewport = (0, row, WIDTH, -(-count * self.words // WIDTH))
            self._screen.render(vertices=3)

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Set what gpu_shaders/regions/mask.glsl reads, on one texture unit."""
        self._texture.use(unit)
        shader["regions"], shader["region_words"] = unit, self.words

    def masks(self) -> dict[int, np.ndarray]:
        """(T, words) uint32 for each reflector's instance: bit i of word w is instance 32 w + i."""
        rows = np.frombuffer(read_back(self._texture), np.uint32)
        starts = {index: row * WIDTH for index, row in self._first_row.items()}
        return {
            index: rows[start : start + self._counts[index] * self.words].reshape(-1, self.words)
            for index, start in starts.items()
        }

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self._texture, self._spheres):
            part.release()


def bounding_spheres(scene: Scene) -> np.ndarray:
    """(I, 4) float32: world centre and radius around each instance; radius -1 where reflections do not see it."""
    rows = np.full((max(1, len(scene.instances)), 4), -1.0, np.float32)
    for row, instance in zip(rows, scene.instances, strict=False):
        if instance.in_reflections and len(scene.meshes[instance.mesh].triangles):
            row[:] = _sphere(instance, scene.meshes[instance.mesh])
    return rows


def _sphere(instance: Instance, mesh: Mesh) -> tuple[float, ...]:
    """Around the middle of the box, reaching to the farthest corner."""
    points = mesh.positions[np.unique(mesh.triangles)].astype(np.float64)
    points = points @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return (*centre, float(np.linalg.norm(points - centre, axis=1).max()) * (1.0 + 1e-6))


@on_gl_thread
def region_view(resident: Resident, camera: Camera, width: int, height: int) -> tuple[np.ndarray, Removed]:
    """The debug view, (height, width, 3) float32, row 0 the top, and what the test removes in it.

    On reflectors: green, the brighter the more objects the triangle may show; red where it shows none.
    """
    regions, visibility = Regions(resident), Visibility(width, height)
    texture = require().texture((width, height), 4, dtype="f4")
    target = require().framebuffer([texture])
    try:
        regions.update(camera)
        visibility.draw(resident, world_to_clip(camera, width, height))
        view = ScreenPass("regions/view.frag", resident, Part.REFLECTORS)
        view.shader["objects"] = len(resident.scene.instances)
        regions.bind(view.shader, FREE_UNIT + 1)
        target.clear()
        view.draw(camera, visibility, target)
        picture = np.frombuffer(read_back(texture), np.float32).reshape(height, width, 4)[::-1, :, :3].copy()
        seen = np.frombuffer(read_back(visibility.texture), np.uint32).reshape(-1, 2)
        return picture, removed(resident.scene, regions.masks(), seen)
    finally:
        for part in (regions, visibility, target, texture):
            part.release()


def removed(scene: Scene, masks: dict[int, np.ndarray], seen: np.ndarray) -> Removed:
    """What `masks` spare; `seen` (pixels, 2) holds instance + 1 and the triangle of the scene, as `Visibility` does."""
    first = first_triangles(scene)
    shown = [instance.in_reflections for instance in scene.instances]
    left: dict[str, list[np.ndarray]] = {"triangles": [np.zeros(0)], "fragments": [np.zeros(0)]}
    for index, mask in masks.items():
        objects = max(1, sum(shown) - shown[index])
        share = _bits(mask) / objects
        left["triangles"].append(share)
        pixels = seen[seen[:, 0] == index + 1, 1].astype(np.int64)
        left["fragments"].append(share[pixels - first[scene.instances[index].mesh]])
    triangles, fragments = (np.concatenate(parts) for parts in left.values())
    parts = (triangles == 0, fragments == 0, 1.0 - triangles, 1.0 - fragments)
    return Removed(*(float(part.mean()) if len(part) else 0.0 for part in parts))


def _bits(mask: np.ndarray) -> np.ndarray:
    """How many bits each row has set."""
    return np.unpackbits(np.ascontiguousarray(mask).view(np.uint8), axis=1).sum(axis=1)
