"""The Cycles reference: right where the answer is known, repeatable, and gone without a trace."""

from dataclasses import replace
from math import radians

import bpy
import numpy as np
import pytest
from catoptric.addon.blender import reference as module
from catoptric.addon.blender.eevee import render_eevee
from catoptric.addon.blender.reference import render_reference
from catoptric.addon.cache import Cache
from catoptric.addon.errors import SceneError, UsageError
from catoptric.addon.metrics import Enough, noise_maps
from catoptric.addon.progress import silent
from catoptric.addon.scene import BLACK, ColorSource, Fresnel, Image, Lighting, Material
from catoptric.tests import blender_stage as stage

RED, GREY = (0.8, 0.1, 0.05), (0.4, 0.5, 0.6)


@pytest.fixture
def mirror_stage():
    """A mirror ball and a box on a floor, a lamp beside them."""
    scene = stage.empty_scene()
    mirror = stage.principled("mirror", (0.9, 0.8, 0.7), Metallic=1.0, Roughness=0.05)
    stage.add_plane(scene, "floor", 40, stage.principled("grey", GREY))
    stage.add_box(scene, "box", 1, stage.principled("red", RED), (1.5, 0, 0.5))
    stage.add_sphere(scene, "ball", 1, mirror, (-0.7, 0, 1))
    stage.add_lamp(scene, "lamp", "POINT", 300, (0, -3, 3), size=0.4)
    stage.add_camera(scene, (0, -7, 2), (radians(80), 0, 0))
    materials = {
        "grey": stage.matte("grey", GREY),
        "red": stage.matte("red", RED),
        "mirror": stage.chrome("mirror", (0.9, 0.8, 0.7)),
    }
    return scene, materials


def looking_down(scene, height=3.0):
    return stage.add_camera(scene, (0, 0, height), (0, 0, 0))


def test_unlit_shows_base_colour_and_world_exactly(mirror_stage):
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"})
    picture = render_reference(scene, extracted, Lighting.UNLIT, 48, 32, 4)
    assert picture.color.shape == (32, 48, 3)
    assert picture.color.dtype == np.float32
    np.testing.assert_allclose(picture.color[1, 1], stage.WORLD, rtol=1e-5)
    np.testing.assert_allclose(picture.color[-1, 24], GREY, rtol=1e-5)
    box = np.abs(picture.color - RED).max(axis=-1) < 1e-5
    assert 30 < box.sum() < 300


def sphere_mirror(picture_size, camera, radius, tint, floor_below, floor, world):
    """What a mirror sphere at the origin shows an orthographic camera straight above, floor far below."""
    size = picture_size
    steps = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(steps * camera, -steps * camera)
    inside = x**2 + y**2 < (0.9 * radius) ** 2
    cosine = np.sqrt(np.maximum(1 - (x**2 + y**2) / radius**2, 0))
    down = 2 * cosine**2 - 1 < 0  # z of the reflected ray
    tint = np.asarray(tint)
    strength = tint + (1 - tint) * (1 - cosine[..., None]) ** 5
    return inside, down, strength * np.where(down[..., None], floor, world)


def test_unlit_mirror_sphere_matches_the_closed_form():
    """Where on the sphere the floor begins, and Schlick's colour on either side of it."""
    scene = stage.empty_scene()
    tint = (0.9, 0.6, 0.3)
    stage.add_sphere(scene, "ball", 1, stage.principled("gold", tint, Metallic=1.0, Roughness=0.3))
    stage.add_plane(scene, "floor", 4000, stage.principled("grey", GREY), (0, 0, -1.0))
    camera = looking_down(scene)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.0
    extracted = stage.as_scene(scene, {"gold": stage.chrome("gold", tint), "grey": stage.matte("grey", GREY)}, {"ball"})
    shown = render_reference(scene, extracted, Lighting.UNLIT, 48, 48, 16).color
    inside, down, wanted = sphere_mirror(48, 1.0, 1.0, tint, -1.0, GREY, stage.WORLD)
    radius = np.hypot(*np.meshgrid(*[(np.arange(48) + 0.5) / 24 - 1] * 2))
    sure = inside & (np.abs(radius - np.sqrt(0.5)) > 0.06)
    assert (sure & down).sum() > 100
    assert (sure & ~down).sum() > 100
    np.testing.assert_allclose(shown[sure], wanted[sure], rtol=0.02)


