"""Waiting for the GPU while other Python threads go on: moderngl's own calls would hold them up for as long."""

from functools import cache

import moderngl

from .context import require
from .functions import function

_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")


def is_software(renderer: str) -> bool:
    """Whether a GL renderer string names a program on the CPU rather than a GPU."""
    return any(name in renderer.lower() for name in _SOFTWARE)


def finish() -> None:
    """Wait until everything drawn so far is drawn."""
    function("glFinish")()


def read_back(source: moderngl.Texture | moderngl.TextureCube | moderngl.Buffer | moderngl.Framebuffer, **how) -> bytes:
    """What `source.read(**how)` gives, once it is drawn."""
    finish()
    return source.read(**how)


def settle() -> None:
    """Before a large draw: wait for earlier ones where the call itself would, as it does in software."""
    if _draws_in_the_call():
        finish()


def render(array: moderngl.VertexArray, mode: int, vertices: int, first: int = 0, most: int = 3 << 14) -> None:
    """What `array.render` does, in calls of at most so many vertices: software runs their shaders in the call.

    Primitives are counted anew in each call; `most` is a multiple of what one takes.
    """
    for begin in range(first, first + vertices, most):
        array.render(mode, vertices=min(most, first + vertices - begin), first=begin)


@cache
def _draws_in_the_call() -> bool:
    return is_software(require().info["GL_RENDERER"])
