"""Opening files, leaving them as they were, and a room that nobody here modelled."""

import gzip
import time

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.errors import Cancelled, SceneError
from catoptric.addon.scene import Fresnel, archive
from catoptric.tests import blender_stage as stage
from catoptric.tests import extract_stage as plain


def refusal(path):
    with pytest.raises(SceneError) as caught:
        open_blend(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.fixture
def saved(tmp_path):
    scene = stage.empty_scene()
    scene.name = "Saved"
    stage.add_camera(scene, (0, 0, 5), (0, 0, 0))
    stage.add_box(scene, "Box", 1.0)
    path = tmp_path / "saved.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def test_a_blend_opens(saved):
    assert open_blend(saved).name == "Saved"
    assert open_blend(str(saved)).name == "Saved"


def test_no_such_file(tmp_path):
    assert "no such file" in refusal(tmp_path / "gone.blend")


def test_a_folder(tmp_path):
    assert "cannot be read" in refusal(tmp_path)


def test_not_a_blend(tmp_path):
    path = tmp_path / "text.blend"
    path.write_text("not a scene")
    assert "not a .blend" in refusal(path)
    path.write_bytes(b"")
    assert "not a .blend" in refusal(path)


@pytest.mark.parametrize("share", [0.001, 0.3, 0.9])
def test_a_truncated_blend(saved, share):
    content = saved.read_bytes()
    saved.write_bytes(content[: max(int(len(content) * share), 20)])
    assert "damaged" in refusal(saved)


def test_something_else_compressed(tmp_path):
    path = tmp_path / "other.blend"
    path.write_bytes(gzip.compress(b"hello" * 100))
    assert "not a .blend" in refusal(path)


def test_a_newer_blender(saved):
    content = saved.read_bytes()
    ours = b"%d%02d" % bpy.app.version[:2]
    head = content[:17]
    assert ours in head, "the version stands in the file's first bytes"
    saved.write_bytes(head.replace(ours, b"9" + ours[1:], 1) + content[17:])
    assert "newer Blender" in refusal(saved)


def contents():
    """Every data block's name and users, and what extraction touches on the way."""
    blocks = {
        name: sorted((block.name_full, block.users) for block in getattr(bpy.data, name))
        for name in dir(bpy.data)
        if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)
    }
    settings = {
        scene.name: (
            scene.frame_current,
            [
                (prop.identifier, repr(getattr(scene.render, prop.identifier)))
                for prop in scene.render.bl_rna.properties
                if prop.type in {"BOOLEAN", "INT", "FLOAT", "ENUM", "STRING"} and not getattr(prop, "is_array", False)
            ],
            [(layer.name, layer.use) for layer in scene.view_layers],
        )
        for scene in bpy.data.scenes
    }
    return blocks, settings


def everything():
    """A scene with a bit of everything that extraction reads."""
    scene, shaped = plain.plane_scene()
    material, _ = plain.textured(image=plain.noise_image())
    shaped.data.materials.append(material)
    stage.add_lamp(scene, "Lamp", "POINT", 10.0)
    bpy.ops.object.text_add()
    bpy.ops.object.metaball_add()
    tree, node = scene.world.node_tree, scene.world.node_tree.nodes["Background"]
    sky = tree.nodes.new("ShaderNodeTexSky")
    tree.links.new(sky.outputs["Color"], node.inputs["Color"])
    scene.frame_set(5)
    return scene


def test_nothing_is_changed():
    scene = everything()
    before = contents()
    extract(scene, frame=9)
    assert contents() == before


def test_nothing_is_changed_when_it_is_cancelled():
    scene = everything()
    before = contents()
    for stage_to_stop in ("reading the scene", "reading the world"):

        def stop(name, fraction, wanted=stage_to_stop):
            if name == wanted:
                raise Cancelled

        with pytest.raises(Cancelled):
            extract(scene, frame=9, progress=stop)
        assert contents() == before


def test_progress_runs_from_0_to_1():
    seen = []
    extract(everything(), progress=lambda name, fraction: seen.append(fraction))
    assert seen == sorted(seen)
    assert (seen[0], seen[-1]) == (0.0, 1.0)


def test_a_scene_that_is_not_the_windows_own():
    other = everything()
    bpy.data.scenes.new("Another")
    bpy.context.window.scene = bpy.data.scenes["Another"] if bpy.context.window else other
    assert {instance.name for instance in extract(other).instances} == {"Plane", "Text", "Mball"}


def test_the_living_room(shared, tmp_path):
    start = time.perf_counter()
    found = extract(open_blend(shared / "scenes" / "living-room.blend"))
    assert time.perf_counter() - start < 60.0
    assert sum(len(found.meshes[instance.mesh].triangles) for instance in found.instances) > 142_000
    mirrors = {found.instances[index].name.split(".")[0] for index in found.reflectors}
    assert mirrors == {"Mirror", "FireplaceGlass", "BrushedStainlessSteel", "Glass"}
    materials = {material.name: material for material in found.materials}
    assert materials["Mirror"].fresnel is Fresnel.SCHLICK
    assert materials["Floor"].base.image is not None
    assert not materials["Sofa"].mirrors
    assert found.world.panorama.shape == (1024, 2048, 3)
    assert len(found.warnings) == 2, "the leaves' alpha and the glass, each once"
    archive.save(found, tmp_path / "room.catoptric")
    again = archive.load(tmp_path / "room.catoptric")
    np.testing.assert_array_equal(again.meshes[10].normals, found.meshes[10].normals)
