"""Where a Blender with a window runs: on this machine, or in a Debian of its own that is made here once.

`python tests/gui/machine.py` makes that Debian (as root, 1.5 GB, some minutes) and says where it is.
"""

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import platformdirs

TOOLS = ("blender", "Xvfb", "xdotool", "import")

PACKAGES = (
    "blender",
    "xvfb",
    "xdotool",
    "imagemagick",
    "libgl1",
    "libglx-mesa0",
    "libgl1-mesa-dri",
    "libegl1",
    "libegl-mesa0",
    "mesa-vulkan-drivers",
    "python3-gi",
    "gir1.2-gtk-3.0",
    "python3-numpy",
    "python3-openimageio",
    "python3-requests",
    "python3-zstandard",
    "python3-cattr",
)
"""`TOOLS`, OpenGL and Vulkan in software, GTK to drag files from, and the Python packages that Blender's own builds
bring and Debian's recommends."""

SUITE = "sid"
FOLDER_VARIABLE = "CATOPTRIC_GUI_ROOT"
"""The environment variable that names another folder for the Debian."""

SOURCES = (Path("/etc/apt/sources.list.d/debian.sources"), Path("/etc/apt/sources.list"))

# The mounts live in a namespace that ends with the command, so that nothing stays mounted.
ENTER = """
set -e
mount -t proc proc "$ROOT/proc"
mount --rbind /dev "$ROOT/dev"
mkdir -p "$ROOT$SHARE"
mount --bind "$SHARE" "$ROOT$SHARE"
if [ -n "$SMALL_DISK" ]; then mount -t tmpfs -o size=256k none "$ROOT$SMALL_DISK"; fi
unset ROOT SHARE SMALL_DISK
exec chroot "$0" "$@"
"""


class NoWindow(Exception):
    """There can be no window here; the message says why."""


@dataclass(frozen=True)
class Machine:
    """Starts programs that share the folder `share`, under one path inside and out. `root` is None on this machine."""

    share: Path
    root: Path | None = None

    def command(self, *arguments: str | Path) -> list[str]:
        """What to start so that the program `arguments` runs there, as the very process that was started."""
        if self.root is None:
            return list(map(str, arguments))
        return [
            "unshare",
            "--mount",
            "--propagation",
            "private",
            "sh",
            "-c",
            ENTER,
            str(self.root),
            *map(str, arguments),
        ]

    def environment(self, **more: str) -> dict[str, str]:
        """The environment of such a process."""
        common = {"LANG": "C.UTF-8", "XDG_RUNTIME_DIR": str(self.share)}  # Blender looks there for Wayland
        if self.root is None:
            return os.environ | common | more
        path = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        inside = {"PATH": path, "HOME": "/root", "DEBIAN_FRONTEND": "noninteractive"}
        return common | inside | {"ROOT": str(self.root), "SHARE": str(self.share)} | more

    def run(self, *arguments: str | Path, timeout: float = 120.0, **environment: str) -> bytes:
        """Run a program to its end; returns what it wrote. Raises `RuntimeError` with its last words if it fails."""
        command, where = self.command(*arguments), self.environment(**environment)
        done = subprocess.run(command, capture_output=True, timeout=timeout, env=where)
        if done.returncode != 0:
            said = (done.stderr or done.stdout).decode(errors="replace").strip()
            raise RuntimeError(f"{arguments[0]} ended with {done.returncode}: {said[-2000:]}")
        return done.stdout


def find(share: Path) -> Machine:
    """This machine if it has `TOOLS`, else the Debian, made first if need be. Raises `NoWindow`."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if not missing:
        return Machine(share)
    if os.geteuid() != 0:
        raise NoWindow(f"{', '.join(missing)} not installed, and only root can make a Debian with them")
    machine = Machine(share, folder())
    if not ready(machine.root):
        make(machine)
    return machine


def folder() -> Path:
    """Where the Debian lies or will lie."""
    chosen = os.environ.get(FOLDER_VARIABLE)
    return Path(chosen) if chosen else platformdirs.user_cache_path("catoptric", False) / f"gui-{SUITE}"


def ready(root: Path) -> bool:
    """Whether a Debian is complete."""
    mark = root / ".packages"
    return mark.exists() and set(PACKAGES) <= set(mark.read_text().split())


def make(machine: Machine) -> None:
    """Install Debian into `machine.root`, with `PACKAGES`. Raises `NoWindow` with the reason if that fails."""
    root = machine.root
    try:
        if not (root / "etc/debian_version").exists():
            root.mkdir(parents=True, exist_ok=True)
            _bootstrap(root)
        if not (root / "etc/mtab").is_symlink():
            (root / "etc/mtab").symlink_to("/proc/self/mounts")  # Blender lists the disks in it
        # A mirror may be a snapshot of another day.
        apt = ["apt-get", "-o", "Acquire::Check-Valid-Until=false", "-o", "Acquire::Check-Date=false", "-qq"]
        (root / "usr/sbin/policy-rc.d").write_text("#!/bin/sh\nexit 101\n")  # no service may start
        (root / "usr/sbin/policy-rc.d").chmod(0o755)
        machine.run(*apt, "update", timeout=300)
        machine.run(*apt, "install", "--yes", "--no-install-recommends", *PACKAGES, timeout=1800)
        machine.run(*apt, "clean")
    except (OSError, RuntimeError, subprocess.SubprocessError) as error:
        raise NoWindow(f"no Debian with Blender could be made in {root}: {error}") from error
    (root / ".packages").write_text("\n".join(PACKAGES))


def _bootstrap(root: Path) -> None:
    here = Machine(root)
    if shutil.which("debootstrap") is None:
        here.run("apt-get", "-qq", "update", timeout=300)
        here.run("apt-get", "-qq", "install", "--yes", "--no-install-recommends", "debootstrap", timeout=300)
    isolated = ["unshare", "--mount", "--propagation", "private"]
    here.run(*isolated, "debootstrap", "--variant=minbase", SUITE, root, _mirror(), timeout=1200)


def _mirror() -> str:
    """The mirror that this machine itself installs from."""
    for path in SOURCES:
        found = (
            re.search(r"^(?:URIs:|deb)\s+(?:\[[^]]*\]\s+)?(https?://\S+)", path.read_text(), re.MULTILINE)
            if path.exists()
            else None
        )
        if found:
            return found[1]
    raise OSError("this machine names no Debian mirror")


if __name__ == "__main__":
    root = folder()
    if not ready(root):
        make(Machine(root.parent, root))
    print(root)
