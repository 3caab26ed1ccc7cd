"""`planar` against Embree, pixel by pixel, and its ways of clipping against each other."""

import ctypes
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import Canvas, Clipping
from catoptric.addon.gl import call, require
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.deferred import Ensemble
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.methods.planar import Planar
from catoptric.addon.scene import Lamp, LampKind, Lighting
from hypothesis import given, settings
from hypothesis import strategies as st

from .mirror_stage import SIZE, SKY, apart, arch, bent, differing, frame_of, grid, holed, pane, truth
from .stage import looking, mesh_of, placed, scene_of

BOX, BALL = mesh_of(trimesh.creation.box()), mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
TORUS = mesh_of(trimesh.creation.torus(0.6, 0.2, major_sections=24, minor_sections=12))
EYE = looking((1.4, -5.5, 1.4))
ABOVE = looking((1.4, -4.5, 2.4), (0.3, -0.5, -1.0))
WALL = placed((0, 1.8, 0.5), (4, 1, 3), turn=0.1)
WAYS = [clipping.value for clipping in Clipping]


def room():
    """A box that is seen from within."""
    shape = trimesh.creation.box()
    shape.invert()
    return mesh_of(shape)


def bevelled():
    """A box with a narrow plane along every edge and corner: 26 planes, more than are mirrors of their own."""
    ends = np.array([(1.0, 0.9, 0.9), (0.9, 1.0, 0.9), (0.9, 0.9, 1.0)])
    signs = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 1, 3)
    return mesh_of(trimesh.convex.convex_hull((0.5 * signs * ends).reshape(-1, 3)))


def things():
    """A box, a ring and the ground."""
    return [
        (BOX, placed((0.2, -0.5, -0.4), (0.5, 0.5, 0.9), turn=0.4), False),
        (TORUS, placed((0.9, 0.6, 0.6), turn=1.0, axis=(1, 0, 0)), False),
        (BOX, placed((0, 0, -1.2), (9, 9, 0.2)), False),
    ]


def standing():
    """What stands on the ground, which is at -1.1."""
    return [(BOX, placed((0.2, -0.5, -0.5), (0.9, 0.5, 1.2), turn=0.4), False), things()[1]]


def before_things(*mirrors, camera=EYE, bounces=4):
    """The mirrors, (mesh, matrix) each, among things."""
    return scene_of([(mesh, at, True) for mesh, at in mirrors] + things(), camera, bounces, world=SKY)


def two_walls(camera=EYE):
    return before_things((pane(), WALL), (pane(), placed((-2.6, 0, 0.5), (3, 1, 3), turn=1.3)), camera=camera)


def three_walls(camera=EYE):
    third = pane(), placed((2.8, 0.4, 0.5), (2.5, 1, 3), turn=-1.1)
    return before_things((pane(), WALL), (pane(), placed((-2.6, 0, 0.5), (3, 1, 3), turn=1.3)), third, camera=camera)


def partly_hidden():
    screen = (BOX, placed((0.3, -1.5, 0.4), (1, 0.3, 1.4)), False)
    return scene_of([(pane(), WALL, True), screen, *things()], EYE, world=SKY)


def in_a_box(camera=None):
    """Six mirrors around a box."""
    eye = camera or looking((1.2, -1.9, 0.6), (0, 0.5, 0), lens=28)
    parts = [(room(), placed(scale=(4, 5, 3)), True), (BOX, placed((0.2, 0.5, -0.4), (0.5, 0.5, 0.9), turn=0.4), False)]
    return scene_of(parts, eye, bounces=3, world=SKY)


def facing(bounces=4):
    """Two mirrors, face to face but for a little, and the viewer in between."""
    far, near = placed((0, 1.0, 0.5), (4, 1, 3)), placed((0, -2.0, 0.5), (6, 1, 4), turn=np.pi + 0.05)
    eye = looking((0.9, -1.6, 1.0), (0.2, 1, 0.6), lens=22)
    return before_things((pane(), far), (pane(), near), camera=eye, bounces=bounces)


