"""The page made of results and pictures, opened in a real browser where there is one."""

import base64
import dataclasses
import re
import shutil
import subprocess
import zlib

import numpy as np
import pytest
from catoptric.addon.metrics import MAGMA, Figures, error_maps, flip_map, magma, to_bytes
from catoptric.batch.pictures import image_paths, load_picture, save_exr, save_images
from catoptric.batch.report import write_number, write_report
from catoptric.batch.report_pictures import half_codes, pack_flip, pack_picture, window_of_interest
from catoptric.batch.results import Result, Results, Skipped, Times
from catoptric.tests.report_stage import HEIGHT, HOSTILE, SOFTWARE, WIDTH, compared_in, measured, scene_picture
from hypothesis import given, settings
from hypothesis import strategies as st

EMBEDDED = '<script type="text/plain" data-picture='


@pytest.fixture
def compared(tmp_path):
    return compared_in(tmp_path)


def page_of(results, directory):
    return write_report(results, directory).read_text(encoding="utf-8")


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
    codes = unpacked(pack_picture(reference))
    assert np.array_equal(codes, half_codes(reference))
    assert np.array_equal(unpacked(pack_picture(picture, reference), codes), half_codes(picture))


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


def test_methods_that_do_not_fit_for_one_reason_share_a_row(tmp_path):
    skipped = [Skipped("box", method, "it is curved", frame=1) for method in ("planar", "glossy-planes")]
    skipped.append(Skipped("box", "auto", "it is curved", frame=2))
    page = page_of(Results("0.1.0", SOFTWARE, skipped=skipped), tmp_path)
    assert page.count("it is curved") == 2
    assert "<td>planar, glossy-planes</td>" in page


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
    assert "the picture images/ball/unlit-0001-layered-depth.exr is missing" in page
    assert "the picture images/box/unlit-0001-reference.exr is damaged" in page
    assert str(directory) not in page
    assert page.count(EMBEDDED) == 2 + 3
    assert page.count("<article") == 2


def unjudged(directory, results, scene, method, color):
    """What `compare` keeps of an archive, which Cycles cannot render."""
    images = dataclasses.replace(image_paths(scene, 1, "unlit", method), reference=None, flip=None)
    save_exr(directory / images.method, color)
    pixels = Figures(24), Figures(WIDTH * HEIGHT)
    results.add(Result(scene, 1, method, "unlit", WIDTH, HEIGHT, {}, *pixels, Times(frame=2.0), images))


def test_a_scene_without_reference_says_so_and_shows_the_methods(compared):
    results, directory = compared
    unjudged(directory, results, "archive", "environment-map", scene_picture()[0])
    unjudged(directory, results, "archive", "layered-depth", scene_picture(0.5)[0])
    page = page_of(results, directory)
    article = page[page.index('id="title-3">archive') :].split("</article>")[0]
    assert "There is no reference for this scene" in article
    assert page.count("There is no reference for this scene") == 1
    assert "is missing" not in page
    assert article.count(EMBEDDED) == 2
    assert article.count("data:image/jpeg") == 2
    assert "∞" not in article
    assert 'class="best"' not in article


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


def sorted_by(results, directory, clicks):
    """Aria's words for the columns of the first table of figures, and its rows' methods, after `clicks` on headers."""
    page = page_of(results, directory)
    click = "".join(
        f'document.querySelectorAll("article .over_reflectors thead button")[{at}].click();' for at in clicks
    )
    (directory / "clicked.html").write_text(page.replace("</body>", f'<script type="module">{click}</script></body>'))
    switches = ("--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={directory / 'profile'}", "--dump-dom")
    address = (directory / "clicked.html").as_uri()
    run = subprocess.run([CHROMIUM, *switches, address], capture_output=True, text=True, timeout=120, check=True)
    table = re.search(
        r'<div class="scroll over_reflectors">\s*<table>\s*<caption>.*?</table>', run.stdout, re.S
    ).group()
    headers = re.findall(r"<th scope=\"col\"[^>]*>", table)
    directions = {
        at: found.group(1) for at, header in enumerate(headers) if (found := re.search(r'sort="(\w+)"', header))
    }
    return directions, re.findall(r'data-rank="(\w+)"', table)


@in_browser
@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("clicks", "directions", "order"),
    [
        ([], {1: "ascending"}, "abc"),
        ([7], {7: "ascending"}, "cab"),
        ([7, 7], {7: "descending"}, "acb"),
        ([3], {3: "descending"}, "abc"),
        ([3, 0], {0: "ascending"}, "abc"),
        ([0, 0], {0: "descending"}, "cba"),
    ],
)
def test_a_click_on_a_header_sorts_by_it(tmp_path, clicks, directions, order):
    """Error grows from a to c; the reflection pass takes 20, nobody knows how many, and 3 milliseconds."""
    results = Results("0.1.0", SOFTWARE)
    for method, shift, reflection in (("a", 0.05, 20.0), ("b", 0.7, None), ("c", 1.5, 3.0)):
        measured(tmp_path, results, "box", method, shift, time_ms=Times(reflection=reflection))
    assert sorted_by(results, tmp_path, clicks) == (directions, list(order))


@in_browser
@pytest.mark.timeout(300)
def test_the_browser_shows_a_method_where_there_is_no_reference(tmp_path):
    results = Results("0.1.0", SOFTWARE)
    colors = {"m": (0.125, 0.25, 0.5), "n": (0.5, 0.125, 0.0625)}
    for method, color in colors.items():
        unjudged(tmp_path, results, "archive", method, np.full((HEIGHT, WIDTH, 3), color, np.float32))
    page = write_report(results, tmp_path)
    for state, method in {"show=0": "m", "show=2": "n"}.items():
        pixels, log = photographed(page, tmp_path, state)
        assert "CONSOLE" not in log, log
        assert pixels_of(pixels, to_bytes(np.array(colors[method]))) > 300_000, state


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
