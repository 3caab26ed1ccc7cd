"""Lightmaps: the light Cycles would show, in charts that do not touch, baked without a trace."""

from dataclasses import replace
from math import cos, pi

import bpy
import numpy as np
import pytest
from catoptric.addon.blender import lightmap
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.lightmap import atlas_places, bake_lightmaps, lightmap_sizes, spread
from catoptric.addon.blender.lightmap_uv import unwrap
from catoptric.addon.blender.reference import render_reference
from catoptric.addon.cache import Cache
from catoptric.addon.errors import UsageError
from catoptric.addon.scene import Lighting, Mesh
from catoptric.tests import blender_stage as stage
from hypothesis import given
from hypothesis import strategies as st

BLACK_WORLD = (0.0, 0.0, 0.0)


def diffuse(name, color):
    material = stage.principled(name, color)
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def set_world(scene, color):
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)


def points_on(scene, index, count, seed=0):
    """Random points of an instance: world positions, world normals and lightmap coordinates."""
    rng = np.random.default_rng(seed)
    instance = scene.instances[index]
    mesh = scene.meshes[instance.mesh]
    corners = mesh.corners @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    chosen = rng.choice(len(corners), count, p=area / area.sum())
    weights = rng.dirichlet((1, 1, 1), count)
    positions = np.einsum("nk,nkc->nc", weights, corners[chosen])
    uvs = np.einsum("nk,nkc->nc", weights, mesh.lightmap_uvs[chosen])
    normals = mesh.normals[chosen, 0] @ np.linalg.inv(instance.matrix[:3, :3])
    return positions, normals / np.linalg.norm(normals, axis=1, keepdims=True), uvs


def look_up(scene, index, uvs):
    """The lightmap's light at these coordinates, between texels linearly: (N, 3)."""
    pixels = scene.images[scene.instances[index].lightmap].pixels[..., :3]
    size = np.array(pixels.shape[1::-1])
    place = np.clip(uvs * size - 0.5, 0, size - 1)
    low = np.floor(place).astype(int)
    high = np.minimum(low + 1, size - 1)
    fx, fy = (place - low).T[..., None]
    bottom = pixels[low[:, 1], low[:, 0]] * (1 - fx) + pixels[low[:, 1], high[:, 0]] * fx
    top = pixels[high[:, 1], low[:, 0]] * (1 - fx) + pixels[high[:, 1], high[:, 0]] * fx
    return bottom * (1 - fy) + top * fy


def named(scene, name):
    return next(index for index, instance in enumerate(scene.instances) if instance.name == name)


@pytest.fixture
def bare_stage():
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 20), (0, 0, 0))
    return scene


def test_a_sun_on_a_floor_is_known_exactly(bare_stage):
    """E cos / pi, and E / pi on a roof turned towards the sun, whatever its colour."""
    set_world(bare_stage, BLACK_WORLD)
    stage.add_plane(bare_stage, "floor", 10, diffuse("grey", (0.5, 0.25, 0.75)))
    roof = stage.add_plane(bare_stage, "roof", 2, diffuse("red", (0.9, 0.1, 0.1)), (20, 0, 0))
    roof.rotation_euler = (0.7, 0, 0)
    stage.add_lamp(bare_stage, "sun", "SUN", 3.0, rotation=(0.7, 0, 0))
    lit = bake_lightmaps(bare_stage, extract(bare_stage), 4, 1 << 12)
    for name, wanted in (("floor", 3.0 / pi * cos(0.7)), ("roof", 3.0 / pi)):
        index = named(lit, name)
        light = look_up(lit, index, points_on(lit, index, 200)[2])
        np.testing.assert_allclose(light, wanted, rtol=0.02)  # the denoiser may err by 1.5 %


def test_light_baked_in_pieces_is_that_of_one_sequence(bare_stage, monkeypatch):
    """However long the pieces: sequences of their own would be other, noisier light."""
    stage.add_plane(bare_stage, "floor", 4, diffuse("grey", (0.5, 0.25, 0.75)))
    stage.add_box(bare_stage, "box", 1, diffuse("red", (0.9, 0.1, 0.1)), (0.4, 0.3, 0.5))
    extracted, light = extract(bare_stage), []
    for length in (4, 16):
        monkeypatch.setattr(lightmap, "CHUNK", length)
        lit = bake_lightmaps(bare_stage, extracted, 16, 1 << 10)
        light.append(lit.images[lit.instances[named(lit, "floor")].lightmap].pixels)
    np.testing.assert_allclose(light[0], light[1], rtol=1e-3)


