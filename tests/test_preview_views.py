"""The preview shows radiance as Blender does: by the view transform that the scene asks for."""

import dataclasses
import json
import zipfile

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.render_fingerprint import fingerprint
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.metrics import to_bytes
from catoptric.addon.parameters import resolve
from catoptric.addon.scene import Lighting
from catoptric.addon.scene.archive import load, save
from catoptric.batch.cli import main
from catoptric.batch.preview.display import Display, Sheet
from catoptric.batch.preview.launch import Wishes
from catoptric.batch.preview.session import Session
from catoptric.batch.preview.views import STANDARD, names

from .blender_stage import add_camera, empty_scene
from .preview_stage import stage

SIZE = (96, 64)


def radiance():
    """(H, W, 3) of nine stops below grey to five above it, grey to nearly pure."""
    random = np.random.default_rng(3)
    grey = 0.18 * np.exp2(random.uniform(-9.0, 5.0, (*SIZE[::-1], 1)))
    return np.float32(grey * random.uniform(0.05, 1.0, (*SIZE[::-1], 3)))


def shown(linear, exposure, view):
    """What the preview puts on a screen, (H, W, 3) uint8."""

    def work():
        canvas, sheet = Canvas(*SIZE), Sheet(*SIZE)
        try:
            pixels = np.dstack([linear, np.zeros_like(linear[..., :1])])[::-1]
            canvas.color.write(np.ascontiguousarray(pixels))
            Display().draw(sheet.target, SIZE, canvas, exposure=exposure, view=view)
            return sheet.read()
        finally:
            canvas.release()
            sheet.release()

    return call(work).astype(int)


def as_blender_saves(linear, exposure, view, path):
    """What Blender writes of the same radiance, (H, W, 3) uint8."""
    scene = empty_scene()
    scene.view_settings.view_transform, scene.view_settings.exposure = view, exposure
    scene.view_settings.look = "None"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.dither_intensity = 0.0
    image = bpy.data.images.new("radiance", *SIZE, float_buffer=True, is_data=False)
    image.pixels.foreach_set(np.dstack([linear, np.ones_like(linear[..., :1])])[::-1].ravel())
    image.save_render(str(path), scene=scene)
    return oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8)[..., :3].astype(int)


@pytest.mark.parametrize("exposure", [0.0, 1.5])
@pytest.mark.parametrize("view", ["AgX", "Filmic", "Khronos PBR Neutral", STANDARD])
def test_a_view_transform_is_blender_s(view, exposure, tmp_path):
    linear = radiance()
    expected = as_blender_saves(linear, exposure, view, tmp_path / "blender.png")
    difference = np.abs(shown(linear, exposure, view) - expected)
    assert difference.mean() < 0.4
    assert (difference <= 2).mean() > 0.99
    assert np.abs(expected - to_bytes(linear)).mean() > 5 or (view, exposure) == (STANDARD, 0.0)


def test_what_is_black_and_what_is_far_too_bright():
    for view in names():
        ends = np.zeros((*SIZE[::-1], 3), np.float32)
        ends[:, 40:] = 1e6
        seen = shown(ends, 0.0, view)
        assert seen[:, :39].max() <= 2
        assert seen[:, 41:].min() >= 250


def test_a_scene_knows_how_it_is_looked_at_and_old_files_are_plain(tmp_path):
    blender = empty_scene()
    add_camera(blender, (0, 0, 5), (0, 0, 0))
    plain = extract(blender)
    blender.view_settings.view_transform, blender.view_settings.exposure = "AgX", 0.75
    found = extract(blender)
    assert (found.view, found.exposure) == ("AgX", 0.75)
    assert fingerprint(blender, found) == fingerprint(blender, plain)  # what Cycles rendered stays good
    save(found, tmp_path / "new.catoptric")
    assert (load(tmp_path / "new.catoptric").view, load(tmp_path / "new.catoptric").exposure) == ("AgX", 0.75)
    with zipfile.ZipFile(tmp_path / "new.catoptric") as new, zipfile.ZipFile(tmp_path / "old.catoptric", "w") as old:
        for name in new.namelist():
            if name != "scene.json":
                old.writestr(name, new.read(name))
        description = json.loads(new.read("scene.json"))
        description["version"] = 1
        del description["scene"]["view"], description["scene"]["exposure"]
        old.writestr("scene.json", json.dumps(description))
    assert (load(tmp_path / "old.catoptric").view, load(tmp_path / "old.catoptric").exposure) == (STANDARD, 0.0)


def wishes(**given):
    values = {name: resolve(method.parameters, {}) for name, method in METHODS.items()}
    return Wishes("layered-depth", None, values, Lighting.UNLIT, **given)


def test_the_look_begins_as_the_scene_has_it():
    scene = dataclasses.replace(stage(), view="AgX", exposure=-0.5)
    assert (wishes().look(scene).view, wishes().look(scene).exposure) == ("AgX", -0.5)
    assert wishes(view="Filmic").look(scene).view == "Filmic"
    assert wishes().look(dataclasses.replace(scene, view="Of a later Blender")).view == STANDARD


def test_c_goes_through_all_view_transforms(tmp_path):
    made = Session(stage(), wishes().look(stage()), wishes().settings, tmp_path / "stage")
    seen = [made.look.view]
    for _ in names():
        made.press("c")
        seen.append(made.look.view)
    assert seen == [*names(), STANDARD]
    assert "AgX" in names()


def test_a_view_that_there_is_not_is_named(capsys):
    assert main(["preview", "mirror-ball", "--view", "Technicolor"]) == 2
    assert "AgX" in capsys.readouterr().err
