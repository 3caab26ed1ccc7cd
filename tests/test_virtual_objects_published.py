"""`virtual-objects-published`: its search against Alhazen's closed form, its pictures against Embree."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.reflector_maps import FINER, SIZE, SPREAD, reflector_maps
from catoptric.addon.baking.reflector_maps_tables import ResidentMaps
from catoptric.addon.gl import on_gl_thread
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.methods.virtual.convergence import reflection_points
from catoptric.addon.methods.virtual.meshes import shares_of
from catoptric.addon.methods.virtual_objects_published import VirtualObjectsPublished
from catoptric.addon.metrics import error_maps
from catoptric.addon.scene import Lighting
from hypothesis import given
from hypothesis import strategies as st

from .mirror_stage import apart, frame_of, pane, truth
from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed, scene_of

PICTURE = (160, 120)
EYE = np.array([3.0, 0.5, 0.2])


def sphere(subdivisions: int = 4):
    """A smooth ball of radius 1."""
    return mesh_of(trimesh.creation.icosphere(subdivisions=subdivisions), smooth=True, name="sphere")


def tessellated(shape: trimesh.Trimesh, times: int):
    """A flat-shaded shape, each triangle quartered."""
    for _ in range(times):
        shape = shape.subdivide()
    return mesh_of(shape)


def floor(times: int):
    """A square of 18 m, of two triangles quartered so often."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 9.0
    return tessellated(trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False), times)


def beside_a_ball(fineness: int, camera=None):
    """A chrome ball above a floor, between two boxes."""
    box = tessellated(trimesh.creation.box(), max(0, fineness - 2))
    parts = [
        (sphere(), placed(), True),
        (floor(fineness), placed((0, 0, -1.2)), False),
        (box, placed((1.9, 0.4, -0.5), turn=0.4), False),
        (box, placed((-1.9, -0.9, -0.7), (0.5, 1.2, 0.6), 1.1, (1, 1, 0)), False),
    ]
    camera = camera or looking((1.0, -3.6, 1.9), (0.0, 0.0, 0.0), lens=45)
    return scene_of(parts, camera, bounces=1, world=(0.0, 0.0, 0.7))


# The search


