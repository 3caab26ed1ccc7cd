"""What the viewport's corner says of a frame."""

import bpy
from catoptric.addon.interface import hud
from catoptric.addon.interface.overlays import DEVELOPS
from catoptric.addon.interface.viewport import Viewport
from catoptric.addon.methods.contract import View

from .interface_stage import found, registered, small_scene, until


def told(stage, show_times=True, scale=1):
    """The lines from the top down, once a picture has been drawn."""
    viewer = Viewport()
    viewer.scale, viewer.copy_ms = scale, 1.25
    stage.studio.look(viewer, View(stage.shown.camera, 48, 32, 1), DEVELOPS["PICTURE"])
    until(lambda: stage.studio.picture(viewer))
    return hud.lines(stage, viewer, show_times)[::-1]


def names(lines):
    return [line.rsplit(" ", 2)[0] for line in lines]


def test_each_stage_and_the_copy_are_told():
    with registered():
        small_scene().catoptric.method = "environment-map"
        lines = told(found())
        assert names(lines) == ["visibility", "light", "reflection", "frame", "copy"]
        assert lines[-1] == "copy 1.2 ms"
        assert told(found(), show_times=False) == []


def test_times_of_a_coarse_picture_are_told_as_such():
    with registered():
        small_scene().catoptric.method = "environment-map"
        assert told(found(), scale=2)[-1] == "at 1/2 of the resolution"
        assert told(found(), show_times=False, scale=2) == []


def test_several_methods_stand_below_their_sum():
    with registered():
        scene = small_scene()
        scene.catoptric.method = "environment-map"
        scene.objects["Crate"].data.materials[0] = bpy.data.materials["Chrome"]
        scene.objects["Crate"].catoptric.method = "layered-depth"
        bpy.context.view_layer.update()
        lines = names(told(found()))
        assert lines[2:] == ["reflection", "    environment-map", "    layered-depth", "frame", "copy"]
