"""Full-screen passes over what the visibility pass found."""

from functools import cache

import moderngl

from ..gl import program, require, screen
from ..scene import Camera
from .resident import FREE_UNIT, Resident
from .visibility import Visibility, set_camera


class ScreenPass:
    """A fragment shader, built on gpu_shaders/common/picture.glsl, run at every pixel. Lives on the GL thread."""

    def __init__(self, fragment: str) -> None:
        """Compile `fragment`, a file below gpu_shaders/."""
        self.shader = program(None, fragment)
        self._screen = screen(self.shader)

    def draw(
        self,
        resident: Resident,
        camera: Camera,
        visibility: Visibility,
        target: moderngl.Framebuffer,
        *,
        corner: tuple[int, int] = (0, 0),
        offset: tuple[float, float] = (0.0, 0.0),
        weight: float = 1.0,
        blend: bool = True,
    ) -> None:
        """Add (or with `blend` off: write) `weight` times the pass's radiance to `target` from pixel `corner` on.

        `offset` moves the sample within the pixel, as in the visibility pass.
        """
        context = require()
        target.use()
        context.viewport = (*corner, *visibility.size)
        context.enable_only(moderngl.BLEND if blend else moderngl.NOTHING)
        context.blend_func = moderngl.ONE, moderngl.ONE
        resident.bind(self.shader)
        set_camera(self.shader, camera, *visibility.size, offset)
        visibility.texture.use(FREE_UNIT)
        self.shader["visibility"] = FREE_UNIT
        self.shader["corner"] = corner
        self.shader["weight"] = weight
        self._screen.render(vertices=3)


@cache
def screen_pass(fragment: str) -> ScreenPass:
    """The pass of a shader file, compiled once."""
    return ScreenPass(fragment)
