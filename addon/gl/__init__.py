"""The one OpenGL context: its thread, programs, data textures and timers."""

from .context import call, on_gl_thread, require
from .programs import program, screen
from .textures import DataTexture
from .timers import is_software, median_ms

__all__ = ["DataTexture", "call", "is_software", "median_ms", "on_gl_thread", "program", "require", "screen"]
