"""The search for reflection points on the GPU against closed forms, and paths built forwards."""

from functools import cache

import numpy as np
import pytest
from catoptric.addon.methods.virtual_objects import STEPS
from hypothesis import given, settings
from hypothesis import strategies as st

from .search_stage import (
    PLACES,
    Samples,
    Search,
    alhazen,
    around,
    eye_at,
    heights,
    is_hidden,
    maps_of,
    near_tangent,
    pairs,
    reflected,
    rounded,
    sphere,
    unit,
)
from .stage import looking, placed, scene_of

TOLERANCE = 1e-4
STILL = 5e-6
"""Radii by which floats let a point tremble that stands still."""
AWAY = looking((0, -5, 0))


@cache
def ball_maps():
    """A ball of radius 1 and its maps."""
    return sphere(6), maps_of(sphere(6), 512, 2)


@cache
def the_ball():
    """The search on it."""
    mesh, maps = ball_maps()
    return Search(scene_of([(mesh, np.eye(4), True)], AWAY), {0: maps}, (1,))


def on_a_ball(eye, vertices, steps=STEPS.default, camera=None):
    """What is found there."""
    return the_ball().find(tuple(eye), vertices, steps, camera)


def on_two_balls(path, place):
    """The search on a path between it and another ball."""
    mesh, maps = ball_maps()
    return Search(scene_of([(mesh, np.eye(4), True), (mesh, placed(place), True)], AWAY), {0: maps, 1: maps}, path)


# ------------------------------------------------------------------ one reflection


@pytest.mark.parametrize("place", PLACES)
def test_reflection_points_on_a_ball_are_those_of_the_closed_form(place):
    errors = [np.linalg.norm(on_a_ball(*pair).directions - alhazen(*pair), axis=1) for pair in pairs(place, 10_000, 17)]
    errors = np.concatenate(errors)
    assert len(errors) >= 10_000
    assert errors.max() < TOLERANCE
    assert np.median(errors) < TOLERANCE / 10


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 2**32 - 1), distance=st.floats(1.02, 100.0), steps=st.integers(4, 32))
def test_every_eye_finds_what_the_closed_form_does(seed, distance, steps):
    rng = np.random.default_rng(seed)
    eye = eye_at(distance, rng)
    vertices = around(300, rng)
    vertices = vertices[~is_hidden(eye, vertices)]
    exact = alhazen(eye, vertices)
    high = heights(eye, exact) > 0.01
    error = np.linalg.norm(on_a_ball(eye, vertices, steps).directions - exact, axis=1)
    assert error[high].max(initial=0.0) < TOLERANCE


def test_four_steps_are_enough_and_more_bring_no_harm():
    rng = np.random.default_rng(3)
    eye = eye_at(3.0, rng)
    vertices = around(2000, rng)
    exact = alhazen(eye, vertices)
    plain = ~is_hidden(eye, vertices) & (heights(eye, exact) > 0.05)
    for steps in (4, 32):
        found_there = on_a_ball(eye, vertices, steps).directions
        assert np.linalg.norm(found_there - exact, axis=1)[plain].max() < TOLERANCE


def test_a_hidden_vertex_lies_where_the_straight_line_to_it_enters():
    rng = np.random.default_rng(4)
    for distance in (1.5, 4.0, np.inf):
        eye = eye_at(distance, rng)
        vertices = around(2000, rng)
        vertices = vertices[is_hidden(eye, vertices) & ((vertices @ eye[:3]) < 0)]
        seen = on_a_ball(eye, vertices)
        way = unit(vertices * eye[3] - eye[:3])
        start = eye[:3] if eye[3] else vertices - way * (vertices * way).sum(axis=1, keepdims=True) - 2 * way
        along = (way * start).sum(axis=1)
        entry = start + (-along - np.sqrt(along**2 - (start * start).sum(axis=-1) + 1))[:, None] * way
        plain = heights(eye, entry) > 0.05
        assert plain.sum() > 300
        assert (seen.lean[plain] <= 0).all()
        assert np.abs(seen.lean[plain]).max() < 1e-3
        assert np.linalg.norm(seen.directions - entry, axis=1)[plain].max() < TOLERANCE


