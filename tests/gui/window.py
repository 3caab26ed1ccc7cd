"""A Blender window on a screen that nobody sees: run Python in it, press keys and the mouse, take pictures."""

import os
import select
import subprocess
import time
from multiprocessing.connection import Client
from pathlib import Path
from types import TracebackType

import numpy as np
import OpenImageIO as oiio

from .machine import Machine

SERVE = Path(__file__).with_name("serve.py")
START_S = 90.0
MODULE = "bl_ext.user_default.catoptric"


class Window:
    """Blender on an X server of its own, with a user's folder of its own; a context manager.

    Everything lies below `machine.share`: the user's folder in `home`, what Blender printed in `log`.
    """

    def __init__(self, machine: Machine, width: int = 1280, height: int = 800, backend: str = "opengl") -> None:
        """`backend` as in Blender's `--gpu-backend`: opengl or vulkan. Software Vulkan may draw wrongly."""
        self.machine, self.size, self.backend = machine, (width, height), backend
        self.home, self.log = machine.share / "home", machine.share / "blender.log"
        self._socket = machine.share / "socket"
        self._programs: list[subprocess.Popen] = []

    def install(self, package: Path) -> None:
        """Install and enable an extension's zip, which must lie below `machine.share`; before the window opens."""
        arguments = ("--command", "extension", "install-file", "--repo", "user_default", "--enable", package)
        self.machine.run("blender", *arguments, BLENDER_USER_RESOURCES=str(self.home))

    def version(self) -> str:
        """The version of Python in that Blender, as in "3.13"."""
        code = "import sys; print('python', *sys.version_info[:2])"
        said = self.machine.run("blender", "--background", "--factory-startup", "--python-expr", code).decode()
        (line,) = (line for line in said.splitlines() if line.startswith("python "))
        return ".".join(line.split()[1:])

    def __enter__(self) -> "Window":
        try:
            self._display = self._open_screen()
            self._open_blender()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """End Blender, then the X server."""
        for program in reversed(self._programs):
            program.terminate()
            try:
                program.wait(10.0)
            except subprocess.TimeoutExpired:
                program.kill()
                program.wait()
        self._programs.clear()

    def python(self, code: str, timeout: float = 60.0) -> str:
        """Run Python on Blender's main thread; returns what it printed. Raises `RuntimeError` with its traceback."""
        self._connection.send(code)
        if not self._connection.poll(timeout):
            raise TimeoutError(f"no answer in {timeout} s; {self.last_words()}")
        said, failure = self._connection.recv()
        if failure:
            raise RuntimeError(failure)
        return said

    def xdotool(self, *arguments: object) -> None:
        """Mouse (from the top left) and keys: `xdotool("mousemove", 100, 200, "click", 1)`, `xdotool("key", "n")`."""
        self.machine.run("xdotool", *map(str, arguments), DISPLAY=self._display)

    def click(self, x: float, y: float) -> None:
        """Press the left button at a place that Blender counts from the bottom left, as its regions do."""
        self.xdotool("mousemove", round(x), round(self.size[1] - 1 - y), "sleep", 0.2, "click", 1, "sleep", 0.3)

    def picture(self, path: Path) -> np.ndarray:
        """Write the screen to a PNG; returns it, (H, W, 3) of 0..255, the top row first."""
        path.write_bytes(self.machine.run("import", "-silent", "-window", "root", "png:-", DISPLAY=self._display))
        return oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8)[..., :3]

    def settle(self, seconds: float = 0.5) -> None:
        """Let Blender draw and handle events."""
        time.sleep(seconds)
        self.python("")

    def last_words(self) -> str:
        """The end of what Blender printed."""
        return self.log.read_text(errors="replace")[-2000:] if self.log.exists() else "Blender printed nothing"

    def _start(self, *arguments: str | Path, log: Path, pass_fds: tuple[int, ...] = (), **environment: str) -> None:
        with log.open("wb") as output:
            program = subprocess.Popen(
                self.machine.command(*arguments),
                stdout=output,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                env=self.machine.environment(**environment),
                pass_fds=pass_fds,
            )
        self._programs.append(program)

    def _open_screen(self) -> str:
        """Start an X server, which chooses a free display and says which."""
        read, write = os.pipe()
        size = f"{self.size[0]}x{self.size[1]}x24"
        log = self.machine.share / "xvfb.log"
        self._start(
            "Xvfb", "-displayfd", str(write), "-screen", "0", size, "-nolisten", "tcp", log=log, pass_fds=(write,)
        )
        os.close(write)
        with os.fdopen(read) as said:
            if not select.select([said], [], [], 30.0)[0] or not (number := said.readline().strip()):
                raise RuntimeError(f"Xvfb did not start: {log.read_text()}")
        return f":{number}"

    def _open_blender(self) -> None:
        """Start Blender and wait until it answers."""
        script = self.machine.share / SERVE.name
        script.write_text(SERVE.read_text())
        self._socket.unlink(missing_ok=True)
        geometry = ("--window-geometry", "0", "0", *map(str, self.size))
        arguments = ("--gpu-backend", self.backend, *geometry, "--python", script, "--", self._socket)
        where = {"DISPLAY": self._display, "BLENDER_USER_RESOURCES": str(self.home)}
        self._start("blender", *arguments, log=self.log, **where)
        deadline = time.monotonic() + START_S
        while not self._socket.exists():
            if self._programs[-1].poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"Blender did not open its window: {self.last_words()}")
            time.sleep(0.1)
        self._connection = Client(str(self._socket), "AF_UNIX")
        self.settle()
