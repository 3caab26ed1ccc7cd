"""Several methods in one frame: each mirror shows what its method alone would, and nothing is baked in vain."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import Canvas
from catoptric.addon.errors import Cancelled, UsageError
from catoptric.addon.gl import call
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.layered_depth_published import LayeredDepthPublished
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.methods.techniques import TECHNIQUES
from catoptric.addon.scene import Lighting

from .stage import Judge, camera_rays, looking, mesh_of, placed, scene_of

SIZE = (96, 64)
BALL, BLOCK = "object 0", "object 1"


def stage():
    """A mirror ball and a mirror block among a box, a torus and a floor."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
    box = mesh_of(trimesh.creation.box())
    torus = mesh_of(trimesh.creation.torus(0.6, 0.2, major_sections=24, minor_sections=12))
    floor = mesh_of(trimesh.creation.box((9, 9, 0.2)))
    parts = [
        (ball, placed((-1.2, 0, 0)), True),
        (box, placed((1.3, 0.3, 0), (1.6, 0.4, 1.8), turn=0.3), True),
        (box, placed((0.2, -1.6, -0.4), (0.5, 0.5, 0.9), turn=0.4), False),
        (torus, placed((0.1, 1.2, 0.6), turn=1.0, axis=(1, 0, 0)), False),
        (floor, placed((0, 0, -1.2)), False),
    ]
    return scene_of(parts, looking((0.4, -5.5, 1.4)))


def seen(scene):
    """(H, W) index of the instance that each pixel's centre shows, by Embree."""
    return Judge(scene).meet(*camera_rays(scene.camera, *SIZE)).instance.reshape(SIZE[::-1])


def picture(method, scene, samples=1):
    return method.render(View(scene.camera, *SIZE, samples))


def alone(name, scene, settings=None, samples=1):
    method = METHODS[name](settings)
    method.prepare(scene, Lighting.UNLIT)
    try:
        return picture(method, scene, samples)
    finally:
        method.release()


@pytest.fixture
def mixed():
    made = []

    def prepare(scene, assignment):
        made.append(Mixed(assignment))
        made[-1].prepare(scene, Lighting.UNLIT)
        return made[-1]

    yield prepare
    for method in made:
        method.release()


@pytest.fixture(scope="module")
def scene():
    return stage()


@pytest.fixture(scope="module")
def frames(scene):
    """Every technique's own picture."""
    return {name: alone(name, scene) for name in TECHNIQUES}


NAMES = list(TECHNIQUES)
PAIRS = [(name, NAMES[(place + apart) % len(NAMES)]) for apart in (1, 5) for place, name in enumerate(NAMES)]
"""Each technique beside four others: what it is mixed with is all one, and all pairs would take minutes."""


@pytest.mark.parametrize("pair", PAIRS, ids=" and ".join)
def test_each_mirror_shows_what_its_method_alone_does(scene, frames, mixed, pair):
    owner = seen(scene)
    for ball, block in (pair, pair[::-1]):
        frame = picture(mixed(scene, {BALL: (ball, {}), BLOCK: (block, {})}), scene)
        for instance, name in ((0, ball), (1, block)):
            mine = owner == instance
            assert mine.sum() > 300
            np.testing.assert_array_equal(frame.color[mine], frames[name].color[mine])
            np.testing.assert_array_equal(frame.distance[mine], frames[name].distance[mine])
        others = owner > 1
        np.testing.assert_array_equal(frame.color[others], frames[ball].color[others])
        np.testing.assert_array_equal(frame.reflectors, frames[ball].reflectors)


def test_the_pictures_to_mix_differ(scene, frames):
    owner = seen(scene)
    # environment-map at rest, and what is as exact as layered-depth where nothing is rough or moves
    alike = {"environment-map-dynamic", "ray-traced", "virtual-objects", "planar", "glossy-planes", "glossy-planar"}
    alike |= {name for name, technique in TECHNIQUES.items() if technique.takes_over}
    for one, other in combinations(set(TECHNIQUES) - alike, 2):
        for instance in (0, 1):
            mine = owner == instance
            assert np.abs(frames[one].color[mine] - frames[other].color[mine]).max() > 0.5


