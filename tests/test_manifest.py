"""Blender's own validator and builder accept the extension, and only what belongs in it ships."""

import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def blender_ext() -> Path:
    """Blender's command-line tool for extensions, from the bpy wheel."""
    home = Path(find_spec("bpy").origin).parent
    (tool,) = home.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    return tool


def run(tool: Path, *arguments: str | Path) -> subprocess.CompletedProcess:
    """Run the tool; `--valid-tags=` says that it has no list of tags to ask the network for."""
    command = [sys.executable, tool, *arguments, "--valid-tags="]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_official_validator_accepts_the_manifest(blender_ext, root):
    done = run(blender_ext, "validate", root)
    assert done.returncode == 0, done.stdout + done.stderr


def test_official_validator_would_refuse_a_wrong_manifest(blender_ext, root, tmp_path):
    text = (root / "blender_manifest.toml").read_text()
    (tmp_path / "blender_manifest.toml").write_text(text.replace('version = "0.1.0"', 'version = "first"'))
    assert run(blender_ext, "validate", tmp_path).returncode != 0


def test_built_extension_holds_exactly_what_blender_needs(blender_ext, root, tmp_path):
    package = tmp_path / "catoptric.zip"
    done = run(blender_ext, "build", "--source-dir", root, "--output-filepath", package)
    assert done.returncode == 0, done.stdout + done.stderr
    with zipfile.ZipFile(package) as archive:
        shipped = {name for name in archive.namelist() if not name.endswith("/")}
    folders = [root / "addon", root / "gpu_shaders"]
    expected = {
        path.relative_to(root).as_posix()
        for folder in folders
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert shipped == expected | {"blender_manifest.toml", "__init__.py", "LICENSE", "README.md"}


def test_manifest_and_project_name_the_same_version_and_licence(root):
    manifest = tomllib.loads((root / "blender_manifest.toml").read_text())
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    assert manifest["version"] == project["version"] == version("catoptric")
    assert manifest["license"] == [f"SPDX:{project['license']}"]


def test_every_listed_wheel_ships_and_every_shipped_wheel_is_listed(root):
    manifest = tomllib.loads((root / "blender_manifest.toml").read_text())
    on_disk = {path.relative_to(root).as_posix() for path in (root / "wheels").glob("*.whl")}
    assert {name.removeprefix("./") for name in manifest.get("wheels", [])} == on_disk
