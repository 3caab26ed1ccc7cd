"""What takes time in a preview: preparing methods and painting. Lives on the GL thread."""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

from ...addon.errors import Cancelled
from ...addon.methods.pace import Pace
from ...addon.progress import Progress
from ...addon.scene import Camera, Scene
from .look import Look
from .painter import Painter
from .prepared import Choice, Prepared

FINE = 4
"""Samples to the side of a pixel, once the camera rests."""

_COARSEST = 4


@dataclass(frozen=True)
class Busy:
    """What takes long just now, and how far it is, 0..1."""

    title: str
    stage: str
    fraction: float


@dataclass(frozen=True)
class Subject:
    """What a picture is of. Another camera object is another camera."""

    camera: Camera
    choices: tuple[Choice, ...]
    size: tuple[int, int]


class Workshop:
    """Does one thing at a time. Meanwhile `pump` is called again and again: the window lives in it."""

    def __init__(self, scene: Scene) -> None:
        """Begin with nothing prepared."""
        self.prepared, self.painter = Prepared(scene), Painter()
        self.pump: Callable[[], None] = lambda: None
        self.busy: Busy | None = None
        self.settled: Look | None = None
        self.scale = self.samples = 0
        self._pace = Pace(_COARSEST)
        self._painted: Subject | None = None
        self._stopped = False

    def restage(self, scene: Scene) -> None:
        """Go on with another scene; the old picture is shown until there is one of the new."""
        self.prepared.release()
        self.prepared, self.settled, self._painted = Prepared(scene), None, None

    def stop(self) -> None:
        """Have what takes long raise `Cancelled`."""
        self._stopped = self.busy is not None

    def run(self, title: str, task: Callable[[Progress], str]) -> str:
        """What `task` returns, run with a progress callback that shows `title`. Raises `Cancelled` once stopped."""

        def report(stage: str, fraction: float) -> None:
            self.busy = Busy(title, stage, fraction)
            self.pump()
            if self._stopped:
                raise Cancelled

        try:
            report("", 0.0)
            return task(report)
        finally:
            self.busy, self._stopped = None, False

    def prepare(self, look: Look, progress: Progress) -> str:
        """Have the methods of `look` ready; what is to be said of them."""
        for choice in look.choices:
            self.prepared.get(choice, progress)
        self.settled, self._painted = look, None
        return "\n".join(filter(None, (self.prepared.remarks(choice) for choice in look.choices)))

    def next_picture(self, subject: Subject, is_moving: bool) -> tuple[int, int] | None:
        """(scale, samples) of the picture to paint now: coarse in flight, then whole, then smooth; None if none."""
        is_new = subject != self._painted
        rested = (1, 1) if is_new or self.scale != 1 else (1, FINE)
        wanted = (self._pace.scale, 1) if is_moving else rested
        return wanted if is_new or wanted != (self.scale, self.samples) else None

    def paint(self, subject: Subject, scale: int, samples: int, is_wanted: Callable[[], bool]) -> None:
        """Paint the picture, unless it is no longer wanted before it is done."""

        def report(stage: str, fraction: float) -> None:
            if samples > 1:
                self.pump()
                if not is_wanted():
                    raise Cancelled

        methods = [self.prepared.get(choice, report) for choice in subject.choices]
        size = tuple(max(1, side // scale) for side in subject.size)
        start = perf_counter()
        try:
            self.painter.paint(methods, subject.camera, size, samples, report)
        except Cancelled:
            return
        self._painted, self.scale, self.samples = subject, scale, samples
        if samples == 1:
            self._pace.took(scale, perf_counter() - start)

    def release(self) -> None:
        """Give the GPU memory back."""
        self.painter.release()
        self.prepared.release()
