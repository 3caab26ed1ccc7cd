"""`compare --frames`: methods go on from frame to frame; curves, films and key frames come of it."""

import json
from pathlib import Path
from typing import ClassVar

import av
import bpy
import numpy as np
import pytest
from catoptric.addon.errors import SceneError
from catoptric.addon.methods.contract import Reuse
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.metrics import error_maps
from catoptric.batch.cli import main
from catoptric.batch.pictures import load_mask, load_picture

from .blender_stage import add_box, add_camera, add_plane, add_sphere, empty_scene, fly, principled

SIZE = "48x32"
EVERY = 3


class Saving(LayeredDepth):
    """Layered depth that says it takes over from earlier pictures: a stand-in for what keeps a state.

    Source: none. Limitations: it saves nothing.
    """

    name = "saving"
    source = "a stand-in"
    baked = 0
    heights: ClassVar[list[int]] = []

    def bake(self, progress) -> None:
        """Count, and begin with a key frame."""
        type(self).baked += 1
        self.age = -1

    def paint(self, view, canvas, progress) -> dict[str, float]:
        """One picture more since the key frame; those that warm up are of another size."""
        self.heights.append(view.height)
        self.age = -1 if view.height != 32 else self.age + 1
        return super().paint(view, canvas, progress)

    def reflect_in_stages(self, clock, view, seen, target, **sample) -> None:
        """In two stages."""
        with clock("matching"):
            pass
        with clock("retracing"):
            self.reflect(view, seen, target, **sample)

    def reused_on(self, seen) -> Reuse:
        """The left half is retraced, in every third picture all."""
        key = self.age % EVERY == 0
        retraced = np.ones((32, 48), bool) if seen.size == (48, 32) else np.ones(seen.size[::-1], bool)
        retraced[:, 24 if not key else 48 :] = False
        return Reuse(retraced, 1.0 if key else 0.25, key)


class Failing(LayeredDepth):
    """Layered depth that fails in frame 2.

    Source: none. Limitations: it fails.
    """

    name = "failing"
    source = "a stand-in"

    def before_frame(self, view) -> None:
        """Fail once."""
        if self.scene.frame == 2:
            raise SceneError("the second frame is not for me")


@pytest.fixture(autouse=True)
def stand_ins(monkeypatch):
    """The methods above are known by name."""
    monkeypatch.setattr(Saving, "baked", 0)
    monkeypatch.setattr(Saving, "heights", [])
    for kind in (Saving, Failing):
        monkeypatch.setitem(METHODS, kind.name, kind)