def test_flat_sides_and_mirrored_objects_get_the_light_of_their_own_side(bare_stage):
    """Two boxes, one turned inside out by a negative scale and put right by Blender, under a slanted sun."""
    set_world(bare_stage, BLACK_WORLD)
    white = diffuse("white", (1, 1, 1))
    white.node_tree.nodes["Diffuse BSDF"].inputs["Color"].default_value = (0.001, 0.001, 0.001, 1)
    stage.add_box(bare_stage, "plain", 1, white)
    mirrored = stage.add_box(bare_stage, "mirrored", 1, white, (5, 0, 0))
    mirrored.data = bare_stage.objects["plain"].data
    mirrored.scale = (-1.5, 1, 1)
    sun = stage.add_lamp(bare_stage, "sun", "SUN", pi, rotation=(0.4, 0.5, 0.3))
    bpy.context.view_layer.update()
    towards = np.array(sun.matrix_world)[:3, 2]
    extracted = extract(bare_stage)
    lit = bake_lightmaps(bare_stage, extracted, 4, 1 << 14)
    for name in ("plain", "mirrored"):
        index = named(lit, name)
        _, normals, uvs = points_on(lit, index, 500)
        wanted = np.maximum(normals @ towards, 0.0)
        wrong = np.abs(look_up(lit, index, uvs)[:, 0] - wanted) > 0.02
        assert wrong.mean() < 0.01


@pytest.mark.parametrize("make", [diffuse, stage.principled])
def test_base_times_lightmap_is_what_cycles_shows(bare_stage, make):
    """A box on a floor under sun and sky, seen from above, off the edges of shadows.

    Principled loses some light to its gloss, and shows the sky in it: 4 % may go either way.
    """
    colors = {"floor": (0.5, 0.6, 0.4), "box": (0.8, 0.3, 0.2)}
    stage.add_plane(bare_stage, "floor", 6, make("floor", colors["floor"]))
    stage.add_box(bare_stage, "box", 1, make("box", colors["box"]), (0.4, 0.3, 0.5))
    stage.add_lamp(bare_stage, "sun", "SUN", 2.0, rotation=(0.6, 0.4, 0), size=0.05)
    camera = bare_stage.camera.data
    camera.type, camera.ortho_scale = "ORTHO", 6.0
    extracted = extract(bare_stage)
    lit = bake_lightmaps(bare_stage, extracted, 64, 1 << 16)
    shown = render_reference(bare_stage, extracted, Lighting.CYCLES, 48, 48, 256).color
    padded = np.pad(shown, ((1, 1), (1, 1), (0, 0)), mode="edge")
    around = np.stack([padded[y : y + 48, x : x + 48] for y in range(3) for x in range(3)])
    smooth = (np.ptp(around, axis=0) < 0.08 * shown).all(axis=-1)
    for name, lowest in (("floor", -0.01), ("box", 0.99)):
        index = named(lit, name)
        positions, normals, uvs = points_on(lit, index, 3000)
        x, y = ((positions[:, :2] / 6.0 * (1, -1) + 0.5) * 48).astype(int).T
        seen = (normals[:, 2] > 0.9) & (positions[:, 2] > lowest) & smooth[y.clip(0, 47), x.clip(0, 47)]
        ours = np.array(colors[name]) * look_up(lit, index, uvs[seen])
        error = ours / shown[y[seen], x[seen]] - 1.0
        assert seen.sum() > 100
        assert np.abs(np.median(error, axis=0)).max() < (0.01 if make is diffuse else 0.04)
        assert np.percentile(np.abs(error), 90) < (0.03 if make is diffuse else 0.06)


def test_one_room_lights_another_object(bare_stage):
    """A glowing ceiling above a floor: no lamp, no sky, and still there is light, most of it in the middle."""
    set_world(bare_stage, BLACK_WORLD)
    stage.add_plane(bare_stage, "floor", 8, diffuse("grey", (0.5, 0.5, 0.5)))
    glow = stage.principled("glow", (0, 0, 0), **{"Emission Strength": 5.0})
    glow.node_tree.nodes["Principled BSDF"].inputs["Emission Color"].default_value = (1, 1, 1, 1)
    stage.add_plane(bare_stage, "ceiling", 1, glow, (0, 0, 1)).rotation_euler = (pi, 0, 0)
    lit = bake_lightmaps(bare_stage, extract(bare_stage), 32, 1 << 12)
    index = named(lit, "floor")
    positions, _, uvs = points_on(lit, index, 2000)
    light, reach = look_up(lit, index, uvs)[:, 0], np.linalg.norm(positions[:, :2], axis=1)
    # Below a square of side 1 at distance 1 the form factor is 0.2395 (four quarter squares of 0.0599 each).
    assert light[reach < 0.25].mean() == pytest.approx(5 * 0.2395, rel=0.06)
    assert light[reach > 3.5].mean() < 0.05