@pytest.mark.parametrize("fresnel", [Fresnel.CONSTANT, Fresnel.SCHLICK, Fresnel.DIELECTRIC])
def test_unlit_plane_mirror_keeps_its_fresnel(fresnel):
    """A mirror floor seen at 60 degrees under a uniform world: one number, known exactly."""
    scene = stage.empty_scene()
    color, diffuse, ior = (0.9, 0.5, 0.2), 0.75, 1.45
    stage.add_plane(scene, "floor", 200, stage.principled("shiny", color))
    stage.add_camera(scene, (0, -np.sqrt(3) * 5, 5), (radians(30), 0, 0), lens=500)
    described = {
        Fresnel.CONSTANT: Material("shiny", BLACK, 0.0, reflection=ColorSource(color)),
        Fresnel.SCHLICK: stage.chrome("shiny", color),
        Fresnel.DIELECTRIC: Material(
            "shiny", ColorSource(color), diffuse, reflection=ColorSource(), fresnel=fresnel, ior=ior
        ),
    }[fresnel]
    scene.camera.rotation_euler = (radians(60), 0, 0)
    extracted = stage.as_scene(scene, {"shiny": described}, {"floor"})
    shown = render_reference(scene, extracted, Lighting.UNLIT, 9, 9, 16).color[4, 4]
    cosine, world = 0.5, np.array(stage.WORLD)
    if fresnel is Fresnel.CONSTANT:
        wanted = np.array(color) * world
    elif fresnel is Fresnel.SCHLICK:
        wanted = (np.array(color) + (1 - np.array(color)) * (1 - cosine) ** 5) * world
    else:
        inner = np.sqrt(1 - (1 - cosine**2) / ior**2)
        s = (cosine - ior * inner) / (cosine + ior * inner)
        p = (ior * cosine - inner) / (ior * cosine + inner)
        share = (s * s + p * p) / 2
        wanted = share * world + (1 - share) * diffuse * np.array(color)
    np.testing.assert_allclose(shown, wanted, rtol=0.005 if fresnel is not Fresnel.DIELECTRIC else 0.03)


def test_unlit_shows_emission_with_its_strength(mirror_stage):
    scene, materials = mirror_stage
    node = bpy.data.materials["red"].node_tree.nodes["Principled BSDF"]
    node.inputs["Emission Color"].default_value = (0.5, 1.0, 0.25, 1.0)
    node.inputs["Emission Strength"].default_value = 3.0
    materials["red"] = Material("red", ColorSource(RED), emission=ColorSource((1.5, 3.0, 0.75)))
    picture = render_reference(scene, stage.as_scene(scene, materials, {"ball"}), Lighting.UNLIT, 48, 32, 4).color
    assert (np.abs(picture - (1.5, 3.0, 0.75)).max(axis=-1) < 1e-4).sum() > 30


@pytest.mark.parametrize("grouped", [False, True])
def test_unlit_keeps_textures_even_in_groups(grouped):
    """Two texels, red and blue, on a plane: left half and right half."""
    scene = stage.empty_scene()
    material = stage.principled("picture", (1, 1, 1))
    plane = stage.add_plane(scene, "plane", 2, material)
    plane.data.uv_layers[0].data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    image = bpy.data.images.new("two", 2, 1)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set([1, 0, 0, 1, 0, 0, 1, 1])
    image.update()
    tree = material.node_tree
    if grouped:
        group = bpy.data.node_groups.new("group", "ShaderNodeTree")
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        end, shader = group.nodes.new("NodeGroupOutput"), group.nodes.new("ShaderNodeBsdfDiffuse")
        group.links.new(shader.outputs[0], end.inputs[0])
        inside, node = group, tree.nodes.new("ShaderNodeGroup")
        node.node_tree = group
        tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        target = shader.inputs["Color"]
    else:
        inside, target = tree, tree.nodes["Principled BSDF"].inputs["Base Color"]
    texture = inside.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    inside.links.new(texture.outputs["Color"], target)
    looking_down(scene, 2)
    pixels = np.full((1, 2, 4), 255, np.uint8)
    picture = Material("picture", ColorSource((1, 1, 1), image=0))
    extracted = replace(stage.as_scene(scene, {"picture": picture}), images=(Image("two", pixels),))
    before = stage.state()
    shown = render_reference(scene, extracted, Lighting.UNLIT, 16, 8, 2).color
    np.testing.assert_allclose(shown[4, 5], (1, 0, 0), atol=1e-5)
    np.testing.assert_allclose(shown[4, 10], (0, 0, 1), atol=1e-5)
    assert stage.state() == before


def test_one_material_may_mirror_here_and_not_there():
    scene = stage.empty_scene()
    tint = (0.9, 0.6, 0.3)
    material = stage.principled("gold", tint, Metallic=1.0, Roughness=0.1)
    stage.add_plane(scene, "left", 2, material, (-1, 0, 0))
    stage.add_plane(scene, "right", 2, material, (1, 0, 0))
    looking_down(scene, 2)
    extracted = stage.as_scene(scene, {"gold": stage.chrome("gold", tint)}, {"left"})
    before = stage.state()
    shown = render_reference(scene, extracted, Lighting.UNLIT, 16, 8, 2).color
    np.testing.assert_allclose(shown[4, 13], tint, rtol=1e-5)
    np.testing.assert_allclose(shown[4, 7], np.array(tint) * stage.WORLD, rtol=0.02)
    assert stage.state() == before


