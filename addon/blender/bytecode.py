"""What Python leaves in Blender's folder of the user, and Blender does not take away."""

from importlib.util import cache_from_source, find_spec
from pathlib import Path

import bpy

TOP_LEVEL_MODULES = ("_moderngl",)
"""Modules that a wheel puts straight into site-packages, not into a folder of its own."""


def remove_bytecode() -> None:
    """Remove the bytecode of `TOP_LEVEL_MODULES` where Blender installed their wheels.

    When the last extension that brings a wheel goes, Blender removes the files that the wheel
    lists, and a package's folder. A module's bytecode is in neither. Python makes it anew if needed.
    """
    installed = Path(bpy.utils.user_resource("EXTENSIONS"))
    for name in TOP_LEVEL_MODULES:
        found = find_spec(name)
        if found is not None and found.origin and Path(found.origin).is_relative_to(installed):
            Path(cache_from_source(found.origin)).unlink(missing_ok=True)
