"""Whether light is still that of a scene, and what it is put onto."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.light import Keys, changes, dressed, standing
from catoptric.addon.scene import Image, World

from .stage import looking, mesh_of, placed, scene_of


@pytest.fixture
def scene():
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=2), smooth=True)
    box = mesh_of(trimesh.creation.box())
    return scene_of([(ball, placed(), True), (box, placed((3, 0, 0)), False)], looking((0, -5, 1)))


def lit(scene):
    """As a bake leaves it: the box in other triangles, with coordinates and an image."""
    mesh = scene.meshes[1]
    mesh = replace(mesh, triangles=mesh.triangles[::-1], lightmap_uvs=np.full((len(mesh.triangles), 3, 2), 0.5))
    image = Image("lightmap of box", np.ones((4, 4, 4), np.float32))
    instances = (scene.instances[0], replace(scene.instances[1], lightmap=len(scene.images)))
    return replace(scene, meshes=(scene.meshes[0], mesh), images=(*scene.images, image), instances=instances)


def told(before, after):
    return changes(standing(before, Keys()), standing(after, Keys()))


def with_instance(scene, **changed):
    return replace(scene, instances=(scene.instances[0], replace(scene.instances[1], **changed)))


def test_nothing_has_changed_where_all_is_equal(scene):
    copies = tuple(replace(mesh, positions=mesh.positions.copy()) for mesh in scene.meshes)
    assert told(scene, replace(scene, meshes=copies, camera=looking((9, 9, 9)), name="other")) == []


def test_each_change_is_named(scene):
    name = scene.instances[1].name
    assert told(scene, with_instance(scene, matrix=placed((3, 0, 1)))) == [f'"{name}" has moved']
    assert told(scene, with_instance(scene, mesh=0)) == [f'"{name}" has another shape']
    assert told(scene, replace(scene, world=World((9.0, 0.0, 0.0)))) == ["the world has changed"]
    gone = replace(scene, instances=scene.instances[:1])
    assert told(scene, gone) == [f'"{name}" is gone']
    assert told(gone, scene) == [f'"{name}" is new']
    red = replace(scene.materials[0], diffuse=0.123)
    assert told(scene, replace(scene, materials=(red, *scene.materials[1:])))


def test_light_is_put_on_what_it_fits_and_on_nothing_else(scene):
    baked, name = lit(scene), scene.instances[1].name
    worn = dressed(scene, baked, {name})
    assert worn.instances[0] is scene.instances[0]
    box = worn.instances[1]
    assert worn.meshes[box.mesh] is baked.meshes[1]
    assert worn.images[box.lightmap] is baked.images[-1]
    assert worn.meshes[:2] == scene.meshes
    assert dressed(scene, baked, set()).instances == scene.instances


def test_a_moved_object_takes_its_light_along(scene):
    moved = with_instance(scene, matrix=placed((0, 0, 7)))
    box = dressed(moved, lit(scene), {scene.instances[1].name}).instances[1]
    assert box.lightmap is not None
    assert np.array_equal(box.matrix, placed((0, 0, 7)))


def test_what_is_the_same_object_is_hashed_once(scene):
    keys = Keys()
    first = keys.of(scene.meshes)
    scene.meshes[0].positions[0] += 1.0  # nobody does this; it shows that nothing is hashed again
    assert keys.of(scene.meshes) == first
    keys.sweep(replace(scene, meshes=()))
    assert keys.of(scene.meshes) != first
