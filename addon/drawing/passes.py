"""Full-screen passes over what the visibility pass found."""

import moderngl

from ..gl import program, require, screen
from ..scene import Camera
from .resident import FREE_UNIT, Resident
from .visibility import Visibility, set_camera


class ScreenPass:
    """A fragment shader, built on gpu_shaders/common/picture.glsl, run at every pixel. Lives on the GL thread."""

    def __init__(self, fragment: str, resident: Resident) -> None:
        """Compile `fragment`, a file below gpu_shaders/, for the light of `resident`; a second time costs nothing."""
        self._resident = resident
        self.shader = program(None, fragment, resident.defines)
        self._screen = screen(self.shader)

    def draw(
        self,
        camera: Camera,
        visibility: Visibility,
        target: moderngl.Framebuffer,
        *,
        corner: tuple[int, int] = (0, 0),
        offset: tuple[float, float] = (0.0, 0.0),
        weight: float = 1.0,
        blend: bool = True,
        on_reflectors: bool = False,
    ) -> None:
        """Add (or with `blend` off: write) `weight` times the pass's radiance to `target` from pixel `corner` on.

        `offset` moves the sample within the pixel, as in the visibility pass. `on_reflectors` spares all
        other pixels; `target` then has `visibility.reflectors` for its depth, and a `depth_mask` of False.
        """
        context = require()
        target.use()
        context.viewport = (*corner, *visibility.size)
        blending = moderngl.BLEND if blend else moderngl.NOTHING
        context.enable_only(blending | (moderngl.DEPTH_TEST if on_reflectors else moderngl.NOTHING))
        context.blend_func = moderngl.ONE, moderngl.ONE
        self._resident.bind(self.shader)
        set_camera(self.shader, camera, *visibility.size, offset)
        visibility.texture.use(FREE_UNIT)
        self.shader["visibility"] = FREE_UNIT
        self.shader["corner"] = corner
        self.shader["weight"] = weight
        # The screen's triangle lies at depth 0.5, in front of the 1 and behind the 0 of the mask.
        context.depth_func = ">"
        self._screen.render(vertices=3)
        context.depth_func = "<"