def stage():
    """A mirror ball on a floor beside a box."""
    scene = empty_scene()
    add_camera(scene, (0.0, -6.0, 2.0), (1.25, 0.0, 0.0))
    silver = principled("Silver", (1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0)
    add_sphere(scene, "Ball", 1.0, silver, (0.0, 0.0, 1.0), 32, 16)
    add_plane(scene, "Floor", 8.0, principled("Green", (0.1, 0.6, 0.1)))
    add_box(scene, "Box", 1.0, principled("Blue", (0.1, 0.1, 0.8)), (1.8, -0.5, 0.5))
    return scene


def saved(path: Path) -> Path:
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    return path


@pytest.fixture(scope="module")
def flight(tmp_path_factory) -> Path:
    """A .blend whose camera moves over 40 frames."""
    fly(stage())
    return saved(tmp_path_factory.mktemp("scenes") / "flight.blend")


def compare(scene, out, *options, status=0) -> list[dict]:
    """Run it; the rows by frame."""
    line = ["compare", scene, "--out", out, "--resolution", SIZE, *options]
    assert main([str(word) for word in line]) == status
    return sorted(json.loads((out / "results.json").read_text())["results"], key=lambda row: row["frame"])


AGAINST = ("--against", "layered-depth")


def test_a_method_is_prepared_once_for_all_frames(flight, tmp_path):
    rows = compare(flight, tmp_path, "--frames", "1:5", "--methods", "saving", *AGAINST, "--no-videos")
    assert Saving.baked == 1
    own = [row for row in rows if row["method"] == "saving"]
    assert [row["reuse"]["key"] for row in own] == [True, False, False, True, False]
    assert [row["reuse"]["retraced"] for row in own] == [1.0, 0.25, 0.25, 1.0, 0.25]
    assert own[0]["time_ms"]["stages"].keys() == {"visibility", "light", "matching", "retracing"}
    mask = load_mask(tmp_path / own[1]["images"]["retraced"])
    assert mask[:, :24].all()
    assert not mask[:, 24:].any()
    assert not (tmp_path / "films").exists()


@pytest.mark.parametrize(("samples", "warming"), [("1", 3), ("4", 0)])
def test_one_sample_is_timed_once_all_is_compiled(flight, tmp_path, samples, warming):
    options = ("--frames", "1:2", "--methods", "saving", *AGAINST, "--no-videos", "--samples", samples)
    compare(flight, tmp_path, *options)
    assert Saving.heights == [16] * warming + [32, 32]


def test_one_frame_is_prepared_and_given_back(flight, tmp_path):
    (row,) = compare(flight, tmp_path, "--frames", "4", "--methods", "saving", "--samples", "4")
    assert row["frame"] == 4
    assert row["against"] is None
    assert row["over_frame"]["flip"] is not None
    assert not (tmp_path / "films").exists()
    assert "sequence-1" not in (tmp_path / "report.html").read_text()


def test_against_a_method_errors_are_the_distance_from_its_pictures(flight, tmp_path):
    options = ("--frames", "1:2", "--methods", "environment-map,layered-depth", *AGAINST)
    rows = compare(flight, tmp_path, *options)
    assert {row["method"] for row in rows} == {"environment-map", "layered-depth"}
    for row in rows:
        if row["method"] == "layered-depth":
            assert row["over_frame"]["flip"] is row["against"] is row["images"]["reference"] is None
            continue
        assert row["against"] == "layered-depth"
        pictures = [load_picture(tmp_path / row["images"][name]) for name in ("method", "reference")]
        found = error_maps(*pictures).over()
        assert row["over_frame"]["mae_8bit"] == pytest.approx(found.mae_8bit)
        assert row["over_frame"]["flip"] == pytest.approx(found.flip)
        assert row["noise"] is None
    page = (tmp_path / "report.html").read_text()
    assert "measured against layered-depth" in page
    assert "not Cycles" in page


def test_an_archive_is_held_against_a_method(flight, tmp_path, capsys):
    archive = tmp_path / "flight.catoptric"
    assert main(["export", str(flight), "--out", str(archive)]) == 0
    rows = compare(archive, tmp_path / "report", "--methods", "environment-map", *AGAINST)
    assert rows[-1]["against"] == "layered-depth"
    assert rows[-1]["over_frame"]["mae_8bit"] > 0.0
    assert json.loads((tmp_path / "report" / "results.json").read_text())["skipped"] == []
    capsys.readouterr()
    compare(archive, tmp_path / "none", "--methods", "environment-map", *AGAINST, "--frames", "1:3", status=2)
    assert "holds frame 1 alone" in capsys.readouterr().err


def test_resumed_in_the_middle_it_begins_with_a_key_frame_and_says_so(flight, tmp_path, capsys):
    options = ("--methods", "saving", *AGAINST, "--no-videos")
    compare(flight, tmp_path, "--frames", "1:2", *options)
    kept = [path.stat().st_mtime_ns for path in sorted(tmp_path.glob("images/**/*.exr"))]
    assert "key frame:" not in capsys.readouterr().err
    rows = compare(flight, tmp_path, "--frames", "1:4", *options, "--resume")
    assert "saving goes on at frame 3 with a key frame" in capsys.readouterr().err
    own = [row for row in rows if row["method"] == "saving"]
    assert [row["reuse"]["key"] for row in own] == [True, False, True, False]
    assert [bool(row["warnings"]) for row in own] == [False, False, True, False]
    after = [path.stat().st_mtime_ns for path in sorted(tmp_path.glob("images/**/*.exr"))]
    assert after[: len(kept)] == kept
    assert Saving.baked == 2


def test_over_a_frame_that_is_kept_nothing_is_taken_over(flight, tmp_path, capsys):
    options = ("--methods", "saving", *AGAINST, "--no-videos")
    compare(flight, tmp_path, "--frames", "2", *options)
    rows = compare(flight, tmp_path, "--frames", "1:4", *options, "--resume")
    assert [row["reuse"]["key"] for row in rows if row["method"] == "saving"] == [True, True, True, False]
    assert "saving goes on at frame 3 with a key frame" in capsys.readouterr().err


def test_resumed_against_something_else_it_is_measured_again(flight, tmp_path):
    options = ("--frames", "1:2", "--methods", "environment-map", "--samples", "4")
    compare(flight, tmp_path, *options)
    rows = compare(flight, tmp_path, *options, *AGAINST, "--resume")
    assert [row["against"] for row in rows if row["method"] == "environment-map"] == ["layered-depth"] * 2
    rows = compare(flight, tmp_path, *options, "--resume")
    assert [row["against"] for row in rows if row["method"] == "environment-map"] == [None] * 2


def test_a_frame_that_fails_leaves_the_others(flight, tmp_path, capsys):
    rows = compare(flight, tmp_path, "--frames", "1:3", "--methods", "failing", *AGAINST)
    assert [row["frame"] for row in rows if row["method"] == "failing"] == [1, 3]
    (skipped,) = json.loads((tmp_path / "results.json").read_text())["skipped"]
    assert (skipped["frame"], skipped["method"], skipped["error"]) == (2, "failing", True)
    assert "the second frame is not for me" in capsys.readouterr().err


def test_a_film_shows_reference_method_and_what_was_retraced(flight, tmp_path, capsys):
    compare(flight, tmp_path, "--frames", "1:4", "--methods", "saving,environment-map", *AGAINST)
    films = [tmp_path / "films" / "flight" / f"unlit-{name}.mp4" for name in ("saving", "environment-map")]
    assert [path for path in tmp_path.glob("films/**/*.mp4") if path not in films] == []
    page = (tmp_path / "report.html").read_text()
    assert all(str(film.relative_to(tmp_path)) in page for film in films)
    with av.open(str(films[0])) as film:
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]
    assert len(pictures) == 4
    assert pictures[0].shape == (32, 3 * 48 + 2 * 4, 3)
    reference, method, view = (pictures[1][:, start : start + 48] for start in (0, 52, 104))
    assert np.abs(reference - method).mean() < 6.0
    # Coloured pixels of a film are half as fine: the edges do not count.
    assert np.abs(view - method)[:, 28:46].mean() < 6.0
    reddened = (view - method)[:, 2:20].mean(axis=(0, 1))
    assert reddened[0] > 20.0 > 0.0 > reddened[1:].max()
    with av.open(str(films[1])) as film:
        assert film.streams.video[0].width == 2 * 48 + 4
        assert sum(1 for _ in film.decode(video=0)) == 4


