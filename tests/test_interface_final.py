"""F12: what Blender's own render gives, pass by pass."""

import bpy
import catoptric
import numpy as np
import OpenImageIO as oiio
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.scene import Lighting
from catoptric.scenes import path_of

SIZE = (72, 48)


@pytest.fixture
def scene():
    """The stage with the add-on in it; a RenderEngine left registered hangs Blender 4.5 as a module at exit."""
    opened = open_blend(path_of("mirror-ball"))
    catoptric.register()
    opened.render.engine = "CATOPTRIC"
    opened.render.resolution_x, opened.render.resolution_y = SIZE
    opened.render.resolution_percentage = 100
    opened.catoptric.lighting = "unlit"
    opened.catoptric.method = "layered-depth"
    opened.catoptric.samples = "2"
    yield opened
    catoptric.unregister()


def rendered(scene, path):
    """Every pass by name, (H, W, channels), row 0 the top."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True, scene=scene.name)
    buffer = oiio.ImageBuf(str(path))
    pixels, passes = buffer.get_pixels(oiio.FLOAT), {}
    for channel, name in enumerate(buffer.spec().channelnames):
        passes.setdefault(name.split(".")[1], []).append(pixels[..., channel])
    return {name: np.dstack(channels) for name, channels in passes.items()}


def test_f12_shows_what_the_command_line_does(scene, tmp_path):
    passes = rendered(scene, tmp_path / "a.exr")
    found = extract(scene)
    method = LayeredDepth()
    method.prepare(found, Lighting.UNLIT)
    frame = method.render(View(found.camera, *SIZE, 2))
    method.release()
    np.testing.assert_allclose(passes["Combined"][..., :3], frame.color, atol=1e-5)
    np.testing.assert_allclose(passes["Reflectors"][..., 0], frame.reflectors, atol=1e-5)
    hits = np.isfinite(frame.distance)
    np.testing.assert_allclose(passes["Hit Distance"][hits, 0], frame.distance[hits], rtol=1e-5)


def test_the_passes_belong_together(scene, tmp_path):
    passes = rendered(scene, tmp_path / "a.exr")
    number, share = passes["Reflector ID"][..., 0], passes["Reflectors"][..., 0]
    assert set(np.unique(number)) == set(range(len(extract(scene).reflectors) + 1))
    assert (number[share == 1.0] > 0).all()
    assert (number[share == 0.0] == 0).all()
    assert (passes["Reflection"][share == 0.0] == 0.0).all()
    assert passes["Reflection"][share == 1.0].mean() > 0.05
    rest = passes["Combined"][..., :3] - passes["Reflection"]
    assert rest.min() > -1e-5


def test_lamps_stand_in_for_light_that_is_not_baked(scene, tmp_path):
    scene.catoptric.lighting = "direct"
    by_lamps = rendered(scene, tmp_path / "a.exr")["Combined"]
    scene.catoptric.lighting = "cycles"
    np.testing.assert_array_equal(rendered(scene, tmp_path / "b.exr")["Combined"], by_lamps)


def test_a_scene_without_a_camera_says_so(scene, capfd):
    scene.camera = None
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render(scene=scene.name)
