"""Pictures made of earlier ones: as if they were traced, whatever has changed in between."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.ray_traced import RayTraced
from catoptric.addon.methods.reprojection import Reprojection, moved_since
from catoptric.addon.methods.tracers import TRACER
from catoptric.addon.scene import Lighting

from .stage import looking, mesh_of, placed, scene_of

SIZE = (160, 100)
EYE = (0.5, -4.5, 1.0)
SKY = (0.1, 0.3, 0.8)


def stage(eye=EYE):
    """A mirror ball and a wall mirror over a floor, a box and a torus between them."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True)
    box = mesh_of(trimesh.creation.box())
    torus = mesh_of(trimesh.creation.torus(0.7, 0.25, major_sections=48, minor_sections=24), smooth=True)
    floor = mesh_of(trimesh.creation.box((9, 9, 0.2)))
    pane = mesh_of(trimesh.creation.box((5, 0.1, 3)))
    parts = [
        (ball, placed(), True),
        (pane, placed((0, 3.0, 0.5)), True),
        (box, placed((1.9, 0.4, -0.5)), False),
        (torus, placed((-1.9, 0.0, 0.0), turn=0.7, axis=(1, 0, 0)), False),
        (floor, placed((0, 0, -1.2)), False),
    ]
    return scene_of(parts, looking(eye, (0.0, 0.5, 0.0)), world=SKY)


def seen_from(scene, eye, target=(0.0, 0.5, 0.0)):
    return replace(scene, camera=looking(eye, target))


def with_placed(scene, index, matrix):
    instances = list(scene.instances)
    instances[index] = replace(instances[index], matrix=matrix)
    return replace(scene, instances=tuple(instances))


class Film:
    """One method and the truth, picture by picture."""

    def __init__(self, scene, method=Reprojection, settings=None, size=SIZE, samples=1, lighting=Lighting.UNLIT):
        self.size, self.samples = size, samples
        self.taken, self.truth = method(settings), RayTraced()
        for one in (self.taken, self.truth):
            one.prepare(scene, lighting)

    def show(self, scene):
        """The method's frame of a scene, and how much each reflector's pixel (N,) is off the traced one."""
        view = View(scene.camera, *self.size, self.samples)
        for one in (self.taken, self.truth):
            one.update(scene)
        frame, truth = self.taken.render(view), self.truth.render(view)
        return frame, np.abs(frame.color - truth.color).max(axis=-1)[truth.reflectors > 0]

    def close(self):
        for one in (self.taken, self.truth):
            one.release()


@pytest.fixture
def film():
    opened = []

    def begin(scene, **given):
        opened.append(Film(scene, **given))
        return opened[-1]

    yield begin
    for one in opened:
        one.close()


def is_right(off) -> bool:
    return np.mean(off > 1e-3) < 0.005


@pytest.mark.parametrize("tracer", TRACER.choices)
def test_a_moving_camera_sees_what_is_there_and_little_is_traced(film, tracer):
    taken = film(stage(), settings={"tracer": tracer})
    for number in range(6):
        frame, off = taken.show(seen_from(stage_once(taken), (0.5 + 0.02 * number, -4.5 + 0.03 * number, 1.0)))
        assert is_right(off)
        assert frame.reuse.is_key == (number == 0)
        assert frame.reuse.share == 1.0 if number == 0 else frame.reuse.share < 0.15


def stage_once(film):
    """The film's own scene, so that its meshes stay the same objects."""
    return film.taken._ensemble.resident.scene


def test_what_was_traced_is_told_pixel_by_pixel(film):
    taken = film(stage())
    taken.show(stage_once(taken))
    frame, _ = taken.show(seen_from(stage_once(taken), (0.6, -4.4, 1.0)))
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
        frame, off = taken.show(seen_from(stage_once(taken), eye))
        assert is_right(off)
    assert not frame.reuse.is_key  # the sample in the middle of the pixels is kept
    (history,) = taken.taken._histories.values()
    assert len(history._keys) < 5


@pytest.mark.parametrize("samples", [1, 2])
def test_a_still_camera_repeats_the_key_frame_bit_by_bit(film, samples):
    taken = film(stage(), samples=samples)
    first, _ = taken.show(stage_once(taken))
    second, _ = taken.show(replace(stage_once(taken), frame=2))
    assert [one.reuse.is_key for one in (first, second)] == [True, False]
    assert second.reuse.share == 0.0
    assert np.array_equal(first.color, second.color)
    assert np.array_equal(first.distance, second.distance, equal_nan=True)


def test_a_cut_is_right_at_once(film):
    taken = film(stage())
    taken.show(stage_once(taken))
    frame, off = taken.show(seen_from(stage_once(taken), (-4.0, 1.0, 2.5)))
    assert frame.reuse.is_key
    assert is_right(off)


def test_another_size_is_right_at_once(film):
    taken = film(stage())
    taken.show(stage_once(taken))
    taken.size = (90, 120)
    frame, off = taken.show(stage_once(taken))
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


def pillars():
    """A mirror on the wall, and before it a thin pillar that hides a farther one, as in figure 9 of the paper.

    Seen in the mirror from x = 0: both pillars stand on the way of one ray from the camera's image.
    """
    pane = mesh_of(trimesh.creation.box((12, 0.1, 6)))
    pillar = mesh_of(trimesh.creation.box((1, 1, 6)))
    wall = mesh_of(trimesh.creation.box((40, 0.1, 12)))
    parts = [
        (pane, placed((0, 0, 0)), True),
        (pillar, placed((0.0, -2.0, 0), (0.10, 0.02, 1)), False),
        (pillar, placed((0.0, -4.0, 0), (0.08, 0.02, 1)), False),
        (wall, placed((0, -12.0, 0)), False),
    ]
    # The camera sees the mirror, and stands far enough to the side not to be hidden by the pillars itself.
    return scene_of(parts, looking((0.0, -1.0, 0.0), (0.0, 0.0, 0.0), lens=20.0), bounces=0)


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
    keys = [taken.show(seen_from(stage_once(taken), (0.5 + 0.01 * n, -4.5, 1.0)))[0].reuse.is_key for n in range(8)]
    assert keys == [True, False, False, False, True, False, False, False]


def test_a_threshold_of_nothing_traces_everything(film):
    taken = film(stage(), settings={"threshold": 0.0})
    taken.show(stage_once(taken))
    frame, _ = taken.show(seen_from(stage_once(taken), (0.6, -4.5, 1.0)))
    assert frame.reuse.is_key


def test_light_that_changes_is_looked_up_anew(film):
    scene = stage()
    taken = film(scene, lighting=Lighting.DIRECT)
    taken.show(scene)
    brighter = replace(scene, world=replace(scene.world, color=(0.9, 0.1, 0.4)))
    _, off = taken.show(brighter)
    assert is_right(off)
