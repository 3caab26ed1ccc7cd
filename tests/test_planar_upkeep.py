"""What `planar` draws and keeps: only mirrors in sight, nothing from the frame before, beside other methods."""

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call, require
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.deferred import Ensemble
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.methods.planar import Planar
from catoptric.addon.scene import Lighting

from .mirror_stage import SIZE, SKY, differing, frame_of, pane, truth
from .planar_stage import (
    BALL,
    BOX,
    EYE,
    WALL,
    WAYS,
    assert_is_true,
    before_things,
    facing,
    in_a_box,
    inside_of,
    things,
    two_walls,
)
from .stage import looking, placed, scene_of


def pictures_of(scene, monkeypatch, drawn_settings=None):
    """How many mirrored pictures a frame takes, by depth."""
    depths = []
    paint = Ensemble.paint_mirrored

    def counted(self, view, canvas, offset):
        depths.append(view.mirrored)
        paint(self, view, canvas, offset)

    monkeypatch.setattr(Ensemble, "paint_mirrored", counted)
    frame_of(scene, drawn_settings)
    return np.bincount(depths, minlength=1)[1:].tolist()


def test_only_mirrors_in_sight_are_drawn(monkeypatch):
    assert pictures_of(two_walls(), monkeypatch)[0] == 2
    away = placed((9, -9, 0.5), (4, 1, 3))
    assert pictures_of(before_things((pane(), WALL), (pane(), away)), monkeypatch) == [1]
    wall = (BOX, placed((0, 1.0, 0.5), (9, 0.1, 9)), False)
    assert pictures_of(scene_of([(pane(), WALL, True), wall], EYE), monkeypatch) == []


def test_a_block_costs_the_sides_in_sight(monkeypatch):
    block = before_things((BOX, placed((0, 0, 0.5), (1.5, 1.2, 1.9), turn=0.5)))
    assert pictures_of(block, monkeypatch) == [2]
    above = replace(block, camera=looking((1.4, -5.5, 4.4)))
    assert pictures_of(above, monkeypatch) == [3]


def test_mirrors_in_mirrors_are_drawn_where_they_are_seen_there(monkeypatch):
    assert pictures_of(facing(bounces=3), monkeypatch) == [1, 1, 1, 1]
    assert pictures_of(facing(bounces=8), monkeypatch, {"depth": 2}) == [1, 1]
    back_to_back = before_things((pane(), WALL), (pane(), WALL @ placed((0, 0.5, 0))))
    assert pictures_of(back_to_back, monkeypatch) == [1]


def test_a_box_of_mirrors_does_not_multiply(monkeypatch):
    drawn = pictures_of(in_a_box(), monkeypatch)
    assert drawn[0] <= 5
    assert drawn[-1] < 5 * 5**2  # uncut it would be 5 for each of the last


def moved(scene, index, matrix):
    instances = list(scene.instances)
    instances[index] = replace(instances[index], matrix=matrix)
    return replace(scene, instances=tuple(instances))


CHANGES = {
    "the mirror": lambda scene: moved(scene, 0, placed((0.3, 1.4, 0.4), (3, 1, 2), turn=-0.2)),
    "a thing": lambda scene: moved(scene, 2, placed((-0.8, -0.9, 0.2), (0.6, 0.5, 0.9), turn=1.2)),
    "the camera": lambda scene: replace(scene, camera=looking((-1.0, -4.5, 0.8))),
    "less flat": lambda scene: replace(scene, meshes=(BALL, *scene.meshes[1:])),
}


@pytest.mark.parametrize("clipping", ["stencil", "clip-planes", "projective-texture"])
def test_an_update_shows_what_a_fresh_start_shows(clipping):
    scene, chosen = two_walls(), {"clipping": clipping}
    method = Planar(chosen)
    method.prepare(scene, Lighting.UNLIT)
    try:
        before = method.render(View(scene.camera, *SIZE, 1)).color
        for name, change in CHANGES.items():
            after = change(scene)
            method.update(after)
            shown = method.render(View(after.camera, *SIZE, 1)).color
            np.testing.assert_array_equal(shown, frame_of(after, chosen).color, err_msg=name)
            assert differing(shown, before).mean() > 0.02
        method.update(scene)
        np.testing.assert_array_equal(method.render(View(scene.camera, *SIZE, 1)).color, before)
    finally:
        method.release()


