"""Pictures of Blender's own window with the extension in it, on a screen that nobody sees."""

import shutil
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from ..addon.metrics import to_bytes
from ..batch.package import ROOT, package
from ..scenes import path_of
from ..tests.gui.machine import find
from ..tests.gui.window import MODULE, Window
from .picture_files import save, strip

OVERLAYS = {
    "REFLECTORS": "Reflectors",
    "DISTANCE": "Hit distance",
    "LAYERS": "Layers",
    "REGIONS": "Reflection regions",
}
_PATIENCE_S = 300.0

_BUSY = f"""
from importlib import import_module
known = import_module("{MODULE}.addon.interface.stages").known
window = bpy.context.window_manager.windows[0]
stage = known(window.scene, window.view_layer)
print(int(stage is None or stage.found is None or stage.stale or stage.studio.busy))
"""
_OPEN_TAB = """
window, area, regions = view3d()
regions["UI"].active_panel_category = "Catoptric"
"""
_SHOW = """
window, area, regions = view3d()
window.scene.render.engine = "CATOPTRIC"
area.spaces.active.shading.type = "RENDERED"
area.spaces.active.region_3d.view_perspective = "CAMERA"
area.spaces.active.region_3d.view_camera_zoom = 8
"""
_BARE = """
space = view3d()[1].spaces.active
space.show_region_ui = space.show_gizmo = space.overlay.show_overlays = False
space.show_region_toolbar = space.show_region_header = space.show_region_tool_header = False
bpy.context.scene.catoptric.show_times = False
"""
_RENDER = """
render = bpy.context.scene.render
if hasattr(render.image_settings, "media_type"):
    render.image_settings.media_type = "MULTI_LAYER_IMAGE"
render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
render.filepath = {path!r}
bpy.ops.render.render(write_still=True)
"""
_PREFERENCES = """
bpy.context.preferences.active_section = "EXTENSIONS"
with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
    bpy.ops.screen.userpref_show()
"""


def take_in_blender(folder: Path) -> None:
    """Install the extension and look at what it shows."""
    machine = find(folder)
    window = Window(machine, 1200, 760)
    (path,) = package(folder, print, ["linux-x64"], [window.version()], ROOT)
    window.install(path)
    with window:
        _take_install(window)
        _take_first(window)
        _open(window, "mirror-ball")
        _take_viewport(window)
        _take_overlays(window)
        _take_passes(window)


def _take_install(window: Window) -> None:
    """The menu that installs from disk. Without a window manager the new window must be put in its place."""
    window.python(_PREFERENCES)
    window.settle(2.0)
    x, y = 200, 150
    window.xdotool("search", "--onlyvisible", "--name", ".", "windowmove", "%2", x, y, "sleep", 1)
    window.xdotool("mousemove", x + 856, y + 18, "sleep", 0.5, "click", 1, "sleep", 1)
    window.xdotool("mousemove", x + 750, y + 141, "sleep", 1)
    save(_screen(window)[y : y + 300, x : x + 875], "install.png")
    window.xdotool("key", "Escape", "mousemove", 2, window.size[1] - 2)  # where it shows no hints
    window.python(
        "with bpy.context.temp_override(window=bpy.context.window_manager.windows[-1]): bpy.ops.wm.window_close()"
    )


def _open(window: Window, scene: str) -> None:
    """Open a copy of a scene that ships, with the sidebar on our tab."""
    path = window.machine.share / f"{scene}.blend"
    shutil.copy(path_of(scene), path)
    window.python(f"bpy.ops.wm.open_mainfile(filepath={str(path)!r})")
    window.settle(1.0)
    _open_tab(window)


def _open_tab(window: Window) -> None:
    window.python("view3d()[1].spaces.active.show_region_ui = True")
    window.settle(1.0)
    window.python(_OPEN_TAB)
    window.settle(1.0)


def _take_first(window: Window) -> None:
    """What a fresh Blender shows, with the button to begin with."""
    _open_tab(window)
    save(_screen(window)[:560], "first.jpg")


def _take_viewport(window: Window) -> None:
    """The engine at work, and the panel with what it says of the reflector that is active."""
    window.python(_SHOW)
    window.python("bpy.ops.catoptric.select(name='Ball')")
    _wait(window)
    save(_screen(window), "viewport.jpg")


def _take_overlays(window: Window) -> None:
    """What the viewport shows instead of the picture."""
    window.python(_BARE)
    pictures = {}
    for identifier, label in OVERLAYS.items():
        window.python(f"bpy.context.scene.catoptric.overlay = {identifier!r}")
        _wait(window)
        pictures[label] = _camera_frame(window)
    window.python("bpy.context.scene.catoptric.overlay = 'PICTURE'")
    save(strip(pictures, columns=2), "overlays.jpg")


def _take_passes(window: Window) -> None:
    """What F12 gives the compositor."""
    path = window.machine.share / "passes.exr"
    window.python(_RENDER.format(path=str(path)), timeout=_PATIENCE_S)
    picture = oiio.ImageBuf(str(path))
    names = picture.spec().channelnames
    pixels = picture.get_pixels(oiio.FLOAT)

    def channels(name: str) -> np.ndarray:
        found = [number for number, channel in enumerate(names) if f".{name}." in channel][:3]
        chosen = {names[number].rpartition(".")[2]: pixels[..., number] for number in found}
        return np.dstack([chosen[letter] for letter in ("RGB" if "R" in chosen else "XXX")])

    distance = channels("Hit Distance")
    near = np.where((distance > 0.0) & (distance < 1e9), 1.0 / (1.0 + distance), 0.0)
    shown = {
        "Combined": channels("Combined"),
        "Reflection": channels("Reflection"),
        "Reflectors": channels("Reflectors"),
        "Hit Distance (near is bright)": near,
    }
    save(strip({label: to_bytes(one) for label, one in shown.items()}, columns=4), "passes.jpg")


def _camera_frame(window: Window) -> np.ndarray:
    """What the viewport shows of the camera's picture."""
    said = window.python(
        "from bpy_extras.view3d_utils import location_3d_to_region_2d as place\n"
        "window, area, regions = view3d()\n"
        "scene, region = window.scene, regions['WINDOW']\n"
        "frame = [scene.camera.matrix_world @ corner for corner in scene.camera.data.view_frame(scene=scene)]\n"
        "corners = [place(region, area.spaces.active.region_3d, corner) for corner in frame]\n"
        "print(*[region.x + corner.x for corner in corners], *[region.y + corner.y for corner in corners])"
    )
    numbers = [round(float(number)) for number in said.split()]
    x, y = numbers[:4], [window.size[1] - number for number in numbers[4:]]
    return _screen(window)[min(y) + 1 : max(y) - 1, min(x) + 1 : max(x) - 1]


def _wait(window: Window) -> None:
    """Until the viewport's picture is as good as it gets; a moment's rest may be that between two pictures."""
    window.settle(2.0)
    deadline, quiet = time.monotonic() + _PATIENCE_S, 0
    while quiet < 4 and time.monotonic() < deadline:
        quiet = 0 if int(window.python(_BUSY)) else quiet + 1
        time.sleep(0.5)


def _screen(window: Window) -> np.ndarray:
    return window.picture(window.machine.share / "screen.png")