def test_what_extraction_left_out_is_hidden(mirror_stage):
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"}, leave_out={"box"})
    picture = render_reference(scene, extracted, Lighting.UNLIT, 48, 32, 2).color
    assert (np.abs(picture - RED).max(axis=-1) < 0.1).sum() == 0


@pytest.mark.parametrize("lighting", list(Lighting))
def test_everything_is_as_it_was(mirror_stage, lighting):
    scene, materials = mirror_stage
    scene.render.resolution_percentage, scene.render.use_border = 50, True
    scene.cycles.samples, scene.cycles.use_denoising = 77, True
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "PNG", "16"
    scene.camera.data.dof.use_dof = True
    stage.add_box(scene, "bare", 0.5, None, (3, 0, 1)).data.materials.append(None)
    before = stage.state()
    render_reference(scene, stage.as_scene(scene, materials, {"ball"}), lighting, 16, 8, 2)
    assert stage.state() == before


def test_everything_is_as_it_was_after_cancelling(mirror_stage):
    scene, materials = mirror_stage
    before = stage.state()

    def cancel(stage_name, fraction):
        if fraction > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render_reference(scene, stage.as_scene(scene, materials, {"ball"}), Lighting.UNLIT, 16, 8, 4, progress=cancel)
    assert stage.state() == before


def test_lamps_light_but_are_not_seen(mirror_stage):
    scene, materials = mirror_stage
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    mirror = bpy.data.materials["mirror"].node_tree.nodes["Principled BSDF"]
    mirror.inputs["Roughness"].default_value = 0.0
    picture = render_reference(scene, stage.as_scene(scene, materials, {"ball"}), Lighting.CYCLES, 48, 32, 32)
    assert picture.color[-1, 24].min() > 0.05
    assert picture.color.max() < 3  # the lamp itself is 48 W/(pi^2 r^2): about 190


def test_noise_is_the_error_of_the_mean(mirror_stage):
    """Over many pixels the estimate agrees with the difference from a picture of far more samples."""
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"})
    few = render_reference(scene, extracted, Lighting.CYCLES, 48, 32, 16)
    many = render_reference(scene, extracted, Lighting.CYCLES, 48, 32, 1024)
    error = np.sqrt(np.mean((few.color - many.color) ** 2))
    told = np.sqrt(np.mean(few.noise**2))
    assert 0.6 < told / error < 1.6
    assert many.noise.mean() < 0.4 * few.noise.mean()


def test_pixels_are_averaged_over_a_box_one_pixel_wide():
    """A white half-plane ending within one column of pixels leaves its neighbours clean."""
    scene = stage.empty_scene()
    stage.add_plane(scene, "sheet", 2, stage.principled("white", (1, 1, 1)), (-1 + 0.1, 0, 0))
    camera = looking_down(scene)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.6
    extracted = stage.as_scene(scene, {"white": stage.matte("white", (1, 1, 1))})
    row = render_reference(scene, extracted, Lighting.UNLIT, 4, 4, 64).color[1, :, 0]
    np.testing.assert_allclose(row, [1, 1, 0.25 + 0.75 * 0.1, 0.1], atol=0.02)
    np.testing.assert_allclose(row[[1, 3]], [1, 0.1], atol=1e-5)


def test_the_cache_answers_until_the_content_changes(mirror_stage, tmp_path, monkeypatch):
    scene, materials = mirror_stage
    cache = Cache(tmp_path)
    extracted = stage.as_scene(scene, materials, {"ball"})
    first = render_reference(scene, extracted, Lighting.UNLIT, 16, 8, 4, cache)
    calls = []
    take = module.take_picture
    monkeypatch.setattr(module, "take_picture", lambda bpy_scene: calls.append(1) or take(bpy_scene))
    again = render_reference(scene, extracted, Lighting.UNLIT, 16, 8, 4, cache)
    assert not calls
    assert (again.color == first.color).all()
    assert (again.noise == first.noise).all()
    bpy.data.materials["red"].node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value[0] = 0.3
    render_reference(scene, extracted, Lighting.UNLIT, 16, 8, 4, cache)
    render_reference(scene, extracted, Lighting.CYCLES, 16, 8, 4, cache)
    render_reference(scene, extracted, Lighting.UNLIT, 8, 16, 4, cache)
    assert len(calls) == 6


