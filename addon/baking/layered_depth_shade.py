"""Colour and normal of the crossings of an object (Zhang et al., 3.3): lit on the GPU, only where they are."""

import moderngl
import numpy as np

from ..drawing import FREE_UNIT, Resident
from ..gl import DataTexture, program, read_back, require, screen, set_uniforms
from ..gl.textures import WIDTH

_CHUNK = WIDTH * 512


class Shader:
    """Lights the crossings of one instance; lives on the GL thread."""

    def __init__(self, resident: Resident, instance: int, low: np.ndarray, size: np.ndarray) -> None:
        """`low` and `size` (3,) of the box in the mesh's space."""
        self._resident = resident
        self._shader = program(None, "peel/shade.frag", resident.defines)
        self._screen = screen(self._shader)
        counts = [len(mesh.triangles) for mesh in resident.scene.meshes]
        first = sum(counts[: resident.scene.instances[instance].mesh])
        self._uniforms = {"instance": instance, "first_triangle": first, "box_low": tuple(low), "box_size": tuple(size)}

    def shade(
        self, axis: int, shape: tuple[int, int], texel: np.ndarray, triangle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Colours and normals (L, 2, 3) float32 of layers: their `texel` (L,) and `triangle` (L, 2)."""
        crossings = np.stack([np.repeat(texel, 2), triangle.ravel()], axis=1).astype(np.uint32)
        colors, normals = np.zeros((2, len(crossings), 3), np.float32)
        for begin in range(0, len(crossings), _CHUNK):
            part = slice(begin, begin + _CHUNK)
            colors[part], normals[part] = self._chunk(axis, shape, crossings[part])
        return colors.reshape(-1, 2, 3), normals.reshape(-1, 2, 3)

    def _chunk(self, axis: int, shape: tuple[int, int], crossings: np.ndarray) -> list[np.ndarray]:
        context = require()
        size = (WIDTH, -(-len(crossings) // WIDTH))
        table = DataTexture(crossings)
        textures = [context.texture(size, 4, dtype="f4") for _ in range(2)]
        target = context.framebuffer(textures)
        try:
            target.use()
            context.enable_only(moderngl.NOTHING)
            self._resident.bind(self._shader)
            table.use(FREE_UNIT)
            chunk = {"crossings": FREE_UNIT, "count": len(crossings), "axis": axis, "shape": shape}
            set_uniforms(self._shader, {**self._uniforms, **chunk})
            self._screen.render(vertices=3)
            read = [np.frombuffer(read_back(texture), np.float32).reshape(-1, 4) for texture in textures]
            return [texels[: len(crossings), :3] for texels in read]
        finally:
            for part in (target, table, *textures):
                part.release()
