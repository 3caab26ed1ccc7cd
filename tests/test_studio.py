"""Pictures for those who do not wait: the newest wish wins, and a failure is told."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.studio import Act, Studio
from catoptric.addon.scene import Lighting

from .stage import looking, mesh_of, placed, scene_of

SIZE = (48, 32)


def plain(canvas, method, view):
    return canvas.pixels()[0]


def stage(shift=0.0):
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
    box = mesh_of(trimesh.creation.box())
    return scene_of([(ball, placed(), True), (box, placed((2 + shift, 0, 0)), False)], looking((0.5, -4.5, 1.0)))


def act(scene, method="layered-depth"):
    return Act(scene, Lighting.UNLIT, {scene.instances[0].name: (method, {})})


def fresh(scene, view):
    method = LayeredDepth()
    method.prepare(scene, Lighting.UNLIT)
    try:
        return method.render(view).color
    finally:
        method.release()


@pytest.fixture
def studio():
    made = Studio(lambda: None)
    yield made
    made.close()


def rest(studio, seconds=30.0):
    """Wait until there is nothing left to draw."""
    end = time.monotonic() + seconds
    while studio.busy:
        assert time.monotonic() < end
        time.sleep(0.005)


def test_a_viewer_sees_the_newest_scene(studio):
    first, second = stage(), stage(0.5)
    view = View(first.camera, *SIZE, 1)
    studio.look("window", view, plain)
    studio.show(act(first))
    number = studio.show(act(second))
    rest(studio)
    studio.look("window", view, plain)
    rest(studio)
    picture = studio.picture("window")
    assert (picture.act, picture.view) == (number, view)
    np.testing.assert_array_equal(picture.pixels[::-1, :, :3], fresh(second, view))


def test_two_viewers_have_a_picture_each(studio):
    scene = stage()
    near, far = View(scene.camera, *SIZE, 1), View(looking((0, -9, 0)), 20, 10, 1)
    studio.show(act(scene))
    studio.look("near", near, plain)
    studio.look("far", far, plain)
    rest(studio)
    assert studio.picture("near").pixels.shape == (32, 48, 4)
    assert studio.picture("far").pixels.shape == (10, 20, 4)
    studio.leave("near")
    rest(studio)
    assert studio.picture("near") is None


def test_asking_takes_no_time(studio):
    scene = stage()
    studio.show(act(scene))
    slow = View(scene.camera, 512, 512, 8)
    studio.look("window", slow, plain)
    start = time.perf_counter()
    for _ in range(100):
        studio.look("window", slow, plain)
    assert time.perf_counter() - start < 0.05
    quick = View(scene.camera, *SIZE, 1)
    studio.look("window", quick, plain)
    rest(studio)
    assert studio.picture("window").view is quick


def test_asking_again_for_the_same_does_not_begin_anew(studio):
    scene = stage()
    studio.show(act(scene))
    rest(studio)
    end = time.monotonic() + 60.0
    while (picture := studio.picture("window")) is None:
        studio.look("window", View(scene.camera, 256, 256, 8), plain)
        assert time.monotonic() < end
        time.sleep(0.002)
    assert picture.view.samples == 8


def test_a_failure_is_told_and_the_last_picture_stays(studio):
    scene = stage()
    view = View(scene.camera, *SIZE, 1)
    studio.show(act(scene))
    studio.look("window", view, plain)
    rest(studio)
    before = studio.picture("window")
    studio.show(act(scene, "no-such-method"))
    rest(studio)
    assert "no-such-method" in studio.problem
    assert studio.picture("window") is before
    studio.show(act(stage(1.0)))
    studio.look("window", view, plain)
    rest(studio)
    assert studio.problem == ""
    assert studio.picture("window") is not before


def test_notices_come_and_closing_ends_the_work():
    heard = threading.Event()
    studio = Studio(heard.set)
    scene = stage()
    studio.show(act(scene))
    studio.look("window", View(scene.camera, 512, 512, 16), plain)
    assert heard.wait(30)
    studio.close()
    assert not studio.busy
    studio.look("window", View(replace(scene).camera, *SIZE, 1), plain)
    assert not studio.busy
