"""Progress on a terminal: one bar a scene, with the time left; nothing where nobody looks.

A program that starts this one sets CATOPTRIC_PROGRESS to `lines`, and reads `progress FRACTION STEP` from stderr.
"""

import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

from ..addon.errors import Cancelled
from ..addon.progress import Progress as Callback

VARIABLE = "CATOPTRIC_PROGRESS"
_INTERVAL_S = 0.1
_STEADY_S = 300.0
"""How far back the time left looks: over several frames of a sequence, whose steps are unlike each other."""


class Bar:
    """A bar that is shared out over steps of unequal length.

    Time left is for the whole bar, so the shares should be near the truth.
    """

    def __init__(
        self, progress: Progress, task: TaskID, stopped: Event, label: str = "", start: float = 0.0, end: float = 1.0
    ) -> None:
        """A bar of `progress`, whose task runs from 0 to 1; callbacks raise `Cancelled` once `stopped` is set.

        It fills the task from `start` to `end`, with `label` before its steps.
        """
        self._progress = progress
        self._task = task
        self._stopped = stopped
        self._label, self._start, self._end = label, start, end

    def part(self, label: str, start: float, end: float) -> "Bar":
        """The bar of larger work, such as a frame of many, that fills this one from `start` to `end`, both 0..1."""
        return Bar(self._progress, self._task, self._stopped, label, self._at(start), self._at(end))

    def _at(self, fraction: float) -> float:
        return self._start + (self._end - self._start) * fraction

    def step(self, label: str, start: float, end: float) -> Callback:
        """The callback of a step that fills the bar from `start` to `end`, both 0..1."""

        def report(stage: str, fraction: float) -> None:
            if self._stopped.is_set():
                raise Cancelled
            done = self._at(start + (end - start) * min(max(fraction, 0.0), 1.0))
            step = ": ".join(filter(None, (self._label, label, stage)))
            self._progress.update(self._task, completed=done, step=step)
            _tell(done, step)

        report("", 0.0)
        return report

    def finish(self) -> None:
        """Take the bar away."""
        self._progress.remove_task(self._task)


def _tell(done: float, step: str) -> None:
    """Write a line for the program that started this one, but not too many."""
    global _told
    now = time.monotonic()
    if os.environ.get(VARIABLE) == "lines" and now > _told + _INTERVAL_S:
        _told = now
        print(f"progress {done:.4f} {step}", file=sys.stderr, flush=True)


_told = 0.0


class Terminal:
    """Where bars, lines and warnings go. Bars and warnings to stderr, results to stdout."""

    def __init__(self) -> None:
        """Bars show only if stderr is a terminal."""
        self._stopped = Event()
        self.errors = Console(stderr=True, highlight=False, soft_wrap=True)
        self._out = Console(highlight=False, soft_wrap=True)
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.fields[step]}", style="dim"),
            console=self.errors,
            disable=not self.errors.is_terminal,
            transient=True,
            speed_estimate_period=_STEADY_S,
        )

    def __enter__(self) -> "Terminal":
        self._before = signal.getsignal(signal.SIGINT)
        if self._before is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._stop)
        self._bars.start()
        return self

    def _stop(self, *_: object) -> None:
        """The first Ctrl-C waits for the next report of progress, the second does not.

        Raised at once, it would land in Blender's own Python as often as not, which prints or swallows it.
        """
        if self._stopped.is_set():
            raise KeyboardInterrupt
        self._stopped.set()
        # Not through the console: the signal may have come in the middle of its own writing.
        os.write(sys.stderr.fileno(), b"\ncatoptric: stopping after this step; press Ctrl-C again to stop at once\n")

    def __exit__(self, *failure: object) -> None:
        if self._before is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._before)
        # Ctrl-C stops the main thread alone; what still runs on another learns it from its callback.
        self._stopped.set()
        self._bars.stop()

    def bar(self, description: str) -> Bar:
        """A new bar."""
        return Bar(self._bars, self._bars.add_task(description, total=1.0, step=""), self._stopped)

    def say(self, line: str) -> None:
        """A line of results."""
        self._out.print(line, markup=False)

    def warn(self, line: str) -> None:
        """A line that a person should read, though the work goes on."""
        self.errors.print(f"catoptric: {line}", markup=False)


@contextmanager
def blender_on_stderr() -> Iterator[None]:
    """What Blender's own code logs to file descriptor 1 goes to stderr, so that stdout holds results alone."""
    ours = sys.stdout
    ours.flush()
    results = os.dup(1)
    os.dup2(2, 1)
    try:
        with open(results, "w", encoding=ours.encoding, closefd=False) as sys.stdout:
            yield
    finally:
        sys.stdout = ours
        os.dup2(results, 1)
        os.close(results)
