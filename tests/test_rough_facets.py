"""Rough flat mirrors in an even white world against Cycles: what lobes let out, facet after facet."""

from math import radians

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.reference import render_reference
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.glossy_planar import GlossyPlanar
from catoptric.addon.scene import Lighting
from catoptric.tests import blender_stage as stage

WIDTH, HEIGHT, BLOCK = 24, 32, 8
GOLD = (0.9, 0.5, 0.2)


def floor_of(kind: str, distribution: str, color, **inputs) -> bpy.types.Scene:
    """A floor that fills the picture, seen from steeply above at its lower edge to nearly along it at its upper one."""
    scene = stage.empty_scene()
    material = bpy.data.materials.new("floor")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(f"ShaderNodeBsdf{kind}"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    node.distribution = distribution
    node.inputs["Color" if kind == "Glossy" else "Base Color"].default_value = (*color, 1.0)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    stage.add_plane(scene, "floor", 2000, material)["catoptric_reflector"] = True
    stage.add_camera(scene, (0, 0, 2), (radians(48), 0, 0), lens=24, sensor_fit="VERTICAL", sensor_height=36)
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    background.inputs["Strength"].default_value = 1.0
    return scene


def in_blocks(picture: np.ndarray) -> np.ndarray:
    """(rows, columns, 3) means."""
    return picture.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def shown(scene: bpy.types.Scene, method=GlossyPlanar, **settings) -> np.ndarray:
    """What a method makes of the floor, in blocks."""
    drawn = method(settings)
    found = extract(scene)
    drawn.prepare(found, Lighting.DIRECT)
    try:
        return in_blocks(drawn.render(View(found.camera, WIDTH, HEIGHT, 4)).color)
    finally:
        drawn.release()


def truth(scene: bpy.types.Scene) -> np.ndarray:
    """What Cycles makes of it, in blocks."""
    return in_blocks(render_reference(scene, extract(scene), Lighting.DIRECT, WIDTH, HEIGHT, 400).color)


@pytest.mark.parametrize("roughness", [0.3, 0.5, 0.9])
def test_a_white_metal_gives_back_all_light(roughness):
    scene = floor_of("Glossy", "MULTI_GGX", (1.0, 1.0, 1.0), Roughness=roughness)
    np.testing.assert_allclose(shown(scene), 1.0, atol=0.015)


@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.8])
@pytest.mark.parametrize("distribution", ["MULTI_GGX", "GGX"])
@pytest.mark.parametrize(
    ("kind", "inputs"),
    [("Glossy", {}), ("Principled", {"Metallic": 1.0}), ("Principled", {})],
    ids=["glossy", "metal", "plastic"],
)
def test_rough_floors_are_as_bright_as_in_cycles(kind, inputs, distribution, roughness):
    scene = floor_of(kind, distribution, GOLD, Roughness=roughness, **inputs)
    np.testing.assert_allclose(shown(scene), truth(scene), atol=0.015)
