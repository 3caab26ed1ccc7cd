"""From canvases to a screen or a file, by one shader. Lives on the GL thread."""

from functools import cache

import moderngl
import numpy as np

from ...addon.drawing import Canvas
from ...addon.gl import program, require, screen
from .views import STANDARD, STOPS, table

_LINE = 1.0
_UNITS = 0, 1
_TABLE_UNIT = 2


class Display:
    """Draws one canvas, or two side by side, as a screen shows them."""

    def __init__(self) -> None:
        """Compile the shader."""
        self._shader = program(None, "preview/display.frag")
        self._screen = screen(self._shader)

    def draw(
        self,
        target: moderngl.Framebuffer,
        size: tuple[int, int],
        left: Canvas,
        right: Canvas | None = None,
        split: float = 0.5,
        exposure: float = 0.0,
        view: str = STANDARD,
    ) -> None:
        """Fill `target`, of `size` pixels.

        `right` begins at `split`, 0..1 of the width; `exposure` in stops; `view` is one of `views.names`. A canvas
        of another size is scaled.
        """
        context = require()
        target.use()
        context.viewport = (0, 0, *size)
        context.enable_only(moderngl.NOTHING)
        for unit, canvas in zip(_UNITS, (left, right or left), strict=True):
            canvas.color.filter = (moderngl.LINEAR, moderngl.LINEAR)
            canvas.color.use(unit)
        if view != STANDARD:
            _table(view).use(_TABLE_UNIT)
        uniforms = {
            "left_picture": _UNITS[0],
            "right_picture": _UNITS[1],
            "shown_size": size,
            "split": split * size[0] if right else 2.0 * size[0],
            "line": _LINE,
            "gain": 2.0**exposure,
            "depth": 0.0,
            "by_table": view != STANDARD,
            "table": _TABLE_UNIT,
            "stops": STOPS,
        }
        for name, value in uniforms.items():
            self._shader[name] = value
        self._screen.render(vertices=3)


@cache
def _table(view: str) -> moderngl.Texture3D:
    """A view transform on the GPU, made once."""
    values = table(view)
    return require().texture3d(values.shape[2::-1], 3, np.ascontiguousarray(values, "f4"), dtype="f4")


class Sheet:
    """What a display is drawn on to be kept: `width` × `height` pixels of 8 bits a channel."""

    def __init__(self, width: int, height: int) -> None:
        """Make the target."""
        context = require()
        self.size = (width, height)
        self._texture = context.texture(self.size, 4, dtype="f1")
        self.target = context.framebuffer([self._texture])

    def read(self) -> np.ndarray:
        """(H, W, 3) uint8, sRGB-encoded, row 0 at the top."""
        width, height = self.size
        pixels = np.frombuffer(self._texture.read(), np.uint8).reshape(height, width, 4)
        return np.ascontiguousarray(pixels[::-1, :, :3])

    def release(self) -> None:
        """Give the memory back."""
        self.target.release()
        self._texture.release()