SCENES = {
    "one mirror": lambda: before_things((pane(), WALL)),
    "three mirrors": three_walls,
    "partly hidden": partly_hidden,
    "arched": lambda: before_things((arch(), WALL)),
    "with a hole, something behind it": lambda: scene_of(
        [(holed(), WALL, True), (BOX, placed((0.1, 3.5, 0.5)), False), *things()], EYE, world=SKY
    ),
    "an L": lambda: before_things((bent(), WALL)),
    "a block, free-standing": lambda: before_things((BOX, placed((0, 0, 0.5), (1.5, 1.2, 1.9), turn=0.5))),
    "something through the mirror": lambda: before_things((pane(), placed((0, 0.6, 0.5), (4, 1, 3), turn=0.1))),
    "the ground": lambda: scene_of([(BOX, placed((0, 0, -1.2), (9, 9, 0.2)), True), *standing()], ABOVE, world=SKY),
    "ground beyond the far end": lambda: scene_of(
        [(pane(), placed((0, 0, -0.9), (900, 1, 900), np.pi / 2, (1, 0, 0)), True), *standing()],
        replace(ABOVE, far=9.0),
        world=SKY,
    ),
    "from behind": lambda: before_things((pane(), WALL), camera=looking((1.0, 6.5, 2), (0, 0, 0.5))),
    "from behind a block's edge": lambda: before_things(
        (BOX, placed((0, 1.8, 0.5), (4, 0.1, 3))), camera=looking((4.0, 6.5, 2), (0, 0, 0.5))
    ),
    "orthographic": lambda: three_walls(replace(EYE, ortho_scale=6.0)),
    "orthographic, on both sides of the camera": lambda: two_walls(
        replace(looking((0.6, 0.3, 0.75), (0.0, 2.0, 0.5)), ortho_scale=6.0, near=-50.0, far=50.0)
    ),
    "orthographic, in a box": lambda: in_a_box(replace(looking((1.2, -1.9, 0.6), (0, 0.5, 0)), ortho_scale=2.0)),
    "a box of mirrors": in_a_box,
    "bevelled": lambda: before_things((bevelled(), placed((0, 0, 0.5), (2, 1.6, 2), turn=0.5)), bounces=2),
    "face to face": facing,
    "shifted and squeezed": lambda: two_walls(replace(EYE, shift=(0.2, -0.1), pixel_aspect=1.5)),
}


def assert_is_true(frame, expected):
    """Every pixel shows what Embree sees, those at edges what it sees beside; distances as well."""
    assert not apart(frame.color, expected.color).any()
    wrong = differing(frame.color, expected.color)
    assert wrong.mean() < 0.001
    assert ((frame.reflectors > 0.5) == np.isnan(expected.distance)).mean() < 0.001
    far = np.isinf(frame.distance) != np.isinf(expected.distance)
    assert far.mean() < 0.001
    both = np.isfinite(frame.distance) & np.isfinite(expected.distance)
    assert both.sum() > 300
    assert np.percentile(np.abs(frame.distance[both] - expected.distance[both]), 99) < 1e-3


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


def pictures_of(scene, monkeypatch, drawn_settings=None):
    """How many mirrored pictures a frame takes, by depth."""
    depths = []
    paint = Ensemble.paint_mirrored

    def counted(self, view, canvas, offset):
        depths.append(view.mirrored)
        paint(self, view, canvas, offset)

    monkeypatch.setattr(Ensemble, "paint_mirrored", counted)
    frame_of(scene, drawn_settings)
    return np.bincount(depths, minlength=1)[1:].tolist()


