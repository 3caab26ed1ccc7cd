"""Compare in place: the same camera on both sides, and the figure that belongs to the picture."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
import trimesh
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.view_camera import seen_by
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call
from catoptric.addon.interface.in_place import InPlace
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.scene import Camera, Lighting

from .stage import looking, mesh_of, placed, scene_of

SIZE = (60, 40)


@pytest.mark.parametrize("ortho", [None, 7.0])
@pytest.mark.parametrize("size", [(90, 60), (40, 70)])
def test_blender_sees_what_the_viewport_saw(ortho, size):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add()
    seen = replace(looking((3.0, -4.0, 2.0)), ortho_scale=ortho, shift=(0.1, -0.2), far=80.0)
    camera = Camera.of_matrices(np.linalg.inv(seen.matrix), seen.projection(*size), *size)
    before = (scene.camera, scene.render.resolution_x, len(bpy.data.objects), len(bpy.data.cameras))
    with seen_by(scene, camera, *size):
        found = extract(scene)
    assert found.resolution == size
    np.testing.assert_allclose(found.camera.matrix, seen.matrix, atol=1e-6)
    np.testing.assert_allclose(found.camera.window(*size), seen.window(*size), rtol=1e-5)
    assert (found.camera.near, found.camera.far) == pytest.approx((0.1, 80.0), rel=1e-4)
    assert (scene.camera, scene.render.resolution_x, len(bpy.data.objects), len(bpy.data.cameras)) == before


class Shown:
    """A ball over a floor, painted on a canvas."""

    def __init__(self):
        ball = mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
        floor = mesh_of(trimesh.creation.box((8, 8, 0.2)))
        parts = [(ball, placed(), True), (floor, placed((0, 0, -1.2)), False)]
        self.scene = scene_of(parts, looking((0.5, -4.5, 1.0)), world=(0.2, 0.3, 0.4))
        self.view = View(self.scene.camera, *SIZE, 1)
        self.method = Mixed({})
        self.method.prepare(self.scene, Lighting.UNLIT)

    def developed(self, develop, view=None):
        """(H, W, 4), row 0 at the bottom."""

        def painted():
            canvas = Canvas(*SIZE)
            try:
                self.method.paint(self.view, canvas)
                return develop(canvas, self.method, view or self.view)
            finally:
                canvas.release()

        return call(painted)


@pytest.fixture
def shown():
    made = Shown()
    yield made
    made.method.release()


def own_pixels(canvas, method, view):
    return canvas.pixels()[0][..., :3].copy()


def test_equal_pictures_have_no_error(shown):
    held = InPlace(shown.view, shown.developed(own_pixels))
    assert (shown.developed(held.error)[..., :3] < 1e-3).all()
    assert held.flip == pytest.approx(0.0, abs=1e-4)


def test_the_right_half_is_cycles(shown):
    ours = shown.developed(own_pixels)
    held = InPlace(shown.view, np.full_like(ours, 0.25))
    split = shown.developed(held.split)
    np.testing.assert_array_equal(split[:, :30, :3], ours[:, :30])
    assert (split[:, 31:, :3] == 0.25).all()
    assert held.flip > 0.05


def test_another_view_shows_our_picture_alone(shown):
    ours = shown.developed(own_pixels)
    held = InPlace(shown.view, np.zeros_like(ours))
    elsewhere = replace(shown.view, camera=looking((2.0, -3.0, 1.0)))
    for develop in (held.split, held.error):
        np.testing.assert_array_equal(shown.developed(develop, elsewhere)[..., :3], ours)
    assert held.flip is None
