"""A key frame's reflection buffers as they were published: two RGBA textures."""

import moderngl

from ...drawing import FREE_UNIT, ScreenPass, Visibility
from ...gl import clear, require, set_uniforms
from .buffers import ReflectionBuffers, Sample, known_camera

UNITS = 2
"""Texture units that the buffers take."""

_TRACED_UNIT = FREE_UNIT + 1


class PackedBuffers:
    """What is in sight of a key frame, and what is mirrored in it (Xie et al., 3.1). Lives on the GL thread.

    `geometry` holds the normal in two channels, the metres from the camera and the specular factor, 0 for what mirrors
    nothing; `light` the radiance that arrives at the mirrors and the metres that it came, 60 km from the world.
    """

    def __init__(self, size: tuple[int, int], parts: moderngl.Renderbuffer, dtype: str) -> None:
        """Make room for key frames of `size`; `parts` as of `Visibility`, `dtype` of the numbers is f4 or f2."""
        context = require()
        self.geometry, self.light = (context.texture(size, 4, dtype=dtype) for _ in range(2))
        self._target = context.framebuffer([self.geometry, self.light], parts)
        self._target.depth_mask = False
        self.sample: Sample | None = None

    def fill(self, packing: ScreenPass, key: ReflectionBuffers, seen: Visibility) -> None:
        """Take over a key frame that is what is `seen`, by gpu_shaders/reprojection_published/pack.frag."""
        self.sample = key.sample
        clear(self._target)
        key.light.use(_TRACED_UNIT)
        packing.shader["traced"] = _TRACED_UNIT
        packing.draw(key.sample.view.camera, seen, self._target, offset=key.sample.offset, blend=False)

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Have a shader read them as reprojection_published/known.glsl does, from texture unit `unit` on."""
        self.geometry.use(unit)
        self.light.use(unit + 1)
        camera = known_camera(self.sample, self.light.size)
        set_uniforms(shader, {**camera, "known_geometry": unit, "known_light": unit + 1})

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self.geometry, self.light):
            part.release()
