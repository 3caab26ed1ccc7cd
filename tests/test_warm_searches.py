"""Searches that begin where those of the last frame ended."""

import numpy as np
import pytest
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.virtual import results
from catoptric.addon.methods.virtual.bundles import Bundle, Run, may_meet
from catoptric.addon.methods.virtual.results import pieces
from catoptric.addon.methods.virtual_objects import VirtualObjects
from catoptric.addon.scene import Lighting
from hypothesis import given
from hypothesis import strategies as st

from .mirror_stage import differing, truth
from .search_stage import Found, Search, maps_of, sphere
from .stage import looking, placed, scene_of
from .test_virtual_objects import ALONE, SIZE, stages

STRETCHED = placed(scale=(1.0, 0.35, 0.7), turn=0.4)
EYE, MOVED = np.array([0.3, -5.0, 1.5, 1.0]), np.array([0.33, -4.98, 1.52, 1.0])


@pytest.fixture(scope="module")
def stretched():
    """A search on an ellipsoid, which a ball is only a rough guess of, and what surrounds it."""
    scene = scene_of([(sphere(5), STRETCHED, True)], looking(EYE[:3], lens=40))
    rng = np.random.default_rng(8)
    ways = rng.normal(size=(3000, 3))
    points = ways / np.linalg.norm(ways, axis=1, keepdims=True) * rng.uniform(1.3, 8.0, (3000, 1))
    return Search(scene, {0: maps_of(sphere(5), 256, 1)}, (1,)), points


def farthest(search, points, right, steps, before=None):
    """Pixels that the search is off after so many steps: 99 of 100 vertices are nearer."""
    found = search.find(tuple(MOVED), points[right], steps, before=before)
    return np.quantile(np.linalg.norm(found.pixels - exact(search, points)[right], axis=1), 0.99)


def exact(search, points):
    return search.find(tuple(MOVED), points, 32).pixels


def found_by(search, eye, points):
    """What is reflected, and where it was found."""
    found = search.find(tuple(eye), points, 32)
    right = (found.lean >= 0.0) & (found.lean < 1e-3)
    return right, Found(found.directions[right], found.lean[right], found.pixels[right])


def test_one_step_is_enough_after_a_small_move(stretched):
    search, points = stretched
    right, before = found_by(search, EYE, points)
    assert right.sum() > 1000
    assert farthest(search, points, right, 1, before) < 1.0
    assert farthest(search, points, right, 1) > 3.0


def test_after_a_long_way_it_ends_where_it_would_have_anyway(stretched):
    search, points = stretched
    right, before = found_by(search, (-4.0, 3.0, -1.0, 1.0), points)
    warm, cold = (search.find(tuple(MOVED), points[right], 6, before=one) for one in (before, None))
    there = (cold.lean >= 0.0) & (cold.lean < 1e-3)
    assert there.sum() > 300
    assert np.abs(warm.directions - cold.directions)[there].max() < 1e-3


def paint(scene, cameras, settings=ALONE):
    """The pictures of one canvas, by camera, one after the other."""
    drawn = VirtualObjects(settings)
    drawn.prepare(scene, Lighting.UNLIT)

    def all_of_them():
        canvas = Canvas(*SIZE)
        pictures = []
        for camera in cameras:
            drawn.paint(View(camera, *SIZE, 1), canvas)
            pictures.append(canvas.read()[0])
        canvas.release()
        return pictures

    try:
        return call(all_of_them)
    finally:
        drawn.release()


def wrong(scene, picture):
    """The share of a mirror's pixels that Embree sees otherwise."""
    expected = truth(scene, SIZE, 2)
    mirrors = ~np.isnan(expected.distance) & ~expected.grazing
    assert mirrors.sum() > 2000
    return differing(picture, expected.color)[mirrors].mean()


def around(angle):
    return looking((3.75 * np.sin(angle), -3.75 * np.cos(angle), 1.9), (0.0, 0.0, 0.0), lens=45)


def stage(name):
    return scene_of(stages()[name][0], around(0.3), bounces=1, world=(0.0, 0.0, 0.7))


@pytest.mark.parametrize("name", ["torus", "shell"])
def test_pictures_on_the_way_are_as_right_as_others(name):
    scene = stage(name)
    assert wrong(scene, paint(scene, [around(angle) for angle in (0.26, 0.28, 0.3)])[-1]) <= stages()[name][1]


@pytest.mark.parametrize("name", ["ball", "shell"])
def test_after_a_cut_everything_is_as_if_it_were_the_first_picture(name):
    scene = stage(name)
    cut = paint(scene, [around(2.6), around(0.3)])[-1]
    np.testing.assert_array_equal(cut, paint(scene, [around(0.3)])[-1])


@pytest.mark.parametrize("name", ["ball", "shell"])
def test_even_if_a_cut_went_unnoticed(name, monkeypatch):
    monkeypatch.setattr(results, "_LIKE", np.inf)
    scene = stage(name)
    picture = paint(scene, [around(2.6), around(0.3)])[-1]
    assert wrong(scene, picture) <= stages()[name][1]


def test_a_ball_that_comes_nearer_is_the_same_mirror_and_one_elsewhere_is_not():
    def bundle(centre, axis=(0.0, 0.0, 1.0)):
        way = np.array(axis) / np.linalg.norm(axis)
        return Bundle((1,), np.array(centre), 1.0, way, 0.8, (0, 0, 1, 1), 1, np.zeros((16, 2, 3)), ())

    here = bundle((0.0, 0.0, 0.0))
    assert bundle((0.2, 0.0, 0.0), (0.1, 0.0, 1.0)).is_near(here, 0.25)
    assert not bundle((0.3, 0.0, 0.0)).is_near(here, 0.25)
    assert not bundle((0.0, 0.0, 0.0), (0.3, 0.0, 1.0)).is_near(here, 0.25)


def test_balls_are_met_where_angles_say_so():
    rng = np.random.default_rng(2)
    centres, radii = rng.normal(size=(4000, 3)) * 3.0, rng.uniform(0.0, 2.0, 4000)
    for spread in (0.02, 0.5, 1.4, 1.7, 2.5, 3.1, 3.2):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        away = np.linalg.norm(centres - 0.1, axis=1)
        off = np.arccos(np.clip((centres - 0.1) @ axis / away, -1.0, 1.0))
        met = (away <= radii + 0.3) | (off <= spread + np.arcsin(np.clip((radii + 0.3) / away, 0.0, 1.0)))
        rays = np.full(3, 0.1), np.array(0.3), axis, np.array(spread)
        np.testing.assert_array_equal(may_meet(*rays, centres, radii), met)
        by_row = [np.repeat(part[None], 4000, axis=0) for part in rays]
        np.testing.assert_array_equal(may_meet(*by_row, centres, radii), met)


spans = st.lists(st.integers(0, 40), max_size=8, unique=True).map(
    lambda ends: [Run(None, *pair, 100 * pair[0]) for pair in zip(sorted(ends)[::2], sorted(ends)[1::2], strict=False)]
)


@given(st.integers(0, 40), st.integers(1, 20), spans)
def test_pieces_are_all_of_a_run_each_in_one_that_was_before(first, length, before):
    found = list(pieces(Run(None, first, first + length, 0), before))
    owner = {chunk: run for run in before for chunk in range(run.first, run.end)}
    covered = [(chunk, run) for begin, end, run in found for chunk in range(begin, end)]
    assert covered == [(chunk, owner.get(chunk)) for chunk in range(first, first + length)]
    assert all(begin < end for begin, end, _ in found)
