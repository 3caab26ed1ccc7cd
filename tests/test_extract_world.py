"""The world lies where `World` says: held against Cycles looking in known directions."""

import bpy
import mathutils
import numpy as np
import pytest
from catoptric.addon.blender import world as module
from catoptric.addon.blender.extract import extract
from catoptric.tests import blender_stage as stage
from catoptric.tests import extract_stage as plain


@pytest.fixture
def scene():
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 5), (0, 0, 0))
    return scene


def background(scene):
    return scene.world.node_tree, scene.world.node_tree.nodes["Background"]


def with_environment(scene, image, strength=1.0):
    tree, node = background(scene)
    environment = tree.nodes.new("ShaderNodeTexEnvironment")
    environment.image = image
    tree.links.new(environment.outputs["Color"], node.inputs["Color"])
    node.inputs["Strength"].default_value = strength
    return environment


def test_no_world_is_black(scene):
    scene.world = None
    world = extract(scene).world
    assert world.color == (0.0, 0.0, 0.0)
    assert world.panorama is None


def test_a_constant_colour(scene):
    _, node = background(scene)
    node.inputs["Strength"].default_value = 2.0
    world = extract(scene).world
    assert world.color == pytest.approx((0.2, 0.4, 0.6))
    assert world.panorama is None


def test_an_environment_image_is_read_as_it_is(scene):
    image = plain.noise_image("Sky", 16, 8, is_float=True)
    with_environment(scene, image, 2.5)
    pixels = np.array(image.pixels[:], np.float32).reshape(8, 16, 4)
    panorama = extract(scene).world.panorama
    assert panorama.dtype == np.float32
    np.testing.assert_allclose(panorama, pixels[..., :3] * 2.5, rtol=1e-6)


def test_rendering_the_same_image_gives_the_same_texels(scene):
    with_environment(scene, plain.noise_image("Sky", 64, 32, is_float=True))
    read = extract(scene).world.panorama
    rendered = module.render_panorama(scene.world, 1, 64)
    # Cycles' sample may lie a 200th of a texel beside the middle.
    np.testing.assert_allclose(rendered, read, atol=0.01)


def test_a_mapped_environment_is_rendered_at_its_own_size(scene):
    image = plain.noise_image("Sky", 64, 32, is_float=True)
    environment = with_environment(scene, image)
    straight = extract(scene).world.panorama
    tree, _ = background(scene)
    mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value[2] = np.pi / 2
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], environment.inputs["Vector"])
    turned = extract(scene).world.panorama
    assert turned.shape == straight.shape
    # A quarter turn about Z is a quarter of the picture's width.
    errors = [np.abs(np.roll(straight, 16 * side, axis=1) - turned).mean() for side in (-1, 0, 1, 2)]
    assert min(errors[0], errors[2]) < 0.01
    assert errors[1] > 0.1


def look(panorama, direction):
    """The texel of a panorama in a direction, by the mapping that `World` documents."""
    x, y, z = direction
    height, width = panorama.shape[:2]
    u, v = 0.5 - np.arctan2(y, x) / (2 * np.pi), 0.5 + np.arctan2(z, np.hypot(x, y)) / np.pi
    return panorama[min(int(v * height), height - 1), int(u * width) % width]


def test_a_gradient_lies_where_a_camera_sees_it(scene, tmp_path):
    tree, node = background(scene)
    coordinates, lifted = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    lifted.operation = "MULTIPLY_ADD"
    lifted.inputs[1].default_value = lifted.inputs[2].default_value = (0.5, 0.5, 0.5)
    tree.links.new(coordinates.outputs["Generated"], lifted.inputs[0])
    tree.links.new(lifted.outputs[0], node.inputs["Color"])
    panorama = extract(scene).world.panorama
    assert panorama.shape == (1024, 2048, 3)
    scene.camera.data.lens = 3000.0
    scene.render.resolution_x = scene.render.resolution_y = plain.SIDE
    for direction in ((1, 0, 0), (0, 1, 0), (-0.6, 0.2, 0.5), (0.3, -0.8, -0.4), (0, 0, 1), (0.1, 0, -1)):
        scene.camera.rotation_euler = mathutils.Vector(direction).to_track_quat("-Z", "Y").to_euler()
        seen = plain.cycles_picture(scene, tmp_path).mean(axis=(0, 1))
        np.testing.assert_allclose(look(panorama, direction), seen, atol=0.004)
        np.testing.assert_allclose(seen, np.array(direction) / np.linalg.norm(direction) / 2 + 0.5, atol=0.004)


def test_a_sky_is_rendered(scene):
    tree, node = background(scene)
    sky = tree.nodes.new("ShaderNodeTexSky")
    tree.links.new(sky.outputs["Color"], node.inputs["Color"])
    panorama = extract(scene).world.panorama
    assert np.isfinite(panorama).all()
    assert panorama[600:].mean() > 0.0


def test_a_missing_environment_is_magenta(scene):
    image = bpy.data.images.new("Gone", 4, 2)
    image.source, image.filepath = "FILE", "/nowhere/gone.exr"
    with_environment(scene, image, 0.5)
    found = extract(scene)
    assert found.world.color == (0.5, 0.0, 0.5)
    assert len(found.warnings) == 1


def test_a_light_path_is_named(scene):
    tree, node = background(scene)
    path = tree.nodes.new("ShaderNodeLightPath")
    tree.links.new(path.outputs["Is Camera Ray"], node.inputs["Strength"])
    found = extract(scene)
    assert any("Light Path" in line for line in found.warnings)
    np.testing.assert_allclose(found.world.panorama, np.broadcast_to(stage.WORLD, (1024, 2048, 3)), rtol=1e-5)