def test_reflectors_keep_no_lightmap_and_the_file_is_as_it_was(bare_stage, tmp_path):
    stage.add_plane(bare_stage, "floor", 10, stage.principled("grey", (0.5, 0.5, 0.5)))
    chrome = stage.principled("chrome", (0.9, 0.9, 0.9), Metallic=1.0, Roughness=0.0)
    stage.add_sphere(bare_stage, "ball", 1, chrome, (0, 0, 1), 32, 16)
    stage.add_box(bare_stage, "bare", 1, None, (3, 0, 0.5))
    stage.add_lamp(bare_stage, "lamp", "POINT", 100, (0, -3, 4))
    extracted = extract(bare_stage)
    before = stage.state()
    cache = Cache(tmp_path)
    lit = bake_lightmaps(bare_stage, extracted, 2, 1 << 12, cache)
    assert stage.state() == before
    assert [instance.lightmap is None for instance in lit.instances] == [i.name == "ball" for i in lit.instances]
    for instance in lit.instances:
        if instance.lightmap is not None:
            pixels = lit.images[instance.lightmap].pixels
            assert pixels.dtype == np.float32
            assert pixels.shape[0] == pixels.shape[1] in (32, 64, 128)
            mesh = lit.meshes[instance.mesh]
            assert mesh.lightmap_uvs.shape == mesh.uvs.shape
            assert mesh.lightmap_uvs.min() >= 0
            assert mesh.lightmap_uvs.max() <= 1

    def never(stage_name, fraction):
        raise AssertionError("the cache did not answer")

    for again in (extracted, lit):
        known = bake_lightmaps(bare_stage, again, 2, 1 << 12, cache, never)
        assert len(known.images) == len(lit.images)
        assert all((a.pixels == b.pixels).all() for a, b in zip(known.images, lit.images, strict=True))
    bpy.data.lights["lamp"].energy = 200
    brighter = bake_lightmaps(bare_stage, extract(bare_stage), 2, 1 << 12, cache)
    assert brighter.images[0].pixels[..., :3].mean() > 1.2 * lit.images[0].pixels[..., :3].mean()


def test_everything_is_as_it_was_after_cancelling(bare_stage):
    stage.add_plane(bare_stage, "floor", 10, stage.principled("grey", (0.5, 0.5, 0.5)))
    extracted = extract(bare_stage)
    before = stage.state()

    def cancel(stage_name, fraction):
        if fraction > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bake_lightmaps(bare_stage, extracted, 64, 1 << 10, progress=cancel)
    assert stage.state() == before


def test_settings_that_make_no_sense_are_one_line(bare_stage):
    stage.add_plane(bare_stage, "floor", 1)
    with pytest.raises(UsageError, match="at least one"):
        bake_lightmaps(bare_stage, extract(bare_stage), 0)


def triangles_of(kind):
    """A mesh to unwrap: positions and triangles."""
    rng = np.random.default_rng(1)
    if kind == "noise":
        positions = rng.normal(size=(400, 3))
        return positions, np.arange(398)[:, None] + [0, 1, 2]
    turns = np.linspace(0, 2 * pi, 400, endpoint=False)
    reach = 2 + np.cos(5 * turns)
    centre = np.stack([reach * np.cos(3 * turns), reach * np.sin(3 * turns), np.sin(5 * turns)], axis=-1)
    tangent = np.roll(centre, -1, 0) - np.roll(centre, 1, 0)
    side = np.cross(tangent, [0, 0, 1.0])
    up = np.cross(tangent, side)
    side, up = (vector / np.linalg.norm(vector, axis=1, keepdims=True) for vector in (side, up))
    angle = np.linspace(0, 2 * pi, 12, endpoint=False)[:, None, None]
    positions = (centre + 0.25 * (np.cos(angle) * side + np.sin(angle) * up)).transpose(1, 0, 2).reshape(-1, 3)
    i, j = (grid.ravel() for grid in np.mgrid[:400, :12])
    a, b = i * 12 + j, i * 12 + (j + 1) % 12
    c, d = (i + 1) % 400 * 12 + j, (i + 1) % 400 * 12 + (j + 1) % 12
    return positions, np.concatenate([np.stack([a, c, d], -1), np.stack([a, d, b], -1)])


def mesh_of(kind):
    positions, triangles = triangles_of(kind)
    corners = np.zeros((len(triangles), 3, 3), np.float32)
    return Mesh(
        kind,
        positions.astype(np.float32),
        triangles.astype(np.int32),
        corners,
        corners[..., :2],
        np.zeros(len(triangles), np.int32),
    )


