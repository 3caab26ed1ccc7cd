"""A scene that is drawn again and again for those who look at it, while nobody waits."""

import logging
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from threading import Lock

import numpy as np

from ..drawing import Canvas
from ..errors import Cancelled, CatoptricError
from ..gl import call, submit
from ..scene import Lighting, Scene
from .auto import Choice
from .contract import View
from .mixed import Assignment, Mixed

Develop = Callable[[Canvas, Mixed, View], np.ndarray]
"""From what was just painted, and by what, to the pixels that a viewer wants; runs on the GL thread."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Picture:
    """What a viewer sees: `pixels` (H, W, 4) float32, row 0 at the bottom, as `develop` made them of a canvas;
    of `view` and of the `act`-th scene shown; `time_ms` by stage.
    """

    pixels: np.ndarray
    view: View
    develop: Develop
    act: int
    time_ms: dict[str, float]


@dataclass(frozen=True, eq=False)
class Act:
    """What is on stage: a scene under a light, each reflector drawn by a method."""

    scene: Scene
    lighting: Lighting
    assignment: Assignment


class Studio:
    """Draws the newest scene for any number of viewers, on the GL thread.

    `problem` is what went wrong last, `stage` and `fraction` how far a bake is, `choices` which method
    draws each reflector, and why.

    Every call returns at once. A wish that is overtaken by a newer one is dropped, or stopped between two
    samples. `notify` is called, on the GL thread, whenever there is something new to look at.
    """

    def __init__(self, notify: Callable[[], None]) -> None:
        """Begin with an empty stage."""
        self.problem = ""
        self.stage, self.fraction = "", 1.0
        self.choices: dict[str, Choice] = {}
        self._notify = notify
        self._lock = Lock()
        self._wanted: Act | None = None
        self._shown: Act | None = None
        self._asked = self._on_stage = 0
        self._under_way: tuple[Hashable, View, Develop] | None = None
        self._wishes: dict[Hashable, tuple[View, Develop]] = {}
        self._pictures: dict[Hashable, Picture] = {}
        self._canvases: dict[Hashable, Canvas] = {}
        self._method: Mixed | None = None
        self._working = self._closed = False

    @property
    def busy(self) -> bool:
        """Whether there is anything left to draw."""
        return self._working

    def show(self, act: Act) -> int:
        """Draw this from now on; the number that its pictures will have."""
        with self._lock:
            self._wanted = act
            self._asked += 1
        self._go_on()
        return self._asked

    def look(self, viewer: Hashable, view: View, develop: Develop) -> None:
        """Have `viewer`'s picture drawn as soon as may be."""
        with self._lock:
            if self._is_under_way(viewer, view, develop):
                self._wishes.pop(viewer, None)
                return
            self._wishes[viewer] = view, develop
        self._go_on()

    def _is_under_way(self, viewer: Hashable, view: View, develop: Develop) -> bool:
        """Whether this very picture is being drawn just now; to ask again must not begin it anew."""
        if self._under_way is None or self._wanted is not None:
            return False
        who, what, how = self._under_way
        return (who, how, what.samples) == (viewer, develop, view.samples) and what.shows_the_same(view)

    def picture(self, viewer: Hashable) -> Picture | None:
        """The newest one of `viewer`, which may be of an older view."""
        return self._pictures.get(viewer)

    def leave(self, viewer: Hashable) -> None:
        """Draw no more for `viewer`."""
        with self._lock:
            self._wishes.pop(viewer, None)
            self._pictures.pop(viewer, None)
        submit(self._drop_canvas, viewer)

    def close(self) -> None:
        """Stop, and give everything back; waits for the sample under way."""
        with self._lock:
            self._closed = True
            self._wanted = None
            self._wishes.clear()
        call(self._release)

    def _go_on(self) -> None:
        with self._lock:
            if self._working or self._closed:
                return
            self._working = True
        submit(self._work)

    def _work(self) -> None:
        """One step: what is on stage comes first, then one viewer's picture."""
        try:
            self._step()
        except Cancelled:
            pass
        except CatoptricError as problem:
            self.problem = str(problem)
        except Exception as defect:  # nobody waits for this thread: what it raised would be lost
            self.problem = f"{type(defect).__name__}: {defect}"
            _log.exception("the studio failed")
        finally:
            with self._lock:
                self._under_way = None
                drawable = bool(self._wishes) and self._method is not None
                self._working = more = not self._closed and (self._wanted is not None or drawable)
            if more:
                submit(self._work)
            self._notify()

    def _step(self) -> None:
        wish = None
        with self._lock:
            act, self._wanted, number = self._wanted, None, self._asked
            if act is None and self._wishes and self._method:
                wish = self._wishes.popitem()
                self._under_way = (wish[0], *wish[1])
        if act:
            self._set(act)
            self._on_stage = number
        elif wish:
            self._draw(wish[0], *wish[1])

    def _set(self, act: Act) -> None:
        """Put `act` on stage, with as little new work as may be."""
        before, self._shown = self._shown, None
        if before and self._method and before.lighting is act.lighting:
            if before.assignment != act.assignment:
                self._method.assign(act.assignment, self._report)
            self._method.update(act.scene, self._report)
        else:
            method = Mixed(act.assignment)
            try:
                method.prepare(act.scene, act.lighting, self._report)
            except BaseException:
                method.release()
                raise
            if self._method:
                self._method.release()
            self._method = method
        self._shown, self.problem = act, ""
        self.choices = dict(self._method.choices)
        self.stage, self.fraction = "", 1.0

    def _report(self, stage: str, fraction: float) -> None:
        """Progress of a bake: shown to whoever looks; stopped when the studio closes."""
        if self._closed:
            raise Cancelled
        self.stage, self.fraction = stage, fraction
        self._notify()

    def _draw(self, viewer: Hashable, view: View, develop: Develop) -> None:
        canvas = self._canvases.get(viewer)
        if canvas is None or canvas.size != (view.width, view.height):
            self._drop_canvas(viewer)
            canvas = self._canvases[viewer] = Canvas(view.width, view.height)

        def overtaken(stage: str, fraction: float) -> None:
            if self._closed or (fraction > 0.0 and (viewer in self._wishes or self._wanted is not None)):
                raise Cancelled

        time_ms = self._method.paint(view, canvas, overtaken)
        pixels = develop(canvas, self._method, view)
        self._pictures[viewer] = Picture(pixels, view, develop, self._on_stage, time_ms)

    def _drop_canvas(self, viewer: Hashable) -> None:
        if viewer in self._canvases:
            self._canvases.pop(viewer).release()

    def _release(self) -> None:
        for viewer in list(self._canvases):
            self._drop_canvas(viewer)
        if self._method:
            self._method.release()
        self._method = None
