"""The preview: a camera that flies, paths and films of its flights, and what a session makes of keys."""

import json
import subprocess
import sys
import time
from dataclasses import replace
from math import pi, radians

import av
import numpy as np
import psutil
import pytest
import trimesh
from catoptric.addon.errors import Cancelled, MachineError, UsageError
from catoptric.addon.gl import call, require
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS, named
from catoptric.addon.metrics import to_bytes
from catoptric.addon.parameters import resolve
from catoptric.addon.scene import Lighting
from catoptric.batch.preview.camera import STEEPEST, Flight, Pose
from catoptric.batch.preview.darkroom import film, photograph
from catoptric.batch.preview.hits import Looker
from catoptric.batch.preview.keys import ACTIONS, BINDINGS
from catoptric.batch.preview.look import Look
from catoptric.batch.preview.path import CameraPath, Recorder
from catoptric.batch.preview.prepared import Choice, Prepared
from catoptric.batch.preview.session import Session
from hypothesis import given, settings
from hypothesis import strategies as st

from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed, scene_of

SIZE = (64, 48)

angles = st.floats(-4 * pi, 4 * pi)
pitches = st.floats(-STEEPEST, STEEPEST)
coordinates = st.tuples(*[st.floats(-1e3, 1e3)] * 3).map(np.array)
wishes = st.tuples(*[st.sampled_from([-1.0, 0.0, 1.0])] * 3).map(np.array)


def stage():
    """A mirror ball, a box to its right, and a floor."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
    box = mesh_of(trimesh.creation.box())
    floor = mesh_of(trimesh.creation.box((8, 8, 0.2)))
    parts = [(ball, placed(), True), (box, placed((2, 0, 0), turn=0.4), False), (floor, placed((0, 0, -1.2)), False)]
    return scene_of(parts, looking((0.5, -4.5, 1.0)), world=(0.2, 0.3, 0.5))


def choice(name, **given):
    return Choice.of(name, resolve(METHODS[name].parameters, given), Lighting.UNLIT)


def rendered(scene, camera, name, samples):
    """What a method of its own makes of it, as a screen shows it."""
    method = named(name)()
    method.prepare(scene, Lighting.UNLIT)
    try:
        return to_bytes(method.render(View(camera, *SIZE, samples)).color)
    finally:
        method.release()


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


def path_of(keys):
    return CameraPath(np.array([key[0] for key in keys]), np.array([key[1:] for key in keys]))


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


# A session


@pytest.fixture
def session(tmp_path):
    """A session that has come to rest, without a window."""
    values = {name: resolve(method.parameters, {}) for name, method in METHODS.items()}
    made = Session(stage(), Look(choice("layered-depth")), values, tmp_path / "stage")
    made.size = SIZE
    rest(made)
    yield made
    call(made.workshop.release)


def rest(session):
    """Let it work until there is nothing left to do; how much there was."""
    return next(count for count in range(100) if not call(session.work))


def colors(session):
    shown = session.workshop.painter.shown
    return [call(canvas.read)[0] for canvas in shown.canvases]


def test_a_session_at_rest_has_a_smooth_picture_and_nothing_to_do(session):
    assert session.workshop.samples == 4
    assert np.abs(to_bytes(colors(session)[0]) - rendered(stage(), stage().camera, "layered-depth", 4)).max() == 0
    assert rest(session) == 0
    session.press("-")
    session.press("h")
    assert rest(session) == 0  # neither needs the picture to be painted again


def test_keys_fly_and_home_goes_back(session):
    before = colors(session)[0]
    session.press("w")
    session.pilot.advance(0.5)
    call(session.work)
    assert session.workshop.samples == 1
    session.release("w")
    session.pilot.advance(5.0)
    session.pilot.advance(0.1)
    assert rest(session) >= 1
    assert np.abs(colors(session)[0] - before).max() > 0.1
    session.press("home")
    rest(session)
    np.testing.assert_array_equal(colors(session)[0], before)


def test_digits_choose_methods_and_v_splits(session):
    session.press("1")
    rest(session)
    assert session.look.left.method == next(iter(METHODS))
    session.press("2", control=True)
    rest(session)
    left, right = (rendered(stage(), stage().camera, name, 4) for name in list(METHODS)[:2])
    for shown, expected in zip(colors(session), (left, right), strict=True):
        assert np.abs(to_bytes(shown).astype(int) - expected).max() <= 1
    session.press("v")
    rest(session)
    assert len(colors(session)) == 1


def test_esc_stops_preparing_and_goes_back(session):
    before, look = colors(session)[0], session.look
    session.workshop.pump = lambda: session.press("escape")
    session.press("1")
    call(session.work)
    assert session.look == look
    assert "stopped" in session.message
    session.workshop.pump = lambda: None
    assert rest(session) == 0
    np.testing.assert_array_equal(colors(session)[0], before)


def test_a_key_in_the_middle_of_preparing_is_obeyed(session):
    session.workshop.pump = lambda: session.press("2") if session.look.left.method == "environment-map" else None
    session.press("1")
    rest(session)
    assert session.look.left.method == "environment-map-dynamic"
    assert session.workshop.settled.left == session.look.left


def test_a_method_that_fails_says_why_and_gives_way(session):
    look = session.look

    def fail():
        raise MachineError("the GPU is full: choose a smaller resolution")

    session.workshop.pump = fail
    session.press("1")
    call(session.work)
    assert session.look == look
    assert session.message == "the GPU is full: choose a smaller resolution"


def test_a_value_is_prepared_once_it_rests(session):
    session.press("1")
    rest(session)
    session.set(False, {"size": 32})
    assert not call(session.work)  # it may change again at once, as it does while it is dragged
    time.sleep(0.3)
    assert rest(session) >= 1
    assert dict(session.workshop.settled.left.settings)["size"] == 32
    session.press("5")
    session.press("1")
    assert dict(session.look.left.settings)["size"] == 32


def test_the_automatic_choice_says_what_it_chose(session):
    session.choose(list(METHODS).index("auto"))
    rest(session)
    assert session.message.startswith("object 0 by ")


def test_light_changes_under_both_methods(session):
    session.press("v")
    session.press("l")
    rest(session)
    assert {each.lighting for each in session.look.choices} == {Lighting.DIRECT}
    session.press("l")
    rest(session)
    assert session.look.lighting is Lighting.UNLIT  # the scene holds no lightmaps


def test_a_flight_is_recorded_saved_played_and_filmed(session, tmp_path):
    session.press("space")
    assert "no path" in session.message
    session.press("r")
    session.press("d")
    for _ in range(20):
        session.pilot.advance(0.05)
    session.release("d")
    session.press("r")
    flown = CameraPath.load(tmp_path / "stage-001.path.json")
    assert flown.duration == pytest.approx(1.0, abs=0.06)
    session.pilot.advance(5.0)
    end = session.pilot.camera.position
    session.press("space")
    session.pilot.advance(0.01)
    assert np.linalg.norm(session.pilot.camera.position - end) > 0.1
    session.pilot.advance(2.0)
    assert session.pilot.played is None
    np.testing.assert_allclose(session.pilot.camera.position, flown.at(9).position, atol=1e-4)
    session.press("x")
    session.press("p")
    rest(session)
    assert {path.name for path in tmp_path.iterdir()} == {"stage-001.path.json", "stage-001.mp4", "stage-001.png"}


def test_every_action_of_a_key_exists(session):
    for key in ACTIONS:
        session.press(key)
        session.release(key)
    assert all(binding.shown and binding.help for binding in BINDINGS)
    session.press("escape")
    session._asked.clear()
    rest(session)


# The one context


ADOPT = """
import moderngl, threading
from catoptric.addon import gl

