"""The pictures of one or two methods, kept until others are wanted. Lives on the GL thread."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...addon.drawing import Canvas
from ...addon.methods.contract import Method, View
from ...addon.progress import Progress, part_of, silent
from ...addon.scene import Camera

_WORLD = 1e29  # metres: beyond any hit


@dataclass
class Painted:
    """Canvases, left to right, and for each the milliseconds by stage, as of a `Frame`."""

    canvases: list[Canvas] = field(default_factory=list)
    times: list[dict[str, float]] = field(default_factory=list)

    def distance_at(self, place: tuple[float, float], side: int) -> float:
        """Metres from the reflector to what is drawn in it at `place`, 0..1 from the upper left corner.

        Infinite for the world, NaN off the reflectors.
        """
        canvas = self.canvases[side]
        column, row = (int(np.clip(at * many, 0, many - 1)) for at, many in zip(place, canvas.size, strict=True))
        texel = canvas.centre.read((column, canvas.size[1] - 1 - row, 1, 1), components=1, attachment=1, dtype="f4")
        (distance,) = np.frombuffer(texel, np.float32)
        return float(np.inf if distance > _WORLD else distance if distance > 0.0 else np.nan)

    def release(self) -> None:
        """Give the memory back."""
        while self.canvases:
            self.canvases.pop().release()


class Painter:
    """Paints behind what is shown, so that a picture that is given up leaves the one before it."""

    def __init__(self) -> None:
        """Begin with nothing to show."""
        self.shown = Painted()
        self._spare = Painted()

    def paint(
        self,
        methods: Sequence[Method],
        camera: Camera,
        size: tuple[int, int],
        samples: int = 1,
        progress: Progress = silent,
    ) -> None:
        """Replace what is shown; `samples` to the side of a pixel. Whatever `progress` raises leaves it as it was."""
        spare = self._spare
        if [canvas.size for canvas in spare.canvases] != [size] * len(methods):
            spare.release()
            spare.canvases = [Canvas(*size) for _ in methods]
        share = 1.0 / len(methods)
        spare.times = [
            method.paint(View(camera, *size, samples), canvas, part_of(progress, side * share, (side + 1) * share))
            for side, (method, canvas) in enumerate(zip(methods, spare.canvases, strict=True))
        ]
        self.shown, self._spare = spare, self.shown

    def release(self) -> None:
        """Give the memory back."""
        self.shown.release()
        self._spare.release()
