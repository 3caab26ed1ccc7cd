"""What people do while Catoptric is at work: undo, delete, open, switch off, quit."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from . import steps
from .machine import Machine
from .window import Window

SMALL = "settings = bpy.context.scene.catoptric; settings.scale, settings.samples = '2', '1'"
LONG_WORK = "bpy.context.scene.catoptric.methods.layered_depth_published.resolution = 512"
STILL_AT_IT = f"print({steps.UNDER_WAY})"
NEW_WINDOW = """
window, area, regions = view3d()
with bpy.context.temp_override(window=window, area=area, region=regions["WINDOW"]):
    bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    bpy.ops.wm.window_new()
"""
OTHER_EYES = """
for number in range(len(probe.viewports())):
    area = view3d(number)[1]
    area.spaces.active.shading.type = "RENDERED"
    probe.look_at("Ball", 3.0 + number, number)
"""
MOVE = """
window, area, regions = view3d()
with bpy.context.temp_override(window=window, area=area, region=regions["WINDOW"]):
    bpy.ops.object.select_all(action="DESELECT")
    ball = bpy.data.objects["Suzanne left"]
    bpy.context.view_layer.objects.active = ball
    ball.select_set(True)
    bpy.ops.transform.translate("EXEC_DEFAULT", value=(0.25, 0.0, 0.0))
    bpy.ops.ed.undo_push(message="Move")
"""
PLACE = "print(round(bpy.data.objects['Suzanne left'].location.x, 3))"
DELETE = "bpy.data.objects.remove(bpy.data.objects['Suzanne left'])"
LEFT = """
kinds = [name for name in ("CatoptricEngine", "CATOPTRIC_OT_bake", "CATOPTRIC_PT_main") if hasattr(bpy.types, name)]
handlers = [
    function for name in ("load_pre", "load_post", "depsgraph_update_post", "undo_post", "save_pre")
    for function in getattr(bpy.app.handlers, name) if function.__module__.startswith(probe.MODULE)
]
print(kinds, handlers, hasattr(bpy.types.Scene, "catoptric"))
"""
DISABLE, ENABLE = (f"bpy.ops.preferences.addon_{verb}able(module=probe.MODULE)" for verb in ("dis", "en"))
QUIT = "bpy.app.timers.register(lambda: bpy.ops.wm.quit_blender() and None, first_interval=0.1)"


@pytest.fixture(scope="module")
def window(gui_machine: Machine, gui_zip: Path) -> Iterator[Window]:
    """A window with the extension, and no camera near to what is baked."""
    window = Window(gui_machine, name="disturbed")
    window.install(gui_zip)
    with window:
        yield window


@pytest.fixture
def shown(window: Window) -> Path:
    """The scene with the mirror ball, on the screen."""
    shutil.rmtree(window.cache, ignore_errors=True)
    path = steps.open_scene(window, "mirror-ball")
    window.python(SMALL)
    window.python("probe.look_at('Ball', 4.0)")
    steps.show(window)
    return path


@pytest.fixture
def baking(window: Window, shown: Path) -> None:
    """A bake that takes some seconds has begun."""
    window.python(LONG_WORK)
    window.until("probe.at_rest()")
    steps.begin_baking(window)


def moved(window: Window) -> float:
    return float(window.python(PLACE))


def test_two_viewports_and_two_windows_show_pictures_of_their_own(window, shown, tmp_path):
    window.python(NEW_WINDOW)
    window.settle(2.0)
    window.python(OTHER_EYES)
    count = int(window.python("print(len(probe.viewports()))"))
    assert count >= 3
    for number in range(count):
        window.until(f"probe.at_rest({number})")
    window.picture(tmp_path / "windows.png")
    for number in range(count):
        frame = steps.expected(window, shown, samples=1, number=number)
        assert frame.reflectors.any()
        assert np.abs(window.pixels(number) - frame.color).max() < 1e-3
    assert steps.complaints(window) == []


def test_undo_and_redo_while_a_bake_runs(window, shown):
    before = moved(window)
    window.python(MOVE)
    after = moved(window)
    assert after == pytest.approx(before + 0.25)
    window.python(LONG_WORK)
    window.until("probe.at_rest()")
    steps.begin_baking(window)
    steps.key_over_view(window, "ctrl+z")
    assert moved(window) == pytest.approx(before)
    steps.key_over_view(window, "ctrl+shift+z")
    assert moved(window) == pytest.approx(after)
    assert window.python(STILL_AT_IT).strip() == "True"
    window.until(f"not {steps.UNDER_WAY}")
    assert window.python("print(probe.ours('work').last())").strip() == "Baking layers: done"
    window.until("probe.at_rest()")
    assert steps.complaints(window) == []


def test_an_object_is_deleted_while_it_is_baked(window, baking):
    window.python(DELETE)
    assert window.python(STILL_AT_IT).strip() == "True"
    window.until(f"not {steps.UNDER_WAY}")
    assert window.python("print(probe.ours('work').last())").strip() == "Baking layers: done"
    window.until("probe.at_rest()")
    names = window.python("print([instance.name for instance in probe.stage().found.instances])")
    assert "Suzanne right" in names
    assert "Suzanne left" not in names
    assert steps.complaints(window) == []


def test_another_file_is_opened_while_a_bake_runs(window, baking):
    steps.open_scene(window, "hollow-box")
    assert window.python(STILL_AT_IT).strip() == "False"
    steps.show(window)
    assert int(window.python("print(len(probe.ours('stages')._stages))")) == 1
    assert steps.complaints(window) == []


def test_it_is_switched_off_and_on_while_it_draws(window, baking, tmp_path):
    window.python(DISABLE)
    window.settle(2.0)
    assert window.python(LEFT).strip() == "[] [] False"
    window.picture(tmp_path / "off.png")
    window.python(ENABLE)
    window.settle(1.0)
    steps.show(window)
    window.picture(tmp_path / "on.png")
    assert steps.complaints(window) == []


def test_blender_quits_in_the_middle_of_a_bake(window, baking):
    window.python(QUIT)
    assert window.ended(20.0) == 0
    assert steps.complaints(window) == []
