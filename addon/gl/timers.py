"""How long the GPU takes."""

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from statistics import median
from time import perf_counter

import moderngl

from .context import require
from .waiting import finish, is_software

_queries: list[moderngl.Query] = []
"""Timer queries of the stopwatch in use, for the next one as well: moderngl never gives one back to OpenGL."""


class Stopwatch:
    """Times the stages of a frame; a stage may come again and again. Lives on the GL thread, one at a time.

    By timer queries on a GPU, which cost nothing until `medians` waits for them. Software renderers
    answer a query before they have drawn, so there the clock runs until the picture is finished.
    """

    def __init__(self) -> None:
        """Start without any stage."""
        self._context = require()
        self._stage = self._clocked if is_software(self._context.info["GL_RENDERER"]) else self._queried
        self._times: dict[Hashable, list[Callable[[], float]]] = {}
        self._asked = 0

    @contextmanager
    def stage(self, name: Hashable) -> Iterator[None]:
        """Time what is drawn inside."""
        with self._stage(self._times.setdefault(name, [])):
            yield

    @contextmanager
    def _queried(self, times: list[Callable[[], float]]) -> Iterator[None]:
        if self._asked == len(_queries):
            _queries.append(self._context.query(time=True))
        query = _queries[self._asked]
        self._asked += 1
        with query:
            yield
        times.append(lambda: query.elapsed / 1e6)

    @contextmanager
    def _clocked(self, times: list[Callable[[], float]]) -> Iterator[None]:
        finish()
        start = perf_counter()
        yield
        finish()
        elapsed = 1e3 * (perf_counter() - start)
        times.append(lambda: elapsed)

    def medians(self) -> dict[Hashable, float]:
        """Median milliseconds of each stage. The first time of several, a warm-up, is not counted."""
        finish()
        return {name: median(time() for time in times[len(times) > 1 :]) for name, times in self._times.items()}
