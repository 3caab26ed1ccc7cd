"""The extension as Blender installs it: one zip a platform, built and checked by Blender's own tool."""

import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path

from ..addon.errors import MachineError, UsageError
from .package_wheels import PLATFORMS, PYTHONS, fetch, requirements

ROOT = Path(__file__).resolve().parents[1]
MANIFEST = "blender_manifest.toml"

SHIPPED = ("__init__.py", "LICENSE", "README.md", "addon", "batch", "gpu_shaders", "scenes/__init__.py")
"""Files and folders of the source tree that Blender needs, beside the manifest and wheels."""

LEFT_OUT = ("cli.py", "manual.py", "package.py", "package_wheels.py", "preview")
"""What does not ship of `batch`: the command line and the preview's window need much that the rest does without."""


def package(
    out: Path,
    warn: Callable[[str], None],
    platforms: Sequence[str] = tuple(PLATFORMS),
    pythons: Sequence[str] = PYTHONS,
    root: Path = ROOT,
) -> list[Path]:
    """Write `catoptric-VERSION-PLATFORM.zip` into `out` for each of `platforms`; returns their paths.

    Each holds `SHIPPED` of the source tree at `root`, and the wheels of `fetch` for every one of
    `pythons`. Raises `UsageError` for a platform or Python that cannot be, `MachineError` for
    wheels that cannot be had, a tree that is not the source, or a folder that cannot be written.
    """
    _check(platforms, pythons)
    try:
        manifest = (root / MANIFEST).read_text()
        version = tomllib.loads(manifest)["version"]
    except (OSError, ValueError, KeyError) as error:
        raise MachineError(f"cannot read {root / MANIFEST}: {error}; run this in Catoptric's source tree") from error
    needed = requirements(root / "uv.lock")
    packages = []
    for platform in dict.fromkeys(platforms):
        wheels = {
            wheel.name: wheel for python in dict.fromkeys(pythons) for wheel in fetch(needed, platform, python, warn)
        }
        target = out / f"catoptric-{version}-{platform}.zip"
        _build(root, manifest_for(manifest, platform, sorted(wheels)), list(wheels.values()), target)
        packages.append(target)
    return packages


def _check(platforms: Sequence[str], pythons: Sequence[str]) -> None:
    for platform in platforms:
        if platform not in PLATFORMS:
            raise UsageError(f"--platform: there is no {platform!r}; choose from {', '.join(PLATFORMS)}")
    for python in pythons:
        if not re.fullmatch(r"3\.\d{1,2}", python):
            raise UsageError(f"--python: {python!r} is no version of Python; write it as in {PYTHONS[-1]}")


def manifest_for(manifest: str, platform: str, wheels: Sequence[str]) -> str:
    """The text of a manifest, narrowed to one platform and with the file names of its wheels listed."""
    listed = "".join(f'    "./wheels/{wheel}",\n' for wheel in wheels)
    narrowed, count = re.subn(
        r"^platforms = .*$", f'platforms = ["{platform}"]\nwheels = [\n{listed}]', manifest, flags=re.MULTILINE
    )
    if count != 1:
        raise MachineError(f"{MANIFEST} must have one line `platforms = [...]`, it has {count}; mend it")
    return narrowed


def _build(root: Path, manifest: str, wheels: Sequence[Path], target: Path) -> None:
    """Put together in a folder of its own what ships, and let Blender's tool build and check it."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as temporary:
            stage = Path(temporary)
            (stage / MANIFEST).write_text(manifest)
            (stage / "wheels").mkdir()
            for wheel in wheels:
                shutil.copy(wheel, stage / "wheels")
            for name in SHIPPED:
                _copy(root / name, stage / name)
            with tempfile.TemporaryDirectory(dir=target.parent, suffix=".part") as beside:
                built = Path(beside, target.name)
                _blender_ext("build", "--source-dir", stage, "--output-filepath", built)
                _blender_ext("validate", built)
                built.replace(target)
    except OSError as error:
        raise MachineError(f"cannot write {target}: {error.strerror or error}") from error


def _copy(source: Path, target: Path) -> None:
    """Copy a file, or of a folder all that ships."""
    if source.is_dir():
        unwanted = LEFT_OUT if source.name == "batch" else ()
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__", *unwanted))
    else:
        target.parent.mkdir(exist_ok=True)
        shutil.copy(source, target)


def _blender_ext(*arguments: str | Path) -> None:
    """Run Blender's tool for extensions, which lies in the bpy wheel and needs no Blender to run."""
    home = Path(find_spec("bpy").origin).parent
    tools = list(home.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    if len(tools) != 1:
        raise MachineError(f"cannot find Blender's extension builder in {home}: run `uv sync`")
    # Without a list of tags, which it would look up in the network.
    command = [sys.executable, tools[0], *arguments, "--valid-tags="]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise MachineError(f"Blender's tool refused the extension: {(done.stderr or done.stdout).strip()}")
