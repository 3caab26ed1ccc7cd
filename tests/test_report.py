"""results.json, the pictures beside it, and the page made of them, opened in a real browser where there is one."""

import base64
import dataclasses
import json
import re
import shutil
import subprocess
import zlib
from functools import cache

import numpy as np
import OpenImageIO as oiio
import pytest
from catoptric.addon.errors import MachineError
from catoptric.addon.metrics import (
    MAGMA,
    Figures,
    PictureError,
    error_maps,
    exposures_of,
    flip_map,
    magma,
    noise_maps,
    to_bytes,
)
from catoptric.batch.pictures import image_paths, load_picture, save_exr, save_images, save_png
from catoptric.batch.report import write_number, write_report
from catoptric.batch.report_pictures import half_codes, pack_flip, pack_method, pack_reference, window_of_interest
from catoptric.batch.results import (
    Machine,
    Noise,
    Result,
    Results,
    ResultsError,
    Skipped,
    Times,
    atomically,
)
from hypothesis import given, settings
from hypothesis import strategies as st

WIDTH, HEIGHT = 48, 32
SOFTWARE = Machine("llvmpipe (LLVM 15.0.6, 256 bits)", "4.5 Mesa", "a processor", "5.2.3", "3.13.0")
EMBEDDED = '<script type="text/plain" data-picture='
HOSTILE = "</script><b>\"&'"


def scene_picture(shift=0.0):
    """A bright disc, brighter than white, on a gradient; `shift` moves what the disc shows."""
    y, x = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
    picture = np.stack([x / WIDTH, y / HEIGHT, np.full_like(x, 0.2)], axis=-1)
    disc = (x - 24) ** 2 + (y - 16) ** 2 < 100
    picture[disc] = 1.5 + np.sin(x[disc] + shift)[:, None] * (1.0, 0.5, 0.2)
    return picture, disc


@cache
def compared_once(shift):
    """The error maps of `scene_picture(shift)` and the noise of its reference: FLIP is slow where cores are shared."""
    reference, _ = scene_picture()
    exposures = exposures_of(reference)
    maps = error_maps(scene_picture(shift)[0], reference, exposures)
    return maps, noise_maps(reference * 1.001, reference * 0.999, exposures)


def measured(directory, results, scene, method, shift, **changes):
    """Compare, write the pictures, and add the result: what `compare` does for each method."""
    (reference, disc), (color, _) = scene_picture(), scene_picture(shift)
    maps, noise = compared_once(shift)
    images = image_paths(scene, 1, "unlit", method)
    save_images(directory, images, color, reference, maps.flip, {"catoptric:method": method})
    result = Result(
        scene=scene,
        frame=1,
        method=method,
        lighting="unlit",
        width=WIDTH,
        height=HEIGHT,
        settings={"texels": 512, "threshold": 0.01, "exact": True, "filter": "linear"},
        over_reflectors=maps.over(disc),
        over_frame=maps.over(),
        time_ms=Times(bake=120.0, reflection=3.0 + shift, frame=9.0),
        images=images,
        noise=Noise(noise.over(disc), noise.over()),
    )
    results.add(dataclasses.replace(result, **changes))


@pytest.fixture
def compared(tmp_path):
    """Two scenes, three methods, one of them missing in the second; and where they lie."""
    results = Results("0.1.0", SOFTWARE, sources={"environment-map": "a source & more"})
    for scene in ("box", "ball"):
        measured(tmp_path, results, scene, "environment-map", 1.5)
        measured(tmp_path, results, scene, "layered-depth", 0.05)
    measured(tmp_path, results, "box", HOSTILE, 0.7, warnings=[f"warned of {HOSTILE}"])
    results.skip(Skipped("ball", HOSTILE, f"a reason with {HOSTILE}", error=True))
    return results, tmp_path


def page_of(results, directory):
    return write_report(results, directory).read_text(encoding="utf-8")


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
        assert set(result["time_ms"]) == {"bake", "reflection", "frame"}
        assert set(result["images"]) == {"method", "reference", "flip"}
        for path in result["images"].values():
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


# Pictures in the page


