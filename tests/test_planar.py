"""`planar` against Embree, pixel by pixel, and its ways of clipping against each other."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.planar import Planar
from catoptric.addon.scene import Lamp, LampKind, Lighting
from hypothesis import given, settings
from hypothesis import strategies as st

from .mirror_stage import SKY, apart, differing, frame_of, grid, pane, truth
from .planar_stage import (
    BALL,
    BOX,
    EYE,
    SCENES,
    WALL,
    WAYS,
    assert_is_true,
    before_things,
    facing,
    inside_of,
    things,
    three_walls,
    two_walls,
)
from .stage import looking, mesh_of, placed, scene_of


@pytest.mark.parametrize("name", SCENES)
def test_shows_what_embree_sees(name):
    scene = SCENES[name]()
    assert_is_true(frame_of(scene), truth(scene))


@pytest.mark.parametrize("clipping", WAYS[1:])
@pytest.mark.parametrize("name", ["three mirrors", "arched", "an L", "something through the mirror", "face to face"])
def test_every_clipping_draws_the_same(name, clipping):
    scene = SCENES[name]()
    frame, first = frame_of(scene, {"clipping": clipping}), frame_of(scene)
    assert_is_true(frame, truth(scene))
    assert not apart(frame.color, first.color).any()
    assert differing(frame.color, first.color).mean() < 0.001
    np.testing.assert_array_equal(frame.reflectors, first.reflectors)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(WAYS))
def test_random_mirrors_show_what_embree_sees(seed, clipping):
    rng = np.random.default_rng(seed)

    def anywhere(size):
        return placed(rng.uniform(-2, 2, 3), rng.uniform(0.3, size, 3), rng.uniform(0, 6), rng.normal(size=3))

    parts = [(pane(), anywhere(4), True) for _ in range(3)] + [(BOX, anywhere(1.5), False) for _ in range(5)]
    scene = scene_of(parts, looking(rng.uniform(-3, 3, 3) + (0, -5, 0)), bounces=2, world=SKY)
    frame, expected = frame_of(scene, {"clipping": clipping}), truth(scene)
    clear = ~expected.grazing
    assert (apart(frame.color, expected.color) & clear).mean() < 0.0005
    assert (differing(frame.color, expected.color) & clear).mean() < 0.003


@pytest.mark.parametrize("bounces", range(5))
def test_a_path_ends_where_the_scenes_bounces_end(bounces):
    scene = facing(bounces)
    frame = frame_of(scene)
    assert_is_true(frame, truth(scene))
    deeper = differing(truth(scene).color, truth(scene, most=bounces + 2).color)
    assert deeper.sum() > 5
    assert not frame.color[deeper].any()


@pytest.mark.parametrize("depth", [1, 2, 4])
def test_a_path_ends_where_the_depth_ends(depth):
    scene = facing(bounces=8)
    assert_is_true(frame_of(scene, {"depth": depth}), truth(scene, most=depth))


def test_each_kind_of_ray_sees_its_own_instances():
    scene = two_walls()
    instances = list(scene.instances)
    instances[2] = replace(instances[2], in_camera=False)
    instances[3] = replace(instances[3], in_reflections=False)
    scene = replace(scene, instances=tuple(instances))
    expected = truth(scene)
    assert_is_true(frame_of(scene), expected)
    reds = expected.color[..., 0].round()
    reflected = ~np.isnan(expected.distance)
    assert (reds[reflected] == 3).any()
    assert not (reds[~reflected] == 3).any()
    assert (reds[~reflected] == 4).any()
    assert not (reds[reflected] == 4).any()


def test_a_mirror_that_is_seen_edge_on_does_no_harm():
    edge_on = looking((0.0, -5.0, 0.5), (0.0, 0.0, 0.5))
    scene = before_things((pane(), placed((0, 1.8, 0.5), (4, 1, 3), np.pi / 2)), camera=edge_on)
    frame, expected = frame_of(scene), truth(scene)
    assert np.isfinite(frame.color).all()
    assert not apart(frame.color, expected.color).any()


def uneven(height, waves=9.0):
    mesh = grid(60, 4)
    positions = mesh.positions + height * np.sin(waves * mesh.positions[:, :1]) * np.float32([0, 1, 0])
    return replace(mesh, positions=positions.astype(np.float32))


@pytest.mark.parametrize(("height", "tolerances"), [(0.0004, {}), (0.02, {"gap": 0.05, "angle": 15.0})])
@pytest.mark.parametrize("clipping", WAYS)
def test_a_nearly_flat_mirror_does_not_hide_its_own_picture(height, tolerances, clipping):
    scene, flat = before_things((uneven(height), WALL)), before_things((pane(), WALL))
    frame, expected = frame_of(scene, {"clipping": clipping, **tolerances}), frame_of(flat)
    both = (frame.reflectors > 0.5) & (expected.reflectors > 0.5)
    wrong = apart(frame.color, expected.color)
    assert both.sum() > 1500
    assert (wrong & both).sum() < 0.01 * both.sum()


def test_a_curved_reflector_beside_a_flat_one_is_drawn_too():
    scene = scene_of([(pane(), WALL, True), (BALL, placed((-0.9, 0.3, -0.5), (0.6,) * 3), True), *things()], EYE)
    planar, exact = frame_of(scene), frame_of(scene, method=LayeredDepth)
    assert not apart(planar.color, exact.color).any()
    assert differing(planar.color, exact.color).mean() < 0.002


def test_reasons_are_given_and_what_is_refused_is_drawn_by_another():
    scene = scene_of([(BALL, placed(), True), *things()], EYE)
    assert "curved" in Planar.applies_to(scene, scene.instances[0])
    np.testing.assert_array_equal(frame_of(scene).color, frame_of(scene, method=LayeredDepth).color)


def smooth_scene():
    """A mirror that shows a large ball whose colour runs smoothly from side to side."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=4))
    at = placed((0, -22, 0.5), (12, 12, 12))
    scene = scene_of([(pane(), WALL, True), (ball, at, False)], EYE)
    shade = 0.5 + 0.5 * np.sin(6.0 * ball.positions[:, [0, 2, 0]] + (0.0, 0.0, 2.0))
    colors = np.concatenate([shade, np.ones((len(shade), 1))], axis=1).astype(np.float32)[ball.triangles]
    painted = replace(scene.meshes[1], colors=colors)
    white = replace(scene.materials[1].base, color=(1.0, 1.0, 1.0), vertex_colors=True)
    materials = scene.materials[0], replace(scene.materials[1], base=white)
    return replace(scene, meshes=(scene.meshes[0], painted), materials=materials)