def alhazen(eye: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """(N, 3) the points of the unit sphere that reflect vertices to the eye, NaN where it hides them."""
    distance = np.linalg.norm(eye)
    axis = eye / distance
    away = vertices @ axis
    aside = vertices - away[:, None] * axis
    off = np.linalg.norm(aside, axis=1)
    low, high = np.zeros(len(vertices)), np.minimum(np.arctan2(off, away), np.arccos(1.0 / distance))
    for _ in range(60):
        middle = (low + high) / 2.0
        normal = np.stack([np.cos(middle), np.sin(middle)], axis=1)
        ways = np.array([distance, 0.0]) - normal, np.stack([away, off], axis=1) - normal
        bisector = sum(way / np.linalg.norm(way, axis=1, keepdims=True) for way in ways)
        beyond = bisector[:, 1] * normal[:, 0] < bisector[:, 0] * normal[:, 1]
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    points = np.cos(low)[:, None] * axis + (np.sin(low) / off)[:, None] * aside
    hidden = ((vertices - points) * points).sum(axis=1) < 0.01
    return np.where(hidden[:, None], np.nan, points)


def first_met(eye: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """(N, 3) where the ways from the eye to vertices enter the unit sphere, NaN for those that pass it by or end."""
    ways = vertices - eye
    lengths = np.linalg.norm(ways, axis=1)
    ways /= lengths[:, None]
    nearest = -ways @ eye
    depth = nearest**2 - eye @ eye + 1.0
    met = nearest - np.sqrt(np.maximum(depth, 0.0))
    hidden = (depth > 0.0) & (met > 0.0) & (met < lengths)
    return np.where(hidden[:, None], eye + met[:, None] * ways, np.nan)


@pytest.fixture(scope="module")
def searched():
    """Errors (N,) of the points that a search finds, and angles (N,) of the bisector, by steps and kind of search."""
    mesh = sphere(5)
    scene = scene_of([(mesh, placed(), True)], looking((0, -4, 0)))
    baked = {0: reflector_maps(mesh, {SIZE.name: 512, FINER.name: 1, SPREAD.name: SPREAD.default})}
    random = np.random.default_rng(1)
    vertices = random.normal(size=(4000, 3))
    vertices *= random.uniform(1.05, 6.0, (4000, 1)) / np.linalg.norm(vertices, axis=1, keepdims=True)
    expected = alhazen(EYE, vertices)
    seen, behind = np.isfinite(expected[:, 0]), first_met(EYE, vertices)
    tables = None

    @on_gl_thread
    def search(steps: int, published: bool = True, hidden: bool = False) -> tuple[np.ndarray, np.ndarray]:
        nonlocal tables
        tables = tables or ResidentMaps(scene, baked)
        right = behind if hidden else expected
        asked = np.isfinite(right[:, 0])
        found = reflection_points(tables, 1, np.append(EYE, 1.0), vertices[asked], steps, published)
        return np.linalg.norm(found[:, :3] - right[asked], axis=1), found[:, 3]

    assert seen.sum() > 3000
    yield search
    on_gl_thread(lambda: tables.release())()


def test_the_search_comes_to_alhazens_point(searched):
    errors, angles = searched(32)
    assert np.median(errors) < 2e-4
    assert np.quantile(errors, 0.95) < 2e-3
    assert (angles >= 0.0).mean() > 0.98


def test_each_two_steps_bring_it_nearer(searched):
    medians = [np.median(searched(steps)[0]) for steps in (3, 5, 7, 9)]
    assert all(after < 0.6 * before for before, after in pairwise(medians))


def test_it_takes_more_steps_than_ours(searched):
    pixel = 1.0 / 300.0
    assert (searched(3, published=False)[0] < pixel).mean() > 0.98
    assert (searched(3)[0] < pixel).mean() < 0.5
    assert (searched(9)[0] < pixel).mean() > 0.9


def test_a_hidden_vertex_is_reflected_where_it_is_seen_through_the_sphere(searched):
    """As 6.1 has it: mirrored about the tangent plane there, it would be reflected to the eye."""
    errors, angles = searched(32, hidden=True)
    assert np.median(errors) < 2e-4
    assert np.quantile(errors, 0.9) < 1e-2
    assert (angles <= 0.0).all()
    assert np.median(angles) > -1e-3


# The pictures


def wrong(scene, settings=None) -> float:
    """The share of the mirrors' pixels that are not what Embree sees at or around them."""
    frame, expected = frame_of(scene, settings, PICTURE, method=VirtualObjectsPublished), truth(scene, PICTURE, 2)
    mirrors = (frame.reflectors > 0) & ~expected.grazing
    assert mirrors.sum() > 2000
    return float(apart(frame.color, expected.color)[mirrors].mean())


def test_shows_what_embree_sees_but_for_edges():
    assert wrong(beside_a_ball(6), {"grid": 0}) < 0.015


def test_the_grid_is_close_to_every_vertex():
    """FLIP of a tenth of the vertices within 0.005 of every vertex, around a finely divided object."""
    ring = tessellated(trimesh.creation.torus(1.2, 0.45, major_sections=64, minor_sections=32), 1)
    scene = scene_of(
        [(sphere(), placed(), True), (ring, placed((1.2, -1.6, 0.3), (0.4, 0.4, 0.4), 0.4, (1, 0, 0)), False)],
        looking((1.0, -4.6, 1.9)),
        world=(0.0, 0.0, 0.7),
    )
    every, between = (frame_of(scene, {"grid": grid}, PICTURE, method=VirtualObjectsPublished) for grid in (0, 10))
    mirrors = every.reflectors > 0
    assert np.isfinite(every.distance).sum() > 150
    assert (every.distance != between.distance).any()
    assert error_maps(between.color, every.color).over(mirrors).flip < 0.005


def test_the_grid_shows_what_embree_sees_but_for_edges():
    assert wrong(beside_a_ball(6), {"grid": 10}) < 0.015


@given(st.lists(st.integers(1, 3000), min_size=1, max_size=20), st.sampled_from([0.041, 0.1, 0.5]))
def test_meshes_share_what_is_searched(counts, share):
    """Small ones are searched whole, but never so many that the others have less than three quarters of it."""
    shares, counts = shares_of(counts, share), np.array(counts)
    whole = shares == 1.0
    assert (shares @ counts <= share * counts.sum() * (1.0 + 1e-9)) | whole.all()
    assert (shares[~whole] >= 0.75 * share).all()
    assert counts[whole].sum() <= 0.25 * share * counts.sum()
    assert (counts[whole] * share < 27).all()


def test_a_coarse_floor_is_searched_whole_beside_dense_meshes():
    np.testing.assert_allclose(shares_of([7958, 97, 7958], 0.1) * [7958, 97, 7958], [752.15, 97.0, 752.15])


def test_more_steps_show_more_of_it_right():
    shares = [wrong(beside_a_ball(6), {"grid": 0, "steps": steps}) for steps in (3, 7, 20)]
    assert shares[0] > shares[1] > shares[2]


def test_coarse_polygons_are_bent_wrongly_unless_they_are_cut():
    scene = beside_a_ball(0)
    assert wrong(scene, {"grid": 0}) > 0.2
    assert wrong(scene, {"grid": 0, "cut": 0.1, "steps": 12}) < 0.02


def test_stretched_turned_and_seen_without_perspective():
    scene = beside_a_ball(6, replace(looking((1.0, -3.6, 1.9)), ortho_scale=4.0))
    ball = replace(scene.instances[0], matrix=placed(scale=(1.0, 0.7, 0.8), turn=0.5))
    assert wrong(replace(scene, instances=(ball, *scene.instances[1:])), {"grid": 0}) < 0.03


def test_nothing_of_the_reflector_in_itself():
    balls = [trimesh.creation.icosphere(subdivisions=3).apply_translation((x, 0, 0)) for x in (-1.2, 1.2)]
    pair = mesh_of(trimesh.util.concatenate(balls), smooth=True)
    scene = scene_of([(pair, placed(), True)], looking((1.0, -5.0, 1.9)))
    expected = truth(scene, PICTURE, 2)
    frame = frame_of(scene, None, PICTURE, method=VirtualObjectsPublished)
    assert np.isfinite(expected.distance).sum() > 100
    assert np.isinf(frame.distance[np.isfinite(expected.distance)]).all()


def test_is_seen_in_flat_mirrors():
    before = beside_a_ball(6)
    parts = [(before.meshes[one.mesh], one.matrix, one.reflector) for one in before.instances]
    camera = looking((3.0, -4.5, 1.2), (0.0, 1.5, 0.0), lens=40)
    scene = scene_of([*parts, (pane(), placed((0, 2.2, 0.0), (6, 1, 5)), True)], camera, world=(0.0, 0.0, 0.7))
    method = Mixed({"object 0": (VirtualObjectsPublished.name, {"grid": 0}), "object 4": ("planar", {})})
    method.prepare(scene, Lighting.UNLIT)
    try:
        frame = method.render(View(camera, *PICTURE, 1))
    finally:
        method.release()
    expected = truth(scene, PICTURE, 2)
    judge = Judge(scene)
    origins, directions = camera_rays(camera, *PICTURE)
    met = judge.meet(origins, directions)
    again = judge.meet(*mirrored(met, directions))
    # Where the ball shows the mirror, Embree gives up, and we show the environment map.
    ball_in_mirror = expected.color.any(axis=2) & ((met.instance == 4) & (again.instance == 0)).reshape(PICTURE[::-1])
    ball_in_mirror &= ~expected.grazing
    assert ball_in_mirror.sum() > 300
    assert apart(frame.color, expected.color)[ball_in_mirror].mean() < 0.03