def test_what_is_seen_has_a_lean_above_zero():
    rng = np.random.default_rng(5)
    eye = eye_at(2.5, rng)
    vertices = around(3000, rng)
    seen = ~is_hidden(eye, vertices)
    plain = heights(eye, alhazen(eye, vertices)) > 0.01
    assert (on_a_ball(eye, vertices).lean[seen & plain] >= 0).all()


def test_a_result_lies_on_the_screen_where_the_camera_sees_it():
    rng = np.random.default_rng(12)
    camera = looking((1.0, -3.0, 2.0), (0.3, 0.0, 0.0))
    eye = np.append(camera.position, 1.0)
    vertices = around(1000, rng)
    seen = on_a_ball(eye, vertices, camera=camera)
    assert np.abs(seen.pixels - projected(camera, seen.directions)).max() < 0.02


def test_a_coarse_map_is_round_between_its_texels():
    rng = np.random.default_rng(13)
    coarse = Search(scene_of([(sphere(6), np.eye(4), True)], AWAY), {0: maps_of(sphere(6), 32, 1)}, (1,))
    eye = eye_at(3.0, rng)
    vertices = around(2000, rng)
    exact = alhazen(eye, vertices)
    plain = ~is_hidden(eye, vertices) & (heights(eye, exact) > 0.1) & (np.linalg.norm(vertices - exact, axis=1) > 0.05)
    errors = np.linalg.norm(coarse.find(eye, vertices, STEPS.default).directions - exact, axis=1)[plain]
    assert errors.max() < 5 * TOLERANCE


@pytest.mark.parametrize("scale", [(1.0, 0.5, 0.8), (3.0, 1.0, 1.0), (-1.0, 1.5, 0.7)])
@pytest.mark.parametrize("distance", [1.5, 6.0])
def test_an_ellipsoid_reflects_what_a_path_built_forwards_reaches(scale, distance):
    rng = np.random.default_rng(6)
    matrix = placed((0.3, -0.2, 0.5), scale, 0.7, (1, 2, 3))
    centre, axes = matrix[:3, 3], matrix[:3, :3]
    eye = np.append(centre + axes @ (unit(rng.normal(size=3)) * distance), 1.0)
    inside = unit(rng.normal(size=(4000, 3)))
    points, normals = inside @ axes.T + centre, unit(inside @ np.linalg.inv(axes))
    low = (unit(eye[:3] - points) * normals).sum(axis=1)
    inside, points, normals = (part[low > 0.02] for part in (inside, points, normals))
    vertices = points + reflected(eye, points, normals) * 10 ** rng.uniform(-2, 2, size=(len(points), 1))
    mesh, maps = ball_maps()
    search = Search(scene_of([(mesh, matrix, True)], AWAY), {0: maps}, (1,))
    seen = search.find(tuple(eye), vertices, STEPS.default)
    assert len(points) > 200
    assert (seen.lean >= 0).all()
    error = np.linalg.norm(seen.directions - inside, axis=1)
    assert (error > TOLERANCE).mean() < 0.001
    assert np.median(error) < TOLERANCE / 10


# ------------------------------------------------------------------ two reflections


