"""What a preview's session makes of keys, and the one context that it may share with a window."""

import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import psutil
import pytest
from catoptric.addon.errors import MachineError, SceneError
from catoptric.addon.gl import call, require
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.metrics import to_bytes
from catoptric.addon.parameters import resolve
from catoptric.addon.scene import Lighting
from catoptric.addon.scene.archive import load, save
from catoptric.batch.preview.keys import ACTIONS, BINDINGS
from catoptric.batch.preview.look import Look
from catoptric.batch.preview.path import CameraPath
from catoptric.batch.preview.session import Session
from catoptric.batch.preview.watch import Watch

from .preview_stage import SIZE, choice, rendered, stage
from .stage import looking, placed

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


def test_the_manual_lists_every_key(root):
    manual = (root / "docs" / "preview.md").read_text(encoding="utf-8")
    rows = [f"| {binding.shown} | {binding.help} |" for binding in BINDINGS]
    assert "\n".join(rows) in manual


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


# Another state of the scene


def moved_box(scene):
    instances = list(scene.instances)
    instances[1] = replace(instances[1], matrix=placed((1.6, 0.2, 0.6), turn=0.9))
    return replace(scene, instances=tuple(instances))


def test_a_scene_that_was_saved_again_is_shown_from_where_the_camera_is(session):
    session.pilot.turn(0.2, 0.1)
    rest(session)
    before, camera = colors(session)[0], session.pilot.camera.matrix
    call(session.take, moved_box(stage()))
    np.testing.assert_array_equal(colors(session)[0], before)  # until there is a new one
    rest(session)
    np.testing.assert_array_equal(session.pilot.camera.matrix, camera)
    expected = rendered(moved_box(stage()), session.pilot.camera, "layered-depth", 4)
    assert np.abs(to_bytes(colors(session)[0]).astype(int) - expected).max() <= 1
    assert np.abs(colors(session)[0] - before).max() > 0.1


def test_who_has_not_flown_follows_the_scene_s_camera(session):
    there = looking((-2.0, -4.0, 2.0))
    call(session.take, replace(stage(), camera=there))
    assert session.pilot.camera is there
    session.pilot.turn(0.2, 0.1)
    call(session.take, replace(stage(), camera=replace(looking((0, -9, 0)), lens=80.0)))
    assert session.pilot.camera.lens == 80.0
    assert np.linalg.norm(session.pilot.camera.position - there.position) < 1e-6


def test_light_that_the_new_scene_lacks_gives_way(session):
    session.lightings = (Lighting.UNLIT, Lighting.CYCLES)
    session.light(Lighting.CYCLES)
    call(session.take, stage())
    assert session.look.lighting is Lighting.UNLIT


def news_of(watch, seconds=20.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if (news := watch.news()) is not None:
            return news
        time.sleep(0.02)
    raise AssertionError("no news")


def test_a_watch_tells_once_of_every_change(tmp_path):
    file = tmp_path / "stage.catoptric"
    save(stage(), file)
    watch = Watch(file, lambda: load(file))
    try:
        assert all(watch.news() is None for _ in range(100))
        save(replace(stage(), name="second"), file)
        assert news_of(watch).name == "second"
        time.sleep(0.6)
        assert watch.news() is None
        file.write_bytes(b"nonsense")
        with pytest.raises(SceneError, match="damaged"):
            news_of(watch)
        file.unlink()
        time.sleep(0.6)
        assert watch.news() is None
        save(replace(stage(), name="third"), file)
        assert news_of(watch).name == "third"
    finally:
        watch.close()
