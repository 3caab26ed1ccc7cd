"""The bakes that the panel lists: how they stand, what makes them, and what stops that."""

import time
from functools import partial

import bpy
import pytest
from catoptric.addon.baking.layered_depth import KIND
from catoptric.addon.cache import DIRECTORY_VARIABLE, Cache
from catoptric.addon.interface import bakes, lights, operators_bake, stages, work
from catoptric.addon.methods.layered_depth_published import LayeredDepthPublished
from catoptric.addon.methods.mixed import Mixed
from catoptric.addon.scene import Lighting

from .interface_stage import found, gone, registered, small_scene, temporary, until


@pytest.fixture
def scene():
    with registered():
        yield small_scene()


@pytest.fixture
def saved(scene, tmp_path):
    """The same, saved as stage.blend; gives the folder it lies in."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "stage.blend"))
    return tmp_path


def kinds(scene):
    account = bakes.wait_for(scene, found())
    return {one.name: one.kind for one in account.objects}


# Layered depth textures


def test_bakes_become_fresh_stale_and_missing(scene):
    assert set(kinds(scene).values()) == {bakes.MISSING}
    assert bpy.ops.catoptric.bake(name="Box") == {"FINISHED"}
    assert kinds(scene)["Box"] == bakes.FRESH
    assert bpy.ops.catoptric.bake() == {"FINISHED"}
    assert set(kinds(scene).values()) == {bakes.FRESH}
    with pytest.raises(RuntimeError, match="nothing to bake"):
        bpy.ops.catoptric.bake()
    scene.objects["Box"].location.x += 1.0  # under lamps, a place is part of a bake
    bpy.context.view_layer.update()
    account = bakes.wait_for(scene, found())
    (box,) = (one for one in account.objects if one.name == "Box")
    assert (box.kind, box.why) == (bakes.STALE, '"Box" has moved')
    assert bpy.ops.catoptric.clear() == {"FINISHED"}
    assert set(kinds(scene).values()) == {bakes.MISSING}


def test_a_bake_is_what_is_on_disk(scene):
    kinds(scene)
    bpy.ops.catoptric.bake()
    account = bakes.wait_for(scene, found())
    assert 0 < account.size <= Cache().size()
    assert all(abs(one.written - time.time()) < 600 for one in account.objects)


def test_a_cache_that_cannot_be_written_is_one_line(scene, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "file"))
    kinds(scene)
    with pytest.raises(RuntimeError, match="cannot write to the cache folder"):
        bpy.ops.catoptric.bake()
    assert work.current() is None


def test_an_object_may_go_while_it_is_baked(scene):
    stage = found()
    account = bakes.wait_for(scene, stage)
    task = operators_bake.LayersTask(scene.session_uid, account, account.instances["Box"])
    work.begin(task)
    bpy.data.objects.remove(scene.objects["Box"])
    until(lambda: task.over)
    assert task.problem == ""
    assert "Box" not in kinds(scene)


def entries():
    """The layered depth textures in the cache."""
    return set((Cache().folder / KIND).glob("*.npz"))


@pytest.fixture
def two_mirrors(scene, tmp_path, monkeypatch):
    """The ball and the crate mirror, each by the published method with texels of its own; nothing is baked yet."""
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    scene.objects["Crate"].data.materials[0] = bpy.data.materials["Chrome"]
    for name, resolution in (("Ball", 24), ("Crate", 40)):
        settings = scene.objects[name].catoptric
        settings.method = LayeredDepthPublished.name
        settings.methods.layered_depth_published.resolution = resolution
    bpy.context.view_layer.update()
    return scene


def test_each_reflector_s_own_settings_count(two_mirrors):
    account = bakes.wait_for(two_mirrors, found())
    assert [asked.resolution for asked in account.baked] == [24, 40]
    assert {one.name: one.kind for one in account.objects} == dict.fromkeys(("Ball", "Box", "Crate"), bakes.MISSING)
    assert bpy.ops.catoptric.bake() == {"FINISHED"}
    assert len(entries()) == 2 * 3
    account = bakes.wait_for(two_mirrors, found())
    assert {one.kind for one in account.objects} == {bakes.FRESH}
    assert account.size == sum(path.stat().st_size for path in entries())


def test_what_is_fresh_is_all_that_the_methods_need(two_mirrors):
    assert bakes.wait_for(two_mirrors, found())
    bpy.ops.catoptric.bake()
    stage, before = found(), entries()
    method = Mixed(stages.assignment(two_mirrors, stage.found))
    method.prepare(stage.shown, Lighting(two_mirrors.catoptric.lighting))
    method.release()
    assert entries() == before


def test_a_reflector_s_changed_setting_makes_bakes_stale(two_mirrors):
    assert bakes.wait_for(two_mirrors, found())
    bpy.ops.catoptric.bake()
    assert set(kinds(two_mirrors).values()) == {bakes.FRESH}
    two_mirrors.objects["Crate"].catoptric.methods.layered_depth_published.resolution = 48
    account = bakes.wait_for(two_mirrors, found())
    assert {(one.kind, one.why) for one in account.objects} == {(bakes.STALE, "the settings have changed")}
    two_mirrors.objects["Crate"].catoptric.methods.layered_depth_published.resolution = 40
    two_mirrors.catoptric.methods.layered_depth_published.resolution = 20  # asked for by no reflector
    assert set(kinds(two_mirrors).values()) == {bakes.FRESH}


# Light


@pytest.mark.slow
def test_bake_all_bakes_the_light_and_then_all_that_shows_in_it(saved):
    scene = bpy.context.scene
    scene.objects["Crate"].location.z = 0.7  # like no other test's
    scene.catoptric.lighting = "cycles"
    bpy.context.view_layer.update()
    found()
    lights.wait()
    before = entries()
    told = []
    task = chain(scene)
    work.begin(task)
    until(lambda: told.append(task.fraction) or task.over, 300.0)
    assert (task.problem, task.outcome) == ("", "All is baked")
    assert told == sorted(told)
    assert any(0.0 < fraction < 0.7 for fraction in told)
    account = bakes.wait_for(scene, found())
    assert {one.kind for one in account.states} == {bakes.FRESH}
    assert len(entries() - before) == 2  # with this light alone
    with pytest.raises(RuntimeError, match="nothing to bake"):
        bpy.ops.catoptric.bake()


def chain(scene):
    """What *Bake All* does for a scene whose light is missing."""
    return work.Chain("Baking", partial(operators_bake._light_and_layers, scene, found()))


@pytest.mark.slow
def test_light_is_baked_shown_stale_and_cleared(saved):
    scene = bpy.context.scene
    scene.catoptric.lighting = "cycles"
    stage = found()
    lights.wait()
    assert bakes.wait_for(scene, found()).light.kind == bakes.MISSING
    with pytest.raises(RuntimeError, match="light is missing"):
        bpy.ops.catoptric.bake(name="Box")
    assert bpy.ops.catoptric.bake_light() == {"FINISHED"}
    lights.wait()
    stage = found()
    lit = {one.name for one in stage.shown.instances if one.lightmap is not None}
    assert lit >= {"Box", "Crate"}
    assert bakes.wait_for(scene, stage).light.kind == bakes.FRESH
    bpy.ops.wm.open_mainfile(filepath=str(saved / "stage.blend"))  # it is found again
    scene = bpy.context.scene
    scene.catoptric.lighting = "cycles"
    found()
    lights.wait()
    scene.objects["Box"].location.z += 1.0
    bpy.context.view_layer.update()
    light = bakes.wait_for(scene, found()).light
    assert (light.kind, light.why) == (bakes.STALE, '"Box" has moved')
    assert bpy.ops.catoptric.clear() == {"FINISHED"}
    assert bakes.wait_for(scene, found()).light.kind == bakes.MISSING


@pytest.mark.slow
def test_baked_light_goes_with_the_file_under_any_name(saved):
    scene = bpy.context.scene
    scene.objects["Crate"].location.z = 0.3  # like no other test's
    scene.catoptric.lighting = "cycles"
    bpy.context.view_layer.update()
    found()
    assert bpy.ops.catoptric.bake_light() == {"FINISHED"}
    lights.wait()
    bpy.ops.wm.save_as_mainfile(filepath=str(saved / "elsewhere.blend"))
    assert light_after_opening(saved / "elsewhere.blend") == (bakes.FRESH, "")
    bpy.context.scene.objects["Box"].location.z += 1.0
    bpy.ops.wm.save_as_mainfile(filepath=str(saved / "changed.blend"))
    assert light_after_opening(saved / "changed.blend") == (bakes.STALE, '"Box" has moved')
    found()
    assert bpy.ops.catoptric.clear() == {"FINISHED"}
    bpy.ops.wm.save_mainfile()
    assert light_after_opening(saved / "changed.blend") == (bakes.MISSING, "never baked")


def test_bake_all_begins_with_the_light_and_esc_ends_it(saved):
    scene = bpy.context.scene
    scene.objects["Crate"].location.y = 1.9  # like no other test's
    scene.catoptric.lighting = "cycles"
    bpy.context.view_layer.update()
    before = entries()
    task = chain(scene)
    work.begin(task)
    until(lambda: task.fraction > 0.0)
    process = task._part._process
    work.cancel()
    until(lambda: task.over)
    assert (task.stopped, task.problem) == (True, "")
    assert gone(process.pid)
    until(lambda: temporary() == [])
    assert lights.known(scene) is None
    assert entries() == before


def test_bake_all_without_a_camera_says_why(scene):
    scene.catoptric.lighting = "cycles"
    found()
    lights.wait()
    scene.camera = None
    with pytest.raises(RuntimeError, match="light is missing, and cannot be baked: The scene has no camera"):
        bpy.ops.catoptric.bake()


def light_after_opening(file):
    bpy.ops.wm.open_mainfile(filepath=str(file))
    found()
    lights.wait()
    light = bakes.wait_for(bpy.context.scene, found()).light
    return light.kind, light.why


def test_esc_in_the_middle_of_baking_light_leaves_nothing(saved):
    scene = bpy.context.scene
    scene.objects["Crate"].location.y = 1.7  # like no other test's, whose light lies in the cache
    bpy.context.view_layer.update()
    task = operators_bake.LightTask(scene, found().found)
    work.begin(task)
    until(lambda: task.fraction > 0.0)
    process = task._process
    work.cancel()
    until(lambda: task.over)
    assert task.stopped
    assert task.problem == ""
    assert gone(process.pid)
    until(lambda: temporary() == [])
    assert lights.known(scene) is None
