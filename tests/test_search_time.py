"""The time of a frame counts what is searched once for all samples of its view."""

from time import sleep

import numpy as np
import pytest
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.methods.virtual.images import Images
from catoptric.addon.scene import Lighting

from .mirror_stage import pane
from .stage import looking, placed, scene_of
from .test_virtual_objects import ALONE, ball, box

SIZE = (48, 32)
WAIT_MS = 400.0
"""How much longer a search is made to take: more than all the rest of such a small picture, even of the first."""


@pytest.fixture
def slow_searches(monkeypatch):
    """Counts the searches, each of which waits."""
    find, found = Images.find, []

    def slowly(images, *arguments):
        found.append(images)
        sleep(WAIT_MS / 1e3)
        find(images, *arguments)

    monkeypatch.setattr(Images, "find", slowly)
    return found


def method(*reflectors):
    parts = [(ball(), placed(), True), (box(), placed((1.9, 0.4, -0.5)), False), *reflectors]
    scene = scene_of(parts, looking((1.0, -3.6, 1.9)), bounces=1, world=(0.0, 0.0, 0.7))
    names = {instance.name: ("virtual-objects", {**ALONE, "orders": 1}) for instance in scene.instances}
    names |= {scene.instances[-1].name: ("planar", {})} if reflectors else {}
    drawn = Mixed(names)
    drawn.prepare(scene, Lighting.UNLIT)
    return drawn, scene.camera


@pytest.mark.parametrize("samples", [1, 2, 3])
def test_one_sample_and_many_count_one_search(slow_searches, samples):
    drawn, camera = method()
    times = drawn.render(View(camera, *SIZE, samples)).time_ms
    drawn.release()
    assert len(slow_searches) == (1 if samples == 1 else 2)
    assert times["reflection"] >= WAIT_MS
    assert times["frame"] >= times["reflection"]


def test_so_do_the_pictures_of_flat_mirrors(slow_searches):
    drawn, camera = method((pane(), placed((0, 2.2, 0.0), (6, 1, 5)), True))
    times = drawn.render(View(camera, *SIZE, 2)).time_ms
    drawn.release()
    assert times["planar"] >= WAIT_MS
    assert times["virtual-objects"] >= WAIT_MS


def test_a_view_that_stands_still_is_searched_once_and_says_so(slow_searches):
    drawn, camera = method()

    def paint():
        canvas = Canvas(*SIZE)
        times = [drawn.paint(View(camera, *SIZE, samples), canvas) for samples in (1, 2)]
        picture = canvas.read()[0]
        canvas.release()
        return times, picture

    (once, still), picture = call(paint)
    assert len(slow_searches) == 1
    assert still["reflection"] < WAIT_MS <= once["reflection"]
    np.testing.assert_array_equal(picture, drawn.render(View(camera, *SIZE, 2)).color)
    drawn.release()
