"""Every button: when it can be pressed, what it does, and what it leaves."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest
from catoptric.addon.interface import (
    background,
    bakes,
    lights,
    operators_bake,
    operators_compare,
    preflight,
    stages,
    work,
)
from catoptric.addon.scene import Lighting
from catoptric.addon.scene.archive import load

from .blender_stage import state
from .interface_stage import found, gone, left_behind, registered, small_scene, temporary, until

KEEP_ON_KEEPING = 50


@pytest.fixture
def scene():
    with registered():
        yield small_scene()


@pytest.fixture
def saved(scene, tmp_path):
    """The same, saved as stage.blend; gives the folder it lies in."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "stage.blend"))
    return tmp_path


# Registration


def test_register_and_unregister_50_times_leaves_nothing():
    before = left_behind()
    for _ in range(KEEP_ON_KEEPING):
        with registered():
            pass
    assert left_behind() == before
    for timer in (work._look, lights.poll, bakes.poll, stages._poll):
        assert not bpy.app.timers.is_registered(timer)


def test_settings_are_saved_and_loaded(saved):
    scene = bpy.context.scene
    scene.catoptric.method, scene.catoptric.lighting = "layered-depth-published", "unlit"
    scene.catoptric.methods.layered_depth_published.linear_steps = 17
    scene.catoptric.compared = "ALL"
    ball = scene.objects["Ball"].catoptric
    ball.method, ball.reflects = "environment-map", "NO"
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(saved / "stage.blend"))
    settings = bpy.context.scene.catoptric
    assert (settings.method, settings.lighting, settings.compared) == ("layered-depth-published", "unlit", "ALL")
    assert settings.methods.layered_depth_published.linear_steps == 17
    ball = bpy.context.scene.objects["Ball"].catoptric
    assert (ball.method, ball.reflects) == ("environment-map", "NO")


# What acts at once


def test_show_chooses_the_engine(scene):
    assert bpy.ops.catoptric.show() == {"FINISHED"}
    assert scene.render.engine == "CATOPTRIC"


def test_find_reads_the_scene_and_sees_changes(scene):
    assert len(found().found.reflectors) == 1
    scene.objects["Ball"].catoptric.reflects = "NO"
    assert found().found.reflectors == ()


def test_select_makes_an_object_the_only_one(scene):
    scene.objects["Box"].select_set(True)
    assert bpy.ops.catoptric.select(name="Ball") == {"FINISHED"}
    assert [holder.name for holder in bpy.context.selected_objects] == ["Ball"]
    assert bpy.context.view_layer.objects.active.name == "Ball"
    with pytest.raises(RuntimeError, match="not in this view layer"):
        bpy.ops.catoptric.select(name="Nobody")


def test_an_object_is_made_a_mirror(scene):
    bpy.context.view_layer.objects.active = scene.objects["Box"]
    assert bpy.ops.catoptric.make_mirror() == {"FINISHED"}
    bpy.context.view_layer.update()
    stage = found()
    assert {stage.found.instances[index].name for index in stage.found.reflectors} == {"Ball", "Box"}


@pytest.mark.parametrize("name", ["bake", "bake_light", "clear"])
def test_nothing_is_baked_before_the_scene_was_read(scene, name):
    assert not getattr(bpy.ops.catoptric, name).poll()


def test_what_needs_a_camera_says_so(scene):
    found()
    scene.camera = None
    for name in ("compare", "bake_light", "export_scene"):
        assert not getattr(bpy.ops.catoptric, name).poll()
    assert not bpy.ops.catoptric.open_report.poll()
    assert not bpy.ops.catoptric.stop.poll()


# Tasks


def test_another_file_ends_what_is_under_way(scene):
    account = bakes.wait_for(scene, found())
    task = operators_bake.LayersTask(scene.session_uid, account, account.instances["Box"])
    work.begin(task)
    bpy.ops.wm.read_homefile(use_empty=True)
    assert work.current() is None
    assert task.over


def test_one_thing_at_a_time(scene):
    account = bakes.wait_for(scene, found())
    task = operators_bake.LayersTask(scene.session_uid, account, account.instances["Box"])
    work.begin(task)
    assert not bpy.ops.catoptric.compare.poll()
    assert bpy.ops.catoptric.stop() == {"FINISHED"}
    until(lambda: task.over)
    assert task.stopped
    assert bpy.ops.catoptric.compare.poll()


