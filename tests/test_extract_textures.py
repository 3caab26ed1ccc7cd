"""Textures and colour attributes: the extracted arrays show what Cycles shows, texel by texel."""

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.scene import Extension, Interpolation
from catoptric.tests import blender_stage as stage
from catoptric.tests import extract_stage as plain
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st


def assert_as_cycles(scene, folder, warnings=()):
    """Compare both pictures; returns the extracted Scene."""
    found = extract(scene)
    assert found.warnings == tuple(warnings)
    expected = plain.cycles_picture(scene, folder)
    np.testing.assert_allclose(plain.scene_picture(found), expected, atol=2e-3, rtol=2e-3)
    assert np.ptp(expected, axis=(0, 1)).max() > 0.1
    return found


@pytest.fixture
def stage_and_texture():
    """A plane with a texture: scene, object, Image Texture node."""
    scene, shaped = plain.plane_scene()
    material, node = plain.textured(image=plain.noise_image())
    shaped.data.materials.append(material)
    return scene, shaped, node


@pytest.mark.parametrize("alpha_mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize("is_float", [False, True])
def test_an_image_with_alpha(stage_and_texture, tmp_path, alpha_mode, is_float):
    scene, _, node = stage_and_texture
    node.image = plain.noise_image("Veil", alpha=True, is_float=is_float)
    node.image.alpha_mode = alpha_mode
    found = assert_as_cycles(scene, tmp_path)
    assert found.images[0].pixels.dtype == (np.float32 if is_float else np.uint8)
    assert found.images[0].srgb == (not is_float)


def test_data_that_is_no_colour(stage_and_texture, tmp_path):
    scene, _, node = stage_and_texture
    node.image.colorspace_settings.name = "Non-Color"
    pixels = np.random.default_rng(1).random(5 * 7 * 4, dtype=np.float32)
    pixels[3::4] = 1.0
    node.image.pixels.foreach_set(pixels)
    assert not assert_as_cycles(scene, tmp_path).images[0].srgb


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND", "CLIP", "MIRROR"])
def test_beyond_the_image(stage_and_texture, tmp_path, extension):
    scene, shaped, node = stage_and_texture
    node.extension = extension
    shaped.data.uv_layers[0].uv.foreach_set("vector", np.array([-1.3, -0.8, 2.1, -0.8, 2.1, 1.9, -1.3, 1.9], "f"))
    assert assert_as_cycles(scene, tmp_path).materials[0].emission.extension is Extension[extension]


@pytest.mark.parametrize("name", ["Closest", "Linear", "Cubic", "Smart"])
def test_interpolation(stage_and_texture, name):
    scene, _, node = stage_and_texture
    node.interpolation = name
    expected = Interpolation.CLOSEST if name == "Closest" else Interpolation.LINEAR
    assert extract(scene).materials[0].emission.interpolation is expected


numbers = st.floats(-2, 2).map(lambda x: round(x, 3))
vectors = st.tuples(numbers, numbers, numbers)


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    kind=st.sampled_from(["POINT", "TEXTURE", "VECTOR"]),
    output=st.sampled_from(["UV", "Generated", "Object"]),
    location=vectors,
    rotation=vectors,
    scale=vectors,
)
@example(kind="POINT", output="UV", location=(0.2, 0.5, 0.0), rotation=(0.3, 0.0, 0.0), scale=(0.0, 0.0, 0.0))
@example(kind="POINT", output="UV", location=(0.2, 0.5, 0.0), rotation=(0.3, 0.0, 0.0), scale=(0.0, 0.0, 1.0))
@example(kind="VECTOR", output="UV", location=(0.2, 0.5, 0.0), rotation=(0.3, 0.0, 0.0), scale=(0.0, 0.0, 0.0))
@example(kind="TEXTURE", output="UV", location=(0.2, 0.5, 0.0), rotation=(0.3, 0.0, 0.0), scale=(0.0, 0.0, 0.0))
def test_mapped_coordinates(tmp_path_factory, kind, output, location, rotation, scale):
    scene, shaped = plain.plane_scene()
    material, node = plain.textured(image=plain.noise_image(width=3, height=2))
    shaped.data.materials.append(material)
    shaped.location.x = 0.1
    tree = material.node_tree
    mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.vector_type = kind
    for name, value in (("Location", location), ("Rotation", rotation), ("Scale", scale)):
        if name in mapping.inputs and mapping.inputs[name].enabled:
            mapping.inputs[name].default_value = value
    tree.links.new(coordinates.outputs[output], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    found = extract(scene)
    assert not found.warnings
    # Cycles shows the coordinates themselves, moved to where they are positive.
    lifted = tree.nodes.new("ShaderNodeVectorMath")
    lifted.inputs[1].default_value = (100.0, 100.0, 100.0)
    tree.links.new(mapping.outputs[0], lifted.inputs[0])
    tree.links.new(lifted.outputs[0], tree.nodes["Emission"].inputs["Color"])
    shown = plain.cycles_picture(scene, tmp_path_factory.mktemp("mapped"))[..., :2] - 100.0
    expected = plain.uv_picture(found)
    # Cycles' one sample may lie half a filter's width beside the middle, where steep coordinates are others.
    steepness = sum(map(np.abs, np.gradient(expected, axis=(0, 1))))
    off = np.abs(expected - shown)
    assert (off <= 2e-3 + 0.5 * plain.FILTER_WIDTH * steepness)[:, 1:].all()


def test_another_objects_space(stage_and_texture, tmp_path):
    scene, shaped, node = stage_and_texture
    other = bpy.data.objects.new("Other", None)
    other.location, other.rotation_euler, other.scale = (0.3, -0.2, 0.5), (0.2, 0.1, 0.7), (0.7, 0.8, 0.9)
    scene.collection.objects.link(other)
    tree = shaped.data.materials[0].node_tree
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    coordinates.object = other
    tree.links.new(coordinates.outputs["Object"], node.inputs["Vector"])
    assert_as_cycles(scene, tmp_path)


@pytest.mark.parametrize("via", ["UVMap", "Attribute", "active"])
def test_the_uv_map_that_the_material_names(stage_and_texture, tmp_path, via):
    scene, shaped, node = stage_and_texture
    second = shaped.data.uv_layers.new(name="Second")
    second.uv.foreach_set("vector", np.array([0.9, 0, 0.9, 0.7, 0.1, 0.7, 0.1, 0], "f"))
    tree = shaped.data.materials[0].node_tree
    if via == "active":
        second.active_render = True
    elif via == "UVMap":
        named = tree.nodes.new("ShaderNodeUVMap")
        named.uv_map = "Second"
        tree.links.new(named.outputs["UV"], node.inputs["Vector"])
    else:
        named = tree.nodes.new("ShaderNodeAttribute")
        named.attribute_name = "Second"
        tree.links.new(named.outputs["Vector"], node.inputs["Vector"])
    found = assert_as_cycles(scene, tmp_path)
    assert found.meshes[0].uvs.max() == pytest.approx(0.9)


def test_two_materials_look_up_their_own_maps(tmp_path):
    scene, _ = plain.plane_scene()
    bpy.data.objects.remove(bpy.data.objects["Plane"])
    corners = [(-1, -1, 0), (0, -1, 0), (1, -1, 0), (1, 1, 0), (0, 1, 0), (-1, 1, 0)]
    shaped = stage.add_mesh(scene, "Two", corners, [(0, 1, 4, 5), (1, 2, 3, 4)])
    shaped.data.uv_layers[0].uv.foreach_set("vector", np.random.default_rng(3).random(16).astype("f"))
    for number, name in enumerate(("First", "Second")):
        material, node = plain.textured(name, plain.noise_image(name, seed=number))
        shaped.data.materials.append(material)
        if number:
            coordinates = material.node_tree.nodes.new("ShaderNodeTexCoord")
            material.node_tree.links.new(coordinates.outputs["Generated"], node.inputs["Vector"])
    shaped.data.polygons.foreach_set("material_index", [0, 1])
    assert_as_cycles(scene, tmp_path)


@pytest.mark.parametrize("kind", ["none", "file", "generated"])
def test_a_missing_image_is_magenta(stage_and_texture, tmp_path, kind):
    scene, _, node = stage_and_texture
    if kind == "none":
        node.image = None
    elif kind == "file":
        node.image = bpy.data.images.new("Gone", 4, 4)
        node.image.source, node.image.filepath = "FILE", "//gone.png"
    else:
        node.image.source, node.image.filepath = "FILE", "/nowhere/gone.png"
        node.image.reload()
    found = extract(scene)
    assert len(found.warnings) == 1
    assert "magenta" in found.warnings[0]
    np.testing.assert_allclose(plain.scene_picture(found), np.broadcast_to((1.0, 0.0, 1.0), (12, 12, 3)))
    np.testing.assert_allclose(plain.cycles_picture(scene, tmp_path), plain.scene_picture(found))


def test_images_on_disk_and_packed_are_alike(stage_and_texture, tmp_path):
    scene, _, node = stage_and_texture
    made = node.image
    made.filepath_raw, made.file_format = str(tmp_path / "noise.png"), "PNG"
    made.save()
    generated = extract(scene).images[0].pixels
    node.image = bpy.data.images.load(str(tmp_path / "noise.png"))
    loaded = node.image.has_data
    np.testing.assert_array_equal(extract(scene).images[0].pixels, generated)
    assert node.image.has_data == loaded, "an image that was not loaded is not kept loaded"
    node.image.pack()
    (tmp_path / "noise.png").unlink()
    np.testing.assert_array_equal(extract(scene).images[0].pixels, generated)


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize("kind", ["FLOAT_COLOR", "BYTE_COLOR"])
@pytest.mark.parametrize("reader", ["ShaderNodeVertexColor", "ShaderNodeAttribute", "active"])
def test_color_attributes(tmp_path, domain, kind, reader):
    scene, shaped = plain.plane_scene()
    material, emission = plain.emissive()
    shaped.data.materials.append(material)
    colors = shaped.data.color_attributes.new("Tint", kind, domain)
    colors.data.foreach_set("color", np.random.default_rng(5).random(16).astype("f"))
    node = material.node_tree.nodes.new("ShaderNodeVertexColor" if reader == "active" else reader)
    if reader == "ShaderNodeAttribute":
        node.attribute_name = "Tint"
    elif reader != "active":
        node.layer_name = "Tint"
    material.node_tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    assert_as_cycles(scene, tmp_path)


def test_an_attribute_that_is_not_there_is_black(tmp_path):
    scene, shaped = plain.plane_scene()
    material, emission = plain.emissive()
    shaped.data.materials.append(material)
    node = material.node_tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "Gone"
    material.node_tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    assert not plain.scene_picture(extract(scene)).any()
    assert not plain.cycles_picture(scene, tmp_path).any()


def test_a_tinted_texture_is_a_product(stage_and_texture, tmp_path):
    scene, shaped, node = stage_and_texture
    colors = shaped.data.color_attributes.new("Tint", "FLOAT_COLOR", "POINT")
    colors.data.foreach_set("color", np.random.default_rng(5).random(16).astype("f"))
    tree = shaped.data.materials[0].node_tree
    attribute = tree.nodes.new("ShaderNodeVertexColor")
    first, second = (tree.nodes.new("ShaderNodeMix") for _ in range(2))
    for mix in (first, second):
        mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
    first.inputs["Factor"].default_value, second.inputs["Factor"].default_value = 0.5, 1.0
    identified = {mix: {socket.identifier: socket for socket in mix.inputs} for mix in (first, second)}
    tree.links.new(node.outputs["Color"], identified[first]["A_Color"])
    identified[first]["B_Color"].default_value = (0.2, 0.4, 0.9, 1.0)
    tree.links.new(first.outputs[2], identified[second]["A_Color"])
    tree.links.new(attribute.outputs["Color"], identified[second]["B_Color"])
    tree.links.new(second.outputs[2], tree.nodes["Emission"].inputs["Color"])
    assert_as_cycles(scene, tmp_path)
