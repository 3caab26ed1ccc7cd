"""What the panel says, as plain text."""

import textwrap
from collections.abc import Iterable, Sequence

from ..methods.auto import Choice
from ..methods.registry import METHODS
from ..scene import Scene

_PIXELS_A_LETTER = 6.5
"""Of Blender's interface font at a scale of 1, on the average."""


def wrapped(text: str, width: float, scale: float = 1.0) -> list[str]:
    """`text` in lines that fit `width` pixels of a region, at the interface's `scale`; labels do not wrap."""
    letters = int(width / (_PIXELS_A_LETTER * scale))
    return textwrap.wrap(text, max(letters, 16)) or [""]


def sentence(phrase: str) -> str:
    """A phrase with a capital at its beginning."""
    return phrase[:1].upper() + phrase[1:]


def method_label(name: str) -> str:
    """A method's name as people read it."""
    return name.replace("-", " ").capitalize()


def reflectors_of(scene: Scene) -> dict[str, list[str]]:
    """The names of a scene's reflectors, those of instances of one object together under the first's name."""
    groups: dict[str, list[str]] = {}
    for index in scene.reflectors:
        name = scene.instances[index].name
        stem, _, number = name.rpartition(" [")
        owner = stem if number[:-1].isdigit() and stem in groups else name
        groups.setdefault(owner, []).append(name)
    return groups


def reflected_of(scene: Scene) -> list[str]:
    """The names of what shows in reflections."""
    return [instance.name for instance in scene.instances if instance.in_reflections]


def drawn_by(name: str, asked: str, choice: Choice | None) -> str:
    """One line for a reflector: its name, its method, and whether that was chosen for it."""
    if choice is None:
        return f"{name}: {method_label(asked)}" if asked in METHODS else name
    label = method_label(choice.method)
    return f"{name}: {label}" if choice.method == asked else f"{name}: {label} ({method_label(asked)})"


def size_of(count: int) -> str:
    """Bytes as people read them."""
    size = float(count)
    for unit in ("bytes", "KB", "MB"):
        if size < 1000.0:
            return f"{size:.0f} {unit}" if unit == "bytes" or size >= 10.0 else f"{size:.1f} {unit}"
        size /= 1000.0
    return f"{size:.1f} GB"


def ago(seconds: float) -> str:
    """How long ago something was made."""
    for limit, length, unit in ((90, 1, "s"), (5400, 60, "min"), (129600, 3600, "h"), (float("inf"), 86400, "days")):
        if seconds < limit:
            return f"{max(seconds, 0.0) / length:.0f} {unit} ago"
    raise AssertionError


def listed(names: Sequence[str], most: int = 3) -> str:
    """`a, b, c and 4 more`."""
    shown = ", ".join(f'"{name}"' for name in names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def count_of(things: Iterable[object], one: str, several: str) -> str:
    """`1 reflector`, `3 reflectors`."""
    count = len(list(things))
    return f"{count} {one if count == 1 else several}"
