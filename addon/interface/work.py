"""Work that goes on while Blender stays usable: one task at a time, looked after by a timer."""

import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future

import bpy

from ..errors import Cancelled, CatoptricError
from ..gl import submit
from ..progress import Progress

_POLL = 0.1
_log = logging.getLogger(__name__)


class Task:
    """Something that takes a while. Lives on the main thread; holds nothing of Blender's but names.

    `stage` and `fraction` say how far it is; at the end, `problem` is the one line that says what went wrong,
    or `notes` are what a person should know and `outcome` is the line that says what came of it.
    """

    def __init__(self, label: str) -> None:
        """`label` names the task for people, as in `Baking`."""
        self.label = label
        self.stage, self.fraction = "", 0.0
        self.problem, self.outcome = "", ""
        self.notes: list[str] = []
        self.over = self.stopped = False

    def start(self) -> None:
        """Begin; raises a `CatoptricError` where that cannot be."""
        raise NotImplementedError

    def look(self) -> bool:
        """Take in what has come of it so far, without waiting; whether it has ended."""
        raise NotImplementedError

    def stop(self) -> None:
        """End it soon."""
        self.stopped = True

    def finish(self) -> None:
        """What is left to do on the main thread, once it has ended well."""

    def drop(self) -> None:
        """Leave nothing behind, however it has ended."""


class GlTask(Task):
    """Steps on the GL thread, one after the other; viewports get their pictures in between."""

    def __init__(self, label: str, steps: Callable[[Progress], Iterator[None]]) -> None:
        """`steps` is a generator; each part up to a `yield` is a step. Its progress callback raises `Cancelled`."""
        super().__init__(label)
        self._steps = steps(self._report)
        self._pending: Future | None = None

    def start(self) -> None:
        """Hand over the first step."""
        self._pending = submit(self._step)

    def look(self) -> bool:
        """Hand over the next step once the last one is done."""
        if not self._pending.done():
            return False
        try:
            ended = self._pending.result()
        except Cancelled:
            self.stopped = ended = True
        except CatoptricError as problem:
            self.problem, ended = str(problem), True
        except MemoryError:
            self.problem, ended = "not enough memory: choose a lower resolution", True
        if not ended:
            self._pending = submit(self._step)
        return ended

    def drop(self) -> None:
        """Let the generator give back what it holds."""
        submit(self._steps.close)

    def _step(self) -> bool:
        if self.stopped:
            raise Cancelled
        return next(self._steps, _ENDED) is _ENDED

    def _report(self, stage: str, fraction: float) -> None:
        if self.stopped:
            raise Cancelled
        self.stage, self.fraction = stage, fraction


Parts = Iterator[tuple[Task | None, float]]
"""Tasks, each with the fraction of the whole that is done after it; None asks to be called again soon."""


class Chain(Task):
    """Tasks one after the other, as one. What a finished one has made is kept, whatever becomes of the rest."""

    def __init__(self, label: str, parts: Callable[[Task], Parts]) -> None:
        """`parts` is a generator, on the main thread, that is given this task; it may raise a `CatoptricError`."""
        super().__init__(label)
        self._parts = parts(self)
        self._part: Task | None = None
        self._span = 0.0, 0.0

    def start(self) -> None:
        """Begin the first part."""
        self._go_on()

    def look(self) -> bool:
        """Look after the part under way; begin the next one after it."""
        try:
            return self._look()
        except CatoptricError as problem:
            self.problem = str(problem)
            return True

    def stop(self) -> None:
        """Stop the part under way; none follows."""
        super().stop()
        if self._part is not None:
            self._part.stop()

    def drop(self) -> None:
        """Drop what is under way."""
        if self._part is not None:
            self._part.drop()
        self._parts.close()

    def _look(self) -> bool:
        if self._part is None:
            return self.stopped or self._go_on()
        part, (start, end) = self._part, self._span
        ended = part.look()
        self.stage, self.fraction = part.stage, start + (end - start) * part.fraction
        if not ended:
            return False
        self.stopped, self.problem = self.stopped or part.stopped, part.problem
        self.notes += part.notes
        if self.stopped or self.problem:
            return True
        part.finish()
        part.over, self._part = True, None
        part.drop()
        return self._go_on()

    def _go_on(self) -> bool:
        """Begin the next part, or wait for it; whether there is none."""
        following = next(self._parts, None)
        if following is None:
            return True
        part, end = following
        if part is not None:
            self._part, self._span = part, (self._span[1], end)
            part.start()
        return False


_ENDED = object()
_current: Task | None = None
_last = ""


def last() -> str:
    """What came of the task before, in a line."""
    return _last


def tell(line: str) -> None:
    """Have the panel show a line."""
    global _last
    _last = line


def current() -> Task | None:
    """What is under way."""
    return _current


def begin(task: Task) -> None:
    """Start a task; it is looked after from now on. Raises a `CatoptricError` if it cannot begin."""
    global _current
    if _current is not None:
        raise CatoptricError(f"{_current.label} is still under way; wait for it, or press Stop")
    try:
        task.start()
    except BaseException:
        task.drop()
        raise
    _current = task
    tell("")
    bpy.app.timers.register(_look, first_interval=_POLL, persistent=True)


def wait(task: Task) -> None:
    """Stay until a task has ended, where there is no window to keep alive."""
    while not task.over:
        time.sleep(_POLL / 10)
        _look()


def cancel() -> None:
    """Stop what is under way, soon."""
    if _current is not None:
        _current.stop()


def abandon(*_: object) -> None:
    """Stop what is under way, and wait for nothing: Blender quits, or opens another file."""
    global _current
    task, _current = _current, None
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
    if task is not None:
        task.stop()
        task.over = True
        task.drop()


def _look() -> float | None:
    """A timer of Blender's."""
    global _current
    task = _current
    if task is None:
        return None
    before = _said(task)
    try:
        ended = task.look()
    except Exception as defect:  # nobody waits for a timer: what it raised would be lost
        task.problem, ended = f"{type(defect).__name__}: {defect}", True
        _log.exception("%s failed", task.label)
    if ended or before != _said(task):
        redraw_panels()
    if not ended:
        return _POLL
    _current = None
    if not task.stopped and not task.problem:
        try:
            task.finish()
        except CatoptricError as problem:
            task.problem = str(problem)
    task.over = True
    task.drop()
    tell(task.problem or (f"{task.label}: stopped" if task.stopped else task.outcome or f"{task.label}: done"))
    return None


def _said(task: Task) -> tuple[str, float, bool]:
    """What the panel shows of a task."""
    return task.stage, round(task.fraction, 2), task.stopped


def redraw_panels() -> None:
    """Draw the sidebars and the render settings anew."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"VIEW_3D", "PROPERTIES"}:
                for region in area.regions:
                    if region.type == ("UI" if area.type == "VIEW_3D" else "WINDOW"):
                        region.tag_redraw()


@bpy.app.handlers.persistent
def _leave_file(*_: object) -> None:
    abandon()


def register() -> None:
    """End what is under way whenever another file is opened."""
    bpy.app.handlers.load_pre.append(_leave_file)


def unregister() -> None:
    """End what is under way."""
    bpy.app.handlers.load_pre.remove(_leave_file)
    abandon()
