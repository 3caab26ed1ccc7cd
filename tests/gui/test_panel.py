"""The panel in a real Blender window, pressed with the mouse."""

from . import steps

STATE = "print(bpy.context.scene.render.engine, view3d()[1].spaces.active.shading.type)"
LONG_WORK = """
bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, location=(3.0, 0.0, 0.0))
bpy.context.scene.catoptric.methods.layered_depth_published.resolution = 2048
"""
FOUND = "probe.stage() is not None and probe.stage().found is not None and len(probe.stage().found.reflectors) == {}"


def test_two_clicks_lead_to_a_reflection(window, tmp_path):
    steps.open_tab(window)
    assert window.python(STATE).split() == ["BLENDER_EEVEE", "SOLID"]
    steps.press(window, steps.FIRST_BUTTON)
    window.until(FOUND.format(0))
    assert window.python(STATE).split() == ["CATOPTRIC", "RENDERED"]
    window.settle(2.0)
    window.picture(tmp_path / "shown.png")
    steps.press(window, steps.BUTTON_BELOW_TEXT)
    window.until(FOUND.format(1))


def test_esc_stops_a_bake(window):
    window.python(LONG_WORK)
    window.settle(3.0)
    steps.begin_baking(window)
    steps.key_over_view(window, "Escape")
    window.until(f"not {steps.UNDER_WAY}")
    assert window.python("print(probe.ours('work').last())").strip() == "Baking layers: stopped"


def test_the_render_tab_shows_the_same(window):
    window.python(
        "areas = view3d()[0].screen.areas\n"
        "space = next(area for area in areas if area.type == 'PROPERTIES').spaces.active\n"
        "space.context = 'RENDER'"
    )
    window.settle(2.0)
    assert steps.complaints(window) == []
