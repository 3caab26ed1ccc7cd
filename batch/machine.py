"""What the figures were measured on."""

import platform
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ..addon.errors import MachineError, UsageError
from ..addon.gl import call, require
from .results import Machine


def describe() -> Machine:
    """This machine. Raises `MachineError` where it offers no OpenGL."""
    info = call(lambda: require().info)
    return Machine(
        renderer=info["GL_RENDERER"],
        gl=info["GL_VERSION"],
        cpu=_cpu(),
        blender=_blender(),
        python=platform.python_version(),
    )


def check_size(width: int, height: int) -> None:
    """Raise an error where this machine cannot draw a picture of that size."""
    if width < 1 or height < 1:
        raise UsageError(f"a picture of {width}x{height} pixels: both sides must be at least 1")
    limit = call(lambda: require().info["GL_MAX_TEXTURE_SIZE"])
    if max(width, height) > limit:
        raise MachineError(f"a picture of {width}x{height} pixels: this GPU draws at most {limit} a side")


def own_version() -> str:
    """Catoptric's version; inside Blender, no package manager knows it."""
    manifest = Path(__file__).resolve().parents[1] / "blender_manifest.toml"
    return tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]


def _blender() -> str:
    """The version of the Blender that runs this, or else of the one that is installed, without starting it."""
    running = sys.modules.get("bpy")
    if running is not None:
        return ".".join(map(str, running.app.version))
    try:
        return version("bpy")
    except PackageNotFoundError:
        return "none"


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
