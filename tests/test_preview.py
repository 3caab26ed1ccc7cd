"""The preview's parts: a camera that flies, its paths, what lies under the cursor, pictures and films."""

import json
from dataclasses import replace
from math import pi, radians

import av
import numpy as np
import pytest
import trimesh
from catoptric.addon.errors import Cancelled, UsageError
from catoptric.addon.gl import call
from catoptric.batch.preview.camera import STEEPEST, Flight, Pose
from catoptric.batch.preview.darkroom import film, photograph
from catoptric.batch.preview.hits import Looker
from catoptric.batch.preview.look import Look
from catoptric.batch.preview.path import CameraPath, Recorder
from catoptric.batch.preview.prepared import Prepared
from hypothesis import given, settings
from hypothesis import strategies as st

from .preview_stage import SIZE, choice, path_of, rendered, stage
from .stage import Judge, camera_rays, looking, mirrored

angles = st.floats(-4 * pi, 4 * pi)
pitches = st.floats(-STEEPEST, STEEPEST)
coordinates = st.tuples(*[st.floats(-1e3, 1e3)] * 3).map(np.array)
wishes = st.tuples(*[st.sampled_from([-1.0, 0.0, 1.0])] * 3).map(np.array)


# The camera


@given(coordinates, angles, pitches, st.lists(st.tuples(angles, angles), max_size=5))
def test_a_camera_never_rolls(position, yaw, pitch, turns):
    pose = Pose(position, yaw, pitch)
    for turn in turns:
        pose = pose.turned(*turn)
    right, up, back = pose.matrix[:3, :3].T
    assert right[2] == 0.0
    assert up[2] > 0.0
    np.testing.assert_allclose(pose.matrix[:3, :3].T @ pose.matrix[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.cross(right, up), back, atol=1e-12)


@given(coordinates, angles, pitches)
def test_a_pose_is_found_again_in_its_matrix(position, yaw, pitch):
    matrix = Pose(position, yaw, pitch).matrix
    np.testing.assert_allclose(Pose.of(matrix).matrix, matrix, atol=1e-9)


def test_a_pose_looks_where_a_rolled_camera_does():
    matrix = looking((1.0, -2.0, 3.0)).matrix
    rolled = matrix @ trimesh.transformations.rotation_matrix(0.7, (0, 0, 1))
    np.testing.assert_allclose(Pose.of(rolled).matrix, matrix, atol=1e-9)


@given(wishes, st.floats(0.01, 100.0), st.lists(st.floats(1e-4, 0.25), min_size=1, max_size=30))
def test_a_flight_is_the_same_at_any_frame_rate(wish, speed, steps):
    one, many = (Flight(Pose(np.zeros(3), 0.3, -0.2)) for _ in range(2))
    one.step(wish, speed, sum(steps))
    for step in steps:
        many.step(wish, speed, step)
    np.testing.assert_allclose(many.pose.position, one.pose.position, atol=1e-9 * speed)


@given(wishes.filter(np.any), st.floats(0.01, 100.0))
def test_a_flight_reaches_its_speed_and_rests_again(wish, speed):
    flight = Flight(Pose(np.zeros(3), 1.0, 0.0))
    flight.step(wish, speed, 10.0)
    before = flight.pose.position
    flight.step(wish, speed, 1.0)
    assert np.linalg.norm(flight.pose.position - before) == pytest.approx(speed, rel=1e-6)
    flight.step(np.zeros(3), speed, 2.0)
    assert not flight.is_moving


# Paths


times = st.lists(st.floats(0.01, 2.0), min_size=1, max_size=8).map(lambda steps: np.cumsum([0.0, *steps]))


@given(times, coordinates, coordinates)
def test_a_path_goes_through_its_keys_and_straight_between_those_in_line(times, start, velocity):
    keys = np.zeros((len(times), 5))
    keys[:, :3] = start + times[:, None] * velocity
    path = CameraPath(times, keys)
    for seconds in [*times, *(times[1:] + times[:-1]) / 2]:
        np.testing.assert_allclose(path.at(seconds).position, start + seconds * velocity, atol=1e-6)


def test_a_path_is_smooth_at_its_keys_and_rests_at_its_ends():
    path = path_of([(0, 0, 0, 0, 0, 0), (1, 1, 2, 0, 0.5, 0), (3, 0, 3, 1, 0.2, 0.3), (4, 5, 3, 1, 0.1, 0.1)])
    step = 1e-5
    for seconds in (1.0, 3.0):
        before, at, after = (path.at(seconds + shift).position for shift in (-step, 0.0, step))
        np.testing.assert_allclose((at - before) / step, (after - at) / step, atol=1e-3)
    np.testing.assert_array_equal(path.at(-5.0).position, [0, 0, 0])
    np.testing.assert_array_equal(path.at(99.0).position, [5, 3, 1])


def test_a_recorder_takes_down_what_was_flown(tmp_path):
    recorder = Recorder()
    for frame in range(401):  # four seconds at 100 frames a second
        seconds = frame / 100
        recorder.add(7.0 + seconds, Pose(np.array([seconds, 0, 1]), 0.1 * seconds, 0.2), last=frame == 400)
    path = recorder.path()
    assert path.duration == pytest.approx(4.0)
    assert 90 <= len(path.times) <= 121
    path.save(tmp_path / "flight.path.json")
    read = CameraPath.load(tmp_path / "flight.path.json")
    for seconds in (0.0, 1.234, 4.0):
        pose = read.at(seconds)
        np.testing.assert_allclose(pose.position, [seconds, 0, 1], atol=1e-3)
        assert (pose.yaw, pose.pitch) == (pytest.approx(0.1 * seconds, abs=1e-4), pytest.approx(0.2, abs=1e-4))


KEY = {"time": 0.0, "position": [0, 0, 0], "yaw": 0, "pitch": 0}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "no camera path"),
        ("[]", "schema"),
        ('{"schema": 1, "keys": 3}', "no camera path"),
        (json.dumps({"schema": 1, "keys": [KEY]}), "two keys"),
        (json.dumps({"schema": 1, "keys": [KEY, KEY]}), "grow"),
        (json.dumps({"schema": 1, "keys": [KEY, {**KEY, "time": 1e9}]}), "an hour"),
        (json.dumps({"schema": 1, "keys": [KEY, {**KEY, "time": 1, "yaw": "left"}]}), "no camera path"),
        (json.dumps({"schema": 1, "keys": [KEY, {**KEY, "time": 1, "position": [1, 2]}]}), "no camera path"),
        (json.dumps({"schema": 1, "keys": [KEY, {"time": 1}]}), "lacks 'position'"),
        (json.dumps({"schema": 1, "keys": [KEY, {**KEY, "time": 1, "pitch": float("nan")}]}), "3 numbers"),
    ],
)
def test_a_damaged_path_is_told_in_one_line(tmp_path, text, says):
    (tmp_path / "bad.path.json").write_text(text)
    with pytest.raises(UsageError, match=says) as caught:
        CameraPath.load(tmp_path / "bad.path.json")
    assert "\n" not in str(caught.value)


