"""Full-screen passes over what the visibility pass found."""

from collections.abc import Mapping

import moderngl

from ..gl import program, require, screen, set_uniforms, settle
from ..scene import Camera
from .resident import FREE_UNIT, Resident
from .visibility import Part, Visibility, camera_uniforms


class ScreenPass:
    """A fragment shader, built on gpu_shaders/common/picture.glsl. Lives on the GL thread.

    It discards what is not its `part` of the picture; a target that has `Visibility.parts` for its depth
    spares it these pixels.
    """

    def __init__(self, fragment: str, resident: Resident, part: Part, defines: Mapping[str, int] | None = None) -> None:
        """Compile `fragment`, a file below gpu_shaders/, for the light of `resident`; a second time costs nothing."""
        self._resident = resident
        self._depth, self._passes = part.value
        self.shader = program(None, fragment, {**resident.defines, **(defines or {})})
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
    ) -> None:
        """Add (or with `blend` off: write) `weight` times the pass's radiance to `target` from pixel `corner` on.

        `offset` moves the sample within the pixel, as in the visibility pass.
        """
        context = require()
        target.use()
        context.viewport = (*corner, *visibility.size)
        context.enable_only(moderngl.DEPTH_TEST | (moderngl.BLEND if blend else moderngl.NOTHING))
        context.blend_func = moderngl.ONE, moderngl.ONE
        self._resident.bind(self.shader)
        visibility.texture.use(FREE_UNIT)
        uniforms = {"visibility": FREE_UNIT, "corner": corner, "weight": weight, "depth": self._depth}
        set_uniforms(self.shader, {**uniforms, **camera_uniforms(camera, *visibility.size, offset)})
        context.depth_func = self._passes
        settle()
        self._screen.render(vertices=3)
        context.depth_func = "<"
