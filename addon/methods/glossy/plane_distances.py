"""How far from a plane everything is that a camera sees."""

from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ...drawing import Canvas, Part, Resident, ScreenPass
from ...gl import require, unbind
from ..planar import Picture

FAR = 1e30
"""Of the world, as in gpu_shaders/common/picture.glsl."""


class PlaneDistances:
    """Pictures of distances from a plane, one for each canvas as long as that lives. Lives on the GL thread."""

    def __init__(self, resident: Resident) -> None:
        """Compile the shader."""
        self._pass = ScreenPass("glossy/plane_distance.frag", resident, Part.SURFACES)
        self._targets: WeakKeyDictionary[Canvas, tuple[moderngl.Texture, moderngl.Framebuffer]] = WeakKeyDictionary()

    def of(self, picture: Picture, plane: np.ndarray) -> moderngl.Texture:
        """Metres, 32-bit, of the size of the picture's canvas; `plane` (4,) unit normal and offset in the world."""
        texture, target = self._target(picture.canvas)
        target.scissor = None
        target.clear(FAR)  # beside the opening, too: a rough ray may look there
        target.scissor = picture.view.opening.bounds
        self._pass.shader["plane"] = tuple(plane)
        camera, seen = picture.view.camera, picture.canvas.visibility
        self._pass.draw(camera, seen, target, offset=picture.offset, blend=False)
        return texture

    def _target(self, canvas: Canvas) -> tuple[moderngl.Texture, moderngl.Framebuffer]:
        if canvas not in self._targets:
            texture = require().texture(canvas.size, 1, dtype="f4")
            target = require().framebuffer([texture], canvas.visibility.parts)
            target.depth_mask = False
            self._targets[canvas] = texture, target
        return self._targets[canvas]

    def release(self) -> None:
        """Give the pictures back."""
        unbind()
        for part in (part for kept in self._targets.values() for part in kept):
            part.release()
        self._targets.clear()
