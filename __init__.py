"""Catoptric: real-time reflections for Blender, measured against Cycles.

The repository root is the package, for pip (`catoptric`) and for Blender
(`bl_ext.*.catoptric`) alike, so every import inside it is relative.
"""


def register() -> None:
    """Register the add-on with Blender."""
    from .addon import interface

    interface.register()


def unregister() -> None:
    """Remove everything that `register` added."""
    from .addon import interface
    from .addon.blender.bytecode import remove_bytecode

    interface.unregister()
    remove_bytecode()
