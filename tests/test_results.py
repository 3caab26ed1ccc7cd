"""Rows measured against a reference, results.json, and the pictures beside it."""

import dataclasses
import json
import re

import numpy as np
import OpenImageIO as oiio
import pytest
from catoptric.addon.errors import MachineError
from catoptric.addon.metrics import Figures, PictureError, to_bytes
from catoptric.addon.scene import Lighting
from catoptric.batch.judging import Shot
from catoptric.batch.pictures import image_paths, load_picture, save_exr, save_png
from catoptric.batch.results import Results, ResultsError, Samples, Times, atomically
from catoptric.tests import stage
from catoptric.tests.report_stage import HOSTILE, SOFTWARE, compared_in, measured, scene_picture


@pytest.fixture
def compared(tmp_path):
    return compared_in(tmp_path)


# Results


def test_results_have_the_schema_others_rely_on(compared):
    results, directory = compared
    content = json.loads(results.save(directory).read_text())
    assert content["schema"] == 1
    assert {"catoptric", "machine", "results", "skipped"} <= set(content)
    assert set(content["machine"]) == {"renderer", "gl", "cpu", "blender", "python"}
    figures = {"pixels", "flip", "flip_hdr", "psnr", "ssim", "mae_8bit", "rel_mse"}
    wanted = {"scene", "frame", "method", "lighting", "width", "height", "settings", "over_reflectors", "over_frame"}
    for result in content["results"]:
        assert wanted | {"time_ms", "images"} <= set(result)
        assert set(result["over_reflectors"]) == set(result["over_frame"]) == figures
        assert set(result["time_ms"]) == {"bake", "reflection", "frame", "stages"}
        assert set(result["images"]) == {"method", "reference", "flip", "retraced"}
        for path in filter(None, result["images"].values()):
            assert (directory / path).is_file()
    assert {"scene", "method", "reason"} <= set(content["skipped"][0])


def test_results_come_back_as_they_were(compared):
    results, directory = compared
    results.save(directory)
    assert Results.load(directory) == results
    again, notice = Results.resume(directory, "0.1.0", SOFTWARE)
    assert again == results
    assert notice is None


def test_numbers_that_json_lacks_become_null(tmp_path):
    results = Results("0.1.0", SOFTWARE)
    measured(tmp_path, results, "box", "m", 0.0, time_ms=Times(bake=float("nan"), reflection=float("inf")))
    results.save(tmp_path)
    assert Results.load(tmp_path).results[0].time_ms == Times()


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda text: text[: len(text) // 2], "results.json"),
        (lambda text: "", "results.json"),
        (lambda text: "[]", "schema 1"),
        (lambda text: text.replace('"schema": 1', '"schema": 2'), "schema 1"),
        (
            lambda text: re.sub(r'"flip": [\d.e-]+', '"flip": "much"', text, count=1),
            r"results\[0\].over_reflectors.flip",
        ),
        (lambda text: text.replace('"width": 48', '"width": 48.5', 1), r"results\[0\].width"),
        (lambda text: text.replace('"frame": 1,', "", 1), "frame"),
        (lambda text: text.replace('"frame": 1,', '"frame": 1, "colour": 3,', 1), "colour"),
    ],
)
def test_damaged_results_are_named_kept_and_started_anew(compared, damage, said):
    results, directory = compared
    path = results.save(directory)
    damaged = damage(path.read_text())
    path.write_text(damaged)
    with pytest.raises(ResultsError, match=said):
        Results.load(directory)
    anew, notice = Results.resume(directory, "0.1.0", SOFTWARE)
    assert anew == Results("0.1.0", SOFTWARE)
    assert "results.damaged.json" in notice
    assert "\n" not in notice
    assert (directory / "results.damaged.json").read_text() == damaged


def test_a_result_replaces_its_older_self_and_its_skip(compared):
    results, directory = compared
    count = len(results.results)
    measured(directory, results, "ball", "layered-depth", 0.4)
    assert len(results.results) == count
    assert results.find(scene="ball", method="layered-depth").time_ms.reflection == 3.4
    assert results.find(scene="ball", method="nobody") is None
    measured(directory, results, "ball", HOSTILE, 0.4)
    assert results.skipped == []


def test_a_result_keeps_its_place_among_the_others(compared):
    """Else a run that went on where another stopped would show methods in another order."""
    results, _ = compared
    before = [(old.scene, old.method) for old in results.results]
    results.add(dataclasses.replace(results.results[1], width=7))
    assert [(new.scene, new.method) for new in results.results] == before
    assert results.results[1].width == 7


