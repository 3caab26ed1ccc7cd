"""What a person does in Blender's window, step by step."""

import json
import shutil
from pathlib import Path

import numpy as np
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.methods.contract import Frame, View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.scene import Camera, Lighting
from catoptric.scenes import path_of

from .window import Window

FIRST_BUTTON, BUTTON_BELOW_TEXT = 57, 121
"""Pixels below the sidebar's top, at a scale of 1: the panel's first row; the one under three lines of text."""

_TAB = (14, 250)
"""Of our tab: pixels from the sidebar's right edge, and below its top."""

_SIDEBAR = "region = view3d()[2]['UI']; print(region.x, region.y, region.width, region.height)"
_VIEW = "region = view3d()[2]['WINDOW']; print(region.x, region.y, region.width, region.height)"
SHOW = """
window, area, regions = view3d()
window.scene.render.engine = "CATOPTRIC"
area.spaces.active.shading.type = "RENDERED"
"""
_EYE = """
import json
window, area, regions = view3d({number})
seen, region, scale = area.spaces.active.region_3d, regions["WINDOW"], probe.scale()
matrices = [list(map(list, matrix)) for matrix in (seen.view_matrix, seen.window_matrix)]
print(json.dumps([*matrices, region.width // scale, region.height // scale]))
"""
_BAKE = """
window, area, regions = view3d()
with bpy.context.temp_override(window=window, area=area, region=regions["UI"]):
    bpy.ops.catoptric.bake("INVOKE_DEFAULT")
"""
UNDER_WAY = "(probe.ours('work').current() is not None)"


def open_tab(window: Window) -> None:
    """Open the sidebar by its key, and our tab by a click."""
    x, y = centre(window)
    window.xdotool("mousemove", x, window.size[1] - y, "sleep", 0.3, "key", "n")
    window.until("view3d()[1].spaces.active.show_region_ui and view3d()[2]['UI'].width > 1")
    window.settle(1.0)
    x, y, width, height = rectangle(window, _SIDEBAR)
    window.click(x + width - _TAB[0], y + height - _TAB[1])
    window.until("view3d()[2]['UI'].active_panel_category == 'Catoptric'")
    window.settle(1.0)


def press(window: Window, below_top: int) -> None:
    """Press a button of the panel, so many pixels below the sidebar's top."""
    x, y, width, height = rectangle(window, _SIDEBAR)
    window.click(x + width / 2 - 20, y + height - below_top)


def open_scene(window: Window, name: str) -> Path:
    """Open a copy of a scene that ships."""
    path = window.machine.share / f"{name}.blend"
    shutil.copy(path_of(name), path)
    window.python(f"bpy.ops.wm.open_mainfile(filepath={str(path)!r})")
    window.settle(1.0)
    return path


def show(window: Window) -> None:
    """Switch the first viewport to Catoptric, and wait for its picture."""
    window.python(SHOW)
    window.until("probe.at_rest()")


def begin_baking(window: Window) -> None:
    """As the button does."""
    window.python(_BAKE)
    window.until(UNDER_WAY)


def key_over_view(window: Window, *keys: str) -> None:
    """Press keys with the mouse over the first viewport."""
    x, y = centre(window)
    window.xdotool("mousemove", x, window.size[1] - y, "sleep", 0.3, "key", *keys)
    window.settle()


def centre(window: Window) -> tuple[int, int]:
    """The middle of the first viewport, as Blender counts."""
    x, y, width, height = rectangle(window, _VIEW)
    return round(x + width / 2), round(y + height / 2)


def rectangle(window: Window, code: str) -> tuple[int, int, int, int]:
    """Left, bottom, width and height, as printed."""
    x, y, width, height = map(int, window.python(code).split())
    return x, y, width, height


def screen_of_view(window: Window, path: Path) -> np.ndarray:
    """The first viewport's part of a picture of the screen, (H, W, 3) of 0..255."""
    x, y, width, height = rectangle(window, _VIEW)
    top = window.size[1] - y - height
    return window.picture(path)[top : top + height, x : x + width]


def expected(window: Window, scene: Path, samples: int, number: int = 0) -> Frame:
    """What the command line draws of a scene from where a viewport looks."""
    *matrices, width, height = json.loads(window.python(_EYE.format(number=number)))
    seen, projected = map(np.array, matrices)
    read = extract(open_blend(scene))
    method = METHODS["auto"]()
    try:
        method.prepare(read, Lighting.DIRECT)
        return method.render(View(Camera.of_matrices(seen, projected, width, height), width, height, samples))
    finally:
        method.release()


def complaints(window: Window) -> list[str]:
    """What Blender has printed and should not have."""
    words = ("error", "warn", "traceback", "exception", "gpu", "assert", "leak")
    printed = window.log.read_text(errors="replace").splitlines()
    return [line for line in printed if any(word in line.lower() for word in words)]
