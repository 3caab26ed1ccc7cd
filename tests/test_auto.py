"""The choice of a method: its bounds hold where the truth is known, and a cheap choice looks like the exact one."""

import time
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.auto import RULES, TOLERANCE, Choice, choose
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.mixed import AUTO, Mixed
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.methods.situation import Situation
from catoptric.addon.metrics import flip_map
from catoptric.addon.scene import ColorSource, Image, Lighting, Material, grey
from hypothesis import given
from hypothesis import strategies as st

from .stage import looking, mesh_of, placed, scene_of

BALL = mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True)
CUBE = mesh_of(trimesh.creation.box())
PANE = mesh_of(trimesh.Trimesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]))
BOWL = trimesh.creation.icosphere(subdivisions=3)
BOWL.update_faces(BOWL.triangles_center[:, 2] < 0.0)
BOWL = mesh_of(BOWL, smooth=True)
NEAR, FAR = "layered-depth", "environment-map"


def choice(parts, camera=None, tolerance=TOLERANCE.default):
    scene = scene_of(parts, camera or looking((0, -5, 1)))
    return choose(scene, scene.instances[0], tolerance)


def situation(parts, camera, **changes):
    scene = replace(scene_of(parts, camera), **changes)
    return Situation(scene, scene.instances[0], TOLERANCE.default)


def around(distance, size=0.2, count=40, seed=1):
    """Cubes all around, so large that each takes as much of the view at every distance."""
    random = np.random.default_rng(seed)
    towards = random.normal(size=(count, 3))
    towards *= distance / np.linalg.norm(towards, axis=1, keepdims=True)
    return [(CUBE, placed(place, (size * distance,) * 3, float(random.uniform(0, 3))), False) for place in towards]


def room(thickness, size=(8.0, 8.0, 6.0)):
    """Six walls, whose outsides make a box of `size`."""
    walls = []
    for axis in range(3):
        for side in (-1, 1):
            scale, place = np.array(size), np.zeros(3)
            scale[axis], place[axis] = thickness, side * 0.5 * (size[axis] - thickness)
            walls.append((CUBE, placed(place, scale), False))
    return walls


INSIDE = looking((0, -3.6, 0), lens=24)
GUEST = (BALL, placed((0.5, 0.3, -0.5)), True)


# What it chooses


