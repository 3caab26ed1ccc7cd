"""How near and how far everything is around each place of a mirrored picture."""

from weakref import WeakKeyDictionary

import moderngl

from ...drawing import Canvas
from ...gl import program, require, screen, unbind
from ..mirrors import Bounds
from ..planar import PICTURE_UNIT
from .plane_distances import FAR

LEVELS = 10
"""At most: the last tells of 1,023 texels around a place."""


class DepthRanges:
    """Pyramids of nearest and farthest depths, one for each canvas as long as that lives. Lives on the GL thread.

    A texel of level `n`, from 1 on, holds the range of its own `2**n` by `2**n` texels of the picture and of all that
    are at most `2**n - 1` away from one of these. Odd levels lie in one texture and even ones in another, so that
    each is drawn from the other; level `n` begins at column `width >> n`, is as wide as that, and begins at row 0.
    (A mip chain would be the same, but Mesa's software renderer takes one level for four pixels at a time.)
    """

    def __init__(self) -> None:
        """Compile the shader."""
        self._reduce = program(None, "glossy/depth_ranges.frag")
        self._targets: WeakKeyDictionary[Canvas, tuple[moderngl.Framebuffer, ...]] = WeakKeyDictionary()

    def of(self, canvas: Canvas, bounds: Bounds, depths: moderngl.Texture) -> tuple[moderngl.Texture, moderngl.Texture]:
        """(nearest, farthest) of even and of odd levels, 32-bit, metres, wherever a texel within `bounds` counts.

        `depths` is of the canvas's size. Elsewhere anything may be: 0 to FAR.
        """
        targets, context = self._target(canvas), require()
        for target in targets:
            target.scissor = None
            target.clear(0.0, FAR)
        depths.swizzle = "RR01"  # the nearest and the farthest of a single texel
        context.enable_only(moderngl.NOTHING)
        below, lies = depths, (0, 0, *canvas.size)
        for level in range(1, levels_of(canvas.size) + 1):
            target, bounds = targets[level % 2], _halved(bounds)
            below.use(PICTURE_UNIT)
            self._reduce["below"], self._reduce["level_below"] = PICTURE_UNIT, lies
            width, height = (side >> level for side in canvas.size)
            below, lies = target.color_attachments[0], (width, 0, width, height)
            self._reduce["corner"] = lies[:2]
            target.scissor = bounds[0] + width, *bounds[1:]
            target.use()
            context.viewport = lies
            screen(self._reduce).render(vertices=3)
        return targets[0].color_attachments[0], targets[1].color_attachments[0]

    def _target(self, canvas: Canvas) -> tuple[moderngl.Framebuffer, ...]:
        if canvas not in self._targets:
            width, height = canvas.size
            sizes = (max(1, width // 2), max(1, height // 4)), (width, max(1, height // 2))
            textures = [require().texture(size, 2, dtype="f4") for size in sizes]
            self._targets[canvas] = tuple(require().framebuffer([texture]) for texture in textures)
        return self._targets[canvas]

    def release(self) -> None:
        """Give the pyramids back."""
        unbind()
        for target in (target for kept in self._targets.values() for target in kept):
            target.color_attachments[0].release()
            target.release()
        self._targets.clear()


def levels_of(size: tuple[int, int]) -> int:
    """How many levels a picture of that size gets, beside itself."""
    return min(LEVELS, min(size).bit_length() - 1)


def _halved(bounds: Bounds) -> Bounds:
    """The texels of the next level that tell of these."""
    x, y, width, height = bounds
    first = max(0, (x - 2) // 2), max(0, (y - 2) // 2)
    return (*first, (x + width + 2) // 2 + 1 - first[0], (y + height + 2) // 2 + 1 - first[1])