def test_the_degrees_of_a_path_are_those_of_its_poses(tmp_path):
    path = tmp_path / "turn.path.json"
    keys = [KEY, {"time": 2, "position": [0, 0, 0], "yaw": 90, "pitch": -30}]
    path.write_text(json.dumps({"schema": 1, "keys": keys}))
    forward = -CameraPath.load(path).at(2.0).matrix[:3, 2]
    np.testing.assert_allclose(forward, [-np.cos(radians(30)), 0, -0.5], atol=1e-12)


# What lies under the cursor


@settings(max_examples=60, deadline=None, derandomize=True)  # on an edge either may be right
@given(st.integers(0, SIZE[0] * SIZE[1] - 1), angles, st.floats(-0.6, 0.4))
def test_what_lies_under_the_cursor_is_what_embree_finds(pixel, turn, height):
    scene = stage()
    camera = looking((5 * np.sin(turn), -5 * np.cos(turn), 2 + height))
    row, column = divmod(pixel, SIZE[0])
    sight = Looker(scene).look(camera, SIZE, (column + 0.5, row + 0.5))
    origins, directions = (rays[pixel : pixel + 1] for rays in camera_rays(camera, *SIZE))
    judge = Judge(scene)
    first = judge.meet(origins, directions)
    names = {-1: None, **{index: instance.name for index, instance in enumerate(scene.instances)}}
    assert sight.name == names[first.instance[0]]
    assert sight.reflects == (first.instance[0] == 0)
    if sight.name:
        assert sight.distance == pytest.approx(first.distance[0], rel=1e-4)
    if sight.reflects:
        second = judge.meet(*mirrored(first, directions))
        assert sight.mirrored == names[second.instance[0]]
        assert sight.path == pytest.approx(second.distance[0], rel=1e-3, abs=1e-3)


# Pictures and films


def test_a_picture_is_the_methods_own_and_the_split_view_has_two():
    scene = stage()
    look = Look(choice("layered-depth"), choice("environment-map"), split=0.25)
    prepared = Prepared(scene)

    def take():
        methods = [prepared.get(each, lambda stage, fraction: None) for each in look.choices]
        return photograph(methods, look, scene.camera, SIZE)

    picture = call(take).astype(int)
    call(prepared.release)
    line = SIZE[0] // 4
    for name, columns in (("layered-depth", slice(0, line - 1)), ("environment-map", slice(line + 1, None))):
        alone = rendered(scene, scene.camera, name, 4)
        assert np.abs(picture[:, columns] - alone[:, columns]).max() <= 1
    assert (picture[:, line - 1 : line + 1] == 255).all()


FLOWN = path_of([(0, 0.5, -4.5, 1.0, 0.1, -0.2), (0.5, 0.0, -4.0, 1.2, 0.0, -0.2), (0.9, -0.5, -4.0, 1.0, -0.1, -0.1)])


def test_a_film_has_every_picture_of_the_flight(tmp_path):
    scene, out = stage(), tmp_path / "flight.mp4"
    prepared = Prepared(scene)
    odd = (SIZE[0] + 1, SIZE[1] + 1)
    assert film(prepared, Look(choice("layered-depth")), scene.camera, FLOWN, odd, 10, out) == 10
    call(prepared.release)
    with av.open(str(out)) as file:
        assert file.streams.video[0].average_rate == 10
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in file.decode(video=0)]
    assert [picture.shape for picture in pictures] == [(SIZE[1], SIZE[0], 3)] * 10
    for number in (0, 9):
        there = replace(scene.camera, matrix=FLOWN.at(number / 10).matrix)
        expected = rendered(scene, there, "layered-depth", 2)
        assert np.abs(pictures[number] - expected).mean() < 5
        assert np.abs(pictures[9 - number] - expected).mean() > 10  # or the test would not tell them apart


def test_a_film_that_is_stopped_leaves_the_one_before(tmp_path):
    out = tmp_path / "flight.mp4"
    out.write_bytes(b"before")
    prepared = Prepared(stage())

    def stop(stage, fraction):
        if fraction > 0.4:
            raise Cancelled

    with pytest.raises(Cancelled):
        film(prepared, Look(choice("layered-depth")), stage().camera, FLOWN, SIZE, 10, out, stop)
    call(prepared.release)
    assert [path.name for path in tmp_path.iterdir()] == ["flight.mp4"]
    assert out.read_bytes() == b"before"
