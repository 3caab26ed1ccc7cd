"""What viewports show instead of the picture, where the answer is known."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call
from catoptric.addon.interface.overlays import DEVELOPS
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.scene import Camera, Lighting

from .stage import mesh_of, placed, scene_of

SIZE = (60, 40)


def developed(scene, name, assignment=None, before=()):
    """(H, W, 4), row 0 at the bottom, after the pictures of the cameras `before`."""
    method = Mixed(assignment or {})
    method.prepare(scene, Lighting.UNLIT)

    def shown():
        canvas = Canvas(*SIZE)
        try:
            for camera in (*before, scene.camera):
                view = View(camera, *SIZE, 1)
                method.paint(view, canvas)
            return DEVELOPS[name](canvas, method, view)
        finally:
            canvas.release()

    try:
        return call(shown)
    finally:
        method.release()


def above(parts):
    """The scene from straight above, six metres wide."""
    return scene_of(parts, Camera(placed((0, 0, 9)), ortho_scale=6.0))


@pytest.mark.parametrize("name", DEVELOPS)
def test_every_overlay_is_opaque_and_fits(name):
    plate = mesh_of(trimesh.creation.box((2, 2, 0.1)))
    shown = developed(above([(plate, placed(), True)]), name)
    assert shown.shape == (40, 60, 4)
    assert shown.dtype == np.float32
    assert (shown[..., 3] == 1.0).all()
    assert np.isfinite(shown).all()


def test_layers_are_counted_along_the_shortest_side():
    """A slab has two layers, three slabs on one another have six."""
    slabs = [trimesh.creation.box((2, 2, 0.02), transform=placed((0, 0, 0.3 * z))) for z in range(3)]
    one = mesh_of(trimesh.creation.box((2, 2, 1.0)))
    three = mesh_of(trimesh.util.concatenate(slabs))
    scene = above([(one, placed((-1.5, 0, 0)), False), (three, placed((1.5, 0, 0)), False)])
    shown = developed(scene, "LAYERS")
    left, right, world = shown[20, 15, :3], shown[20, 45, :3], shown[1, 1, :3]
    assert (world == 0.0).all()
    assert min(left[1], left[2]) > 5 * left[0]  # two layers, entry and exit: teal
    assert right[0] > 5 * max(right[1], right[2])  # six: red


def test_hit_distance_darkens_with_distance():
    """Over a tilted mirror, a ceiling that rises: what is farther is darker; where there is none it is blue."""
    mirror = mesh_of(trimesh.creation.box((4, 2, 0.1)))
    ceiling = mesh_of(trimesh.Trimesh([[-2, -2, 2], [0, -2, 2], [0, 2, 2], [-2, 2, 2]], [[0, 1, 2], [0, 2, 3]]))
    scene = above([(mirror, placed(), True), (ceiling, placed(), False)])
    instances = (scene.instances[0], replace(scene.instances[1], in_camera=False))
    shown = developed(replace(scene, instances=instances), "DISTANCE")
    under, open_sky, off = shown[20, 20, :3], shown[20, 40, :3], shown[2, 2, :3]
    assert under == pytest.approx([0.5, 0.5, 0.5], abs=0.01)  # the one distance there is, hence the median
    assert open_sky[2] > 0.2 > open_sky[0]
    assert (off == 0.0).all()


def test_reflectors_are_green():
    plates = [(mesh_of(trimesh.creation.box((1, 1, 0.1))), placed((x, 0, 0)), x > 0) for x in (-1.5, 1.5)]
    shown = developed(above(plates), "REFLECTORS")
    mirror, other = shown[20, 45, :3], shown[20, 15, :3]
    assert mirror[1] > 2 * mirror[0]
    assert mirror[1] > other[1]


def test_what_is_traced_anew_is_red_where_a_method_takes_over_the_rest():
    """A key frame is traced whole; from one a step aside, only what comes into sight; a mirror drawn anew says nothing.

    Two mirrors, left by reprojection, right by layered-depth.
    """
    mirror = mesh_of(trimesh.creation.box((2, 2, 0.1)))
    lid = mesh_of(trimesh.creation.box((0.5, 0.5, 0.1)))
    ceiling = mesh_of(trimesh.creation.box((40, 40, 0.1)))
    left, right, above_left, far = (placed(at) for at in ((-1.5, 0, 0), (1.5, 0, 0), (-1.5, 0, 2), (0, 0, 12)))
    parts = [(mirror, left, True), (mirror, right, True), (lid, above_left, False), (ceiling, far, False)]
    scene = scene_of(parts, Camera(placed((0, 0, 9))))
    by = {scene.instances[0].name: ("reprojection", {"threshold": 1.0})}
    beside = replace(scene.camera, matrix=placed((0.4, 0, 9)))

    def red(cameras):
        shown = developed(scene, "RETRACED", by, cameras)
        return (shown[..., 0] > 0.7) & (shown[..., 1] < 0.1)

    first = red([])
    assert first[:, :30].sum() > 50
    assert not first[:, 30:].any()
    assert 0 < red([beside]).sum() < 0.3 * first.sum()
    assert not red([scene.camera]).any()
