"""Pictures and films of a look, without a window."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...addon.gl import on_gl_thread
from ...addon.methods.contract import Method
from ...addon.progress import Progress, silent
from ...addon.scene import Camera
from .display import Display, Sheet
from .look import Look
from .painter import Painter
from .path import CameraPath
from .prepared import Prepared
from .video import Video

_STILL, _FILM = 4, 2
"""Samples to the side of a pixel."""


class Darkroom:
    """Makes pictures of `width` × `height` pixels that can be kept. Lives on the GL thread."""

    def __init__(self, width: int, height: int) -> None:
        """Make the targets."""
        self.size = (width, height)
        self._painter, self._display, self._sheet = Painter(), Display(), Sheet(width, height)

    def expose(
        self, methods: Sequence[Method], look: Look, camera: Camera, samples: int, progress: Progress = silent
    ) -> np.ndarray:
        """(H, W, 3) uint8, sRGB-encoded, row 0 at the top: what a window of that size shows."""
        self._painter.paint(methods, camera, self.size, samples, progress)
        self._display.draw(self._sheet.target, self.size, *self._painter.shown.canvases[:2], **shown_as(look))
        return self._sheet.read()

    def release(self) -> None:
        """Give the memory back."""
        self._painter.release()
        self._sheet.release()


def shown_as(look: Look) -> dict[str, float | str]:
    """What `Display.draw` wants to know of a look."""
    return {"split": look.split, "exposure": look.exposure, "view": look.view}


def photograph(
    methods: Sequence[Method], look: Look, camera: Camera, size: tuple[int, int], progress: Progress = silent
) -> np.ndarray:
    """One picture as of `Darkroom.expose`, with smooth edges; on the GL thread."""
    darkroom = Darkroom(*size)
    try:
        return darkroom.expose(methods, look, camera, _STILL, progress)
    finally:
        darkroom.release()


@on_gl_thread
def film(
    prepared: Prepared,
    look: Look,
    camera: Camera,
    path: CameraPath,
    size: tuple[int, int],
    rate: int,
    out: Path,
    progress: Progress = silent,
) -> int:
    """Write the flight along `path` to `out` as H.264 in MP4, `rate` pictures a second; returns how many there are.

    `camera` gives lens and clipping; an odd width or height loses a pixel, which H.264 asks for. Whatever
    stops the film, a file that was there before stays.
    """
    methods = [prepared.get(choice, progress) for choice in look.choices]
    size = tuple(max(2, side - side % 2) for side in size)
    count = int(path.duration * rate + 1e-6) + 1
    darkroom = Darkroom(*size)
    try:
        with Video(out, size, rate) as video:
            for number in range(count):
                progress(f"picture {number + 1} of {count}", number / count)
                there = replace(camera, matrix=path.at(number / rate).matrix)
                video.add(darkroom.expose(methods, look, there, _FILM))
    finally:
        darkroom.release()
    progress("", 1.0)
    return count