def test_supersampled_pictures_mix_as_well(scene, mixed):
    frame = picture(mixed(scene, {BALL: ("environment-map", {})}), scene, 2)
    owner = seen(scene)
    for instance, name in ((0, "environment-map"), (1, "layered-depth")):
        single = alone(name, scene, samples=2)
        inside = (owner == instance) & (single.reflectors == 1.0)
        np.testing.assert_array_equal(frame.color[inside], single.color[inside])
    assert frame.time_ms["frame"] >= frame.time_ms["reflection"] > 0.0


def test_each_method_has_a_time_of_its_own(scene, mixed):
    method = mixed(scene, {BALL: ("environment-map", {"size": 16}), BLOCK: ("environment-map-dynamic", {})})
    times = picture(method, scene).time_ms
    shares = [times["environment-map"], times["environment-map-dynamic"]]
    assert times["reflection"] == pytest.approx(sum(shares))
    assert times["frame"] == pytest.approx(times["visibility"] + times["light"] + times["reflection"])
    assert shares[1] > 5 * shares[0] > 0.0  # it captures six pictures for this one


def test_one_method_with_two_settings_has_one_time(scene, mixed):
    method = mixed(scene, {BALL: ("environment-map", {"size": 16}), BLOCK: ("environment-map", {"size": 32})})
    assert list(picture(method, scene).time_ms) == ["visibility", "light", "reflection", "frame"]


def test_settings_are_each_reflectors_own(scene, mixed):
    coarse, fine = {"size": 16}, {"size": 128}
    method = mixed(scene, {BALL: ("environment-map", coarse), BLOCK: ("environment-map", fine)})
    frame, owner = picture(method, scene), seen(scene)
    for instance, settings in ((0, coarse), (1, fine)):
        single = alone("environment-map", scene, settings)
        np.testing.assert_array_equal(frame.color[owner == instance], single.color[owner == instance])
    assert (alone("environment-map", scene, coarse).color != alone("environment-map", scene, fine).color).any()


def test_equal_methods_are_one(scene, mixed):
    method = mixed(scene, {BALL: ("environment-map", {}), BLOCK: ("environment-map", {"size": 512})})
    assert len(method.cast(scene)) == 1


def moved(scene):
    instances = list(scene.instances)
    instances[2] = replace(instances[2], matrix=placed((-0.4, -1.4, 0.2)))
    return replace(scene, instances=tuple(instances))


def without_ball(scene):
    return replace(scene, instances=scene.instances[1:])


def with_another_mirror(scene):
    instances = list(scene.instances)
    instances[3] = replace(instances[3], reflector=True, materials=(0,))
    return replace(scene, instances=tuple(instances))


def seen_from_elsewhere(scene):
    return replace(scene, camera=looking((-3.0, -4.0, 2.0)))


@pytest.mark.parametrize("change", [moved, without_ball, with_another_mirror, seen_from_elsewhere])
def test_an_update_shows_what_a_fresh_start_shows(scene, mixed, change):
    assignment = {BALL: ("layered-depth-published", {}), BLOCK: ("environment-map", {"size": 64})}
    after = change(scene)
    method = mixed(scene, assignment)
    before = picture(method, scene).color
    method.update(after)
    fresh = picture(mixed(after, assignment), after).color
    np.testing.assert_array_equal(picture(method, after).color, fresh)
    assert np.abs(fresh - before).max() > 0.05
    method.update(scene)
    np.testing.assert_array_equal(picture(method, scene).color, before)


