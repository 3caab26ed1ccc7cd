"""The extension in a real Blender window: it gets in, does its work beside Blender's own drawing, and goes."""

import numpy as np
import pytest

from .window import MODULE

DRAW = f"""
import importlib
gl = importlib.import_module("{MODULE}.addon.gl")

def draw():
    context = gl.require()
    context.wireframe = True  # Blender never asks for it nor takes it back: in its context, all would be lines
    target = context.simple_framebuffer((64, 64), components=4)
    target.use()
    context.clear(1.0, 0.5, 0.0)
    return target.read(components=3)[:3], context.info["GL_RENDERER"]

print(*gl.call(draw))
"""


def test_the_zip_is_installed_and_enabled(window):
    said = window.python(f"print({MODULE!r} in bpy.context.preferences.addons, bpy.app.background)")
    assert said.split() == ["True", "False"]


REDRAW = "for area in bpy.context.window_manager.windows[0].screen.areas: area.tag_redraw()"


def test_our_context_leaves_blender_s_picture_alone(window, tmp_path):
    window.python("bpy.context.preferences.system.viewport_aa = 'OFF'\n" + REDRAW)  # smoothing goes on for a while
    window.settle(1.0)
    before = window.picture(tmp_path / "before.png")
    assert before.shape == (window.size[1], window.size[0], 3)
    assert len(np.unique(before.reshape(-1, 3), axis=0)) > 100  # a whole interface, not a black screen
    assert "b'\\xff\\x80\\x00'" in window.python(DRAW)
    window.python(REDRAW)
    window.settle(1.0)
    assert np.array_equal(window.picture(tmp_path / "after.png"), before)


def test_keys_and_mouse_arrive(window):
    window.python("window, area, regions = view3d(); area.spaces.active.show_region_ui = False")
    x, y = map(float, window.python("r = view3d()[2]['WINDOW']; print(r.x + r.width / 2, r.y + r.height / 2)").split())
    window.click(x, y)
    window.xdotool("key", "n")
    window.until("view3d()[1].spaces.active.show_region_ui", 20.0)


def test_what_fails_inside_is_told_outside(window):
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        window.python("1 / 0")


def test_it_goes_without_a_trace_and_blender_printed_no_complaint(window):
    window.python(f"bpy.ops.preferences.addon_disable(module={MODULE!r})")
    window.python(
        "names = [repo.module for repo in bpy.context.preferences.extensions.repos]\n"
        "bpy.ops.extensions.package_uninstall(repo_index=names.index('user_default'), pkg_id='catoptric')",
    )
    window.settle(2.0)
    left = [path for path in (window.home / "extensions").rglob("*") if path.is_file()]
    own = [path for path in left if path.name != "compat.dat" and ".blender_ext" not in path.parts]
    assert own == []
    printed = window.last_words().lower()
    assert not any(word in printed for word in ("error", "warning", "traceback"))