# Beside Blender


def test_compare_writes_a_report_beside_the_file_and_leaves_the_scene(saved):
    scene = bpy.context.scene
    before, objects = state(), len(bpy.data.objects)
    assert bpy.ops.catoptric.compare() == {"FINISHED"}
    folder = saved / "stage-catoptric" / "Scene"
    assert (folder / "report.html").is_file()
    (row,) = json.loads((folder / "results.json").read_text())["results"]
    assert (row["method"], row["lighting"], row["width"]) == ("auto", scene.catoptric.lighting, 48)
    assert row["over_reflectors"]["flip"] < 0.2
    assert bpy.ops.catoptric.open_report() == {"FINISHED"}
    assert state() == before
    assert len(bpy.data.objects) == objects
    assert bpy.data.filepath == str(saved / "stage.blend")
    until(lambda: temporary() == [])


def test_compare_without_a_reflector_says_so_and_leaves_no_folder(saved):
    bpy.context.scene.objects["Ball"].catoptric.reflects = "NO"
    with pytest.raises(RuntimeError, match="nothing reflects here"):
        bpy.ops.catoptric.compare()
    until(lambda: not (saved / "stage-catoptric" / "Scene").exists())


def test_the_report_of_an_unsaved_file_stays_in_the_user_s_folder(scene, tmp_path, monkeypatch):
    monkeypatch.setenv("BLENDER_USER_RESOURCES", str(tmp_path / "user"))
    (said,) = preflight.unsaved(operators_compare.report_folder(scene))
    assert bpy.ops.catoptric.compare() == {"FINISHED"}
    (report,) = (tmp_path / "user").rglob("report.html")
    assert str(report.parent) in said
    assert Path(bpy.app.tempdir) not in report.parents
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "named.blend"))
    assert operators_compare.last_report(bpy.context.scene) == report  # *Open Report* finds it still
    assert preflight.unsaved(report) == []


def test_two_unsaved_files_share_no_folder(scene):
    before = operators_compare.report_folder(scene)
    time.sleep(1.1)
    bpy.ops.wm.read_homefile(use_empty=True)
    assert operators_compare.report_folder(bpy.context.scene) != before


def test_exports_are_written(saved):
    assert bpy.ops.catoptric.export_scene(filepath=str(saved / "out.catoptric")) == {"FINISHED"}
    assert len(load(saved / "out.catoptric").instances) == 3
    bpy.ops.catoptric.select(name="Box")
    assert bpy.ops.catoptric.export_engine(filepath=str(saved / "engine")) == {"FINISHED"}
    assert (saved / "engine" / "catoptric.json").is_file()


def test_an_export_that_cannot_be_written_is_one_line(saved):
    with pytest.raises(RuntimeError, match="there is no folder"):
        bpy.ops.catoptric.export_scene(filepath=str(saved / "nowhere" / "out.catoptric"))


QUIT = """
import os, sys, time
import bpy, catoptric
bpy.ops.wm.open_mainfile(filepath={file!r})
catoptric.register()
from catoptric.addon.interface import operators_compare, work
task = operators_compare._Comparison(
    0,
    operators_compare.report_folder(bpy.context.scene),
    lighting="unlit",
    settings={{"layered-depth": {{}}}},
    samples=4096,
)
work.begin(task)
while not task.fraction:
    work._look()
    time.sleep(0.05)
print(task._process.pid, task.folder, flush=True)
{end}
"""


@pytest.mark.parametrize("end", ["catoptric.unregister(); sys.exit()", "os.kill(os.getpid(), 9)"])
def test_the_process_beside_goes_when_blender_does(saved, end):
    code = QUIT.format(file=str(saved / "stage.blend"), end=end)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode in (0, -signal.SIGKILL), done.stderr
    pid, folder = done.stdout.splitlines()[-1].split(maxsplit=1)
    assert gone(int(pid))
    if done.returncode == 0:
        assert not Path(folder).exists()


def test_a_process_that_fails_tells_its_last_words(saved):
    task = background.ProcessTask("Failing", "export", out="x.catoptric", nonsense=True, lighting=Lighting.UNLIT.value)
    work.begin(task)
    until(lambda: task.over)
    assert "nonsense" in task.problem
    assert "\n" not in task.problem
