"""What a camera sees first: a triangle a pixel."""

from collections.abc import Callable
from enum import Enum

import moderngl
import numpy as np

from ..gl import clear, finish, program, require, sample_counter, screen, settle
from ..gl.stencil import attach_stencil, depth_stencil
from ..scene import Camera
from .opening import Opening
from .resident import FREE_UNIT, Resident


class Part(Enum):
    """What of the picture a pass draws: (depth of its fragments, -1 to 1; how they compare to the part's)."""

    REFLECTORS = -0.5, ">"
    SURFACES = 0.5, ">"
    WORLD = 0.5, "<"


class Visibility:
    """A picture of (instance + 1, triangle), (0, 0) where the world is seen. Lives on the GL thread.

    `depth` is the depth buffer of what is seen. `parts` is one for a target's attachment as well, by which passes
    over a `Part` are spared all other pixels. A target that has either needs a `depth_mask` of False.
    """

    def __init__(self, width: int, height: int, stencil: bool = False) -> None:
        """Make a target of `width` × `height` pixels; `stencil` for openings that need one."""
        context = require()
        self.size = (width, height)
        self.texture = context.texture(self.size, 2, dtype="u4")
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.depth = depth_stencil(self.size) if stencil else context.depth_renderbuffer(self.size)
        self._target = context.framebuffer([self.texture], self.depth)
        if stencil:
            attach_stencil(self._target, self.depth)
        self.parts = context.depth_renderbuffer(self.size)
        self._mask = context.framebuffer([], self.parts)
        self._mark = program(None, "visibility/parts.frag")
        self._screen = screen(self._mark)

    def draw(self, resident: Resident, world_to_clip: np.ndarray, hidden: frozenset[int] = frozenset()) -> None:
        """Rasterise what cameras see of the scene; `hidden` instances are left out."""
        context = require()
        self._target.use()
        context.viewport = (0, 0, *self.size)
        clear(self._target)
        context.enable_only(moderngl.DEPTH_TEST)
        settle()
        instances = resident.scene.instances
        shown = (index for index, instance in enumerate(instances) if instance.in_camera and index not in hidden)
        resident.rasteriser.draw(world_to_clip, shown)

    def draw_through(self, resident: Resident, world_to_clip: np.ndarray, opening: Opening) -> None:
        """Rasterise what is seen through an opening, and nothing else."""
        context = require()
        self._target.scissor = self._mask.scissor = opening.bounds
        self._target.use()
        context.viewport = (0, 0, *self.size)
        clear(self._target)
        context.enable_only(moderngl.DEPTH_TEST)
        with opening.kept_to(self._target):
            resident.rasteriser.draw(world_to_clip, opening.shown, opening.cuts)

    def mark_parts(self, resident: Resident, group: int = 0) -> None:
        """Fill `parts` from what `draw` found; of the reflectors, those of one group count as such."""
        context = require()
        self._mask.use()
        context.viewport = (0, 0, *self.size)
        context.enable_only(moderngl.DEPTH_TEST)
        context.depth_func = "1"
        resident.bind(self._mark)
        self.texture.use(FREE_UNIT)
        self._mark["visibility"], self._mark["group"] = FREE_UNIT, group
        settle()
        self._screen.render(vertices=3)
        context.depth_func = "<"

    def shows(self, mark: Callable[[], None]) -> bool:
        """Whether `mark`, which draws a fragment for each pixel that it looks for, finds one."""
        context = require()
        self._mask.depth_mask = False
        self._mask.use()
        context.viewport = (0, 0, *self.size)
        context.enable_only(moderngl.NOTHING)
        counted = sample_counter()
        with counted:
            mark()
        self._mask.depth_mask = True
        finish()
        return counted.samples > 0

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self.texture, self.depth, self._mask, self.parts):
            part.release()


def world_to_clip(camera: Camera, width: int, height: int, offset: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """(4, 4) float64; `offset` moves the sample within the pixel, in pixels from its centre."""
    shift = np.eye(4)
    shift[:2, 3] = -2.0 * offset[0] / width, -2.0 * offset[1] / height
    return shift @ camera.projection(width, height) @ np.linalg.inv(camera.matrix)


def camera_uniforms(
    camera: Camera, width: int, height: int, offset: tuple[float, float] = (0.0, 0.0)
) -> dict[str, object]:
    """The uniforms of gpu_shaders/common/camera.glsl for the same sample of the pixel."""
    left, right, bottom, top = camera.window(width, height)
    dx, dy = offset[0] * (right - left) / width, offset[1] * (top - bottom) / height
    return {
        "camera_to_world": tuple(camera.matrix.T.ravel()),
        "window": (left + dx, right + dx, bottom + dy, top + dy),
        "orthographic": camera.ortho_scale is not None,
    }
