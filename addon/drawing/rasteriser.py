"""The meshes of a Scene as vertex buffers, and a picture of which triangle is where."""

from collections.abc import Iterable

import moderngl
import numpy as np

from ..gl import program, require
from ..scene import Mesh, Scene
from .tables import first_triangles

_CLIP_DISTANCE = 0x3000

MOST_CUTS = 8
"""Planes that OpenGL promises to cut geometry by."""


class Rasteriser:
    """Draws (instance + 1, triangle) of what a camera sees. Lives on the GL thread."""

    def __init__(self) -> None:
        """Begin without meshes; `take` brings them."""
        self._buffers: dict[Mesh, tuple[moderngl.Buffer, moderngl.Buffer]] = {}
        self._arrays: dict[tuple[Mesh, int], moderngl.VertexArray] = {}

    def take(self, scene: Scene) -> None:
        """Draw this scene from now on; meshes that stay are not uploaded again."""
        self._scene = scene
        self._first_triangle = first_triangles(scene)
        gone = self._buffers.keys() - set(scene.meshes)
        for key in [key for key in self._arrays if key[0] in gone]:
            self._arrays.pop(key).release()
        for mesh in gone:
            for buffer in self._buffers.pop(mesh):
                buffer.release()
        context = require()
        for mesh in set(scene.meshes) - self._buffers.keys():
            vertices = context.buffer(np.ascontiguousarray(mesh.positions, np.float32))
            indices = context.buffer(np.ascontiguousarray(mesh.triangles, np.int32))
            self._buffers[mesh] = vertices, indices

    def draw(self, world_to_clip: np.ndarray, shown: Iterable[int], cuts: np.ndarray | None = None) -> None:
        """Draw the instances `shown` into the bound framebuffer.

        `world_to_clip` (4, 4) float64; `cuts` (N, 4) float64 world planes, N up to `MOST_CUTS`: what is on their
        negative side is cut away.
        """
        planes = np.zeros((0, 4)) if cuts is None else cuts
        context = require()
        shader = program("visibility/visibility.vert", "visibility/visibility.frag", {"CUTS": len(planes)})
        for number in range(len(planes)):
            context.enable_direct(_CLIP_DISTANCE + number)
        for index in shown:
            self._draw(shader, index, world_to_clip, planes)
        for number in range(len(planes)):
            context.disable_direct(_CLIP_DISTANCE + number)

    def _draw(self, shader: moderngl.Program, index: int, world_to_clip: np.ndarray, planes: np.ndarray) -> None:
        instance = self._scene.instances[index]
        # Products in double precision: a float chain loses far scenes.
        matrix = (world_to_clip @ instance.matrix).astype(np.float32)
        shader["object_to_clip"].write(matrix.T.tobytes())
        if len(planes):
            shader["cuts"].write((planes @ instance.matrix).astype(np.float32).tobytes())
        shader["instance"] = index + 1
        shader["first_triangle"] = int(self._first_triangle[instance.mesh])
        self._array(self._scene.meshes[instance.mesh], len(planes)).render(moderngl.TRIANGLES)

    def _array(self, mesh: Mesh, cuts: int) -> moderngl.VertexArray:
        if (mesh, cuts) not in self._arrays:
            shader = program("visibility/visibility.vert", "visibility/visibility.frag", {"CUTS": cuts})
            vertices, indices = self._buffers[mesh]
            self._arrays[mesh, cuts] = require().vertex_array(shader, [(vertices, "3f", "position")], indices)
        return self._arrays[mesh, cuts]

    def release(self) -> None:
        """Give the GPU memory back."""
        for array in self._arrays.values():
            array.release()
        for buffer in (buffer for pair in self._buffers.values() for buffer in pair):
            buffer.release()
