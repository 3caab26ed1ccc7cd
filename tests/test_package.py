"""The zips that people install: what is in them, and that a Blender with nothing else runs on them."""

import ast
import hashlib
import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from catoptric.addon.cache import DIRECTORY_VARIABLE, Cache
from catoptric.addon.errors import MachineError, UsageError
from catoptric.batch.cli import main
from catoptric.batch.package import manifest_for, package
from catoptric.batch.package_wheels import NEEDED, PLATFORMS, requirements
from hypothesis import given
from hypothesis import strategies as st
from packaging.requirements import Requirement
from packaging.tags import compatible_tags, cpython_tags
from packaging.utils import parse_wheel_filename

PYTHONS = ((3, 11), (3, 13))
GLIBC = 28
"""Blender's Linux releases ask for glibc 2.28."""

TAGS = {
    "linux-x64": [f"manylinux_2_{n}_x86_64" for n in range(GLIBC, 4, -1)] + ["manylinux2014_x86_64"],
    "windows-x64": ["win_amd64"],
    "macos-arm64": ["macosx_11_0_arm64", "macosx_11_0_universal2"],
}

NOT_IN_BLENDER = {"skimage", "pyktx"}
"""Not shipped, for the one is heavy and the other needs a library beside it: code must work without."""

LEFT_OUT = ("batch/preview/", "batch/cli.py", "batch/manual.py", "batch/package")
"""The command line, its packager and its window: they need more than Blender has."""

JUNK = (
    "notes.txt",
    ".env",
    "addon/__pycache__/junk.cpython-313.pyc",
    "wheels/stray-1.0-py3-none-any.whl",
    "dist/old.zip",
    "scenes/big.blend",
)


@pytest.fixture(scope="session")
def source(root, tmp_path_factory) -> Path:
    """A copy of what the zips are made of, with things beside it that must not ship."""
    copy = tmp_path_factory.mktemp("source")
    for name in ("addon", "batch", "gpu_shaders"):
        shutil.copytree(root / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "scenes").mkdir()
    single = ("LICENSE", "README.md", "blender_manifest.toml", "uv.lock", "pyproject.toml", "scenes/__init__.py")
    for name in ("__init__.py", *single):
        shutil.copy(root / name, copy / name)
    return copy


@pytest.fixture(scope="session")
def contents(source) -> set[str]:
    """The files that must ship, but for wheels."""
    found = {
        path.relative_to(source).as_posix()
        for folder in ("addon", "batch", "gpu_shaders")
        for path in source.glob(f"{folder}/**/*")
        if path.is_file() and not path.relative_to(source).as_posix().startswith(LEFT_OUT)
    }
    assert {Path(name).suffix for name in found} == {".py", ".glsl", ".vert", ".geom", ".frag", ".js", ".css", ".j2"}
    for name in JUNK:
        (source / name).parent.mkdir(exist_ok=True)
        (source / name).write_text("junk")
    return found | {"__init__.py", "scenes/__init__.py", "LICENSE", "README.md", "blender_manifest.toml"}


@pytest.fixture(scope="session")
def zips(source, contents, tmp_path_factory) -> dict[str, Path]:
    """A zip for each platform. Its wheels are kept in the user's cache from run to run."""
    out, warnings = tmp_path_factory.mktemp("zips"), []
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv(DIRECTORY_VARIABLE)
        try:
            written = package(out, warnings.append, root=source)
        except MachineError as error:
            if "cannot fetch" in str(error):
                pytest.skip(str(error))
            raise
    assert warnings == []
    assert {path.name for path in out.iterdir()} == {path.name for path in written}
    return dict(zip(PLATFORMS, written, strict=True))


@pytest.fixture(params=list(PLATFORMS))
def platform(request) -> str:
    """Each platform that the extension is for."""
    return request.param


def wheels_in(archive: zipfile.ZipFile) -> dict[str, bytes]:
    """The wheels in a zip: file name and content."""
    return {Path(name).name: archive.read(name) for name in archive.namelist() if name.startswith("wheels/")}


