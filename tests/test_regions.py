"""Reflection regions: the cone test on the GPU against a minimum searched for on the CPU."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.regions import Regions, bounding_spheres, region_view
from catoptric.addon.drawing import Resident
from catoptric.addon.gl import call
from catoptric.addon.scene import Lighting
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .stage import looking, mesh_of, placed, scene_of

EYE = np.array([0.0, -6.0, 1.0])


def masks_of(scene, camera=None):
    """Each reflector's masks as (T, instances) bool, and the words a triangle takes."""

    def work():
        resident = Resident(scene, Lighting.UNLIT)
        regions = Regions(resident)
        try:
            regions.update(camera or scene.camera)
            return regions.masks(), regions.words
        finally:
            regions.release()
            resident.release()

    masks, words = call(work)
    bits = {
        index: (mask[:, :, None] >> np.arange(32, dtype=np.uint32) & 1).astype(bool).reshape(len(mask), -1)
        for index, mask in masks.items()
    }
    return {index: mask[:, : len(scene.instances)] for index, mask in bits.items()}, words


def soup(corners):
    """Loose triangles (T, 3, 3) as a mesh."""
    faces = np.arange(3 * len(corners)).reshape(-1, 3)
    return mesh_of(trimesh.Trimesh(corners.reshape(-1, 3), faces, process=False))