@pytest.mark.parametrize("scale", [2, 4, 8])
def test_a_smaller_texture_lies_where_the_full_one_does(scale):
    scene = smooth_scene()
    full = frame_of(scene)
    small = frame_of(scene, {"clipping": "projective-texture", "scale": scale})
    np.testing.assert_array_equal(small.reflectors, full.reflectors)
    within = inside_of((full.reflectors > 0.5) & np.isfinite(full.distance), scale + 1)
    assert within.sum() > 800
    assert full.color[within].std() > 0.1
    down, across = np.gradient(full.color.mean(axis=-1))
    change = (small.color - full.color).mean(axis=-1)
    shift = np.linalg.lstsq(np.c_[across[within], down[within]], change[within], rcond=None)[0]
    assert np.abs(shift).max() < 0.02 * scale  # pixels
    assert np.abs(change[within]).max() < 0.004 * scale**2
    assert np.percentile(np.abs(small.distance - full.distance)[within], 99) < 0.05


def test_a_smaller_texture_is_filtered():
    scene, settings = smooth_scene(), {"clipping": "projective-texture", "scale": 8}
    small, full = frame_of(scene, settings), frame_of(scene)
    within = inside_of((full.reflectors > 0.5) & np.isfinite(full.distance), 9)
    steps = np.abs(np.diff(small.color, axis=1))[within[:, 1:]].max()
    assert 0.0 < steps < 1.5 * np.abs(np.diff(full.color, axis=1))[within[:, 1:]].max()  # blocks would step by 8


def test_a_smaller_texture_does_not_reach_round_the_picture():
    left, right = (BOX, placed((-6, -1, 0), (6, 0.1, 20)), False), (BOX, placed((6, -1, 0), (6, 0.1, 20)), False)
    eye = replace(looking((0, -0.5, 0), (0, 2, 0), lens=18), ortho_scale=None)
    scene = scene_of([(pane(), placed((0, 2, 0), (30, 1, 30)), True), left, right], eye, world=SKY)
    frame = frame_of(scene, {"clipping": "projective-texture", "scale": 8})
    reds = frame.color[..., 0].round(3)
    assert set(np.unique(reds[:, :3])) == {2.0}
    assert set(np.unique(reds[:, -3:])) == {3.0}


@pytest.mark.parametrize("clipping", [*WAYS, "scale 2"])
def test_a_smaller_or_clipped_picture_is_close_when_supersampled(clipping):
    chosen = {"clipping": "projective-texture", "scale": 2} if clipping == "scale 2" else {"clipping": clipping}
    scene = three_walls()
    frame, exact = frame_of(scene, chosen, samples=3), frame_of(scene, method=LayeredDepth, samples=3)
    difference = np.abs(frame.color - exact.color).mean()
    assert difference < (0.03 if clipping == "scale 2" else 0.002)


def lit(scene):
    """Two lamps with hard edges, where the picture shows it if they are mirrored wrongly."""
    spot = Lamp("spot", LampKind.SPOT, placed((0.5, -2.5, 3.0), turn=0.5, axis=(1, 0, 0)), (900.0, 500.0, 300.0))
    sun = Lamp("sun", LampKind.SUN, placed(turn=0.9, axis=(0.6, 1, 0.2)), (0.5, 0.9, 1.5))
    return replace(scene, lamps=(spot, sun))


@pytest.mark.parametrize("name", ["three mirrors", "something through the mirror", "face to face"])
def test_lamps_light_the_mirrored_scene_as_they_do_the_scene(name):
    scene = lit(SCENES[name]())
    planar, exact = (frame_of(scene, lighting=Lighting.DIRECT, method=each) for each in (Planar, LayeredDepth))
    mirrored = planar.reflectors > 0.5
    assert planar.color[mirrored].std() > 0.05
    assert not apart(planar.color, exact.color, 0.01).any()
    assert differing(planar.color, exact.color, 0.01).mean() < 0.003


def test_its_tolerance_says_what_is_flat():
    """A shallow dome of 8 degrees at its rim: curved, unless a mirror may turn as far as that."""
    dome = trimesh.creation.icosphere(subdivisions=4, radius=10.0)
    dome.update_faces(dome.triangles_center[:, 2] > 10.0 * np.cos(np.radians(8.0)))
    scene = scene_of([(mesh_of(dome, smooth=True), placed((0, 0, -10)), True)], looking((0, -5, 3)))
    tolerant = {"angle": 20.0, "gap": 1.0}
    assert "curved" in Planar.applies_to(scene, scene.instances[0])
    assert Planar.applies_to(scene, scene.instances[0], tolerant) is None
    assert list(Planar(tolerant).cast(scene).values()) == [(0,)]
