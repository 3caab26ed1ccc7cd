"""A Scene that anyone may have written: what cannot be drawn is named and left out, the rest is drawn."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.errors import SceneError
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.scene import Lamp, LampKind, Lighting
from catoptric.addon.scene.archive import save
from catoptric.addon.scene.soundness import sound
from catoptric.batch.sources import locate
from hypothesis import given
from hypothesis import strategies as st

from .stage import looking, mesh_of, placed, scene_of


@pytest.fixture(scope="module")
def scene():
    """A mirror ball, and a box in front of it."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=2), smooth=True, name="ball")
    box = mesh_of(trimesh.creation.box(), name="box")
    return scene_of([(ball, placed(), True), (box, placed((0.0, -2.5, 0.0)), False)], looking((0.0, -6.0, 1.0)))


def with_box(scene, **changes):
    """The scene with another box."""
    return replace(scene, meshes=(scene.meshes[0], replace(scene.meshes[1], **changes)))


def without_faces(mesh):
    return {name: getattr(mesh, name)[:0] for name in ("triangles", "normals", "uvs", "slots")}


def broken(scene, index, value):
    """The box with one coordinate that is no number."""
    positions = scene.meshes[1].positions.copy()
    positions.flat[index % positions.size] = value
    return with_box(scene, positions=positions)


def put(scene, matrix):
    """The scene with its box somewhere else."""
    return replace(scene, instances=(scene.instances[0], replace(scene.instances[1], matrix=matrix)))


def test_a_sound_scene_is_itself(scene):
    assert sound(scene) is scene


@given(st.integers(0, 23), st.sampled_from([np.nan, np.inf, -np.inf]))
def test_a_mesh_with_what_is_no_number_is_left_out(scene, index, value):
    left = sound(broken(scene, index, value))
    assert [one.name for one in left.instances] == [scene.instances[0].name]
    assert len(left.meshes) == 1
    (warning,) = left.warnings
    assert scene.instances[1].name in warning
    assert "not numbers" in warning


def test_meshes_without_area_are_left_out_and_the_others_keep_theirs(scene):
    flat = with_box(scene, positions=np.ones_like(scene.meshes[1].positions))
    empty = with_box(scene, **without_faces(scene.meshes[1]))
    for one, why in ((flat, "without area"), (empty, "no faces")):
        for order in ([0, 1], [1, 0]):
            meshes = tuple(one.meshes[index] for index in order)
            instances = tuple(replace(instance, mesh=order[instance.mesh]) for instance in one.instances)
            left = sound(replace(one, meshes=meshes, instances=instances))
            assert [left.meshes[instance.mesh].name for instance in left.instances] == ["ball"]
            assert why in left.warnings[0]


@pytest.mark.parametrize("matrix", [placed(scale=(1.0, 0.0, 1.0)), np.full((4, 4), np.nan)])
def test_what_is_nowhere_is_left_out(scene, matrix):
    left = sound(put(scene, matrix))
    assert len(left.instances) == 1
    assert "scale of zero" in left.warnings[0]


def test_a_normal_that_is_no_direction_is_the_triangles_own(scene):
    normals = scene.meshes[1].normals.copy()
    normals[3, 1] = np.nan
    normals[5, 0] = 0.0
    mended = sound(with_box(scene, normals=normals))
    np.testing.assert_allclose(mended.meshes[1].normals, scene.meshes[1].normals, atol=1e-6)


def test_a_lamp_without_a_place_is_left_out(scene):
    lamps = [Lamp(name, LampKind.POINT, matrix, (1.0, 1.0, 1.0)) for name, matrix in LAMPS.items()]
    left = sound(replace(scene, lamps=tuple(lamps)))
    assert left.lamps == (lamps[0],)
    assert '"lost"' in left.warnings[0]


LAMPS = {"here": placed((0.0, 0.0, 3.0)), "lost": np.full((4, 4), np.inf)}


def test_a_camera_without_a_place_is_an_error(scene):
    camera = replace(scene.camera, matrix=np.full((4, 4), np.nan))
    with pytest.raises(SceneError, match="camera"):
        sound(replace(scene, camera=camera))


@pytest.mark.parametrize("method", ["layered-depth", "ray-traced", "virtual-objects", "environment-map"])
def test_an_archive_with_a_broken_mesh_is_drawn_without_it(scene, method, tmp_path):
    """As if the mesh had never been there."""
    save(broken(scene, 4, np.nan), tmp_path / "broken.catoptric")
    whole = replace(scene, meshes=scene.meshes[:1], instances=scene.instances[:1])
    pictures = []
    for one in (locate(str(tmp_path / "broken.catoptric")).scene(), whole):
        drawn = METHODS[method]()
        drawn.prepare(one, Lighting.UNLIT)
        pictures.append(drawn.render(View(one.camera, 48, 32)).color)
        drawn.release()
    np.testing.assert_array_equal(*pictures)
