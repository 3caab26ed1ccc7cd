"""Which key does what: one table for the window, its help and the manual."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Binding:
    """Keys that do one thing. `shown` is how people read them, `help` what they do."""

    keys: tuple[str, ...]
    shown: str
    help: str
    action: str = ""


DIGITS = tuple("123456789")

BINDINGS = (
    Binding(("w", "a", "s", "d", "up", "left", "down", "right"), "W A S D", "fly; the arrow keys do as well"),
    Binding(("q", "e"), "Q E", "fly down, up"),
    Binding(("shift",), "Shift", "fly four times as fast"),
    Binding(
        (),
        "drag",
        "look around, as far as you like; on the line of the split view: move it",
    ),
    Binding((), "wheel", "fly faster or slower from now on"),
    Binding(("home",), "Home", "back to the scene's camera", "pilot.go_home"),
    Binding(DIGITS, "1 … 9", "this method; with Ctrl: in the right half of the split view"),
    Binding(("v",), "V", "split view, on and off", "toggle_split"),
    Binding(("tab",), "Tab", "swap the two halves", "swap"),
    Binding(("l",), "L", "next light: unlit, direct, and cycles where the scene holds lightmaps", "next_lighting"),
    Binding(("-", "="), "- =", "exposure, half a stop down or up"),
    Binding(("c",), "C", "next view transform: the plain sRGB curve, and those of Blender", "next_view"),
    Binding(("r",), "R", "record a path; again: stop, and save it beside the scene", "toggle_recording"),
    Binding(("space",), "Space", "play the path; again: stop", "toggle_replay"),
    Binding(("x",), "X", "export the path as a film", "ask_film"),
    Binding(("p",), "P", "save a picture", "ask_picture"),
    Binding(("h",), "H", "show or hide the panel", "toggle_panel"),
    Binding(("f1",), "F1", "these keys", "toggle_help"),
    Binding(("escape",), "Esc", "stop what takes long, and go back to what was there before", "stop"),
    Binding((), "Ctrl Q", "close the window"),
)

ACTIONS = {key: binding.action for binding in BINDINGS for key in binding.keys if binding.action}

_WISHES = {
    **dict.fromkeys(("d", "right"), (1, 0, 0)),
    **dict.fromkeys(("a", "left"), (-1, 0, 0)),
    **dict.fromkeys(("e",), (0, 1, 0)),
    **dict.fromkeys(("q",), (0, -1, 0)),
    **dict.fromkeys(("w", "up"), (0, 0, 1)),
    **dict.fromkeys(("s", "down"), (0, 0, -1)),
}

FLYING = frozenset(_WISHES)


def wish_of(held: set[str]) -> np.ndarray:
    """(3,) right, up and forward, each -1..1, as these keys ask for."""
    return np.clip(sum((np.array(_WISHES[key]) for key in held & FLYING), np.zeros(3)), -1.0, 1.0)
