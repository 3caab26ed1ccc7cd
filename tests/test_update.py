"""A method that goes on with another state of a scene shows what a fresh one would, and nothing is uploaded in vain."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import Resident
from catoptric.addon.gl import call
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.scene import ColorSource, Image, Lighting, Material, World

from .stage import looking, mesh_of, placed, scene_of


def stage():
    """A mirror ball over a floor, a box beside it."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
    box = mesh_of(trimesh.creation.box())
    floor = mesh_of(trimesh.creation.box((8, 8, 0.2)))
    parts = [(ball, placed(), True), (box, placed((2, 0, 0)), False), (floor, placed((0, 0, -1.2)), False)]
    return scene_of(parts, looking((0.5, -4.5, 1.0)))


def moved(scene):
    instances = list(scene.instances)
    instances[1] = replace(instances[1], matrix=placed((-1.6, -1.0, 0.4), turn=0.5))
    return replace(scene, instances=tuple(instances))


def painted(scene):
    """Another colour, and an image on the floor: the shaders are others then."""
    checker = np.zeros((4, 4, 4), np.uint8)
    checker[::2, 1::2] = checker[1::2, ::2] = 255
    materials = list(scene.materials)
    materials[1] = Material("red", ColorSource((0.9, 0.1, 0.1)))
    materials[2] = Material("checker", ColorSource(image=0))
    return replace(scene, materials=tuple(materials), images=(Image("checker", checker),))


def reshaped(scene):
    torus = mesh_of(trimesh.creation.torus(0.7, 0.3, major_sections=16, minor_sections=8))
    return replace(scene, meshes=(scene.meshes[0], torus, scene.meshes[2]))


def without_box(scene):
    return replace(scene, instances=(scene.instances[0], scene.instances[2]))


def under_another_sky(scene):
    return replace(scene, world=World(panorama=np.full((4, 8, 3), (0.1, 0.3, 0.8), np.float32)))


def seen_from_elsewhere(scene):
    return replace(scene, camera=looking((-3.0, -3.0, 2.0)))


CHANGES = (moved, painted, reshaped, without_box, under_another_sky, seen_from_elsewhere)


def picture(method, scene):
    return method.render(View(scene.camera, 64, 48, 1)).color


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
@pytest.mark.parametrize("name", METHODS)
def test_an_update_shows_what_a_fresh_start_shows(name, change):
    before = stage()
    after = change(before)
    method, fresh = METHODS[name](), METHODS[name]()
    method.prepare(before, Lighting.UNLIT)
    fresh.prepare(after, Lighting.UNLIT)
    try:
        old = picture(method, before)
        method.update(after)
        new = picture(method, after)
        np.testing.assert_array_equal(new, picture(fresh, after))
        assert np.abs(new - old).max() > 0.05
        method.update(before)
        np.testing.assert_array_equal(picture(method, before), old)
    finally:
        method.release()
        fresh.release()


def test_only_what_changed_is_uploaded():
    scene = stage()
    resident = call(Resident, scene, Lighting.UNLIT)
    try:
        textures = dict(resident._textures)
        assert call(resident.update, seen_from_elsewhere(scene)) is False
        assert resident._textures == textures
        assert call(resident.update, moved(scene)) is True
        assert {name for name in textures if resident._textures[name] is not textures[name]} == {"records"}
    finally:
        call(resident.release)
