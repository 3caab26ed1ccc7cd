"""How much is drawn. One query of each kind serves all: moderngl gives none back."""

from functools import cache

import moderngl

from .context import require


@cache
def sample_counter() -> moderngl.Query:
    """Counts, in `samples`, the pixels that are drawn inside it; on the GL thread, one use at a time."""
    return require().query(samples=True)


@cache
def primitive_counter() -> moderngl.Query:
    """Counts, in `primitives`, the points or triangles that come out of the stages before the pixels; likewise."""
    return require().query(primitives=True)
