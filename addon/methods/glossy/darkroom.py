"""What happens to a mirrored picture between the camera and the floor: it is dimmed by planes, and blurred.

Source: the paper on glossy planar reflections, sections 3 and 4.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ...drawing import Canvas, Resident, world_to_clip
from ...gl import program, require, screen, unbind
from ..planar import PICTURE_UNIT, Picture
from .attenuation_planes import AttenuationPlanes
from .plane_distances import PlaneDistances

MOST_PLANES = 256

KERNEL_SPREAD = math.sqrt(3.0 / 4.0 + 1.0 / 6.0)
"""Standard deviation, in texels, of the kernel's weights 1 3 3 1 and of the look-up's filter after them.

That of a disc is half its radius.
"""

_APART = 0.5 / math.sqrt(3.0 / 4.0)
"""How far apart the kernel's taps stand where they spread as a disc of radius 1."""

_DEPTH_CLAMP = 0x864F


@dataclass(frozen=True)
class Slab:
    """What lies between two heights above the mirror, metres, and the radius that it is blurred by, in texels."""

    low: float
    high: float
    radius: float


class _Bath:
    """Targets beside a canvas, of its size."""

    def __init__(self, canvas: Canvas) -> None:
        context = require()
        self.blurred, self.slab = (context.texture(canvas.size, 4, dtype="f4") for _ in range(2))
        for texture in (self.blurred, self.slab):
            texture.repeat_x = texture.repeat_y = False
        self.onto_picture = context.framebuffer([canvas.color], canvas.visibility.depth)
        self.onto_picture.depth_mask = False
        self.onto_blurred = context.framebuffer([self.blurred])
        self.onto_slab = context.framebuffer([self.slab])

    def release(self) -> None:
        targets = (self.onto_picture, self.onto_blurred, self.onto_slab)
        for part in (*targets, self.blurred, self.slab):
            part.release()


class Darkroom:
    """Dims and blurs mirrored pictures of a scene. Lives on the GL thread."""

    def __init__(self, resident: Resident) -> None:
        """Compile the shaders."""
        context = require()
        self._planes = program("glossy/planes.vert", "glossy/planes.frag")
        self._stack = context.buffer(reserve=MOST_PLANES * 12)
        self._drawn = context.vertex_array(self._planes, [(self._stack, "3f/i", "plane")])
        self._convolve = program(None, "glossy/convolve.frag")
        self._slab, self._spread = program(None, "glossy/slab.frag"), program(None, "glossy/spread.frag")
        self._heights = PlaneDistances(resident)
        self._baths: dict[Canvas, _Bath] = {}

    def _bath(self, picture: Picture) -> _Bath:
        if picture.canvas not in self._baths:
            self._baths[picture.canvas] = _Bath(picture.canvas)
        return self._baths[picture.canvas]

    def dim(self, picture: Picture, planes: AttenuationPlanes) -> None:
        """Draw the planes, but for their common `strength`, between the mirrored camera and what it has seen.

        Planes that are nearer than the camera sees, or farther, count all the same.
        """
        context, size = require(), picture.canvas.size
        target = self._bath(picture).onto_picture
        target.scissor = picture.view.opening.bounds
        target.use()
        context.viewport = (0, 0, *size)
        context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        context.enable_direct(_DEPTH_CLAMP)
        context.depth_func, context.blend_func = "<=", (moderngl.ZERO, moderngl.SRC_COLOR)
        lines = np.stack([planes.foot_heights, np.tan(planes.tilts), planes.factors], axis=1)
        self._stack.write(np.ascontiguousarray(lines, np.float32))
        clip = world_to_clip(picture.view.camera, *size, picture.offset)
        self._planes["frame"].write((_ground(picture) @ clip.T).astype(np.float32).tobytes())
        self._drawn.render(moderngl.TRIANGLES, vertices=12, instances=len(lines))
        context.depth_func = "<"
        context.disable_direct(_DEPTH_CLAMP)

    def convolve(self, picture: Picture) -> moderngl.Texture:
        """The picture, blurred by the kernel, and moved by half a texel to the lower left."""
        bath = self._bath(picture)
        self._begin(picture, bath.onto_blurred)
        picture.canvas.color.use(PICTURE_UNIT)
        self._convolve["mirrored"] = PICTURE_UNIT
        screen(self._convolve).render(vertices=3)
        return bath.blurred

    def blur_slabs(self, picture: Picture, slabs: Sequence[Slab]) -> moderngl.Texture:
        """The picture, cut into slabs, each blurred by itself and laid over those before it.

        Alpha is how much there is: something near hides what the picture would show of a slab behind it.
        """
        bath = self._bath(picture)
        heights = self._heights.of(picture, picture.mirror.plane)
        bath.onto_blurred.scissor = None
        bath.onto_blurred.clear()
        for slab in slabs:
            self._cut(picture, bath, heights, slab)
            self._lay(picture, bath, slab)
        return bath.blurred

    def _cut(self, picture: Picture, bath: _Bath, heights: moderngl.Texture, slab: Slab) -> None:
        bath.onto_slab.scissor = None
        bath.onto_slab.clear()
        self._begin(picture, bath.onto_slab)
        picture.canvas.color.use(PICTURE_UNIT)
        heights.use(PICTURE_UNIT + 1)
        self._slab["mirrored"], self._slab["heights"] = PICTURE_UNIT, PICTURE_UNIT + 1
        self._slab["slab"] = slab.low, slab.high
        screen(self._slab).render(vertices=3)
        bath.slab.build_mipmaps()

    def _lay(self, picture: Picture, bath: _Bath, slab: Slab) -> None:
        self._begin(picture, bath.onto_blurred)
        context = require()
        context.enable_only(moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        bath.slab.use(PICTURE_UNIT)
        self._spread["slab_texels"], self._spread["apart"] = PICTURE_UNIT, _APART * slab.radius
        screen(self._spread).render(vertices=3)

    @staticmethod
    def _begin(picture: Picture, target: moderngl.Framebuffer) -> None:
        """Draw into `target`, where the mirrored picture is."""
        context = require()
        target.scissor = picture.view.opening.bounds
        target.use()
        context.viewport = (0, 0, *picture.canvas.size)
        context.enable_only(moderngl.NOTHING)

    def release(self) -> None:
        """Give the pictures back."""
        unbind()
        for bath in self._baths.values():
            bath.release()
        self._baths.clear()
        self._heights.release()


def _ground(picture: Picture) -> np.ndarray:
    """(4, 4) rows, homogeneous, in the world: the viewer's foot, and the ways up, ahead and across from there.

    A camera that looks straight at the mirror has the top of its picture ahead.
    """
    plane, camera = picture.mirror.plane, picture.view.camera
    up = plane[:3]
    foot = camera.position - (up @ camera.position + plane[3]) * up
    ways = [way - (way @ up) * up for way in (-camera.matrix[:3, 2], camera.matrix[:3, 1])]
    ahead = ways[0] if np.linalg.norm(ways[0]) > 1e-4 else ways[1]
    ahead = ahead / np.linalg.norm(ahead)
    return np.array([[*foot, 1.0], [*up, 0.0], [*ahead, 0.0], [*np.cross(up, ahead), 0.0]])