def unpacked(text, reference=None):
    """What pictures.js does, in NumPy."""
    parts = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8).reshape(3, 3, HEIGHT, WIDTH).astype(int)
    folded = parts[0] + 256 * parts[1] + 65536 * parts[2]
    green, red, blue = (folded >> 1) ^ -(folded & 1)
    differences = np.stack([green + red, green, green + blue], axis=-1)
    return np.cumsum(differences, axis=1) if reference is None else differences + reference


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=20, deadline=None)
def test_packed_pictures_are_lossless(seed, scale):
    rng = np.random.default_rng(seed)
    reference, picture = (rng.normal(size=(HEIGHT, WIDTH, 3)).astype(np.float32) * scale for _ in range(2))
    codes = unpacked(pack_reference(reference))
    assert np.array_equal(codes, half_codes(reference))
    assert np.array_equal(unpacked(pack_method(picture, reference), codes), half_codes(picture))


def test_half_codes_are_halves_of_what_can_be_shown():
    values = np.array([-1.0, 0.0, 0.5, 1.0, 1e9])
    assert half_codes(values).astype(np.uint16).view(np.float16).tolist() == [0.0, 0.0, 0.5, 1.0, 65504.0]


def test_packed_flip_gives_the_values_back():
    values = np.linspace(0.0, 1.0, HEIGHT * WIDTH).reshape(HEIGHT, WIDTH)
    steps = np.frombuffer(zlib.decompress(base64.b64decode(pack_flip(magma(values)))), np.uint8)
    assert np.array_equal(steps, np.round(255 * values).astype(np.uint8).ravel())


def test_thumbnails_show_where_methods_differ():
    reference, disc = scene_picture()
    rows, columns = window_of_interest([reference, scene_picture(1.5)[0]])
    assert disc[rows, columns].mean() > 2 * disc.mean()
    assert (columns.stop - columns.start) / (rows.stop - rows.start) == pytest.approx(WIDTH / HEIGHT, rel=0.1)
    assert window_of_interest([reference, reference]) == (slice(0, HEIGHT), slice(0, WIDTH))


# The page


def test_the_page_needs_nothing_else(compared):
    page = page_of(*compared)
    assert not re.search(r"(?:https?:)?//[a-z0-9-]+\.[a-z]", re.sub(r"base64,[\w+/=]+|>[\w+/=]{200,}<", "", page))
    assert "default-src 'none'" in page
    assert not re.search(r"<(link|iframe|object)\b|<script[^>]*\bsrc=|@import", page)


def test_the_page_shows_every_method_scene_reason_and_source(compared):
    page = page_of(*compared)
    for word in (
        "environment-map",
        "layered-depth",
        "box",
        "ball",
        "a source &amp; more",
        "texels",
        "software rendering",
    ):
        assert word in page
    assert "a reason with &lt;/script&gt;&lt;b&gt;&#34;&amp;&#39;" in page
    assert "warned of &lt;/script&gt;" in page
    assert HOSTILE not in page
    assert page.count(EMBEDDED) == 2 + 2 + 3


def test_least_error_comes_first_and_is_marked(compared):
    page = page_of(*compared)
    table = page[page.index("<caption>") : page.index("</table>", page.index("<caption>"))]
    assert table.index("layered-depth") < table.index("environment-map")
    best = re.search(r'<td class="best">([\d.]+)', table).group(1)
    least = min(result.over_reflectors.flip for result in compared[0].results if result.scene == "ball")
    assert best == f"{least:.4f}"


def test_scenes_where_the_best_method_fails_come_first(compared):
    results, directory = compared
    measured(directory, results, "hard", "environment-map", 1.5)
    page = page_of(results, directory)
    assert re.search(r'id="title-1">(\S+)', page).group(1) == "hard"


def test_a_graphics_card_is_not_called_software(compared):
    results, directory = compared
    results.machine = dataclasses.replace(SOFTWARE, renderer="NVIDIA GeForce RTX 4070/PCIe/SSE2")
    page = page_of(results, directory)
    assert "software rendering" not in page
    assert "RTX 4070" in page


def test_a_page_of_nothing_says_so(tmp_path):
    assert "Nothing was measured." in page_of(Results("0.1.0", SOFTWARE), tmp_path)


def test_a_page_of_reasons_only(tmp_path):
    results = Results("0.1.0", SOFTWARE, skipped=[Skipped("box", "m", "no reflector")])
    page = page_of(results, tmp_path)
    assert "no reflector" in page
    assert "the reasons are below" in page


def test_a_page_of_one_result_without_numbers(tmp_path):
    results = Results("0.1.0", SOFTWARE)
    measured(tmp_path, results, "box", "m", 0.0, over_reflectors=Figures(0), noise=None, time_ms=Times())
    page = page_of(results, tmp_path)
    assert page.count("<article") == 1
    assert "∞" in page


