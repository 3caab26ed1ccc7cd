"""The panel in a real Blender window, pressed with the mouse."""

import time

from .window import MODULE

OPEN = """
window, area, regions = view3d()
area.spaces.active.show_region_ui = True
area.tag_redraw()
"""
TAB = """
window, area, regions = view3d()
regions["UI"].active_panel_category = "Catoptric"
area.tag_redraw()
"""
PLACE = "r = view3d()[2]['UI']; print(r.x + r.width / 2 - 20, r.y + r.height)"
STATE = "print(bpy.context.scene.render.engine, view3d()[1].spaces.active.shading.type)"
BIG_BUTTON, SECOND_BIG_BUTTON = 57, 121
"""Pixels below the sidebar's top, at a scale of 1: the first row; the one under three lines of text."""

MODULES = f"""
import importlib
stages, work = (importlib.import_module("{MODULE}.addon.interface." + name) for name in ("stages", "work"))
"""
REFLECTORS = (
    MODULES
    + """
stage = stages.known(bpy.context.scene, bpy.context.view_layer)
print(len(stage.found.reflectors) if stage and stage.found else "none")
"""
)
LONG_WORK = """
bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, location=(3.0, 0.0, 0.0))
bpy.context.scene.catoptric.methods.layered_depth_published.resolution = 2048
"""
BEGIN = """
window, area, regions = view3d()
with bpy.context.temp_override(window=window, area=area, region=regions["UI"]):
    bpy.ops.catoptric.bake("INVOKE_DEFAULT")
"""
CURRENT = MODULES + "print(work.current() is not None, work.last())"


def press(window, below_top):
    x, top = map(float, window.python(PLACE).split())
    window.click(x, top - below_top)


def until(window, code, said, seconds=60.0):
    """Wait for what Python prints in the window."""
    end = time.monotonic() + seconds
    while (now := window.python(code).strip()) != said:
        assert time.monotonic() < end, now
        time.sleep(0.5)


def test_two_clicks_lead_to_a_reflection(window, tmp_path):
    window.python(OPEN)
    window.settle(1.0)
    window.python(TAB)
    window.settle(1.0)
    assert window.python(STATE).split() == ["BLENDER_EEVEE", "SOLID"]
    press(window, BIG_BUTTON)
    until(window, STATE, "CATOPTRIC RENDERED")
    until(window, REFLECTORS, "0")
    window.settle(2.0)
    window.picture(tmp_path / "shown.png")
    press(window, SECOND_BIG_BUTTON)
    until(window, REFLECTORS, "1")


def test_esc_stops_a_bake(window):
    window.python(LONG_WORK)
    window.settle(3.0)
    window.python(BEGIN)
    assert window.python(CURRENT).startswith("True")
    x, y = map(float, window.python("r = view3d()[2]['WINDOW']; print(r.x + 200, r.y + 200)").split())
    window.xdotool("mousemove", round(x), round(window.size[1] - 1 - y), "sleep", 0.3, "key", "Escape")
    until(window, CURRENT, "False Baking layers: stopped")


def test_the_render_tab_shows_the_same(window):
    window.python(
        "areas = view3d()[0].screen.areas\n"
        "space = next(area for area in areas if area.type == 'PROPERTIES').spaces.active\n"
        "space.context = 'RENDER'"
    )
    window.settle(2.0)
    printed = window.last_words().lower()
    assert not any(word in printed for word in ("error", "traceback"))
