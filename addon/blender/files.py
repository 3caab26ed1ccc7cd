"""Opening .blend files."""

from pathlib import Path

import bpy

from ..errors import SceneError

_HEADS = (b"BLENDER", b"\x28\xb5\x2f\xfd", b"\x1f\x8b")
"""How a .blend begins: plain, compressed by Zstandard, or (before 3.0) by gzip."""


def open_blend(path: str | Path) -> bpy.types.Scene:
    """Open a .blend, without its user interface or scripts, and return its active scene.

    Raises `SceneError` if there is no such file, or it is no .blend, damaged, or from a newer Blender.
    """
    path = Path(path).expanduser().resolve()
    try:
        with path.open("rb") as file:
            head = file.read(7)
    except FileNotFoundError:
        raise SceneError(f"{path}: there is no such file") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror})") from None
    if not any(head.startswith(known) for known in _HEADS):
        raise SceneError(f"{path}: is not a .blend file; save it from Blender")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise SceneError(f"{path}: {_reason(str(error))}") from None
    if bpy.data.version[:2] > bpy.app.version[:2]:
        raise SceneError(f"{path}: {_newer('.'.join(map(str, bpy.data.version[:2])))}")
    if Path(bpy.data.filepath).resolve() != path:
        raise SceneError(f"{path}: is damaged; open it in Blender, or go back to its .blend1")
    return bpy.context.scene


def _reason(report: str) -> str:
    if "newer" in report.lower():
        return _newer("one")
    return "is damaged or not a .blend file; open it in Blender, or go back to its .blend1"


def _newer(version: str) -> str:
    ours = ".".join(map(str, bpy.app.version[:2]))
    return f"was saved by a newer Blender ({version}) than this {ours}; open it with that, or save it from {ours}"