def test_missing_pictures_are_named_and_figures_kept(compared):
    results, directory = compared
    (directory / results.find(scene="ball", method="layered-depth").images.method).unlink()
    (directory / results.find(scene="box").images.reference).write_bytes(b"")
    page = page_of(results, directory)
    assert "unlit-0001-layered-depth.exr is missing" in page
    assert "unlit-0001-reference.exr is damaged" in page
    assert page.count(EMBEDDED) == 2
    assert page.count("<article") == 2


def test_a_page_too_large_keeps_its_figures(compared):
    results, directory = compared
    page = write_report(results, directory, limit=0).read_text()
    assert EMBEDDED not in page
    assert "left out here" in page
    assert page.count("data:image/jpeg") == 2 + 2 + 3


@pytest.mark.parametrize(
    ("value", "digits", "written"),
    [
        (None, 4, "–"),
        (float("inf"), 1, "∞"),
        (0.01234, 4, "0.0123"),
        (0.0, 2, "0.00"),
        (3e-6, 4, "3.0e-06"),
        (2100.04, 2, "2100"),
    ],
)
def test_numbers_are_written_for_people(value, digits, written):
    assert write_number(value, digits) == written


# In a browser

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)
in_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here to open the report with")


def photographed(page, folder, state):
    """The pixels (H, W, 3) uint8 of `page` in a window, and what the browser logged.

    The browser's virtual clock does not wait for the thread that inflates pictures, so an empty
    stage, which is grey, is looked at again.
    """
    shot = folder / "shot.png"
    switches = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--force-device-scale-factor=1")
    files = (f"--user-data-dir={folder / 'profile'}", f"--screenshot={shot}", f"{page.as_uri()}#{state}")
    timing = ("--enable-logging=stderr", "--window-size=1400,1600", "--virtual-time-budget=6000")
    for _ in range(8):
        run = subprocess.run(
            [CHROMIUM, *switches, *timing, *files], capture_output=True, text=True, timeout=120, check=True
        )
        pixels = load_picture(shot)
        if pixels_of(pixels, (128, 128, 128)) < 100_000:
            break
    return pixels, run.stderr


def pixels_of(pixels, color):
    """How many pixels have just that colour."""
    return int((pixels == np.array(color)).all(axis=-1).sum())


@in_browser
@pytest.mark.timeout(300)
def test_the_browser_shows_each_mode_without_errors(tmp_path):
    """Constant pictures, so that each mode must fill the stage with one known colour."""
    results = Results("0.1.0", SOFTWARE)
    reference, color = np.zeros((HEIGHT, WIDTH, 3), np.float32), np.zeros((HEIGHT, WIDTH, 3), np.float32)
    reference[:], color[:] = (0.125, 0.25, 0.5), (0.125, 0.25, 0.50390625)
    flip = flip_map(color, reference)
    images = image_paths("flat", 1, "unlit", "m")
    save_images(tmp_path, images, color, reference, flip, {})
    maps = error_maps(color, reference)
    results.add(Result("flat", 1, "m", "unlit", WIDTH, HEIGHT, {}, maps.over(), maps.over(), Times(), images))
    page = write_report(results, tmp_path)
    shown, other = to_bytes(reference)[0, 0].tolist(), to_bytes(2 * reference)[0, 0].tolist()
    expected = {
        "mode=picture&show=0": shown,
        "mode=picture&show=0&exposure=1": other,
        "mode=flip&show=1": MAGMA[round(255 * float(flip[16, 24]))].tolist(),
        "mode=flip&show=0": MAGMA[0].tolist(),
    }
    for state, color_shown in expected.items():
        pixels, log = photographed(page, tmp_path, state)
        assert "CONSOLE" not in log, log
        assert pixels_of(pixels, color_shown) > 300_000, state
    pixels, log = photographed(page, tmp_path, "mode=difference&show=1")
    assert "CONSOLE" not in log, log
    encoded = [1.055 * value ** (1 / 2.4) - 0.055 for value in (0.50390625, 0.5)]
    wanted = 60 * 255 * (encoded[0] - encoded[1])
    stage = pixels[(pixels[..., 0] == 0) & (pixels[..., 1] == 0)]
    assert np.median(stage[:, 2]) == pytest.approx(wanted, abs=1)
