"""From the zip to a reflection, as a person goes, in a Blender that nobody has used before."""

from pathlib import Path

import numpy as np
import pytest
from catoptric.addon.metrics import to_bytes

from . import steps
from .machine import Machine
from .window import Window

BLUE = (71, 114, 179)
"""Of the button that is chosen already."""
MOST_CLICKS = 5


@pytest.fixture(scope="module")
def fresh(gui_machine: Machine):
    with Window(gui_machine, name="fresh") as window:
        yield window


def button(picture: np.ndarray, before: np.ndarray) -> tuple[float, float]:
    """The middle of the blue button that was not there before, as xdotool counts."""
    rows, columns = np.nonzero((picture == BLUE).all(axis=-1) & ~(before == BLUE).all(axis=-1))
    return float(np.median(columns)), float(np.median(rows))


def test_five_clicks_lead_from_the_zip_to_a_reflection(fresh: Window, gui_zip: Path, tmp_path: Path):
    before = fresh.picture(tmp_path / "before.png")
    fresh.drop(gui_zip, *steps.centre(fresh))
    x, y = button(fresh.picture(tmp_path / "dropped.png"), before)
    fresh.click(x, fresh.size[1] - 1 - y)
    fresh.until("probe.MODULE in bpy.context.preferences.addons")
    fresh.settle(1.0)
    steps.open_tab(fresh)
    steps.press(fresh, steps.FIRST_BUTTON)
    fresh.until("probe.at_rest()")
    assert fresh.python("print(len(probe.stage().found.reflectors))").strip() == "0"
    fresh.settle(1.0)
    steps.press(fresh, steps.BUTTON_BELOW_TEXT)
    fresh.until("len(probe.stage().found.reflectors) == 1 and probe.at_rest()")
    fresh.settle(1.0)
    fresh.picture(tmp_path / "reflection.png")
    assert fresh.clicks <= MOST_CLICKS


def test_the_viewport_shows_what_the_command_line_draws(fresh: Window, tmp_path: Path):
    path = steps.open_scene(fresh, "mirror-ball")
    fresh.python("probe.look_at('Ball', 4.0)")
    steps.show(fresh)
    fresh.settle(1.0)
    shown = steps.screen_of_view(fresh, tmp_path / "ball.png")
    frame = steps.expected(fresh, path, samples=4)
    mirror = frame.reflectors > 0.99
    assert mirror.mean() > 0.1
    off = np.abs(shown.astype(float) - to_bytes(frame.color))[mirror]
    # Blender draws its own lines over the picture.
    assert np.median(off) <= 1.0
    assert np.mean(off) < 3.0


def test_a_picture_that_takes_long_is_coarse_while_it_turns_and_whole_at_rest(fresh: Window):
    steps.show(fresh)
    fresh.python("probe.viewport()._pace.took(1, 1.0)")
    fresh.python("probe.motion = probe.Motion(probe.orbit, 100)")
    fresh.until("probe.viewport().scale == 2")
    assert fresh.python("print(probe.motion.over)").strip() == "False"
    fresh.until("probe.motion.over and probe.at_rest()")
    assert fresh.python("print(probe.viewport().scale)").strip() == "1"


def test_nobody_complained(fresh: Window):
    assert steps.complaints(fresh) == []