@pytest.mark.parametrize(
    ("parts", "method", "clue"),
    [
        ([(BALL, placed(), True)], FAR, "nothing but the world"),
        ([(BALL, placed(), True), *around(500)], FAR, "sizes away"),
        ([(BALL, placed(), True), (CUBE, placed((1.8, 0, 0)), False)], NEAR, "object 1 is 0.3 m away and it is 2 m"),
        ([(BALL, placed(), True), (CUBE, placed((0, 0, -2), (9, 9, 2)), False)], NEAR, "beside"),
        ([(BALL, placed(), True), (BALL, placed((4, 0, 0)), True)], NEAR, "object 1 is 2 m away"),
        ([(BOWL, placed(), True)], NEAR, "convex body"),
        ([(PANE, placed(turn=1.2, axis=(1, 0, 0)), True)], NEAR, "texel"),
        ([(PANE, placed(turn=1.2, axis=(1, 0, 0)), True), *around(500)], NEAR, "m away"),
        ([(BALL, placed(scale=(0.05,) * 3), True), *around(500)], NEAR, "pixels across"),
        ([(BALL, placed(), True), (CUBE, placed((3, 0, 0), (0.002,) * 3), False)], FAR, "tiny"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_geometry_decides_and_the_reason_says_how(parts, method, clue):
    chosen = choice(parts)
    assert chosen.method == method
    assert clue in chosen.reason


def test_an_empty_room_is_projected():
    assert choice([GUEST, *room(0.001)], INSIDE).method == "environment-map-parallax"
    one_mesh = trimesh.creation.box()
    one_mesh.invert()
    assert choice([GUEST, (mesh_of(one_mesh), placed(scale=(8, 8, 6)), False)], INSIDE).method.endswith("parallax")


@pytest.mark.parametrize(
    "parts",
    [
        [GUEST, *room(0.001)[1:]],
        [GUEST, *room(0.3)],
        [GUEST, *room(0.001), (CUBE, placed((2.5, 1, -2.5)), False)],
        [GUEST, *room(0.001), (CUBE, placed((2.5, 1, -2.5), (0.5,) * 3), True)],
        [(mesh, placed(turn=0.4) @ matrix, mirrors) for mesh, matrix, mirrors in [GUEST, *room(0.001)]],
    ],
    ids=["a wall missing", "thick walls", "furnished", "with a mirror", "turned"],
)
def test_other_rooms_are_not(parts):
    assert choice(parts, INSIDE).method == NEAR


def test_what_only_one_kind_of_ray_sees_counts():
    scene = scene_of([(BALL, placed(), True), (CUBE, placed((60, 0, 0), (20,) * 3), False)], looking((0, -5, 1)))
    assert choose(scene, scene.instances[0], 4.0).method == FAR
    for name in ("in_camera", "in_reflections"):
        odd = replace(scene, instances=(scene.instances[0], replace(scene.instances[1], **{name: False})))
        assert choose(odd, odd.instances[0], 4.0).method == NEAR
    gone = replace(scene.instances[1], in_camera=False, in_reflections=False)
    absent = replace(scene, instances=(scene.instances[0], gone))
    assert choose(absent, absent.instances[0]).reason.startswith("nothing but the world")


def test_tolerance_moves_the_limit():
    parts = [(BALL, placed(), True), *around(40)]
    assert choice(parts, tolerance=0.5).method == NEAR
    assert choice(parts, tolerance=50.0).method == FAR


def test_a_rule_of_a_new_method_is_asked_first(monkeypatch):
    def flat(situation):
        return Choice("planar", "it is flat") if situation.curvature == 0.0 else None

    monkeypatch.setattr("catoptric.addon.methods.auto.RULES", [flat, *RULES])
    assert choice([(PANE, placed(), True), *around(5)]).method == "planar"
    assert choice([(BALL, placed(), True), *around(5)]).method == NEAR


# Its bounds


@given(
    st.floats(1.5, 20.0), st.floats(2.0, 1e4), st.floats(0.2, 3.0), st.integers(100, 2000), st.sampled_from([24, 50])
)
def test_the_bound_holds_on_a_ball(viewer, distance, radius, width, lens):
    """Everything lies on a sphere around the ball; where a pixel's lookup truly shows is found along a meridian."""
    camera = looking((0.0, -viewer * radius, 0.0), lens=lens)
    shell = distance * radius
    parts = [(BALL, placed(scale=(radius,) * 3), True), (CUBE, placed((shell + 0.5, 0, 0)), False)]
    measured = situation(parts, camera, resolution=(width, width))
    angle = np.linspace(0.0, np.arccos(1.0 / viewer), 20_001)[:-1]  # of the normal, from the axis to the camera
    point = radius * np.stack([np.cos(angle), np.sin(angle)], -1)
    ray = point - np.array([viewer * radius, 0.0])
    screen = ray[:, 1] / -ray[:, 0] / (36.0 / lens) * width
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    normal = point / radius
    ray -= 2.0 * (ray * normal).sum(-1, keepdims=True) * normal
    along = (point * ray).sum(-1)
    met = point + (np.sqrt(along**2 + shell**2 - radius**2) - along)[:, None] * ray
    looked_up, shown = np.arctan2(ray[:, 1], ray[:, 0]), np.arctan2(met[:, 1], met[:, 0])
    there = np.interp(looked_up, shown, screen, right=np.nan)
    error = np.nanmax(np.abs(there - screen))
    bound = measured.on_screen(measured.radius, shell - radius)
    assert error <= 1.1 * bound  # thin mirrors are an approximation
    assert bound <= 30.0 * error + 1e-3 * width


@given(st.floats(0.5, 30.0), st.floats(0.1, 1e4), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_the_bound_holds_on_a_pane(viewer, distance, u, v):
    """A plane shows the mirror image of a point; the lookup shows the point seen from the pane's middle."""
    camera = looking((0.0, -1e-6, viewer))
    measured = situation([(PANE, placed(), True), (CUBE, placed((0, 0, distance + 0.5)), False)], camera)
    width = measured.scene.resolution[0]
    place = np.array([u, v])
    slope = place / viewer
    true = place + slope * distance  # where the ray meets a plane at `distance`
    looked_up = slope * distance
    # Both seen by way of the plane: their mirror images stand `distance` behind it.
    pixels = np.linalg.norm(true - looked_up) / (viewer + distance) / (36.0 / 50.0) * width
    assert measured.curvature == 0.0
    assert pixels <= measured.on_screen(measured.radius, distance) * (1 + 1e-6)


def test_a_stretched_ball_is_as_flat_as_its_flattest_place():
    for scale in ((1, 1, 1), (3, 1, 1), (1, 2, 5)):
        measured = situation([(BALL, placed(scale=scale), True)], looking((0, -9, 0)))
        assert measured.curvature == pytest.approx(min(scale) / max(scale) ** 2, rel=0.1)
        assert measured.radius == pytest.approx(max(scale), rel=1e-5)


@pytest.mark.parametrize(
    ("mesh", "alone"), [(BALL, True), (CUBE, True), (PANE, True), (BOWL, False)], ids=["ball", "cube", "pane", "bowl"]
)
def test_what_shows_itself(mesh, alone):
    assert situation([(mesh, placed(), True)], looking((0, -5, 1))).alone is alone


@given(st.floats(-6, 6), st.floats(-6, 6), st.floats(-6, 6), st.floats(0, 3), st.floats(0.1, 3))
def test_distances_are_never_too_large(x, y, z, turn, size):
    matrix = placed((x, y, z), (size, 1.0, 0.5), turn, (1, 2, 3))
    measured = situation([(BALL, placed(), True), (CUBE, matrix, False)], looking((0, -20, 0)))
    surface = trimesh.Trimesh(np.asarray(CUBE.positions), CUBE.triangles).apply_transform(matrix)
    _, gap, _ = trimesh.proximity.closest_point_naive(surface, [(0.0, 0.0, 0.0)])
    assert measured.distances[0] <= max(gap[0] - 1.0, 0.0) + 1e-4


# What it shows


def colorful(scene):
    random = np.random.default_rng(2)
    colors = [ColorSource(tuple(map(float, random.uniform(0.1, 0.9, 3)))) for _ in scene.materials]
    materials = [m if m.mirrors else Material(m.name, base=c) for m, c in zip(scene.materials, colors, strict=True)]
    return replace(scene, materials=tuple(materials), resolution=(288, 192))


def shot(method, scene):
    method.prepare(scene, Lighting.UNLIT)
    try:
        return method.render(View(scene.camera, *scene.resolution, 4))
    finally:
        method.release()


@pytest.mark.parametrize(
    ("parts", "camera", "method"),
    [
        ([(BALL, placed(), True), *around(150)], looking((0, -5, 1)), FAR),
        ([GUEST, *room(0.001)], INSIDE, "environment-map-parallax"),
    ],
    ids=["far", "room"],
)
def test_a_cheap_choice_looks_like_the_exact_one(parts, camera, method):
    scene = colorful(scene_of(parts, camera))
    assert choose(scene, scene.instances[0]).method == method
    exact, auto = shot(METHODS[NEAR](), scene), shot(METHODS[AUTO](), scene)
    mask = exact.reflectors >= 0.5
    assert flip_map(auto.color, exact.color)[mask].mean() < 0.04
    np.testing.assert_array_equal(auto.color, shot(METHODS[method](), scene).color)


def test_auto_chooses_again_when_things_move():
    far = scene_of([(BALL, placed(), True), (CUBE, placed((800, 0, 0)), False)], looking((0, -5, 1)))
    near = replace(far, instances=(far.instances[0], replace(far.instances[1], matrix=placed((2, 0, 0)))))
    method = Mixed({"object 0": (AUTO, {})})
    method.prepare(far, Lighting.UNLIT)
    try:
        assert method.choices["object 0"].method == FAR
        method.update(near)
        assert method.choices["object 0"].method == NEAR
        frame = method.render(View(near.camera, 96, 64, 1))
        np.testing.assert_array_equal(frame.color, replace_render(near))
    finally:
        method.release()


def replace_render(scene):
    """Layered-depth's picture of a scene, one sample a pixel."""
    method = METHODS[NEAR]()
    method.prepare(scene, Lighting.UNLIT)
    try:
        return method.render(View(scene.camera, 96, 64, 1)).color
    finally:
        method.release()


def test_a_choice_among_150_takes_no_time():
    balls = [(BALL, placed((3.0 * (i % 12), 3.0 * (i // 12), 0.0)), i == 0) for i in range(150)]
    scene = scene_of(balls, looking((-3, -5, 1)))
    choose(scene, scene.instances[0])
    times = []
    for _ in range(5):
        moved = replace(scene, instances=tuple(replace(each) for each in scene.instances))
        start = time.perf_counter()
        choose(moved, moved.instances[0])
        times.append(time.perf_counter() - start)
    assert min(times) < 0.005


@pytest.mark.parametrize(
    ("shape", "roughness", "texels", "expected"),
    [
        (PANE, 0.3, None, "glossy-planar"),
        (PANE, 0.0, None, NEAR),
        (PANE, 0.01, None, NEAR),  # a lobe of 0.03 degrees is less than half a pixel
        (PANE, 1.0, (20, 100), "glossy-planar"),
        (PANE, 1.0, (0, 0), NEAR),
        (BALL, 0.3, None, NEAR),  # rough, but not flat
    ],
)
def test_a_rough_flat_mirror_is_blurred(shape, roughness, texels, expected):
    scene = scene_of([(shape, placed(scale=(2, 2, 2)), True), (CUBE, placed((0, 0, 1.2)), False)], looking((0, -5, 2)))
    images = ()
    if texels:
        pixels = np.zeros((1, 16, 4), np.uint8)
        pixels[:, :8], pixels[:, 8:] = texels
        images = (Image("scratches", pixels),)
    rough = replace(scene.materials[0], roughness=replace(grey(roughness), image=0 if texels else None))
    scene = replace(scene, materials=(rough, *scene.materials[1:]), images=images)
    assert choose(scene, scene.instances[0]).method == expected
