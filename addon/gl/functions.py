"""Functions of OpenGL that moderngl does not offer, from the context's own loader."""

import ctypes
from collections.abc import Callable
from functools import cache

from .context import require


@cache
def function(name: str, *arguments: type) -> Callable[..., None]:
    """OpenGL's function of that name, which returns nothing and takes `arguments` (ctypes); on the GL thread.

    While it runs, other Python threads go on. Raises `AttributeError` where the driver has no such function.
    """
    address = require().mglo._context.load_opengl_function(name)
    if not address:
        raise AttributeError(f"this OpenGL driver has no {name}")
    kind = ctypes.WINFUNCTYPE if hasattr(ctypes, "WINFUNCTYPE") else ctypes.CFUNCTYPE
    return kind(None, *arguments)(address)