def test_rows_are_put_into_words_once(compared):
    """Of a long flight thousands of rows are written after each frame."""
    results, directory = compared
    results.save(directory)
    lines = [result.line for result in results.results]
    results.add(dataclasses.replace(results.results[0], frame=99))
    content = results.save(directory).read_text()
    assert all(old is new.line for old, new in zip(lines, results.results, strict=False))
    assert all(line in content for line in lines)


def test_a_write_that_fails_leaves_the_old_file(tmp_path):
    path = tmp_path / "kept.json"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError), atomically(path) as temporary:
        temporary.write_text("half \ud800", encoding="utf-8")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(MachineError, match="cannot write") as caught, atomically(tmp_path / "file" / "x.json"):
        pass
    assert "\n" not in str(caught.value)


# Rows


@pytest.fixture
def shot(tmp_path):
    """A shot whose left half shows a reflector, not judged yet."""
    scene = stage.scene_of([], stage.looking((0.0, -5.0, 0.0)))
    shot = Shot("box", scene, Lighting.UNLIT, (16, 8), tmp_path)
    shot.mask = np.arange(16) < np.full((8, 1), 8)
    return shot


def test_noise_is_that_of_the_halves_channel_by_channel(shot):
    """Red alone is noisy, on the reflector alone: 10 steps of a screen, a third of it over three channels."""
    reference = np.full((8, 16, 3), 0.25, np.float32)
    half = reference.copy()
    shown = 1.055 * 0.25 ** (1 / 2.4) - 0.055
    half[:, :8, 0] = ((shown + 10 / 255 + 0.055) / 1.055) ** 2.4
    shot.judge_by(reference, half, 200)
    row = shot.result("planar", reference, {}, Times(), [])
    assert row.samples == Samples(200, 100)
    assert row.over_reflectors.mae_8bit == 0.0
    assert row.noise.over_reflectors.mae_8bit == pytest.approx(10 / 3)
    assert row.noise.over_frame.mae_8bit == pytest.approx(10 / 6)


def test_a_row_without_reference_names_no_picture_that_is_not_there(shot):
    row = shot.result("m", np.full((8, 16, 3), 0.5, np.float32), {}, Times(), [])
    assert row.images.reference is None
    assert row.images.flip is None
    assert (shot.out / row.images.method).is_file()
    assert row.over_reflectors == Figures(64)
    results = Results("0.1.0", SOFTWARE, results=[row])
    results.save(shot.out)
    assert Results.load(shot.out) == results


# Pictures


def test_exr_comes_back_bit_exactly_with_its_metadata(tmp_path):
    picture = np.random.default_rng(0).normal(size=(5, 7, 3)).astype(np.float32) * 1e6
    save_exr(tmp_path / "deep" / "a.exr", picture, {"catoptric:method": "m"})
    assert np.array_equal(load_picture(tmp_path / "deep" / "a.exr"), picture)
    spec = oiio.ImageInput.open(str(tmp_path / "deep" / "a.exr")).spec()
    assert spec.getattribute("catoptric:method") == "m"


def test_half_exr_is_clamped_not_infinite(tmp_path):
    save_exr(tmp_path / "a.exr", np.full((2, 2, 3), 1e9, np.float32), half=True)
    assert load_picture(tmp_path / "a.exr").max() == 65504


def test_png_shows_what_the_metrics_see(tmp_path):
    picture, _ = scene_picture()
    save_png(tmp_path / "a.png", picture)
    assert np.array_equal(load_picture(tmp_path / "a.png"), to_bytes(picture))


@pytest.mark.parametrize("content", [None, b"", b"not a picture"])
def test_a_picture_that_cannot_be_read_is_named(tmp_path, content):
    path = tmp_path / "a.exr"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(PictureError, match=r"a\.exr is (missing|damaged)"):
        load_picture(path)


def test_names_that_would_meet_get_paths_of_their_own():
    paths = {image_paths(scene, 1, "unlit", "m").method for scene in ("a b", "a/b", "a-b", "../a b", "é", "ü")}
    assert len(paths) == 6
    assert all(re.fullmatch(r"images/[\w.-]+/unlit-0001-m\.exr", path) for path in paths)
    assert not any("/../" in path for path in paths)
