"""What a mirrored picture is seen through: the part of the screen, and the ways to keep to it.

The ways are those of *Advanced Graphics Programming Using OpenGL*, 17.1.2.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum

import moderngl
import numpy as np

from ..gl import program, require, screen
from ..gl.stencil import clear_stencil, where_stencil, writing_stencil


class Clipping(StrEnum):
    """How geometry is kept to the outline of the mirror that it is seen in.

    STENCIL: the mirror marks its pixels first; STENCIL_AFTER: the geometry is drawn first, then wiped where the
    mirror is not; CLIP_PLANES: planes through the eye and the outline's edges cut it; DEPTH: what was drawn before
    hides it all around; PROJECTIVE_TEXTURE: not at all, the picture is a texture that only the mirror shows.
    """

    STENCIL = "stencil"
    STENCIL_AFTER = "stencil-after"
    CLIP_PLANES = "clip-planes"
    DEPTH = "depth"
    PROJECTIVE_TEXTURE = "projective-texture"


NEED_STENCIL = (Clipping.STENCIL, Clipping.STENCIL_AFTER)
"""Openings of these go with a canvas that has a stencil."""


@dataclass(frozen=True, eq=False)
class Opening:
    """An outline on the screen and what lies behind it.

    `bounds` x, y, width and height in pixels, row 0 at the bottom, that hold the outline; `cuts` (N, 4) world planes
    that geometry is cut by; `shown` the instances to draw; `mark` draws a fragment for each pixel of the outline,
    at the far end, into the bound framebuffer.
    """

    bounds: tuple[int, int, int, int]
    cuts: np.ndarray
    shown: tuple[int, ...]
    clipping: Clipping
    mark: Callable[[], None]

    @contextmanager
    def kept_to(self, target: moderngl.Framebuffer) -> Iterator[None]:
        """Keep what is drawn inside, into the bound and cleared `target`, to the outline."""
        if self.clipping is Clipping.STENCIL:
            clear_stencil()
            self._mark_stencil(target)
            with where_stencil(1):
                yield
        elif self.clipping is Clipping.STENCIL_AFTER:
            yield
            clear_stencil()
            self._mark_stencil(target)
            self._wipe_around()
        else:
            if self.clipping is Clipping.DEPTH:
                target.clear(depth=0.0)
                self._mark(target, depth_mask=True)
            yield

    def _mark_stencil(self, target: moderngl.Framebuffer) -> None:
        with writing_stencil():
            self._mark(target, depth_mask=False)

    def _mark(self, target: moderngl.Framebuffer, depth_mask: bool) -> None:
        context = require()
        target.depth_mask, target.color_mask = depth_mask, (False,) * 4
        target.use()
        context.depth_func = "1"
        self.mark()
        context.depth_func = "<"
        target.depth_mask, target.color_mask = True, (True,) * 4
        target.use()

    def _wipe_around(self) -> None:
        """Set the pixels to nothing that the mirror does not cover: a clear would not ask the stencil."""
        context = require()
        wipe = program(None, "visibility/nothing.frag")
        wipe["depth"] = 1.0
        context.depth_func = "1"
        with where_stencil(0):
            screen(wipe).render(vertices=3)
        context.depth_func = "<"
