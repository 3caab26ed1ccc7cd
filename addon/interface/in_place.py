"""Compare in place: a picture by Cycles of what a viewport shows, half and half with ours."""

from dataclasses import dataclass, field

import numpy as np

from ..drawing import Canvas
from ..methods.contract import View
from ..methods.mixed import Mixed
from .overlays import opaque, picture

_LINE = 0.9


@dataclass(eq=False)
class InPlace:
    """Cycles' picture (H, W, 3) of a view, row 0 at the bottom; `flip` the mean FLIP of the last picture held
    against it over the reflectors, None before the first.
    """

    view: View
    color: np.ndarray
    flip: float | None = field(default=None)

    def fits(self, view: View) -> bool:
        """Whether a picture of `view` may be held against this one."""
        return self.view.shows_the_same(view)

    def split(self, canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
        """Ours to the left, Cycles to the right; ours alone once the view has changed."""
        ours = picture(canvas, method, view)
        if self.fits(view):
            self._judge(canvas, view)
            middle = view.width // 2
            ours[:, middle:, :3] = self.color[:, middle:]
            ours[:, middle, :3] = _LINE
        return ours

    def error(self, canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
        """The FLIP map, from black (equal) by purple and red to yellow; our picture once the view has changed."""
        if not self.fits(view):
            return picture(canvas, method, view)
        return opaque(_heat(self._judge(canvas, view)))

    def _judge(self, canvas: Canvas, view: View) -> np.ndarray:
        from ..metrics.flip import flip_map  # a wheel that a distribution's own Blender may lack

        color = canvas.rows(canvas.color)
        errors = flip_map(np.ascontiguousarray(color[::-1, :, :3]), np.ascontiguousarray(self.color[::-1]))[::-1]
        mirrors = color[..., 3] >= 0.5
        self.flip = float(errors[mirrors].mean()) if mirrors.any() else None
        return errors


def _heat(errors: np.ndarray) -> np.ndarray:
    """(H, W, 3) scene-linear for errors 0..1: black, purple, red, yellow."""
    stops = np.float32([[0, 0, 0], [0.12, 0.01, 0.2], [0.6, 0.03, 0.05], [1.0, 0.7, 0.1]])
    at = np.clip(errors, 0.0, 1.0) * (len(stops) - 1)
    low = np.minimum(at.astype(int), len(stops) - 2)
    share = (at - low)[..., None]
    return (1.0 - share) * stops[low] + share * stops[low + 1]