def test_without_pyav_a_film_is_a_folder_of_pictures(flight, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "catoptric.batch.preview.video", None)
    compare(flight, tmp_path, "--frames", "1:3", "--methods", "environment-map", *AGAINST)
    pictures = sorted(tmp_path.glob("films/flight/unlit-environment-map/*.png"))
    assert [path.name for path in pictures] == ["0001.png", "0002.png", "0003.png"]
    assert load_picture(pictures[0]).shape == (32, 100, 3)
    assert "films/flight/unlit-environment-map" in (tmp_path / "report.html").read_text()


def test_where_nothing_moves_one_frame_stands_for_all(tmp_path, capsys):
    stage()
    still = saved(tmp_path / "still.blend")
    rows = compare(still, tmp_path / "report", "--frames", "3:9", "--methods", "environment-map", *AGAINST)
    assert {row["frame"] for row in rows} == {3}
    said = capsys.readouterr().err
    assert "neither the camera nor anything else moves from frame 3 to 9" in said


def test_frames_beyond_the_scene_are_named(flight, tmp_path, capsys):
    options = ("--frames", "39:42", "--methods", "environment-map", *AGAINST, "--no-videos")
    assert len(compare(flight, tmp_path, *options)) == 2 * 4
    assert "beyond the scene's own, 1 to 40" in capsys.readouterr().err


def test_many_frames_leave_hdr_flip_out_and_few_do_not(flight, tmp_path):
    options = ("--methods", "environment-map", *AGAINST, "--no-videos")
    few = compare(flight, tmp_path / "few", "--frames", "1:2", *options)
    many = compare(flight, tmp_path / "many", "--frames", "1:7", *options)
    for rows, there in ((few, True), (many, False)):
        judged = [row["over_frame"] for row in rows if row["against"]]
        assert all((figures["flip_hdr"] is not None) == there for figures in judged)
        assert all(figures["flip"] is not None for figures in judged)