@pytest.mark.parametrize("kind", ["knot", "noise"])
def test_charts_do_not_overlap(kind):
    """Points that share a texel lie together on the mesh: within the stretch of a few texels."""
    size = 256
    mesh = mesh_of(kind)
    uvs = unwrap(mesh, size)
    assert uvs.shape == (len(mesh.triangles), 3, 2)
    assert uvs.min() >= 0
    assert uvs.max() <= 1
    rng = np.random.default_rng(0)
    edges = uvs[:, 1:] - uvs[:, :1]
    area = np.abs(np.cross(np.pad(edges[:, 0], ((0, 0), (0, 1))), np.pad(edges[:, 1], ((0, 0), (0, 1))))[:, 2])
    chosen = rng.choice(len(uvs), 400_000, p=area / area.sum())
    weights = rng.dirichlet((1, 1, 1), len(chosen))
    positions = np.einsum("nk,nkc->nc", weights, mesh.corners[chosen])
    texel = (np.einsum("nk,nkc->nc", weights, uvs[chosen]) * size).astype(int).clip(0, size - 1) @ [1, size]
    least, most = np.full((size * size, 3), np.inf), np.full((size * size, 3), -np.inf)
    np.minimum.at(least, texel, positions)
    np.maximum.at(most, texel, positions)
    used = np.isfinite(least[:, 0])
    extent = np.linalg.norm(most[used] - least[used], axis=1)
    solid = np.linalg.norm(
        np.cross(mesh.corners[:, 1] - mesh.corners[:, 0], mesh.corners[:, 2] - mesh.corners[:, 0]), axis=1
    )
    stretch = np.sqrt((solid / np.maximum(area, 1e-12)).max() if kind == "noise" else solid.sum() / area.sum()) / size
    assert (extent > 8 * stretch).mean() < 0.001


def test_neighbouring_charts_keep_their_distance():
    """Texels within one of a chart belong to no other: six sides of a box, each a chart."""
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 9), (0, 0, 0))
    stage.add_box(scene, "box", 1)
    mesh = extract(scene).meshes[0]
    size = 64
    uvs = unwrap(mesh, size) * size
    side = np.argmax(np.abs(mesh.normals[:, 0]), axis=1) * 2 + (mesh.normals[:, 0].sum(axis=1) > 0)
    boxes = [(uvs[side == k].reshape(-1, 2).min(0), uvs[side == k].reshape(-1, 2).max(0)) for k in range(6)]
    for k, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[:k]:
            assert np.maximum(low - other_high, other_low - high).max() >= 2.0


@given(st.lists(st.sampled_from([32, 64, 128, 256, 512, 1024, 2048]), min_size=1, max_size=40))
def test_places_in_the_atlas_do_not_overlap(sizes):
    places, (width, height) = atlas_places(sizes)
    used = np.zeros((height // 32, width // 32), int)
    for (x, y), size in zip(places // 32, np.array(sizes) // 32, strict=True):
        assert x + size <= width // 32
        assert y + size <= height // 32
        used[y : y + size, x : x + size] += 1
    assert used.max() == 1
    assert used.mean() > 0.25


@given(st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=50), st.integers(1 << 10, 1 << 22))
def test_sizes_follow_area_within_bounds(areas, texels):
    sizes = np.array(lightmap_sizes(areas, texels))
    assert set(sizes) <= {32, 64, 128, 256, 512, 1024, 2048}
    order = np.argsort(areas)
    assert (np.diff(sizes[order]) >= 0).all()
    assert (sizes.astype(float) ** 2)[sizes > 32].sum() <= 2.01 * texels


def test_light_spreads_beyond_borders_without_darkening():
    light = np.zeros((20, 20, 3), np.float32)
    light[5:8, 5:8], light[5:8, 12:15] = (1, 2, 3), (3, 2, 1)
    covered = light[..., 0] > 0
    filled = spread(light, covered, 3)
    assert (filled[covered] == light[covered]).all()
    np.testing.assert_allclose(filled[2:11, 2:9], np.broadcast_to((1, 2, 3), (9, 7, 3)), rtol=1e-5)
    np.testing.assert_allclose(filled[0, 0], (2, 2, 2), rtol=1e-5)


def test_what_is_walled_in_does_not_darken_what_is_beside_it():
    light = np.ones((12, 12, 3), np.float32)
    hidden = np.zeros((12, 12), bool)
    hidden[:, 6:] = True
    light[hidden] = 0.0
    filled = spread(light, np.ones((12, 12), bool), 8, hidden)
    assert (filled[:, :8] == 1.0).all()
    assert (filled[:, 8:] == 0.0).all()


def test_a_scene_without_scattering_is_returned_as_it_is(bare_stage):
    chrome = stage.principled("chrome", (0.9, 0.9, 0.9), Metallic=1.0, Roughness=0.0)
    stage.add_sphere(bare_stage, "ball", 1, chrome, (0, 0, 1), 32, 16)
    extracted = extract(bare_stage)
    assert bake_lightmaps(bare_stage, extracted, 2).images == extracted.images
    assert replace(extracted).instances[0].lightmap is None
