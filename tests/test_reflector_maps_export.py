"""Reflector maps written as EXR files."""

import os
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.layered_depth_atlas import bake_scene
from catoptric.addon.baking.reflector_maps_export import CHANNELS, export_maps, read_maps
from catoptric.addon.cache import Cache
from catoptric.addon.errors import SceneError, UsageError
from catoptric.addon.scene import Lighting

from .search_stage import maps_of, sphere
from .stage import looking, mesh_of, placed, scene_of

SETTINGS = {"map_size": 64, "finer": 0, "spread": 35.0}


def ring():
    return mesh_of(trimesh.creation.torus(1.0, 0.4, major_sections=24, minor_sections=12), smooth=True, name="ring")


def mirrors(*parts):
    scene = scene_of([(mesh, matrix, True) for mesh, matrix in parts], looking((0, -5, 0)))
    names = ("a/b: Mirror", "a/b: Mirror", "Other")
    return replace(scene, instances=tuple(map(lambda i, n: replace(i, name=n), scene.instances, names)))


@pytest.mark.parametrize("mesh", [sphere(2), ring()], ids=["whole", "patches"])
def test_maps_are_read_back_bit_by_bit(mesh, tmp_path):
    matrix = placed((1, 2, 3), (1, 2, 1), 0.3)
    (path,) = export_maps(mirrors((mesh, matrix)), tmp_path / "new" / "folder", SETTINGS)
    assert path.name == "a-b-Mirror_reflector-maps.exr"
    assert list(path.parent.iterdir()) == [path]
    baked, stored = maps_of(mesh, 64, 0, 35.0), read_maps(path)
    assert len(baked) == len(stored)
    for number, (one, there) in enumerate(zip(baked, stored, strict=True), 1):
        for name in ("positions", "normals", "covered"):
            assert getattr(there, name).tobytes() == getattr(one, name).tobytes()
        said = there.metadata
        assert (said["object"], said["mesh"], said["part"]) == ("a/b: Mirror", mesh.name, number)
        assert said["transforms"] == {"a/b: Mirror": matrix.tolist()}
        assert (said["centre"], said["frame"]) == (one.part.centre.tolist(), one.part.frame.tolist())
        assert (said["reach"], said["triangles"]) == (one.reach, len(one.part.triangles))
        assert said["curvature"] == one.part.curvature.name.lower()


def test_faces_lie_side_by_side_with_row_0_at_the_top(tmp_path):
    import OpenImageIO as oiio

    (path,) = export_maps(mirrors((sphere(2), np.eye(4))), tmp_path, SETTINGS)
    buffer = oiio.ImageBuf(str(path))
    assert (buffer.spec().width, buffer.spec().height) == (6 * 64, 64)
    pixels = buffer.get_pixels(oiio.FLOAT)[..., [buffer.spec().channelnames.index(name) for name in CHANNELS]]
    for face, axis in enumerate(np.repeat(np.eye(3), 2, axis=0) * np.tile([[1], [-1]], (3, 1))):
        middle = pixels[31:33, 64 * face + 31 : 64 * face + 33].mean(axis=(0, 1))
        assert np.abs(middle[:3] - axis).max() < 0.05
    # The face +X: upwards is +Z, rightwards -Y.
    assert pixels[0, 32, 2] > 0.6
    assert pixels[32, 63, 1] < -0.6


def test_instances_of_one_mesh_share_a_file_and_names_do_not_clash(tmp_path):
    mesh = sphere(2)
    scene = mirrors((mesh, np.eye(4)), (ring(), placed((5, 0, 0))), (mesh, placed((0, 5, 0))))
    files = export_maps(scene, tmp_path, SETTINGS, Cache(tmp_path / "cache"))
    assert [file.name for file in files] == ["a-b-Mirror_reflector-maps.exr", "a-b-Mirror-2_reflector-maps.exr"]
    (ball,) = read_maps(files[0])
    assert set(ball.metadata["transforms"]) == {"a/b: Mirror", "Other"}


def test_what_is_no_map_is_one_line(tmp_path):
    (tmp_path / "noise.exr").write_bytes(os.urandom(500))
    with pytest.raises(SceneError, match="cannot read"):
        read_maps(tmp_path / "noise.exr")
    scene = scene_of([(sphere(2), np.eye(4), False)], looking((0, -5, 0)))
    (atlas,) = bake_scene(scene, Lighting.UNLIT, tmp_path, {"resolution": 16})[:1]
    with pytest.raises(SceneError, match="no reflector maps"):
        read_maps(atlas)
    with pytest.raises(UsageError, match="map_size"):
        export_maps(scene, tmp_path, {"map_size": 1})
    assert export_maps(scene, tmp_path, SETTINGS) == []
