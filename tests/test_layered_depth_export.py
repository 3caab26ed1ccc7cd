"""Layered depth textures kept in the cache and written as atlases."""

import os
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.layered_depth import FACES
from catoptric.addon.baking.layered_depth_atlas import CHANNELS, bake_scene, read_atlas
from catoptric.addon.baking.layered_depth_keys import keys_of
from catoptric.addon.cache import Cache
from catoptric.addon.errors import MachineError, SceneError
from catoptric.addon.scene import ColorSource, Lamp, LampKind, Lighting

from .stage import mesh_of, placed
from .test_layered_depth_bake import IDENTITY, SETTINGS, bake_all, same, scene_with, union

# ------------------------------------------------------------------ the cache


def test_a_moved_object_reuses_its_bake_until_its_content_changes():
    shape = mesh_of(trimesh.creation.icosphere(1))
    scene = scene_with((shape, IDENTITY))
    (key,) = keys_of(scene, Lighting.UNLIT, 48, 16)
    moved = replace(scene, instances=(replace(scene.instances[0], matrix=placed((1, 2, 3), (2, 1, 1), 0.5)),))
    assert keys_of(moved, Lighting.UNLIT, 48, 16) == [key]
    assert keys_of(moved, Lighting.DIRECT, 48, 16) != keys_of(scene, Lighting.DIRECT, 48, 16)
    renamed = replace(scene, materials=(replace(scene.materials[0], name="other"),))
    assert keys_of(renamed, Lighting.UNLIT, 48, 16) == [key]
    changed = [
        replace(scene, materials=(replace(scene.materials[0], base=ColorSource((0.5, 0.5, 0.5))),)),
        replace(scene, meshes=(replace(shape, positions=shape.positions * np.float32(1.01)),)),
        replace(scene, meshes=(replace(shape, uvs=shape.uvs + np.float32(0.1)),)),
    ]
    others = [keys_of(other, Lighting.UNLIT, 48, 16)[0] for other in changed]
    others += [keys_of(scene, Lighting.UNLIT, *size)[0] for size in ((49, 16), (48, 15))]
    assert len({key, *others}) == 6
    lamp = Lamp("sun", LampKind.SUN, np.eye(4), (1.0, 1.0, 1.0))
    lit = replace(scene, lamps=(lamp,))
    assert keys_of(lit, Lighting.UNLIT, 48, 16) == [key]
    assert keys_of(lit, Lighting.DIRECT, 48, 16) != keys_of(scene, Lighting.DIRECT, 48, 16)
    unseen = replace(scene, instances=(replace(scene.instances[0], in_reflections=False),))
    assert keys_of(unseen, Lighting.UNLIT, 48, 16) == [None]


def test_a_bake_comes_back_from_the_cache_bit_by_bit(tmp_path):
    cache = Cache(tmp_path)
    shape = mesh_of(trimesh.creation.torus(1.0, 0.3))
    scene = scene_with((shape, IDENTITY))
    (fresh,) = bake_all(scene, cache)
    (path,) = tmp_path.rglob("*.npz")
    written = path.read_bytes()
    (kept,) = bake_all(replace(scene, instances=(replace(scene.instances[0], matrix=placed((5, 0, 0))),)), cache)
    assert same(fresh, kept)
    assert path.read_bytes() == written
    # Proof that it is read, not baked: what lies there is what comes.
    entry = cache.get("layered-depth", path.stem)
    entry.arrays["0_colors"][:] = 7.0
    cache.put("layered-depth", path.stem, *entry)
    assert (bake_all(scene, cache)[0].axes[0].colors == 7.0).all()
    path.write_bytes(written[:-1000])
    assert same(bake_all(scene, cache)[0], fresh)
    assert cache.get("layered-depth", path.stem) is not None


def test_instances_of_one_mesh_and_material_share_a_bake():
    shape = mesh_of(trimesh.creation.box())
    scene = scene_with((shape, IDENTITY), (shape, placed((3, 0, 0))), (shape, placed((6, 0, 0))))
    instances = scene.instances
    scene = replace(scene, instances=(instances[0], replace(instances[1], materials=(0,)), instances[2]))
    first, second, third = bake_all(scene)
    assert first is second
    assert first is not third
    assert first.axes[0].colors[0, 0, 0] != third.axes[0].colors[0, 0, 0]


# ------------------------------------------------------------------ export


def test_atlases_are_read_back_bit_by_bit(tmp_path):
    shape = union(trimesh.creation.torus(1.0, 0.3), trimesh.creation.icosphere(2, radius=0.4))
    matrix = placed((1, 2, 3), (1, 2, 1), 0.3)
    scene = scene_with((shape, matrix))
    scene = replace(scene, instances=(replace(scene.instances[0], name="a/b: Ring"),))
    files = bake_scene(scene, Lighting.UNLIT, tmp_path / "new" / "folder", dict(SETTINGS))
    (bake,) = bake_all(scene)
    assert [file.name for file in files] == [f"a-b-Ring_layer-{index + 1}.exr" for index in range(bake.layers)]
    assert sorted(path.name for path in files[0].parent.iterdir()) == sorted(file.name for file in files)
    for layer, file in enumerate(files):
        pixels, metadata = read_atlas(file)
        assert metadata["layer"] == layer + 1
        assert metadata["box_low"] == bake.low.tolist()
        assert metadata["transforms"] == {"a/b: Ring": matrix.tolist()}
        rows, columns = pixels.shape[0] // 2, pixels.shape[1] // 3
        for index, name in enumerate(FACES):
            face = bake.face(name)
            height, width = face.counts.shape
            assert metadata["face_rows_and_columns"][name] == [height, width]
            # Undo the layout by hand: v upwards in each cell, + faces in the upper row.
            cell = pixels[::-1][(1 - index % 2) * rows :, (index // 2) * columns :][:height, :width]
            assert np.array_equal(cell[..., CHANNELS.index("layers")], face.counts)
            layers, texels = face.layer(layer)
            held = cell.reshape(-1, len(CHANNELS))[texels]
            assert held[:, :3].tobytes() == face.colors[layers, 0].tobytes()
            assert held[:, 3:5].tobytes() == face.depths[layers].tobytes()
            assert held[:, 5:8].tobytes() == face.normals[layers, 0].tobytes()
            rest = np.delete(cell.reshape(-1, len(CHANNELS)), texels, axis=0)
            assert (rest[:, 3:5] == 1).all()
            assert (rest[:, :3] == 0).all()


def test_objects_with_the_same_name_do_not_overwrite_each_other(tmp_path):
    scene = scene_with((trimesh.creation.box(), IDENTITY), (trimesh.creation.icosphere(1), IDENTITY))
    scene = replace(scene, instances=tuple(replace(instance, name="Thing") for instance in scene.instances))
    files = bake_scene(scene, Lighting.UNLIT, tmp_path)
    assert [file.name for file in files] == ["Thing_layer-1.exr", "Thing-2_layer-1.exr"]


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").write_text("in the way")
    scene = scene_with((trimesh.creation.box(), IDENTITY))
    with pytest.raises(MachineError, match="cannot make the folder"):
        bake_scene(scene, Lighting.UNLIT, tmp_path / "file" / "below")


def test_a_file_that_is_no_atlas_is_one_line(tmp_path):
    (tmp_path / "noise.exr").write_bytes(os.urandom(500))
    with pytest.raises(SceneError, match="cannot read"):
        read_atlas(tmp_path / "noise.exr")
