"""Where what is written goes by itself."""

import time
from pathlib import Path

import bpy

_opened = time.localtime()
"""When the file that is open was opened: two that have no name yet share no folder."""


def output_folder() -> Path:
    """Beside the open file; for one without a name, in Blender's folder of the user's data, which stays."""
    if bpy.data.filepath:
        file = Path(bpy.data.filepath)
        return file.with_name(f"{file.stem}-catoptric")
    return user_folder() / time.strftime("unsaved-%Y-%m-%d-%H%M%S", _opened)


def user_folder() -> Path:
    """What the add-on keeps for the user beside files; it need not exist."""
    return Path(bpy.utils.user_resource("DATAFILES", path="catoptric"))


@bpy.app.handlers.persistent
def _open_another(*_: object) -> None:
    global _opened
    _opened = time.localtime()


def register() -> None:
    """Notice when another file is opened."""
    bpy.app.handlers.load_pre.append(_open_another)


def unregister() -> None:
    """Notice nothing more."""
    bpy.app.handlers.load_pre.remove(_open_another)
