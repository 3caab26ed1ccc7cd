"""How long the GPU takes."""

from collections.abc import Callable
from statistics import median
from time import perf_counter

import moderngl

from .context import require

_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")


def is_software(renderer: str) -> bool:
    """Whether a GL renderer string names a program on the CPU rather than a GPU."""
    return any(name in renderer.lower() for name in _SOFTWARE)


def median_ms(draw: Callable[[], None], repeats: int = 5, warm_up: int = 1) -> float:
    """Median milliseconds of `draw`, after `warm_up` calls that are not counted.

    By timer queries on a GPU. Software renderers answer a query before they have drawn, so there
    the clock runs until the picture is finished.
    """
    context = require()
    measure = _clock_ms if is_software(context.info["GL_RENDERER"]) else _query_ms
    for _ in range(warm_up):
        measure(context, draw)
    return median(measure(context, draw) for _ in range(repeats))


def _query_ms(context: moderngl.Context, draw: Callable[[], None]) -> float:
    query = context.query(time=True)
    with query:
        draw()
    return query.elapsed / 1e6


def _clock_ms(context: moderngl.Context, draw: Callable[[], None]) -> float:
    context.finish()
    start = perf_counter()
    draw()
    context.finish()
    return 1e3 * (perf_counter() - start)