def test_two_balls_reflect_what_a_path_built_forwards_reaches():
    rng = np.random.default_rng(7)
    second = np.array([2.6, 0.4, 0.3])
    eye = np.array([0.8, -4.0, 1.0, 1.0])
    first = unit(rng.normal(size=(200_000, 3)))
    first = first[heights(eye, first) > 0.05]
    way = reflected(eye, first, first)
    from_second = first - second
    along = (way * from_second).sum(axis=1)
    inner = along**2 - (from_second**2).sum(axis=1) + 1
    meets = (inner > 0) & (along < 0)
    first, way, met = first[meets], way[meets], -along[meets] - np.sqrt(inner[meets])
    at = first + met[:, None] * way
    normal = at - second
    high = -(way * normal).sum(axis=1) > 0.05
    first, at, normal, way = first[high], at[high], normal[high], way[high]
    onwards = way - 2 * (way * normal).sum(axis=1, keepdims=True) * normal
    vertices = at + onwards * 10 ** rng.uniform(-1, 2, size=(len(at), 1))
    chosen = np.linspace(0, len(at) - 1, 16).astype(int)
    samples = Samples(at[chosen], onwards[chosen], (first[chosen], normal[chosen]))
    for steps, most in ((4, 0.01), (STEPS.default, 0.001)):
        seen = on_two_balls((1, 2), second).find(eye, vertices, steps, samples=samples)
        error = np.linalg.norm(seen.directions - first, axis=1)
        assert len(error) > 1000
        assert np.median(error) < TOLERANCE / 10
        assert (error > TOLERANCE).mean() < most


# ------------------------------------------------------------------ it always ends


@pytest.mark.parametrize(
    "eye", [(0, 0, 3, 1), (0, 0, 1, 1), (0, 0, 0.5, 1), (0, 0, 0, 1), (0, 0, 1, 0), (1, 1, 1e6, 1)]
)
@pytest.mark.parametrize("path", [(1,), (1, 2)])
def test_the_search_ends_with_numbers_wherever_eye_and_vertex_are(eye, path):
    rng = np.random.default_rng(8)
    search = on_two_balls(path, (2.6, 0, 0))
    special = [
        eye[:3],
        (0, 0, 0),
        (0, 0, 1),
        (0, 0, -1),
        (1, 0, 0),
        (2.6, 0, 0),
        (0, 0, -3),
        (1e30, 0, 0),
        (0, 1e-30, 0),
    ]
    vertices = np.concatenate([special, unit(rng.normal(size=(100, 3))), rng.normal(size=(200, 3)) * 0.3])
    for steps in (1, 6, 32):
        starts = unit(rng.normal(size=(2, 16, 3)))
        samples = Samples(starts[0], starts[1], starts) if len(path) == 2 else None
        seen = search.find(eye, vertices, steps, samples=samples)
        assert np.isfinite(seen.directions).all()
        assert not np.isnan(seen.lean).any()
        assert np.allclose(np.linalg.norm(seen.directions, axis=1), 1, atol=1e-5)


# ------------------------------------------------------------------ no flicker


@pytest.mark.parametrize("distance", [1.3, 4.0])
def test_nothing_jumps_when_the_camera_goes_round(distance):
    rng = np.random.default_rng(9)
    angles = np.linspace(0.0, np.pi / 2, 60)
    arc = distance * unit(np.stack([np.cos(angles), np.sin(angles), np.full(60, 0.4)], axis=1))
    grazing = [near_tangent(np.append(position, 1.0), 50, rng, 0.001) for position in arc[::5]]
    vertices = np.concatenate([around(1500, rng), *grazing])
    places, shown, exact, exact_shown = [], [], [], []
    for position in arc:
        camera, eye = looking(position), rounded(np.append(position, 1.0))
        seen = on_a_ball(eye, vertices, camera=camera)
        places.append(seen.directions)
        shown.append(seen.pixels)
        exact.append(alhazen(eye, vertices))
        exact_shown.append(projected(camera, exact[-1]))
    pixels = 512 * 50 / 36 / (distance - 1)  # a metre, at the ball's nearest
    for values, wanted, scale in ((places, exact, 1.0), (shown, exact_shown, pixels)):
        change = np.linalg.norm(np.diff(values, axis=0), axis=2)
        expected = np.linalg.norm(np.diff(wanted, axis=0), axis=2)
        assert (change <= 2 * expected + 2 * STILL * scale).all()


def projected(camera, points, size=512):
    """Pixels from the middle of a square picture."""
    local = (points - camera.position) @ camera.matrix[:3, :3]
    left, right, _, _ = camera.window(size, size)
    return local[:, :2] / -local[:, 2:] / (right - left) * size
