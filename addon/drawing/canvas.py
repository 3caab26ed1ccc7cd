"""What a picture is drawn on."""

import moderngl
import numpy as np

from ..errors import MachineError, UsageError
from ..gl import read_back, require, unbind
from .visibility import Visibility

_CLEARLY_FAR = 1e29


class Canvas:
    """The targets of a picture of `width` × `height` pixels, kept from frame to frame. Lives on the GL thread.

    `color` holds radiance, its alpha the share of the pixel that shows a reflector; `distance` metres from
    the reflector to what the pixel's centre sees in it. Passes add: `light` takes what needs no reflection,
    `picture` the reflections of a sample, `centre` those of the one at the pixel's centre, with its distance.
    """

    def __init__(self, width: int, height: int, apart: bool = False, stencil: bool = False) -> None:
        """`apart` keeps the reflections by themselves as well, in `reflection`; `stencil` is for openings.

        Raises `UsageError` for a size that makes no sense, `MachineError` for one that the GPU does not draw.
        """
        _check_size(width, height)
        context = require()
        self.size = (width, height)
        self.visibility = Visibility(width, height, stencil)
        self.color = context.texture(self.size, 4, dtype="f4")
        self.color.repeat_x = self.color.repeat_y = False  # where a mirror looks it up, smaller
        self.distance = context.texture(self.size, 1, dtype="f4")
        self.reflection = context.texture(self.size, 4, dtype="f4") if apart else None
        self._spare = context.texture(self.size, 1, dtype="f4") if apart else None  # distances that count for nothing
        kept = [texture for texture in (self._spare, self.reflection) if texture]
        # A pass must write all that its target holds.
        self.light = context.framebuffer([self.color], self.visibility.parts)
        self.picture = context.framebuffer([self.color, *kept], self.visibility.parts)
        self.centre = context.framebuffer([self.color, self.distance, *kept[1:]], self.visibility.parts)
        for target in (self.light, self.picture, self.centre):
            target.depth_mask = False  # neither a pass nor a clear may wipe the parts

    def clear(self) -> None:
        """Wipe everything that passes add to; the spare distances count for nothing."""
        self.centre.clear()

    def keep_to(self, bounds: tuple[int, int, int, int]) -> None:
        """Draw only within x, y, width and height from now on; row 0 is at the bottom."""
        for target in (self.light, self.picture, self.centre):
            target.scissor = bounds

    def rows(self, texture: moderngl.Texture) -> np.ndarray:
        """(H, W, channels) float32 of one of the textures as it is, row 0 at the bottom."""
        width, height = self.size
        return np.frombuffer(read_back(texture), np.float32).reshape(height, width, -1)

    def pixels(self) -> tuple[np.ndarray, np.ndarray]:
        """`color` (H, W, 4) and `distance` (H, W) as they are: row 0 at the bottom, 0 off the reflectors."""
        return self.rows(self.color), self.rows(self.distance)[..., 0]

    def read(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Colour (H, W, 3), reflectors (H, W) and distance (H, W) as a `Frame` has them."""
        color, distance = (rows[::-1] for rows in self.pixels())
        distance = np.where(distance > _CLEARLY_FAR, np.inf, distance)
        distance = np.where(distance > 0.0, distance, np.nan)
        return color[..., :3].copy(), color[..., 3].copy(), distance.astype(np.float32)

    def read_reflection(self) -> np.ndarray:
        """(H, W, 3) float32, row 0 the top: what the reflections add to the colour; for a canvas that keeps them."""
        return self.rows(self.reflection)[::-1, :, :3].copy()

    def read_instances(self) -> np.ndarray:
        """(H, W) int64, row 0 the top: the instance that the last sample of each pixel shows, -1 for the world."""
        width, height = self.size
        seen = np.frombuffer(read_back(self.visibility.texture), np.uint32).reshape(height, width, 2)
        return seen[::-1, :, 0].astype(np.int64) - 1

    def release(self) -> None:
        """Give the memory back."""
        unbind()
        for part in (self.light, self.picture, self.centre, self.color, self.distance, self.reflection, self._spare):
            if part:
                part.release()
        self.visibility.release()


def _check_size(width: int, height: int) -> None:
    limit = require().info["GL_MAX_TEXTURE_SIZE"]
    if min(width, height) < 1:
        raise UsageError(f"a picture of {width}×{height} pixels: give a width and height of at least 1")
    if max(width, height) > limit:
        raise MachineError(f"a picture of {width}×{height} pixels: this GPU draws at most {limit} a side")
