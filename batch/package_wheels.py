"""The wheels that the extension ships: chosen by uv.lock, fetched by pip, kept in the cache folder."""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from ..addon.cache import Cache, key_of
from ..addon.errors import MachineError

NEEDED = ("flip-evaluator", "jinja2", "moderngl", "platformdirs", "rich")
"""What the shipped code imports and Blender lacks; what these need themselves comes along."""

BLENDER_BRINGS = frozenset({"numpy", "openimageio"})
"""What every Blender has, in a version of its own."""

PLATFORMS = {
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_11_0_arm64",),
}
"""Blender's names of platforms, and the newest wheel tags that its releases there can load."""

PYTHONS = ("3.11", "3.13")
"""What Blender 4.5 and 5.2 run, and uv.lock knows."""


@dataclass(frozen=True)
class Requirement:
    """A package as uv.lock pins it. `hashes` are the SHA-256 of its wheels, in hexadecimal."""

    name: str
    version: str
    hashes: frozenset[str]

    def line(self, hashed: bool) -> str:
        """As pip reads it."""
        allowed = [f"--hash=sha256:{digest}" for digest in sorted(self.hashes)] if hashed else []
        return " ".join([f"{self.name}=={self.version}", *allowed])


def requirements(lock: Path) -> tuple[Requirement, ...]:
    """What the extension ships, by name. Raises `MachineError` if uv.lock cannot be read or lacks one."""
    try:
        packages = {package["name"]: package for package in tomllib.loads(lock.read_text())["package"]}
        names, pending = set(), set(NEEDED)
        while pending:
            names |= pending
            needed = {other["name"] for name in pending for other in packages[name].get("dependencies", ())}
            pending = needed - names - BLENDER_BRINGS
        return tuple(_requirement(packages[name]) for name in sorted(names))
    except (OSError, ValueError, KeyError) as error:
        raise MachineError(f"cannot read which wheels to ship from {lock}: {error}; run `uv lock`") from error


def _requirement(package: dict) -> Requirement:
    hashes = frozenset(wheel["hash"].removeprefix("sha256:") for wheel in package.get("wheels", ()))
    return Requirement(package["name"], package["version"], hashes)


def fetch(needed: Iterable[Requirement], platform: str, python: str, warn: Callable[[str], None]) -> list[Path]:
    """The wheels of `needed` that fit Blender's `platform` and a `python` such as "3.13", unmodified.

    From the cache folder, else from pip's index. A Python that uv.lock does not know, such as a
    distribution's own Blender may have, takes the same versions without hashes, and without the
    packages that have no wheel for it, each with a warning. Raises `MachineError` if there is no
    network, no uv, or a wheel that is not the one uv.lock names.
    """
    needed, hashed = tuple(needed), python in PYTHONS
    lines = tuple(requirement.line(hashed) for requirement in needed)
    folder = Cache().folder / "wheels" / f"{platform}-{python}-{key_of(lines, PLATFORMS[platform])}"
    if not folder.is_dir():
        _fill(folder, lines, platform, python, hashed)
    wheels = sorted(folder.glob("*.whl"))
    for requirement in needed:
        found = [wheel for wheel in wheels if _name_of(wheel) == requirement.name]
        if not found:
            warn(f"{requirement.name} has no wheel for Python {python} on {platform}: left out")
        elif hashed and hashlib.sha256(found[0].read_bytes()).hexdigest() not in requirement.hashes:
            shutil.rmtree(folder)
            raise MachineError(f"{found[0]} was not the wheel that uv.lock names: removed; run the same command again")
    return wheels


def _name_of(wheel: Path) -> str:
    return wheel.name.partition("-")[0].replace("_", "-").lower()


def _fill(folder: Path, lines: tuple[str, ...], platform: str, python: str, hashed: bool) -> None:
    """Download into `folder`, which appears whole or not at all."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent, suffix=".part") as temporary:
            wheels = Path(temporary, "wheels")
            # Without hashes each goes alone, so that one without a wheel does not take the others along.
            failures = [
                failure
                for batch in ([lines] if hashed else [(line,) for line in lines])
                if (failure := _download(wheels, batch, platform, python))
            ]
            if failures and (hashed or not wheels.is_dir()):
                raise MachineError(
                    f"cannot fetch the wheels for {platform}, Python {python}: {failures[0]}; is the network there?"
                )
            os.replace(wheels, folder)
    except OSError as error:
        raise MachineError(f"cannot keep wheels in {folder.parent}: {error.strerror or error}") from error


def _download(folder: Path, lines: tuple[str, ...], platform: str, python: str) -> str | None:
    """Let pip, which `uv` brings, download wheels for a machine that this one need not be; says what went wrong."""
    uv = shutil.which("uv")
    if uv is None:
        raise MachineError("cannot fetch wheels: `uv` is not on the PATH; install it (docs.astral.sh/uv)")
    wanted = folder.with_name("requirements.txt")
    wanted.write_text("\n".join(lines))
    pip = [uv, "tool", "run", "--quiet", "--python", sys.executable, "pip", "download", "--quiet"]
    tags = [f"--platform={tag}" for tag in PLATFORMS[platform]]
    options = ["--no-deps", "--only-binary=:all:", f"--python-version={python}", "--dest", folder, "-r", wanted]
    done = subprocess.run([*pip, *tags, *options], capture_output=True, text=True)
    if done.returncode == 0:
        return None
    said = [line for line in done.stderr.splitlines() if line.strip()]
    return said[-1].removeprefix("ERROR: ") if said else f"pip ended with status {done.returncode}"
