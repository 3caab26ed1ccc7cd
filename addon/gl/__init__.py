"""The one OpenGL context: its thread, programs, data textures and timers."""

from .capture import capture
from .clearing import clear
from .context import adopt, call, give_way, on_gl_thread, require, submit, unbind
from .counting import primitive_counter, sample_counter
from .functions import function
from .programs import feedback, program, screen, set_uniforms
from .textures import DataTexture
from .timers import Stopwatch
from .waiting import finish, is_software, read_back, render, settle

__all__ = [
    "DataTexture",
    "Stopwatch",
    "adopt",
    "call",
    "capture",
    "clear",
    "feedback",
    "finish",
    "function",
    "give_way",
    "is_software",
    "on_gl_thread",
    "primitive_counter",
    "program",
    "read_back",
    "render",
    "require",
    "sample_counter",
    "screen",
    "set_uniforms",
    "settle",
    "submit",
    "unbind",
]
