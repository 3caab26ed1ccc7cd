"""Pictures made of earlier ones: as if they were traced, whatever has changed in between."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from catoptric.addon.methods.reprojection import Reprojection, moved_since
from catoptric.addon.methods.tracers import TRACER
from catoptric.addon.scene import Lighting

from .reprojection_stage import EYE, SIZE, filming, is_right, pillars, seen_from, stage, with_placed


@pytest.fixture
def film():
    with filming() as begin:
        yield partial(begin, method=Reprojection)


@pytest.mark.parametrize("tracer", TRACER.choices)
def test_a_moving_camera_sees_what_is_there_and_little_is_traced(film, tracer):
    taken = film(stage(), settings={"tracer": tracer})
    for number in range(6):
        frame, off = taken.show(seen_from(taken.scene, (0.5 + 0.02 * number, -4.5 + 0.03 * number, 1.0)))
        assert is_right(off)
        assert frame.reuse.is_key == (number == 0)
        assert frame.reuse.share == 1.0 if number == 0 else frame.reuse.share < 0.15


def test_what_was_traced_is_told_pixel_by_pixel(film):
    taken = film(stage())
    taken.show(taken.scene)
    frame, _ = taken.show(seen_from(taken.scene, (0.6, -4.4, 1.0)))
    mirrors = frame.reflectors > 0
    assert frame.reuse.retraced.shape == mirrors.shape
    assert not (frame.reuse.retraced & ~mirrors).any()
    assert frame.reuse.share == pytest.approx(frame.reuse.retraced.sum() / mirrors.sum())
    assert 0.0 < frame.reuse.share < 0.3


@pytest.mark.parametrize("samples", [2, 3])
def test_samples_that_find_no_room_are_traced(film, samples):
    """Room for two of them; what is kept is right, and so is the rest."""
    room = 2 * 2 * 48 * SIZE[0] * SIZE[1] / 2**20
    taken = film(stage(), settings={"memory": math.ceil(room)}, samples=samples)
    for eye in (EYE, (0.55, -4.45, 1.0)):
        frame, off = taken.show(seen_from(taken.scene, eye))
        assert is_right(off)
    assert not frame.reuse.is_key  # the sample in the middle of the pixels is kept
    (history,) = taken.taken._histories.values()
    assert len(history._keys) < 5


@pytest.mark.parametrize("samples", [1, 2])
def test_a_still_camera_repeats_the_key_frame_bit_by_bit(film, samples):
    taken = film(stage(), samples=samples)
    first, _ = taken.show(taken.scene)
    second, _ = taken.show(replace(taken.scene, frame=2))
    assert [one.reuse.is_key for one in (first, second)] == [True, False]
    assert second.reuse.share == 0.0
    assert np.array_equal(first.color, second.color)
    assert np.array_equal(first.distance, second.distance, equal_nan=True)


def test_a_cut_is_right_at_once(film):
    taken = film(stage())
    taken.show(taken.scene)
    frame, off = taken.show(seen_from(taken.scene, (-4.0, 1.0, 2.5)))
    assert frame.reuse.is_key
    assert is_right(off)


def test_another_size_is_right_at_once(film):
    taken = film(stage())
    taken.show(taken.scene)
    taken.size = (90, 120)
    frame, off = taken.show(taken.scene)
    assert frame.color.shape == (120, 90, 3)
    assert is_right(off)


@pytest.mark.parametrize("index", [0, 2], ids=["a mirror", "a thing"])
@pytest.mark.parametrize("far", [0.05, 1.5], ids=["moved", "teleported"])
def test_an_object_that_moves_is_right_at_once(film, index, far):
    scene = stage()
    taken = film(scene)
    taken.show(scene)
    matrix = scene.instances[index].matrix.copy()
    matrix[:3, 3] += far * np.array([0.6, -0.5, 0.6])
    moved = with_placed(scene, index, matrix)
    assert moved_since(scene, moved) == [index]
    for eye in (EYE, (0.53, -4.48, 1.0)):
        _, off = taken.show(seen_from(moved, eye))
        assert is_right(off)


def test_an_object_that_was_hidden_begins_a_key_frame(film):
    scene = stage()
    taken = film(scene)
    instances = [replace(one, in_reflections=number != 2) for number, one in enumerate(scene.instances)]
    taken.show(replace(scene, instances=tuple(instances)))
    frame, off = taken.show(scene)
    assert frame.reuse.is_key
    assert is_right(off)


def test_what_emerges_behind_a_pillar_is_noticed(film):
    scene = pillars()
    wrong = {}
    for checks in (0, 64):
        taken = film(scene, settings={"checks": checks}, size=(320, 60))
        taken.show(scene)
        frame, off = taken.show(seen_from(scene, (0.45, -1.0, 0.0), (0.45, 0.0, 0.0)))
        assert not frame.reuse.is_key
        wrong[checks] = np.sum(off > 1e-3)
    assert wrong[0] > 500
    assert wrong[64] < 20


def test_a_schedule_begins_key_frames(film):
    taken = film(stage(), settings={"schedule": 3})
    keys = [taken.show(seen_from(taken.scene, (0.5 + 0.01 * n, -4.5, 1.0)))[0].reuse.is_key for n in range(8)]
    assert keys == [True, False, False, False, True, False, False, False]


def test_a_threshold_of_nothing_traces_everything(film):
    taken = film(stage(), settings={"threshold": 0.0})
    taken.show(taken.scene)
    frame, _ = taken.show(seen_from(taken.scene, (0.6, -4.5, 1.0)))
    assert frame.reuse.is_key


def test_light_that_changes_is_looked_up_anew(film):
    scene = stage()
    taken = film(scene, lighting=Lighting.DIRECT)
    taken.show(scene)
    brighter = replace(scene, world=replace(scene.world, color=(0.9, 0.1, 0.4)))
    _, off = taken.show(brighter)
    assert is_right(off)
