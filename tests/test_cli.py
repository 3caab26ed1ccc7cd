"""The command line as a person meets it: what it writes, and what it says when something is wrong."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
from catoptric.addon.baking.layered_depth_atlas import read_atlas
from catoptric.addon.baking.reflector_maps_export import read_maps
from catoptric.addon.methods.registry import METHODS
from catoptric.batch.cli import main
from catoptric.batch.pictures import load_picture

from .blender_stage import add_box, add_camera, add_plane, add_sphere, empty_scene, fly, principled

SIZE = "48x32"
QUICK = ["--resolution", SIZE, "--samples", "2", "--methods", "environment-map,layered-depth"]


def stage(camera=True, mirror=True):
    """A mirror ball on a red floor beside a blue box."""
    scene = empty_scene()
    if camera:
        add_camera(scene, (0.0, -6.0, 2.0), (1.25, 0.0, 0.0))
    metal = {"Metallic": 1.0, "Roughness": 0.0} if mirror else {}
    add_sphere(scene, "Ball", 1.0, principled("Silver", (1.0, 1.0, 1.0), **metal), (0.0, 0.0, 1.0), 32, 16)
    add_plane(scene, "Floor", 8.0, principled("Red", (0.8, 0.1, 0.1)))
    add_box(scene, "Box", 1.0, principled("Blue", (0.1, 0.1, 0.8)), (1.8, -0.5, 0.5))
    return scene


def save(path: Path) -> Path:
    """Save Blender's open file."""
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    return path


@pytest.fixture(scope="session")
def blend(tmp_path_factory) -> Path:
    """A .blend file that is all right."""
    stage()
    return save(tmp_path_factory.mktemp("scenes") / "stage.blend")


@pytest.fixture(scope="session")
def flight(tmp_path_factory) -> Path:
    """The same with a camera that moves over 40 frames."""
    fly(stage())
    return save(tmp_path_factory.mktemp("scenes") / "flight.blend")


@pytest.fixture(scope="session")
def archive(blend) -> Path:
    """The same, exported."""
    path = blend.with_name("exported.catoptric")
    assert main(["export", str(blend), "--out", str(path)]) == 0
    return path


@pytest.fixture
def complain(capsys):
    """Run a command line that must fail; returns the one line that it says."""

    def run(*arguments: object, status: int = 2) -> str:
        capsys.readouterr()
        assert main([str(argument) for argument in arguments]) == status
        lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("catoptric:")]
        assert len(lines) == 1, lines
        return lines[0]

    return run


def results_in(folder: Path) -> dict:
    """results.json."""
    return json.loads((folder / "results.json").read_text())


