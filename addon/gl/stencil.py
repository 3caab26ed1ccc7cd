"""The stencil buffer, which moderngl leaves out."""

from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import c_int, c_uint

import moderngl

from .context import require
from .functions import function

_STENCIL_TEST, _STENCIL_BUFFER_BIT = 0x0B90, 0x0400
_KEEP, _REPLACE, _EQUAL, _ALWAYS = 0x1E00, 0x1E01, 0x0202, 0x0207
_FRAMEBUFFER, _RENDERBUFFER, _STENCIL_ATTACHMENT, _DEPTH24_STENCIL8 = 0x8D40, 0x8D41, 0x8D20, 0x88F0


def depth_stencil(size: tuple[int, int]) -> moderngl.Renderbuffer:
    """A depth buffer of `size` pixels that has a stencil as well; `attach_stencil` gives it to a framebuffer."""
    buffer = require().depth_renderbuffer(size)
    function("glBindRenderbuffer", c_uint, c_uint)(_RENDERBUFFER, buffer.glo)
    storage = function("glRenderbufferStorage", c_uint, c_uint, c_int, c_int)
    storage(_RENDERBUFFER, _DEPTH24_STENCIL8, *size)
    return buffer


def attach_stencil(framebuffer: moderngl.Framebuffer, buffer: moderngl.Renderbuffer) -> None:
    """Let a framebuffer whose depth buffer is `buffer`, of `depth_stencil`, use its stencil too."""
    framebuffer.use()
    attach = function("glFramebufferRenderbuffer", c_uint, c_uint, c_uint, c_uint)
    attach(_FRAMEBUFFER, _STENCIL_ATTACHMENT, _RENDERBUFFER, buffer.glo)


def clear_stencil() -> None:
    """Set the bound framebuffer's stencil to 0, within its scissor."""
    function("glClear", c_uint)(_STENCIL_BUFFER_BIT)


@contextmanager
def writing_stencil() -> Iterator[None]:
    """Every fragment that is drawn inside, and passes the depth test, sets the stencil to 1."""
    with _stencil(_ALWAYS, 1, _REPLACE):
        yield


@contextmanager
def where_stencil(value: int) -> Iterator[None]:
    """Only pixels with this stencil are drawn inside."""
    with _stencil(_EQUAL, value, _KEEP):
        yield


@contextmanager
def _stencil(test: int, value: int, on_pass: int) -> Iterator[None]:
    context = require()
    context.enable_direct(_STENCIL_TEST)
    function("glStencilFunc", c_uint, c_int, c_uint)(test, value, 0xFF)
    function("glStencilOp", c_uint, c_uint, c_uint)(_KEEP, _KEEP, on_pass)
    try:
        yield
    finally:
        context.disable_direct(_STENCIL_TEST)
