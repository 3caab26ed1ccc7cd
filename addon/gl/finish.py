"""Waiting for the GPU while other Python threads go on: moderngl holds the interpreter's lock as it waits."""

import ctypes
import ctypes.util
import sys
from collections.abc import Callable
from functools import cache

from .context import require

_LIBRARIES = {"win32": ("opengl32",), "darwin": ("OpenGL",)}
_ELSEWHERE = ("libOpenGL.so.0", "libGL.so.1")


def finish() -> None:
    """Return when everything drawn so far is drawn; on the GL thread."""
    context = require()
    _gl_finish()()
    context.finish()  # where the library of that name knows nothing of our context, this is what waits


@cache
def _gl_finish() -> Callable[[], None]:
    for name in _LIBRARIES.get(sys.platform, _ELSEWHERE):
        try:
            library = ctypes.CDLL(ctypes.util.find_library(name) or name)
            return library.glFinish
        except (OSError, AttributeError):
            continue
    return lambda: None