def mirrored_centre(corners, centre):
    """The centre's mirror image in each triangle's plane, by the appendix' matrix with a unit normal."""
    normal = np.cross(corners[:, 0] - corners[:, 1], corners[:, 2] - corners[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    d = -(normal * corners[:, 0]).sum(axis=1)
    matrix = np.eye(3) - 2.0 * normal[:, :, None] * normal[:, None, :]
    return matrix @ centre - 2.0 * normal * d[:, None]


def outside_by(corners, eye, centre, radius):
    """How far the triangle stays outside the cone (negative: they meet), by search.

    Distance off the axis less the cone's radius there is convex, so two nested ternary searches over
    the triangle find its least value.
    """
    towards = mirrored_centre(corners, centre) - eye
    distance = np.linalg.norm(towards, axis=1)
    axis = towards / distance[:, None]
    slope = radius / np.sqrt(np.maximum(distance**2 - radius**2, 1e-30))

    def value(s, t):
        point = (
            corners[:, 0] + s[:, None] * (corners[:, 1] - corners[:, 0]) + t[:, None] * (corners[:, 2] - corners[:, 0])
        )
        along = ((point - eye) * axis).sum(axis=1)
        off = np.linalg.norm(point - eye - along[:, None] * axis, axis=1)
        return off - slope * along

    def least_over(low, high, function):
        for _ in range(36):
            first, second = low + (high - low) / 3, high - (high - low) / 3
            shrink = function(first) < function(second)
            low, high = np.where(shrink, low, first), np.where(shrink, second, high)
        return function(0.5 * (low + high))

    nought, one = np.zeros(len(corners)), np.ones(len(corners))
    found = least_over(nought, one, lambda s: least_over(nought, 1.0 - s, lambda t: value(s, t)))
    return np.where(distance <= radius, -np.inf, found)


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.integers(0, 2**32 - 1), st.floats(0.02, 3.0), st.floats(0.05, 1.5))
def test_triangles_meet_the_cone_where_a_search_says_so(seed, spread, radius):
    random = np.random.default_rng(seed)
    corners = random.normal(size=(60, 1, 3)) + spread * random.normal(size=(60, 3, 3))
    ball = mesh_of(trimesh.creation.icosphere(1))
    centres = 3.0 * random.normal(size=(3, 3))
    parts = [(soup(corners), np.eye(4), True), *((ball, placed(centre, (radius,) * 3), False) for centre in centres)]
    camera = looking(5.0 * random.normal(size=3) + (0.0, 0.0, 0.1))
    scene = scene_of(parts, camera)
    (mask,) = masks_of(scene)[0].values()
    assert not mask[:, 0].any()
    spheres = bounding_spheres(scene).astype(float)
    corners = scene.meshes[0].corners.astype(float)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    for index in range(1, 4):
        outside = outside_by(corners, camera.position, spheres[index, :3], spheres[index, 3])
        # A sliver's normal is rounding; a touch of the cone as well.
        clear = (np.abs(outside) > 1e-3) & (area > 1e-3 * spread)
        assert clear.sum() > 20
        assert np.array_equal(mask[clear, index], outside[clear] < 0)


def facing_mirror(corners, distance=4.0, radius=0.5):
    """Whether a triangle in the plane y = 0 may show a ball at `distance` straight before it, behind the eye."""
    ball = mesh_of(trimesh.creation.icosphere(1))
    scene = scene_of(
        [(soup(np.array([corners], float)), np.eye(4), True), (ball, placed((0, -distance, 0), (radius,) * 3), False)],
        looking((0, -2, 0), (0, 0, 1e-9)),
    )
    (mask,) = masks_of(scene)[0].values()
    return bool(mask[0, 1])


def test_the_three_cases_of_the_paper():
    """The virtual ball is 6 m from the eye, the mirror 2 m: the ellipse is a circle of radius 0.167 or so."""
    assert facing_mirror([(0.1, 0, 0), (2, 0, 0), (2, 0, 2)])  # a corner in the cone
    assert facing_mirror([(-2, 0, 0.1), (2, 0, 0.1), (0, 0, 3)])  # an edge through it, both ends outside
    assert facing_mirror([(-2, 0, -1), (2, 0, -1), (0, 0, 3)])  # the ellipse within the triangle
    assert not facing_mirror([(0.2, 0, 0), (2, 0, 0), (2, 0, 2)])
    assert not facing_mirror([(-2, 0, 0.2), (2, 0, 0.2), (0, 0, 3)])
    assert not facing_mirror([(-2, 0, -1), (-1, 0, -1), (-2, 0, 3)])


def test_a_triangle_behind_the_eye_shows_nothing():
    """A cone has two halves; only the one before the eye counts."""
    ball = mesh_of(trimesh.creation.icosphere(1))
    # Mirrored in the plane y = 8, the ball at y = -20 lies at y = 36: ahead. In y = -9 it lies at y = 2: ahead too,
    # while that triangle is behind.
    corners = np.array([[(-5, 8, -5), (5, 8, -5), (0, 8, 9)], [(-5, -9, -5), (5, -9, -5), (0, -9, 9)]], float)
    scene = scene_of(
        [(soup(corners), np.eye(4), True), (ball, placed((0, -20, 0)), False)], looking((0, 0, 0), (0, 1, 1e-9))
    )
    (mask,) = masks_of(scene)[0].values()
    assert mask[:, 1].tolist() == [True, False]


def test_beyond_32_objects_there_are_more_words():
    ball, mirror = mesh_of(trimesh.creation.icosphere(1)), mesh_of(trimesh.creation.icosphere(2))
    random = np.random.default_rng(5)
    placements = [placed(3.0 * random.normal(size=3), (0.2,) * 3) for _ in range(67)]
    parts = [
        (mirror, placed(), True),
        *((ball, matrix, False) for matrix in placements),
        (mirror, placed((9, 0, 0)), True),
    ]
    scene = scene_of(parts, looking(EYE))
    masks, words = masks_of(scene)
    assert words == 3
    assert list(masks) == [0, 68]
    for index, matrix in enumerate(placements, 1):
        alone = scene_of([parts[0], (ball, matrix, False)], looking(EYE))
        assert np.array_equal(masks[0][:, index], masks_of(alone)[0][0][:, 1])


def test_what_reflections_do_not_see_is_in_no_region():
    ball = mesh_of(trimesh.creation.icosphere(2))
    scene = scene_of([(ball, placed(), True), (ball, placed((2, 0, 0)), False)], looking(EYE))
    hidden = replace(scene, instances=(scene.instances[0], replace(scene.instances[1], in_reflections=False)))
    assert masks_of(scene)[0][0][:, 1].any()
    assert not masks_of(hidden)[0][0].any()


def test_an_orthographic_camera_rules_nothing_out():
    box, tiny = mesh_of(trimesh.creation.box()), mesh_of(trimesh.creation.box((0.01, 0.01, 0.01)))
    scene = scene_of([(box, placed(), True), (tiny, placed((2, 0, 0)), False)], looking(EYE))
    assert not masks_of(scene)[0][0][:, 1].all()
    assert masks_of(scene, replace(scene.camera, ortho_scale=4.0))[0][0][:, 1].all()


@given(st.floats(0.0, 3.0), st.floats(0.2, 4.0), st.floats(-100.0, 100.0))
@settings(max_examples=20, deadline=None)
def test_bounding_spheres_hold_their_objects(turn, stretch, away):
    shape = trimesh.creation.cone(0.4, 1.0, sections=9)
    matrix = placed((away, 1, 2), (1, stretch, 1), turn, (1, 2, 3))
    sphere = bounding_spheres(scene_of([(mesh_of(shape), matrix, False)], looking(EYE)))[0].astype(float)
    points = trimesh.transform_points(shape.vertices, matrix)
    reach = np.linalg.norm(points - sphere[:3], axis=1).max()
    assert reach <= sphere[3] * (1 + 1e-4)
    assert sphere[3] <= 1.8 * np.ptp(points, axis=0).max()


def test_the_view_shows_and_counts_what_is_removed():
    """A mirror of two far halves, one before a ball and one that it cannot show in."""
    halves = [[(-8, 2, -2), (-6, 2, -2), (-7, 2, 2)], [(-1, 2, -1), (1, 2, -1), (0, 2, 2)]]
    ball = mesh_of(trimesh.creation.icosphere(2, radius=0.3))
    parts = [(soup(np.array(halves, float)), np.eye(4), True), (ball, placed((0, -1, 0)), False)]
    scene = scene_of(parts, looking((0, -6, 1), (0, 0, 0), lens=14.0))

    picture, removed = call(lambda: region_view(Resident(scene, Lighting.UNLIT), scene.camera, 96, 64))
    red, green = (picture[..., 0] > 0).sum(), (picture[..., 1] > 0).sum()
    assert removed.triangles == removed.triangle_searches == 0.5
    assert red > 30
    assert green > 30
    assert removed.fragments == removed.fragment_searches == pytest.approx(red / (red + green))
    # The half without reflections is the left one; only reflectors are painted.
    assert np.nonzero(picture[..., 0])[1].max() < np.nonzero(picture[..., 1])[1].min()
    assert (picture[..., 2] == 0).all()
