"""Framebuffers wiped, whatever they hold."""

from ctypes import POINTER, c_float, c_int, c_uint

import moderngl

from .functions import function

_COLOR, _DEPTH = 0x1800, 0x1801


def clear(framebuffer: moderngl.Framebuffer) -> None:
    """Set all colours to 0 and the depth to 1, within the scissor and as far as masks allow; binds the framebuffer.

    moderngl's own clearing leaves it to the driver what integers become.
    """
    framebuffer.use()
    for number, texture in enumerate(framebuffer.color_attachments):
        name, kind = ("glClearBufferuiv", c_uint) if texture.dtype.startswith("u") else ("glClearBufferfv", c_float)
        _clear(name, kind, _COLOR, number, (0, 0, 0, 0))
    if framebuffer.depth_attachment is not None:
        _clear("glClearBufferfv", c_float, _DEPTH, 0, (1,))


def _clear(name: str, kind: type, buffer: int, number: int, values: tuple[int, ...]) -> None:
    function(name, c_uint, c_int, POINTER(kind))(buffer, number, (kind * len(values))(*values))