def gl_objects():
    """How many OpenGL objects of each kind there are, of the first thousands of names."""
    counts = {}
    for kind in ("Texture", "Buffer", "Framebuffer", "Renderbuffer", "Query"):
        address = require().mglo._context.load_opengl_function(f"glIs{kind}")
        exists = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(address)
        counts[kind] = sum(exists(name) for name in range(1, 10_000))
    return counts


@pytest.mark.parametrize("clipping", WAYS)
def test_nothing_is_kept_from_frame_to_frame_and_nothing_at_the_end(clipping):
    frame_of(facing(bounces=2), {"clipping": clipping})  # what is kept for good, programs and the like, is there now
    scene, method, before = facing(bounces=2), Planar({"clipping": clipping}), call(gl_objects)
    method.prepare(scene, Lighting.UNLIT)
    canvas = call(Canvas, *SIZE)
    try:
        method.paint(View(scene.camera, *SIZE, 1), canvas)
        first = call(gl_objects)
        for _ in range(50):
            method.paint(View(scene.camera, *SIZE, 1), canvas)
        assert call(gl_objects) == first
        for number in range(20):
            method.update(moved(scene, 2, placed((0.1 * number, -0.5, -0.4), (0.5, 0.5, 0.9))))
            method.paint(View(scene.camera, *SIZE, 1), canvas)
        assert call(gl_objects) == first
    finally:
        call(canvas.release)
        method.release()
    assert call(gl_objects) == before


def test_pictures_are_given_back_and_follow_the_size():
    scene = facing()
    method = Planar()
    method.prepare(scene, Lighting.UNLIT)
    try:
        for size in (SIZE, (40, 30), SIZE):
            frame = method.render(View(scene.camera, *size, 1))
            np.testing.assert_array_equal(frame.color, frame_of(scene, size=size).color)
            assert {canvas.size for level, canvas in method._canvases.items() if level < 3} == {size}
    finally:
        method.release()
    assert method._canvases == {}


@pytest.mark.parametrize("clipping", WAYS)
def test_a_plain_frame_after_it_is_as_one_before_it(clipping):
    scene = facing()
    bare = scene_of(things(), EYE, world=SKY)
    before = [frame_of(each, method=LayeredDepth).color for each in (scene, bare)]
    frame_of(scene, {"clipping": clipping}, samples=2)
    after = [frame_of(each, method=LayeredDepth).color for each in (scene, bare)]
    np.testing.assert_array_equal(after, before)


@pytest.mark.parametrize("clipping", WAYS)
def test_no_test_of_opengl_stays_on(clipping):
    def enabled():
        address = require().mglo._context.load_opengl_function("glIsEnabled")
        ask = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(address)
        return [hex(test) for test in (0x0B90, *range(0x3000, 0x3008)) if ask(test)]  # stencil, clip distances

    frame_of(facing(), {"clipping": clipping})
    assert call(enabled) == []


def assigned(scene, *names):
    """A frame in which each reflector is drawn by its own method."""
    mixed = Mixed({f"object {index}": (name, {}) for index, name in enumerate(names)})
    mixed.prepare(scene, Lighting.UNLIT)
    try:
        assert [choice.method for choice in mixed.choices.values()] == list(names)
        return mixed.render(View(scene.camera, *SIZE, 1))
    finally:
        mixed.release()


@pytest.mark.parametrize("names", [("planar", "layered-depth"), ("layered-depth", "planar")])
def test_beside_an_exact_method_it_shows_what_both_show(names):
    scene = facing()
    assert_is_true(assigned(scene, *names), truth(scene))


def test_a_mirror_shows_another_as_that_ones_method_draws_it():
    ball = BALL, placed((-0.9, 0.1, 0.2), (0.6,) * 3)
    scene = before_things((pane(), WALL), ball)
    frame, exact = assigned(scene, "planar", "environment-map"), frame_of(scene)
    expected = truth(scene, most=1)  # where the mirror shows the ball, this stays black
    blacks = ~expected.color.any(axis=-1)
    wall = inside_of(np.isfinite(expected.distance) & blacks & (np.indices(SIZE[::-1])[1] < SIZE[0]), 1)
    assert wall.sum() > 30
    assert differing(frame.color, exact.color)[wall].mean() > 0.1  # an environment map is not exact
    assert frame.color[wall].any(axis=-1).mean() > 0.95  # but it is there
    plain = np.isnan(expected.distance)
    np.testing.assert_array_equal(frame.color[plain], exact.color[plain])