@pytest.fixture
def pieces(monkeypatch):
    """The pieces that Cycles renders from here on: (seed, first sample, samples)."""
    rendered, take = [], module.take_picture

    def taking(bpy_scene):
        cycles = bpy_scene.cycles
        rendered.append((cycles.seed, cycles.sample_offset, cycles.sample_subset_length))
        return take(bpy_scene)

    monkeypatch.setattr(module, "take_picture", taking)
    return rendered


def test_a_kept_picture_grows_into_what_it_would_have_been_at_once(mirror_stage, tmp_path, pieces):
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"})
    at_once = render_reference(scene, extracted, Lighting.CYCLES, 24, 16, 100)
    cache = Cache(tmp_path)
    for few in (32, 40):  # a half of 20 samples ends amid a piece: nothing can go on from it
        render_reference(scene, extracted, Lighting.CYCLES, 24, 16, few, cache)
    pieces.clear()
    grown = render_reference(scene, extracted, Lighting.CYCLES, 24, 16, 100, cache)
    assert pieces == [(seed, *piece) for seed in (0, 1) for piece in ((16, 16), (32, 16), (48, 2))]
    assert grown.samples == at_once.samples == 100
    assert np.array_equal(grown.color, at_once.color)
    assert np.array_equal(grown.half, at_once.half)
    pieces.clear()
    fewer = render_reference(scene, extracted, Lighting.CYCLES, 24, 16, 64, cache)
    assert (0, 0, 16) not in pieces
    assert not np.array_equal(fewer.color, grown.color)


def test_samples_go_on_until_the_noise_is_low(mirror_stage, tmp_path, pieces):
    """What the half's FLIP says is held against the noise as the report has it, over the same pixels."""
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"})
    ball = np.zeros((32, 48), bool)
    ball[8:28, 10:26] = True

    def noise(picture):
        return noise_maps(picture.half, 2 * picture.color - picture.half, hdr=False).over(ball).flip

    def taken(bound, most=512, cache=None):
        return render_reference(scene, extracted, Lighting.UNLIT, 48, 32, Enough(ball, bound, 32, most), cache)

    first = taken(1.0)
    assert first.samples == 32
    bound = 0.6 * noise(first)
    cache = Cache(tmp_path)
    enough = taken(bound, cache=cache)
    assert 32 < enough.samples < 512
    assert noise(enough) <= bound
    exactly = render_reference(scene, extracted, Lighting.UNLIT, 48, 32, enough.samples)
    assert np.array_equal(enough.color, exactly.color)
    pieces.clear()
    assert taken(bound, cache=cache).samples == enough.samples
    assert not pieces
    assert taken(1e-9, most=90).samples == 90
    assert render_reference(scene, extracted, Lighting.UNLIT, 48, 32, Enough(ball, 1.0, 44, 512)).samples == 44
    nowhere = Enough(np.zeros_like(ball), noise(first), 32, 512)
    assert render_reference(scene, extracted, Lighting.UNLIT, 48, 32, nowhere).samples <= enough.samples


def test_progress_of_unknown_length_never_goes_back(mirror_stage):
    scene, materials = mirror_stage
    told = []
    few = Enough(np.ones((16, 24), bool), 1e-9, 32, 128)
    extracted = stage.as_scene(scene, materials, {"ball"})
    render_reference(scene, extracted, Lighting.UNLIT, 24, 16, few, progress=lambda _, done: told.append(done))
    assert told == sorted(told)
    assert told[0] == 0.0
    assert told[-1] == 1.0


def test_bad_input_is_one_line(mirror_stage):
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"})
    with pytest.raises(UsageError, match="0x8"):
        render_reference(scene, extracted, Lighting.UNLIT, 0, 8, 4)
    with pytest.raises(UsageError, match="at least 2"):
        render_reference(scene, extracted, Lighting.UNLIT, 8, 8, 1)
    scene.camera = None
    with pytest.raises(SceneError, match="no camera"):
        render_reference(scene, extracted, Lighting.UNLIT, 8, 8, 4)


@pytest.mark.slow
def test_eevee_agrees_where_nothing_is_reflected(mirror_stage):
    scene, materials = mirror_stage
    extracted = stage.as_scene(scene, materials, {"ball"})
    before = stage.state()
    picture = render_eevee(scene, extracted, Lighting.UNLIT, 48, 32, 2, progress=silent)
    assert stage.state() == before
    assert picture.seconds_per_sample >= 0  # so few pixels may cost less than the clock can tell
    np.testing.assert_allclose(picture.color[1, 1], stage.WORLD, rtol=0.01)
    np.testing.assert_allclose(picture.color[-1, 24], GREY, rtol=0.01)