def start(*arguments: object, first: str = "pass", **options) -> subprocess.Popen:
    """A process of its own that runs `first`, which is safe among threads, then the command. It minds Ctrl-C."""
    minded = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    command = [
        sys.executable,
        "-c",
        f"{minded}; {first}; import sys; from catoptric.batch.cli import main; sys.exit(main())",
    ]
    return subprocess.Popen(
        [*command, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


# What it does


def test_compare_writes_rows_pictures_and_a_page(blend, tmp_path):
    assert main(["compare", str(blend), "--out", str(tmp_path), *QUICK]) == 0
    written = results_in(tmp_path)
    assert written["schema"] == 1
    assert set(written["machine"]) == {"renderer", "gl", "cpu", "blender", "python"}
    assert [row["method"] for row in written["results"]] == ["environment-map", "layered-depth"]
    for row in written["results"]:
        assert (row["scene"], row["width"], row["height"], row["lighting"]) == ("stage", 48, 32, "unlit")
        assert row["over_frame"]["pixels"] == 48 * 32
        assert 0 < row["over_reflectors"]["pixels"] < 48 * 32
        assert row["time_ms"]["reflection"] > 0.0
        for picture in filter(None, row["images"].values()):
            assert load_picture(tmp_path / picture).shape == (32, 48, 3)
    errors = {row["method"]: row["over_reflectors"]["flip"] for row in written["results"]}
    assert errors["layered-depth"] < 0.5 * errors["environment-map"]
    assert "<html" in (tmp_path / "report.html").read_text()


def test_resume_keeps_what_is_done_and_measures_what_is_not(blend, tmp_path):
    first = ["compare", blend, "--out", tmp_path, "--resolution", SIZE, "--samples", "2", "--methods"]
    assert main([*map(str, first), "environment-map"]) == 0
    kept = tmp_path / results_in(tmp_path)["results"][0]["images"]["method"]
    before = kept.stat().st_mtime_ns
    assert main([*map(str, first), "environment-map,layered-depth", "--resume"]) == 0
    assert kept.stat().st_mtime_ns == before
    assert [row["method"] for row in results_in(tmp_path)["results"]] == ["environment-map", "layered-depth"]
    assert main([*map(str, first), "environment-map", "--resume", "--set", "environment-map.size=32"]) == 0
    assert kept.stat().st_mtime_ns > before
    sizes = {row["method"]: row["settings"].get("size") for row in results_in(tmp_path)["results"]}
    assert sizes["environment-map"] == 32


def test_ctrl_c_keeps_finished_rows_and_resume_goes_on(flight, tmp_path):
    arguments = ["compare", flight, "--out", tmp_path, "--resolution", SIZE, "--samples", "2", "--frames", "1:40"]
    arguments += ["--methods", "environment-map"]
    process = start(*arguments)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not (
        (tmp_path / "results.json").exists() and results_in(tmp_path)["results"]
    ):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "--resume" in said
    assert "Traceback" not in said
    finished = {row["frame"] for row in results_in(tmp_path)["results"]}
    assert 0 < len(finished) < 40
    assert (tmp_path / "report.html").is_file()
    last = max(finished) + 1
    assert main([*map(str, arguments), "--frames", f"1:{last}", "--resume"]) == 0
    assert {row["frame"] for row in results_in(tmp_path)["results"]} == set(range(1, last + 1))


def test_an_archive_is_drawn_as_its_blend_file_is(blend, archive, tmp_path):
    pictures = []
    for scene in (blend, archive):
        out = tmp_path / f"{scene.stem}.exr"
        line = ["render", scene, "--method", "layered-depth", "--out", out, "--resolution", SIZE]
        assert main([str(word) for word in line]) == 0
        pictures.append(load_picture(out))
    np.testing.assert_array_equal(*pictures)


def test_stdout_holds_results_alone(blend, tmp_path):
    out = tmp_path / "x.png"
    process = start("render", blend, "--method", "environment-map", "--out", out, "--resolution", SIZE)
    printed, _ = process.communicate(timeout=120)
    assert printed == f"{out}\n"


def test_an_archive_renders_where_blender_is_not(archive, tmp_path):
    out = tmp_path / "picture.png"
    script = (
        "import sys; sys.modules['bpy'] = None\n"
        "from catoptric.batch.cli import main\n"
        f"sys.exit(main(['render', {str(archive)!r}, '--method', 'layered-depth', '--out', {str(out)!r},"
        f" '--resolution', {SIZE!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert load_picture(out).dtype == np.uint8


def test_comparing_an_archive_says_that_cycles_is_left_out(archive, tmp_path, capsys):
    assert main(["compare", str(archive), "--out", str(tmp_path), *QUICK]) == 0
    written = results_in(tmp_path)
    assert [row["method"] for row in written["results"]] == ["environment-map", "layered-depth"]
    assert all(row["over_frame"]["flip"] is None for row in written["results"])
    (skipped,) = written["skipped"]
    assert skipped["method"] == "cycles"
    assert "archive" in skipped["reason"]
    assert "archive" in capsys.readouterr().err


def test_bake_writes_a_picture_for_each_object_and_layer(blend, tmp_path, capsys):
    assert main(["bake", str(blend), "--out", str(tmp_path), "--resolution", "16", "--map-size", "32"]) == 0
    written = sorted(path.name for path in tmp_path.iterdir())
    assert {"Ball_layer-1.exr", "Box_layer-1.exr", "Floor_layer-1.exr", "Ball_reflector-maps.exr"} <= set(written)
    pixels, metadata = read_atlas(tmp_path / "Box_layer-1.exr")
    assert pixels.shape[:2] == (2 * 16, 3 * 16)
    assert metadata["object"] == "Box"
    (ball,) = read_maps(tmp_path / "Ball_reflector-maps.exr")
    assert ball.positions.shape == (6, 32, 32, 3)
    *files, regions = capsys.readouterr().out.splitlines()
    assert sorted(Path(line).name for line in files) == written
    assert "regions.png" in written
    assert "of all searches" in regions


def test_methods_prints_every_method_and_parameter(capsys):
    assert main(["methods"]) == 0
    printed = capsys.readouterr().out
    for method in METHODS.values():
        assert method.name in printed
        assert all(f"{method.name}.{parameter.name}" in printed for parameter in method.parameters)
    assert printed.count("Limits:") == printed.count("Source:") == len(METHODS)


@pytest.mark.parametrize("command", [[], ["compare"], ["render"], ["bake"], ["export"], ["methods"]])
def test_help_explains(command, capsys):
    assert main([*command, "--help"]) == 0
    assert "Usage: catoptric" in capsys.readouterr().out


# What it says when something is wrong


@pytest.mark.parametrize(
    ("arguments", "clue"),
    [
        (["compare", "missing.blend"], "no such file"),
        (["compare", "no-such-scene"], "mirror-ball"),
        (["compare", "--methods", "magic"], "layered-depth"),
        (["compare", "--lighting", "candle"], "unlit"),
        (["compare", "--resolution", "huge"], "768x512"),
        (["compare", "--resolution", "0x512"], "at least 1"),
        (["compare", "--resolution", "9999999x8"], "GPU"),
        (["compare", "--samples", "many"], "--samples"),
        (["compare", "--samples", "0"], "--samples"),
        (["compare", "--frames", "9:1"], "1:10"),
        (["compare", "--against", "magic"], "layered-depth"),
        (["compare", "--against", "layered-depth", "--methods", "layered-depth"], "no other method"),
        (["compare", "--against", "layered-depth,planar"], "one method"),
        (["compare", "--samples", "1"], "at least 2"),
        (["compare", "--peers", "unity"], "eevee"),
        (["compare", "--set", "environment-map.size=0"], "16"),
        (["compare", "--set", "environment-map.colour=1"], "size"),
        (["compare", "--colour"], "--colour"),
        (["paint"], "paint"),
        (["bake", "mirror-ball", "--out", "x", "--resolution", "1"], "16"),
        (["render", "mirror-ball", "--out", "x.png"], "--method"),
        (["render", "mirror-ball", "--method", "layered-depth", "--out", "x.gif"], ".exr"),
        (["render", "mirror-ball", "--method", "layered-depth", "--out", "x.png", "--resolution", "8x0"], "at least 1"),
        (["export", "mirror-ball", "--out", "x.zip"], ".catoptric"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_one_line_says_what_is_wrong(arguments, clue, complain, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert clue in complain(*arguments)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("lacking", "clue"), [("camera", "camera"), ("mirror", "nothing reflects")])
def test_a_scene_that_lacks_something(lacking, clue, complain, tmp_path):
    stage(**{lacking: False})
    path = save(tmp_path / "lacking.blend")
    assert clue in complain("render", path, "--method", "layered-depth", "--out", tmp_path / "x.png")
    assert clue in complain("compare", path, "--out", tmp_path / "report", *QUICK)
    assert not (tmp_path / "x.png").exists()


def test_a_scene_that_fails_does_not_stop_the_others(blend, tmp_path):
    stage(camera=False)
    broken = save(tmp_path / "broken.blend")
    assert main(["compare", str(broken), str(blend), "--out", str(tmp_path / "report"), *QUICK]) == 0
    written = results_in(tmp_path / "report")
    assert [(skipped["scene"], skipped["error"]) for skipped in written["skipped"]] == [("broken", True)]
    assert {row["scene"] for row in written["results"]} == {"stage"}


def test_objects_that_cannot_be_drawn_are_left_out_with_a_warning(blend, tmp_path, capsys):
    scene = stage()
    broken = add_box(scene, "Not a number", 1.0, principled("Green", (0.1, 0.8, 0.1)), (-1.8, -0.5, 0.5))
    broken.data.vertices[0].co.x = float("nan")
    flat = add_box(scene, "Flattened", 1.0, principled("Gold", (0.8, 0.8, 0.1)), (-1.8, -0.5, 0.5))
    flat.scale = (0.0, 0.0, 0.0)
    add_plane(scene, "Needle", 0.0, principled("Grey", (0.5, 0.5, 0.5)))
    add_box(scene, "Nothing", 1.0).data.clear_geometry()
    path = save(tmp_path / "stage.blend")
    pictures = []
    for number, source in enumerate((blend, path)):
        out = tmp_path / f"{number}.exr"
        line = ["render", source, "--method", "layered-depth", "--out", out, "--resolution", SIZE]
        assert main([str(word) for word in line]) == 0
        pictures.append(load_picture(out))
    warned = capsys.readouterr().err
    assert "Not a number" in warned
    assert "Flattened" in warned
    np.testing.assert_array_equal(*pictures)


def test_a_missing_texture_is_named_and_magenta(tmp_path, capsys):
    scene = stage()
    material = principled("Lost", (1.0, 1.0, 1.0))
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("lost", 4, 4)
    texture.image.source = "FILE"
    texture.image.filepath = "//lost.png"
    links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    scene.objects["Floor"].data.materials[0] = material
    path, out = save(tmp_path / "stage.blend"), tmp_path / "x.exr"
    line = ["render", path, "--method", "layered-depth", "--out", out, "--resolution", SIZE]
    assert main([str(word) for word in line]) == 0
    assert "lost" in capsys.readouterr().err
    floor = load_picture(out)[-1, 0]
    np.testing.assert_allclose(floor, (1.0, 0.0, 1.0), atol=1e-3)


@pytest.mark.parametrize("content", [b"", b"not a scene at all", b"BLENDER-v999" + bytes(100)])
def test_a_file_that_is_no_scene(content, complain, tmp_path):
    for name in ("broken.blend", "broken.catoptric"):
        path = tmp_path / name
        path.write_bytes(content)
        line = complain("render", path, "--method", "layered-depth", "--out", tmp_path / "x.png")
        assert name in line


def test_a_blend_file_from_a_newer_blender(blend, complain, tmp_path):
    content = blend.read_bytes()
    newer = tmp_path / "newer.blend"
    if content.startswith(b"BLENDER17"):
        newer.write_bytes(content[:13] + b"9901" + content[17:])
    else:
        newer.write_bytes(content[:9] + b"990" + content[12:])
    line = complain("render", newer, "--method", "layered-depth", "--out", tmp_path / "x.png")
    assert "newer" in line


def test_a_damaged_archive_is_named(archive, complain, tmp_path):
    content = bytearray(archive.read_bytes())
    content[len(content) // 2] ^= 0xFF
    damaged = tmp_path / "damaged.catoptric"
    damaged.write_bytes(content)
    assert "damaged.catoptric" in complain("render", damaged, "--method", "layered-depth", "--out", tmp_path / "x.png")


def test_a_damaged_cache_is_made_again(blend, tmp_path, monkeypatch):
    monkeypatch.setenv("CATOPTRIC_CACHE", str(tmp_path / "cache"))
    pictures = []
    for name in ("first", "second"):
        assert main(["compare", str(blend), "--out", str(tmp_path / name), *QUICK]) == 0
        images = results_in(tmp_path / name)["results"][0]["images"]
        pictures.append(load_picture(tmp_path / name / images["reference"]))
        kept = [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]
        assert kept
        for path in kept:
            path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    np.testing.assert_array_equal(*pictures)


def test_a_folder_that_is_a_file(blend, complain, tmp_path):
    occupied = tmp_path / "report"
    occupied.write_text("mine")
    assert "report" in complain("compare", blend, "--out", occupied, *QUICK)
    assert occupied.read_text() == "mine"


def test_a_full_disk_is_named_and_leaves_no_half_file(blend, tmp_path):
    out = tmp_path / "stage.catoptric"
    small = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))"
    process = start("export", blend, "--out", out, first=small)
    _, said = process.communicate(timeout=120)
    assert process.returncode == 2
    assert "stage.catoptric" in said
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []


def test_without_opengl_the_missing_package_is_named(archive, tmp_path):
    nowhere = str(tmp_path / "nowhere")
    hidden = {
        "__EGL_VENDOR_LIBRARY_DIRS": nowhere,
        "__EGL_VENDOR_LIBRARY_FILENAMES": f"{nowhere}/none.json",
        "GLCONTEXT_LINUX_LIBGL": f"{nowhere}/libGL.so",  # for a screen that may be here, even one not named
        "DISPLAY": "",
    }
    process = start(
        "render", archive, "--method", "layered-depth", "--out", tmp_path / "x.png", env={**os.environ, **hidden}
    )
    _, said = process.communicate(timeout=120)
    assert process.returncode == 2
    assert "libegl1" in said
    assert "libgl1-mesa-dri" in said
    assert "Traceback" not in said
