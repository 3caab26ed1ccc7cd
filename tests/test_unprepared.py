"""Scenes that nobody prepared, by every shipped method and Cycles: the whole way from Blender to figures."""

import math
from pathlib import Path

import bpy
import mathutils
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.blender.reference import render_reference
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.metrics import error_maps
from catoptric.addon.scene import Lighting

from .blender_stage import empty_scene

SIZE = (288, 192)


def material(name, color, metallic=0.0, roughness=0.5):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    inputs = made.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1.0)
    inputs["Metallic"].default_value, inputs["Roughness"].default_value = metallic, roughness
    return made


def dressed(worn):
    """The object that an operator just added, in a material."""
    added = bpy.context.object
    added.data.materials.clear()
    added.data.materials.append(worn)
    return added


def add_what_people_model(scene):
    """Text, a wireframe, an array, a curve, a mirrored instance, and two mirrors that face each other."""
    chrome = material("chrome", (0.95, 0.93, 0.9), 1.0, 0.0)
    colors = {"grey": (0.5, 0.5, 0.5), "red": (0.8, 0.1, 0.05), "green": (0.1, 0.6, 0.2), "blue": (0.1, 0.2, 0.8)}
    worn = {name: material(name, color) for name, color in colors.items()}
    bpy.ops.mesh.primitive_plane_add(size=12)
    dressed(worn["grey"])
    for x in (-2.2, 2.2):
        bpy.ops.mesh.primitive_plane_add(size=1, location=(x, 0.6, 1.2), rotation=(0, math.pi / 2, 0))
        dressed(chrome).scale = (2.2, 3.2, 1)
    bpy.ops.object.text_add(location=(-1.2, 0.8, 0.3), rotation=(math.pi / 2, 0, 0.2))
    text = dressed(worn["red"])
    text.data.body, text.data.extrude, text.data.bevel_depth = "Hello", 0.06, 0.01
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(0.3, 0.0, 0.6))
    dressed(worn["blue"]).modifiers.new("wires", "WIREFRAME").thickness = 0.02
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(-1.6, -0.6, 0.12))
    array = dressed(worn["green"]).modifiers.new("row", "ARRAY")
    array.count, array.relative_offset_displace = 7, (1.6, 0.2, 0.4)
    bpy.ops.mesh.primitive_monkey_add(size=0.7, location=(1.2, 0.9, 0.6), rotation=(0, 0, 0.6))
    mirrored = bpy.data.objects.new("mirrored", dressed(worn["red"]).data)
    mirrored.location, mirrored.scale, mirrored.rotation_euler = (1.2, -0.3, 0.5), (-1, 1, 1), (0, 0, -0.5)
    scene.collection.objects.link(mirrored)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.35, location=(-0.5, -0.7, 0.4), segments=48, ring_count=24)
    dressed(chrome)
    bpy.ops.object.shade_smooth()
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.5, location=(-0.4, 0.2, 1.6), rotation=(0.7, 0.3, 0))
    dressed(worn["green"]).data.bevel_depth = 0.03


def add_camera(scene, location, target, lens):
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.data.lens = location, lens
    towards = mathutils.Vector(target) - camera.location
    camera.rotation_euler = towards.to_track_quat("-Z", "Y").to_euler()
    scene.camera = camera


def flip_of(bpy_scene, method, size=SIZE, side=4, samples=64):
    """FLIP over the reflector pixels in `unlit`, and how many there are; `side` squared samples a pixel are ours."""
    scene = extract(bpy_scene)
    drawn = METHODS[method]()
    drawn.prepare(scene, Lighting.UNLIT)
    try:
        frame = drawn.render(View(scene.camera, *size, side))
    finally:
        drawn.release()
    truth = render_reference(bpy_scene, scene, Lighting.UNLIT, *size, samples=samples).color
    mask = frame.reflectors >= 0.5
    return error_maps(frame.color, truth).over(mask).flip, int(mask.sum())


def test_what_people_model_is_reflected_as_cycles_does():
    scene = empty_scene()
    add_what_people_model(scene)
    add_camera(scene, (-1.4, -4.2, 1.9), (0.5, 0.6, 0.9), 28)
    flip, pixels = flip_of(scene, "layered-depth")
    assert pixels > 5000
    assert flip <= 0.02
    worse, _ = flip_of(scene, "environment-map")
    assert flip <= worse / 5


@pytest.mark.parametrize("model", ["horse.obj", "buddha.obj", "armadillo.obj", "bunny.obj"])
@pytest.mark.slow
def test_scanned_meshes_are_reflected_as_cycles_does(shared, model):
    scene = empty_scene()
    bpy.ops.wm.obj_import(filepath=str(shared / "models" / model))
    scanned = dressed(material("clay", (0.7, 0.4, 0.2)))
    size = max(scanned.dimensions)
    scanned.scale = [2 / size] * 3
    bpy.context.view_layer.update()
    corners = np.array([scanned.matrix_world @ mathutils.Vector(corner) for corner in scanned.bound_box])
    scanned.location -= mathutils.Vector((corners.min(0) + corners.max(0)) / 2) - mathutils.Vector((1.9, -0.3, 0))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=128, ring_count=64)
    dressed(material("chrome", (1, 1, 1), 1.0, 0.0))
    bpy.ops.object.shade_smooth()
    add_camera(scene, (0, -5, 1), (0, 0, 0), 55)
    flip, pixels = flip_of(scene, "layered-depth")
    assert pixels > 5000
    assert flip <= 0.02


@pytest.mark.slow
def test_a_room_that_nobody_here_modelled(shared):
    room: Path = shared / "scenes" / "living-room.blend"
    if not room.is_file():
        pytest.skip("no living-room.blend here")
    # Its candlesticks mirror a window a hundred times as bright as the wall: few samples would miss it.
    flip, pixels = flip_of(open_blend(room), "layered-depth", (768, 512), side=8, samples=256)
    assert pixels > 5000
    assert flip <= 0.04