def test_only_mirrors_in_sight_are_drawn(monkeypatch):
    assert pictures_of(two_walls(), monkeypatch)[0] == 2
    away = placed((9, -9, 0.5), (4, 1, 3))
    assert pictures_of(before_things((pane(), WALL), (pane(), away)), monkeypatch) == [1]
    wall = (BOX, placed((0, 1.0, 0.5), (9, 0.1, 9)), False)
    assert pictures_of(scene_of([(pane(), WALL, True), wall], EYE), monkeypatch) == []


def test_a_block_costs_the_sides_in_sight(monkeypatch):
    block = before_things((BOX, placed((0, 0, 0.5), (1.5, 1.2, 1.9), turn=0.5)))
    assert pictures_of(block, monkeypatch) == [2]
    above = replace(block, camera=looking((1.4, -5.5, 4.4)))
    assert pictures_of(above, monkeypatch) == [3]


def test_mirrors_in_mirrors_are_drawn_where_they_are_seen_there(monkeypatch):
    assert pictures_of(facing(bounces=3), monkeypatch) == [1, 1, 1, 1]
    assert pictures_of(facing(bounces=8), monkeypatch, {"depth": 2}) == [1, 1]
    back_to_back = before_things((pane(), WALL), (pane(), WALL @ placed((0, 0.5, 0))))
    assert pictures_of(back_to_back, monkeypatch) == [1]


def test_a_box_of_mirrors_does_not_multiply(monkeypatch):
    drawn = pictures_of(in_a_box(), monkeypatch)
    assert drawn[0] <= 5
    assert drawn[-1] < 5 * 5**2  # uncut it would be 5 for each of the last


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


def inside_of(mask, by):
    """The pixels of a mask that are `by` pixels or more from its border."""
    for _ in range(by):
        padded = np.pad(mask, 1)
        mask = mask & padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
    return mask


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


def moved(scene, index, matrix):
    instances = list(scene.instances)
    instances[index] = replace(instances[index], matrix=matrix)
    return replace(scene, instances=tuple(instances))


CHANGES = {
    "the mirror": lambda scene: moved(scene, 0, placed((0.3, 1.4, 0.4), (3, 1, 2), turn=-0.2)),
    "a thing": lambda scene: moved(scene, 2, placed((-0.8, -0.9, 0.2), (0.6, 0.5, 0.9), turn=1.2)),
    "the camera": lambda scene: replace(scene, camera=looking((-1.0, -4.5, 0.8))),
    "less flat": lambda scene: replace(scene, meshes=(BALL, *scene.meshes[1:])),
}


@pytest.mark.parametrize("clipping", ["stencil", "clip-planes", "projective-texture"])
def test_an_update_shows_what_a_fresh_start_shows(clipping):
    scene, chosen = two_walls(), {"clipping": clipping}
    method = Planar(chosen)
    method.prepare(scene, Lighting.UNLIT)
    try:
        before = method.render(View(scene.camera, *SIZE, 1)).color
        for name, change in CHANGES.items():
            after = change(scene)
            method.update(after)
            shown = method.render(View(after.camera, *SIZE, 1)).color
            np.testing.assert_array_equal(shown, frame_of(after, chosen).color, err_msg=name)
            assert differing(shown, before).mean() > 0.02
        method.update(scene)
        np.testing.assert_array_equal(method.render(View(scene.camera, *SIZE, 1)).color, before)
    finally:
        method.release()


def gl_objects():
    """How many OpenGL objects of each kind there are, of the first thousands of names."""
    counts = {}
    for kind in ("Texture", "Buffer", "Framebuffer", "Renderbuffer", "Query"):
        address = require().mglo._context.load_opengl_function(f"glIs{kind}")
        exists = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(address)
        counts[kind] = sum(exists(name) for name in range(1, 10_000))
    return counts