def imported(folder: Path, left_out: tuple[str, ...]) -> set[str]:
    """The top-level modules that Python files import, wherever in the file, but for their own package."""
    names = set()
    for path in folder.rglob("*.py"):
        if path.relative_to(folder).as_posix().startswith(left_out):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                names.add(node.module.partition(".")[0])
    return names


# What is in them


def test_names_tell_version_and_platform(zips, source):
    version = tomllib.loads((source / "blender_manifest.toml").read_text())["version"]
    assert [path.name for path in zips.values()] == [f"catoptric-{version}-{platform}.zip" for platform in PLATFORMS]


def test_official_validator_accepts_each(zips, platform, blender_ext):
    done = blender_ext("validate", zips[platform])
    assert done.returncode == 0, done.stdout + done.stderr


def test_contents_are_the_allow_list_and_the_listed_wheels(zips, platform, contents):
    with zipfile.ZipFile(zips[platform]) as archive:
        names = [name for name in archive.namelist() if not name.endswith("/")]
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert len(names) == len(set(names))
    assert set(names) == contents | {name.removeprefix("./") for name in manifest["wheels"]}


def test_files_are_the_source_tree_s_own(zips, platform, source, contents):
    with zipfile.ZipFile(zips[platform]) as archive:
        for name in contents - {"blender_manifest.toml"}:
            assert archive.read(name) == (source / name).read_bytes(), name


def test_manifest_is_the_source_s_narrowed_to_the_platform(zips, platform, source):
    with zipfile.ZipFile(zips[platform]) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    before = tomllib.loads((source / "blender_manifest.toml").read_text())
    assert manifest.pop("platforms") == [platform]
    assert manifest.pop("wheels")
    assert set(before.pop("platforms")) == set(PLATFORMS)
    assert manifest == before


def test_wheels_are_those_of_the_lock_byte_by_byte(zips, platform, source):
    lock = tomllib.loads((source / "uv.lock").read_text())
    known = {
        wheel["url"].rpartition("/")[2]: wheel["hash"]
        for package in lock["package"]
        for wheel in package.get("wheels", ())
    }
    with zipfile.ZipFile(zips[platform]) as archive:
        wheels = wheels_in(archive)
    for name, content in wheels.items():
        assert known[name] == f"sha256:{hashlib.sha256(content).hexdigest()}"


def test_each_package_has_one_wheel_for_each_python_that_fits(zips, platform):
    with zipfile.ZipFile(zips[platform]) as archive:
        parsed = {name: parse_wheel_filename(name) for name in wheels_in(archive)}
    used = set()
    for python in PYTHONS:
        supported = {
            *cpython_tags(python, platforms=TAGS[platform]),
            *compatible_tags(python, platforms=TAGS[platform]),
        }
        fitting = {name: parts for name, parts in parsed.items() if parts[3] & supported}
        assert sorted(parts[0] for parts in fitting.values()) == [
            "flip-evaluator",
            "glcontext",
            "jinja2",
            "markdown-it-py",
            "markupsafe",
            "mdurl",
            "moderngl",
            "platformdirs",
            "pygments",
            "rich",
        ]
        used |= set(fitting)
    assert used == set(parsed)


def test_wheels_are_what_the_code_imports_and_blender_lacks(source):
    ours = imported(source, LEFT_OUT) - set(sys.stdlib_module_names)
    blender = {"bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "blf", "bl_math", "bl_ui", "numpy", "OpenImageIO"}
    assert ours - blender - NOT_IN_BLENDER == {name.replace("-", "_") for name in NEEDED}


# In Blender


def brought_by_blender() -> set[Path]:
    """What bpy and OpenImageIO, with all that they need, put into site-packages."""
    names, pending = set(), {"bpy", "openimageio"}
    while pending:
        names |= pending
        wanted = [Requirement(line) for name in pending for line in importlib.metadata.requires(name) or ()]
        pending = {each.name for each in wanted if each.marker is None or each.marker.evaluate({"extra": ""})} - names
    dists = [importlib.metadata.distribution(name) for name in names]
    paths = {Path(dist.locate_file(file.parts[0])) for dist in dists for file in dist.files}
    return {path for path in paths if path.name not in ("..", "__pycache__")}


@pytest.fixture(scope="session")
def visited(zips, root, tmp_path_factory) -> dict:
    """What package_visit.py tells of this Python's Blender, in a process that sees none of these tests' packages."""
    if sys.platform != "linux":
        pytest.skip("installs the Linux zip")
    site, home = tmp_path_factory.mktemp("site"), tmp_path_factory.mktemp("home")
    for path in brought_by_blender():
        (site / path.name).symlink_to(path)
    command = [sys.executable, "-I", "-S", root / "tests/package_visit.py", site, zips["linux-x64"]]
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(home)}
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_installs_and_runs_on_its_own_wheels(visited):
    assert visited["enabled"]
    assert visited["outside"] == []
    assert re.match(r"[4-9]\.", visited["gl"])


