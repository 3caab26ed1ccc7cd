"""Runs inside Blender's window: what a test or a benchmark has to know of it, and moves in it."""

import json
import math
import os
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import bpy
from mathutils import Quaternion

MODULE = sys.argv[-1]
_TICK_S = 0.01
_SAY_S = 60.0


def viewports() -> list[tuple]:
    """All 3D viewports: window and area."""
    windows = bpy.context.window_manager.windows
    return [(window, area) for window in windows for area in window.screen.areas if area.type == "VIEW_3D"]


def view3d(number: int = 0) -> tuple:
    """One of the 3D viewports: window, area, and its regions by type."""
    window, area = viewports()[number]
    return window, area, {region.type: region for region in area.regions}


def ours(name: str):
    """A module of the extension's interface."""
    return import_module(f"{MODULE}.addon.interface.{name}")


def stage(number: int = 0):
    """What a viewport shows, or None."""
    window = view3d(number)[0]
    return ours("stages").known(window.scene, window.view_layer)


def viewport(number: int = 0):
    """The extension's side of a viewport, or None."""
    known = stage(number)
    return known.viewers.get(view3d(number)[2]["WINDOW"].as_pointer()) if known else None


def picture(number: int = 0):
    """The newest picture that a viewport has, or None."""
    viewer = viewport(number)
    return stage(number).studio.picture(viewer) if viewer else None


def at_rest(number: int = 0) -> bool:
    """Whether a viewport shows a picture that is as good as it gets."""
    known, shown = stage(number), picture(number)
    if known is None or shown is None or known.stale or known.studio.busy:
        return False
    samples, is_whole = int(view3d(number)[0].scene.catoptric.samples), viewport(number).scale == scale(number)
    return is_whole and (shown.act, shown.view.samples) == (known.act, samples) and viewport(number)._shown is shown


def scale(number: int = 0) -> int:
    """By what the sides of a viewport at rest are divided."""
    return ours("viewport").scale_at_rest(view3d(number)[0].scene.catoptric)


def resident_mb() -> float:
    """Memory of this process that lies in RAM, in megabytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


class Held:
    """How long the main thread was held by each function of the extension that Blender called, in milliseconds."""

    def __init__(self) -> None:
        self.times: dict[str, list[float]] = defaultdict(list)
        self._folder = str(Path(import_module(MODULE).__file__).parent)
        self._frame, self._begun = None, 0.0

    def __enter__(self) -> "Held":
        events = sys.monitoring.events
        sys.monitoring.use_tool_id(sys.monitoring.PROFILER_ID, "catoptric")
        called = {events.PY_START: self._start, events.PY_RETURN: self._end, events.PY_UNWIND: self._end}
        for event, function in called.items():
            sys.monitoring.register_callback(sys.monitoring.PROFILER_ID, event, function)
        sys.monitoring.set_events(sys.monitoring.PROFILER_ID, sum(called))
        return self

    def __exit__(self, *error: object) -> None:
        sys.monitoring.set_events(sys.monitoring.PROFILER_ID, 0)
        sys.monitoring.free_tool_id(sys.monitoring.PROFILER_ID)

    def _start(self, code, offset):
        if not code.co_filename.startswith(self._folder):
            return sys.monitoring.DISABLE
        if threading.current_thread() is threading.main_thread() and self._frame is None:
            self._frame, self._begun = sys._getframe(1), time.perf_counter()
        return None

    def _end(self, code, offset, value):
        if self._frame is not None and sys._getframe(1) is self._frame:
            self.times[code.co_qualname].append(1e3 * (time.perf_counter() - self._begun))
            self._frame = None


class Motion:
    """Moves something at every third tick of a timer; notes how far apart the ticks are, in milliseconds, and counts
    the pictures that come meanwhile.
    """

    def __init__(self, step: Callable[[int], None], ticks: int) -> None:
        self.gaps: list[float] = []
        self._pictures = [picture()]
        self._step, self._ticks, self._last = step, ticks, time.perf_counter()
        self.held = Held()
        self.held.__enter__()
        bpy.app.timers.register(self._tick, first_interval=_TICK_S)

    @property
    def over(self) -> bool:
        """Whether it has come to its end."""
        return len(self.gaps) >= self._ticks

    def _tick(self) -> float | None:
        now = time.perf_counter()
        self.gaps.append(1e3 * (now - self._last))
        self._last = now
        if self._pictures[-1] is not picture():
            self._pictures.append(picture())
        if self.over:
            self.held.__exit__()
            return None
        if len(self.gaps) % 3 == 0:
            self._step(len(self.gaps))
        return _TICK_S

    def result(self) -> str:
        """As JSON."""
        return json.dumps({"gaps": self.gaps, "held": self.held.times, "pictures": len(self._pictures) - 1})


def look_at(name: str, distance: float, number: int = 0) -> None:
    """Put a viewport's eye so far from an object, on the camera's side of it."""
    region = view3d(number)[1].spaces.active.region_3d
    region.view_perspective = "PERSP"
    region.view_location = bpy.data.objects[name].matrix_world.translation
    region.view_rotation = bpy.context.scene.camera.matrix_world.to_quaternion()
    region.view_distance = distance


def orbit(number: int) -> None:
    """Turn the first viewport a little."""
    region = view3d()[1].spaces.active.region_3d
    region.view_rotation = (Quaternion((0.0, 0.0, 1.0), 0.02) @ region.view_rotation).normalized()


def shift(name: str) -> Callable[[int], None]:
    """Moves an object to and fro."""
    start = bpy.data.objects[name].location.x

    def step(number: int) -> None:
        bpy.data.objects[name].location.x = start + 0.3 * math.sin(0.02 * number)

    return step


class Redraws:
    """Turns the camera as often as asked, each time once its picture is on the screen; a record of each."""

    def __init__(self, wanted: int) -> None:
        self.records: list[dict[str, float]] = []
        self.memory: list[float] = []
        self._wanted = wanted
        self._turn()
        bpy.app.timers.register(self._tick, first_interval=_TICK_S)

    @property
    def over(self) -> bool:
        """Whether it has come to its end."""
        return len(self.records) >= self._wanted

    def _turn(self) -> None:
        orbit(0)
        self._turned, self._first = time.perf_counter(), None

    def _tick(self) -> float | None:
        _, area, regions = view3d()
        shown, region, seen = viewport()._shown, regions["WINDOW"], area.spaces.active.region_3d
        took = 1e3 * (time.perf_counter() - self._turned)
        if self._first is None and ours("viewport").is_of(shown, region, seen):
            self._first = took
        if not shown.view.shows_the_same(ours("viewport").view_of(region, seen, scale())):
            return _TICK_S / 5
        self.records.append({"first": self._first, "total": took, "copy": viewport().copy_ms, **shown.time_ms})
        self.memory.append(resident_mb())
        if self.over:
            return None
        self._turn()
        return _TICK_S / 5

    def result(self) -> str:
        """As JSON."""
        return json.dumps({"records": self.records, "memory": self.memory})


def read_back_ms(times: int) -> list[float]:
    """Milliseconds that it takes to read the first viewport's picture back from the GPU."""
    studio, viewer, shown = stage().studio, viewport(), picture()
    call = import_module(f"{MODULE}.addon.gl").call

    def read() -> float:
        start = time.perf_counter()
        shown.develop(studio._canvases[viewer], studio._method, shown.view)
        return 1e3 * (time.perf_counter() - start)

    return [call(read) for _ in range(times)]
