"""Blender's own validator accepts the manifest, and it says what the project says."""

import tomllib
from importlib.metadata import version


def test_official_validator_accepts_the_manifest(blender_ext, root):
    done = blender_ext("validate", root)
    assert done.returncode == 0, done.stdout + done.stderr


def test_official_validator_would_refuse_a_wrong_manifest(blender_ext, root, tmp_path):
    text = (root / "blender_manifest.toml").read_text()
    (tmp_path / "blender_manifest.toml").write_text(text.replace('version = "0.1.0"', 'version = "first"'))
    assert blender_ext("validate", tmp_path).returncode != 0


def test_manifest_and_project_name_the_same_version_and_licence(root):
    manifest = tomllib.loads((root / "blender_manifest.toml").read_text())
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    assert manifest["version"] == project["version"] == version("catoptric")
    assert manifest["license"] == [f"SPDX:{project['license']}"]