def test_all_its_modules_find_what_they_import(visited):
    assert set(visited["missing"].values()) <= NOT_IN_BLENDER


def test_disabled_it_leaves_nothing_in_blender(visited):
    assert visited["disabled"] == []


def test_uninstalled_it_leaves_nothing_in_blender_nor_on_disk(visited):
    assert visited["left"] == []
    assert visited["files"] == []


# What goes wrong


def complaint(capsys, *arguments: object) -> str:
    """The one line that a command that must fail says."""
    capsys.readouterr()
    assert main([str(argument) for argument in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_an_unknown_platform_is_refused_with_those_there_are(capsys, tmp_path):
    line = complaint(capsys, "package", "--out", tmp_path, "--platform", "beos-ppc")
    assert "beos-ppc" in line
    assert all(platform in line for platform in PLATFORMS)


@given(st.text().filter(lambda text: not re.fullmatch(r"3\.\d\d?", text)))
def test_what_is_no_version_of_python_is_refused(tmp_path_factory, text):
    with pytest.raises(UsageError, match="--python"):
        package(tmp_path_factory.getbasetemp(), pytest.fail, pythons=[text])


def test_without_network_and_cache_one_line_says_so(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.delenv("PIP_FIND_LINKS", raising=False)
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    line = complaint(capsys, "package", "--out", tmp_path / "out")
    assert "cannot fetch" in line
    assert "network" in line
    assert not list((tmp_path / "out").glob("*"))
    assert not list((tmp_path / "cache/wheels").glob("*"))


def test_without_uv_one_line_says_so(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    assert "uv" in complaint(capsys, "package", "--out", tmp_path)


def test_a_wheel_that_changed_on_disk_does_not_ship(zips, source, monkeypatch, tmp_path):
    monkeypatch.delenv(DIRECTORY_VARIABLE)
    shutil.copytree(Cache().folder / "wheels", tmp_path / "cache/wheels")
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    changed = list(tmp_path.glob("cache/wheels/linux-x64-3.13-*/moderngl-*.whl"))  # older versions needed others
    for wheel in changed:
        wheel.write_bytes(wheel.read_bytes()[:-1] + b"!")
    with pytest.raises(MachineError, match="run the same command again"):
        package(tmp_path / "out", pytest.fail, ["linux-x64"], root=source)
    assert len([wheel for wheel in changed if not wheel.exists()]) == 1
    assert not (tmp_path / "out").exists()


def test_outside_the_source_tree_one_line_says_so(tmp_path):
    with pytest.raises(MachineError, match="source tree"):
        package(tmp_path, pytest.fail, root=tmp_path)


@pytest.mark.parametrize("text", ["", "[[package]]\nname = 'moderngl'\n", "this is not TOML"])
def test_a_damaged_lock_is_refused(tmp_path, text):
    (tmp_path / "uv.lock").write_text(text)
    with pytest.raises(MachineError, match=r"uv\.lock"):
        requirements(tmp_path / "uv.lock")


def test_a_folder_that_cannot_be_written_is_refused(zips, source, tmp_path, monkeypatch):
    monkeypatch.delenv(DIRECTORY_VARIABLE)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(MachineError, match="cannot write"):
        package(tmp_path / "file", pytest.fail, ["linux-x64"], root=source)


def test_a_manifest_without_its_line_of_platforms_is_refused():
    with pytest.raises(MachineError, match="platforms"):
        manifest_for('id = "catoptric"\n', "linux-x64", [])
