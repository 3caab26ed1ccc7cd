"""What a program's last stage before the pixels puts out, written to a buffer by several draws in a row."""

from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import c_uint

import moderngl

from .functions import function

_RASTERIZER_DISCARD = 0x8C89
_TRANSFORM_FEEDBACK_BUFFER = 0x8C8E
_TRIANGLES = 0x0004


@contextmanager
def capture(shader: moderngl.Program, buffer: moderngl.Buffer) -> Iterator[None]:
    """Have what is drawn inside, by this program alone, write its varyings to `buffer` and nothing to the screen.

    moderngl's own `transform` begins anew with every draw, so that each would have to wait for the one before to
    know where to go on.
    """
    function("glUseProgram", c_uint)(shader.glo)
    function("glEnable", c_uint)(_RASTERIZER_DISCARD)
    function("glBindBufferBase", c_uint, c_uint, c_uint)(_TRANSFORM_FEEDBACK_BUFFER, 0, buffer.glo)
    function("glBeginTransformFeedback", c_uint)(_TRIANGLES)
    try:
        yield
    finally:
        function("glEndTransformFeedback")()
        function("glBindBufferBase", c_uint, c_uint, c_uint)(_TRANSFORM_FEEDBACK_BUFFER, 0, 0)
        function("glDisable", c_uint)(_RASTERIZER_DISCARD)