context = moderngl.create_context(standalone=True, require=410, **{backend})
gl.adopt(context)
assert gl.call(gl.require) is context
try:
    gl.adopt(context)
except RuntimeError as refusal:
    print("refused:", refusal)
def elsewhere():
    try:
        gl.call(gl.require)
    except RuntimeError as refusal:
        print("elsewhere refused:", refusal)
other = threading.Thread(target=elsewhere)
other.start()
other.join()
"""

TOO_LATE = """
import moderngl
from catoptric.addon import gl

gl.call(gl.require)
try:
    gl.adopt(moderngl.create_context(standalone=True, require=410, **{backend}))
except RuntimeError as refusal:
    print("refused:", refusal)
"""


@pytest.mark.parametrize(("script", "refusals"), [(ADOPT, 2), (TOO_LATE, 1)])
def test_a_process_has_one_context(script, refusals):
    backend = {"backend": "egl"} if sys.platform.startswith("linux") else {}
    command = [sys.executable, "-c", script.replace("{backend}", repr(backend))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("refused: this process has its GL context already") == refusals


def test_what_python_lets_go_of_leaves_the_gpu():
    """On software OpenGL a buffer is memory of this process."""

    def waste():
        for _ in range(40):
            require().buffer(np.ones(2**21))  # 16 MiB
            require().buffer(np.ones(8)).release()

    before = psutil.Process().memory_info().rss
    call(waste)
    assert psutil.Process().memory_info().rss - before < 2**28


def test_the_degrees_of_a_path_are_those_of_its_poses(tmp_path):
    path = tmp_path / "turn.path.json"
    keys = [KEY, {"time": 2, "position": [0, 0, 0], "yaw": 90, "pitch": -30}]
    path.write_text(json.dumps({"schema": 1, "keys": keys}))
    forward = -CameraPath.load(path).at(2.0).matrix[:3, 2]
    np.testing.assert_allclose(forward, [-np.cos(radians(30)), 0, -0.5], atol=1e-12)
