"""What a camera sees first: a triangle a pixel."""

from enum import Enum

import moderngl
import numpy as np

from ..gl import program, require, screen
from ..scene import Camera
from .resident import FREE_UNIT, Resident


class Part(Enum):
    """What of the picture a pass draws: (depth of its fragments, -1 to 1; how they compare to the part's)."""

    REFLECTORS = -0.5, ">"
    SURFACES = 0.5, ">"
    WORLD = 0.5, "<"


class Visibility:
    """A picture of (instance + 1, triangle), (0, 0) where the world is seen. Lives on the GL thread.

    `parts` is a depth buffer of the same size for a target's attachment, by which passes over a `Part` are
    spared all other pixels; the target then needs a `depth_mask` of False.
    """

    def __init__(self, width: int, height: int) -> None:
        """Make a target of `width` × `height` pixels."""
        context = require()
        self.size = (width, height)
        self.texture = context.texture(self.size, 2, dtype="u4")
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._depth = context.depth_renderbuffer(self.size)
        self._target = context.framebuffer([self.texture], self._depth)
        self.parts = context.depth_renderbuffer(self.size)
        self._mask = context.framebuffer([], self.parts)
        self._mark = program(None, "visibility/parts.frag")
        self._screen = screen(self._mark)

    def draw(self, resident: Resident, world_to_clip: np.ndarray, hidden: frozenset[int] = frozenset()) -> None:
        """Rasterise the scene; `hidden` instances are left out."""
        context = require()
        self._target.use()
        context.viewport = (0, 0, *self.size)
        self._target.clear()
        context.enable_only(moderngl.DEPTH_TEST)
        resident.rasterise(world_to_clip, hidden)

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
        self._screen.render(vertices=3)
        context.depth_func = "<"

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self.texture, self._depth, self._mask, self.parts):
            part.release()


def world_to_clip(camera: Camera, width: int, height: int, offset: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """(4, 4) float64; `offset` moves the sample within the pixel, in pixels from its centre."""
    shift = np.eye(4)
    shift[:2, 3] = -2.0 * offset[0] / width, -2.0 * offset[1] / height
    return shift @ camera.projection(width, height) @ np.linalg.inv(camera.matrix)


def set_camera(
    shader: moderngl.Program, camera: Camera, width: int, height: int, offset: tuple[float, float] = (0.0, 0.0)
) -> None:
    """Set the uniforms of gpu_shaders/common/camera.glsl for the same sample of the pixel."""
    left, right, bottom, top = camera.window(width, height)
    dx, dy = offset[0] * (right - left) / width, offset[1] * (top - bottom) / height
    uniforms = {
        "camera_to_world": tuple(camera.matrix.T.ravel()),
        "window": (left + dx, right + dx, bottom + dy, top + dy),
        "orthographic": camera.ortho_scale is not None,
    }
    for name, value in uniforms.items():
        if name in shader:
            shader[name] = value