def test_a_change_bakes_nothing_that_stays(scene, mixed):
    method = mixed(scene, {BALL: ("environment-map", {"size": 64}), BLOCK: ("layered-depth-published", {})})
    (cubes, bakes), resident = baked(method), method._ensemble.resident
    uploaded = dict(resident._textures)
    method.assign({BALL: ("environment-map-parallax", {"size": 32}), BLOCK: ("layered-depth-published", {})})
    others, kept = baked(method)
    assert kept is bakes
    assert others is not cubes
    assert {name for name in uploaded if resident._textures[name] is not uploaded[name]} == set()
    frame, mine = picture(method, scene), seen(scene) == 0
    single = alone("environment-map-parallax", scene, {"size": 32})
    np.testing.assert_array_equal(frame.color[mine], single.color[mine])


def baked(method):
    """What each method of the mix has baked, in the order of the reflectors."""
    return [each.bakes if isinstance(each, LayeredDepthPublished) else each.cubes for each in method._ensemble._cast]


def test_an_equal_assignment_changes_nothing(scene, mixed):
    assignment = {BALL: ("environment-map", {"size": 64}), BLOCK: ("environment-map-parallax", {"size": 64})}
    method = mixed(scene, assignment)
    before = baked(method)
    method.assign({name: (technique, dict(settings)) for name, (technique, settings) in assignment.items()})
    assert [one is other for one, other in zip(before, baked(method), strict=True)] == [True, True]


def test_a_wrong_assignment_is_refused_and_the_old_one_stays(scene, mixed):
    method = mixed(scene, {BALL: ("environment-map", {"size": 64})})
    before = picture(method, scene).color
    for wrong, clue in ((("magic", {}), "auto"), (("environment-map", {"sizes": 1}), "size")):
        with pytest.raises(UsageError, match=clue):
            method.assign({BALL: wrong})
    np.testing.assert_array_equal(picture(method, scene).color, before)


def test_a_bake_that_was_stopped_is_made_up_for(scene, mixed):
    assignment = {BALL: ("environment-map", {"size": 64}), BLOCK: ("environment-map-parallax", {"size": 64})}
    wanted = picture(mixed(scene, assignment), scene).color
    method = mixed(scene, {})

    def stop(stage, fraction):
        if fraction >= 0.5:
            raise Cancelled

    with pytest.raises(Cancelled):
        method.assign(assignment, stop)
    owner, frame = seen(scene), picture(method, scene)
    np.testing.assert_array_equal(frame.color[owner == 0], wanted[owner == 0])
    assert not frame.color[owner == 1].any()
    method.update(scene)
    np.testing.assert_array_equal(picture(method, scene).color, wanted)


def test_a_reflector_that_a_method_refuses_falls_back_with_the_reason(scene, frames, mixed, monkeypatch):
    def only_balls(cls, scene, reflector, settings):
        return None if reflector.name == BALL else "it is no ball"

    monkeypatch.setattr(TECHNIQUES["environment-map"], "applies_to", classmethod(only_balls))
    method = mixed(scene, {BALL: ("environment-map", {}), BLOCK: ("environment-map", {})})
    assert method.choices[BALL].method == "environment-map"
    assert (method.choices[BLOCK].method, method.choices[BLOCK].reason) == ("layered-depth", "it is no ball")
    frame, owner = picture(method, scene), seen(scene)
    for instance, name in ((0, "environment-map"), (1, "layered-depth")):
        np.testing.assert_array_equal(frame.color[owner == instance], frames[name].color[owner == instance])


def test_a_scene_without_mirrors_is_drawn(mixed):
    bare = replace(stage(), instances=stage().instances[2:])
    frame = picture(mixed(bare, {}), bare)
    np.testing.assert_array_equal(frame.color, alone("layered-depth", bare).color)


def test_a_canvas_serves_frame_after_frame(scene, mixed):
    method = mixed(scene, {BALL: ("environment-map-dynamic", {"size": 64})})
    canvas = call(Canvas, *SIZE)
    try:
        shots = []
        for _ in range(2):
            method.paint(View(scene.camera, *SIZE, 1), canvas)
            shots.append(call(canvas.read)[0])
        np.testing.assert_array_equal(*shots)
    finally:
        call(canvas.release)