@pytest.mark.parametrize("clipping", WAYS)
def test_nothing_is_kept_from_frame_to_frame_and_nothing_at_the_end(clipping):
    frame_of(facing(bounces=2), {"clipping": clipping})  # what is kept for good, programs and the like, is there now
    scene, method, before = facing(bounces=2), Planar({"clipping": clipping}), call(gl_objects)
    method.prepare(scene, Lighting.UNLIT)
    canvas = call(Canvas, *SIZE)
    try:
        method.paint(View(scene.camera, *SIZE, 1), canvas)
        first = call(gl_objects)
        for _ in range(50):
            method.paint(View(scene.camera, *SIZE, 1), canvas)
        assert call(gl_objects) == first
        for number in range(20):
            method.update(moved(scene, 2, placed((0.1 * number, -0.5, -0.4), (0.5, 0.5, 0.9))))
            method.paint(View(scene.camera, *SIZE, 1), canvas)
        assert call(gl_objects) == first
    finally:
        call(canvas.release)
        method.release()
    assert call(gl_objects) == before


def test_pictures_are_given_back_and_follow_the_size():
    scene = facing()
    method = Planar()
    method.prepare(scene, Lighting.UNLIT)
    try:
        for size in (SIZE, (40, 30), SIZE):
            frame = method.render(View(scene.camera, *size, 1))
            np.testing.assert_array_equal(frame.color, frame_of(scene, size=size).color)
            assert {canvas.size for level, canvas in method._canvases.items() if level < 3} == {size}
    finally:
        method.release()
    assert method._canvases == {}


@pytest.mark.parametrize("clipping", WAYS)
def test_a_plain_frame_after_it_is_as_one_before_it(clipping):
    scene = facing()
    bare = scene_of(things(), EYE, world=SKY)
    before = [frame_of(each, method=LayeredDepth).color for each in (scene, bare)]
    frame_of(scene, {"clipping": clipping}, samples=2)
    after = [frame_of(each, method=LayeredDepth).color for each in (scene, bare)]
    np.testing.assert_array_equal(after, before)


@pytest.mark.parametrize("clipping", WAYS)
def test_no_test_of_opengl_stays_on(clipping):
    def enabled():
        address = require().mglo._context.load_opengl_function("glIsEnabled")
        ask = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(address)
        return [hex(test) for test in (0x0B90, *range(0x3000, 0x3008)) if ask(test)]  # stencil, clip distances

    frame_of(facing(), {"clipping": clipping})
    assert call(enabled) == []


def assigned(scene, *names):
    """A frame in which each reflector is drawn by its own method."""
    mixed = Mixed({f"object {index}": (name, {}) for index, name in enumerate(names)})
    mixed.prepare(scene, Lighting.UNLIT)
    try:
        assert [choice.method for choice in mixed.choices.values()] == list(names)
        return mixed.render(View(scene.camera, *SIZE, 1))
    finally:
        mixed.release()


@pytest.mark.parametrize("names", [("planar", "layered-depth"), ("layered-depth", "planar")])
def test_beside_an_exact_method_it_shows_what_both_show(names):
    scene = facing()
    assert_is_true(assigned(scene, *names), truth(scene))


def test_a_mirror_shows_another_as_that_ones_method_draws_it():
    ball = BALL, placed((-0.9, 0.1, 0.2), (0.6,) * 3)
    scene = before_things((pane(), WALL), ball)
    frame, exact = assigned(scene, "planar", "environment-map"), frame_of(scene)
    expected = truth(scene, most=1)  # where the mirror shows the ball, this stays black
    blacks = ~expected.color.any(axis=-1)
    wall = inside_of(np.isfinite(expected.distance) & blacks & (np.indices(SIZE[::-1])[1] < SIZE[0]), 1)
    assert wall.sum() > 30
    assert differing(frame.color, exact.color)[wall].mean() > 0.1  # an environment map is not exact
    assert frame.color[wall].any(axis=-1).mean() > 0.95  # but it is there
    plain = np.isnan(expected.distance)
    np.testing.assert_array_equal(frame.color[plain], exact.color[plain])
