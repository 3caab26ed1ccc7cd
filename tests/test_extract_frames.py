"""Reading one frame after another gives what reading each alone gives, and nothing is read or lit in vain."""

import bpy
import numpy as np
import pytest
from catoptric.addon.blender import extract_frames
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.extract_frames import extract_at
from catoptric.addon.cache import Cache
from catoptric.addon.scene import Lighting, alike, only_seen_from_elsewhere, sharing
from catoptric.batch.footage import Footage
from catoptric.batch.sources import BlendFile

from .blender_stage import add_box, add_camera, add_lamp, add_plane, empty_scene, fly, principled


def stage():
    """A mirror on the floor, a box; the camera flies over them."""
    scene = empty_scene()
    add_camera(scene, (0.0, -6.0, 2.0), (1.25, 0.0, 0.0))
    add_plane(scene, "Floor", 8.0, principled("Silver", (1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0))
    add_box(scene, "Box", 1.0, principled("Blue", (0.1, 0.1, 0.8)), (0.0, 0.0, 1.0))
    fly(scene)
    return scene


def rise(scene):
    """The box rises."""
    box = scene.objects["Box"]
    for frame, height in ((1, 1.0), (40, 3.0)):
        box.location.z = height
        box.keyframe_insert("location", frame=frame)


def rise_unseen(scene):
    """The box rises, and the viewport does not show it."""
    rise(scene)
    scene.objects["Box"].hide_viewport = True


def grow(scene):
    """The box's shape changes, by a modifier."""
    modifier = scene.objects["Box"].modifiers.new("Wave", "DISPLACE")
    modifier.mid_level = 0.0
    for frame, strength in ((1, 0.0), (40, 1.0)):
        modifier.strength = strength
        modifier.keyframe_insert("strength", frame=frame)


def blush(scene):
    """The box's colour changes."""
    color = scene.objects["Box"].data.materials[0].node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    for frame, red in ((1, 0.0), (40, 1.0)):
        color.default_value = (red, 0.1, 0.8, 1.0)
        color.keyframe_insert("default_value", frame=frame)


def follow(scene):
    """The box hangs on the camera."""
    scene.objects["Box"].parent = scene.camera


def cut(scene):
    """Another camera takes over in the middle."""
    first = scene.camera
    add_camera(scene, (0.0, -3.0, 4.0), (0.6, 0.0, 0.0))
    for frame, camera in ((1, first), (20, scene.camera)):
        scene.timeline_markers.new("cut", frame=frame).camera = camera


CHANGES = (lambda scene: None, rise, rise_unseen, grow, blush, follow, cut)


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__.strip("<>"))
def test_a_frame_after_another_is_what_it_is_alone(change):
    scene = stage()
    change(scene)
    before = None
    for frame in (1, 2, 30, 30, 5):
        before = extract_at(scene, frame, before)
        alone = extract(scene)
        assert before.frame == scene.frame_current == frame
        assert alike(before, alone)


def test_a_camera_that_moves_costs_no_reading(monkeypatch):
    scene = stage()
    first = extract_at(scene, 1)
    monkeypatch.delattr(extract_frames, "extract")
    second = extract_at(scene, 40, first)
    assert only_seen_from_elsewhere(second, first)
    np.testing.assert_allclose(second.camera.matrix[:3, 3] - first.camera.matrix[:3, 3], (2.0, 0.0, 0.0), atol=1e-6)


def test_what_moves_is_another_object_and_the_rest_is_the_same():
    scene = stage()
    rise(scene)
    first = extract_at(scene, 1)
    second = extract_at(scene, 40, first)
    assert not only_seen_from_elsewhere(second, first)
    same = [one.name for one, other in zip(second.instances, first.instances, strict=True) if one is other]
    assert same == ["Floor"]
    assert all(one is other for one, other in zip(second.meshes, first.meshes, strict=True))


def test_scenes_of_other_sizes_share_what_they_can():
    scene = stage()
    first = extract_at(scene, 1)
    bpy.data.objects.remove(scene.objects["Box"])
    second = sharing(extract(scene), first)
    assert len(second.meshes) == 1
    assert not only_seen_from_elsewhere(second, first)


def footage_of(tmp_path, lighting):
    """The stage, under a lamp, as a file."""
    add_lamp(stage(), "Sun", "SUN", 3.0, (0.0, 0.0, 5.0), (0.3, 0.2, 0.0))
    path = tmp_path / "stage.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    return Footage(BlendFile(path), lighting, Cache(tmp_path / "cache"), 8)


@pytest.mark.slow
def test_light_is_baked_once_while_the_camera_alone_moves(tmp_path):
    footage = footage_of(tmp_path, Lighting.CYCLES)
    first = footage.light(footage.read(1))
    second = footage.light(footage.read(40))
    assert any(instance.lightmap is not None for instance in first.instances)
    assert only_seen_from_elsewhere(second, first)
    assert second.frame == 40
    assert not alike(second.camera, first.camera)


def test_the_first_change_is_found(tmp_path):
    footage = footage_of(tmp_path, Lighting.UNLIT)
    assert footage.first_change((1, 2, 3)) == 2
    assert footage.first_change((40, 41, 50)) is None
