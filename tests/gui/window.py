"""A Blender window on a screen that nobody sees: run Python in it, press keys and the mouse, take pictures."""

import os
import select
import shutil
import subprocess
import time
from multiprocessing.connection import Client
from pathlib import Path
from types import TracebackType

import numpy as np
import OpenImageIO as oiio
from catoptric.addon.cache import DIRECTORY_VARIABLE

from .machine import Machine

SERVE, PROBE, DRAG = (Path(__file__).with_name(name) for name in ("serve.py", "probe.py", "drag.py"))
START_S = 90.0
MODULE = "bl_ext.user_default.catoptric"


class Window:
    """Blender on an X server of its own, with a user's folder and a cache of its own; a context manager.

    Everything lies in a folder below `machine.share`: the user's in `home`, bakes in `cache`, what Blender printed in
    `log`.
    """

    def __init__(
        self,
        machine: Machine,
        width: int = 1280,
        height: int = 800,
        backend: str = "opengl",
        name: str = "window",
        small_disk: bool = False,
    ) -> None:
        """`backend` as in Blender's `--gpu-backend`: opengl or vulkan. Software Vulkan may draw wrongly.

        `name` is that of the folder; windows of the same name share it, one after the other. With `small_disk` the
        cache lies on a disk of 256 KB, which only a machine with a `root` can mount, and which none but Blender sees.
        """
        self.machine, self.size, self.backend = machine, (width, height), backend
        folder = machine.share / name
        folder.mkdir(exist_ok=True)
        self.home, self.log, self.cache = folder / "home", folder / "blender.log", folder / "cache"
        self._small_disk = small_disk
        self._folder, self._socket = folder, folder / "socket"
        self._programs: list[subprocess.Popen] = []
        self._blender: subprocess.Popen | None = None
        self.clicks = 0
        """How often the mouse was pressed, by `click` and `drop`."""

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

    @property
    def pid(self) -> int:
        """The number of Blender's process."""
        return self._blender.pid

    def ended(self, seconds: float) -> int:
        """Wait until Blender has ended by itself; what it ended with."""
        return self._blender.wait(seconds)

    def until(self, condition: str, seconds: float = 240.0) -> None:
        """Wait until an expression holds on Blender's main thread. Raises `TimeoutError` with its last value."""
        end = time.monotonic() + seconds
        while (said := self.python(f"print(repr({condition}))").strip()) != "True":
            if time.monotonic() > end:
                raise TimeoutError(f"{condition} is {said} after {seconds} s; {self.last_words()}")
            time.sleep(0.2)

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
        self.clicks += 1
        self.xdotool("mousemove", round(x), round(self.size[1] - 1 - y), "sleep", 0.2, "click", 1, "sleep", 0.3)

    def drop(self, path: Path, x: float, y: float) -> None:
        """Drag a file from a window of another program to a place that Blender counts from the bottom left."""
        self.clicks += 1
        size, log = 60, self._folder / "drag.log"
        shutil.copy(DRAG, self._folder)
        top = self.size[1] - size
        other = self._start("python3", self._folder / DRAG.name, path, 0, top, size, log=log, DISPLAY=self._display)
        time.sleep(2.0)
        way = [(size // 2, top + size // 2), (size, top), (x - 20, self.size[1] - y), (x, self.size[1] - y)]
        moves = [("mousemove", round(to_x), round(to_y), "sleep", 0.5) for to_x, to_y in way]
        self.xdotool(*moves[0], "mousedown", 1, "sleep", 0.5, *sum(moves[1:], ()), "mouseup", 1, "sleep", 1)
        other.wait(10.0)
        self.settle(1.0)

    def picture(self, path: Path) -> np.ndarray:
        """Write the screen to a PNG; returns it, (H, W, 3) of 0..255, the top row first."""
        path.write_bytes(self.machine.run("import", "-silent", "-window", "root", "png:-", DISPLAY=self._display))
        return oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8)[..., :3]

    def pixels(self, number: int = 0) -> np.ndarray:
        """The extension's own picture for a viewport, (H, W, 3) float32 scene-linear, the top row first."""
        path = self._folder / "pixels.npy"
        self.python(f"import numpy; numpy.save({str(path)!r}, probe.picture({number}).pixels)")
        return np.load(path)[::-1, :, :3]

    def settle(self, seconds: float = 0.5) -> None:
        """Let Blender draw and handle events."""
        time.sleep(seconds)
        self.python("")

    def last_words(self) -> str:
        """The end of what Blender printed."""
        return self.log.read_text(errors="replace")[-2000:] if self.log.exists() else "Blender printed nothing"

    def _start(
        self, *arguments: str | Path, log: Path, pass_fds: tuple[int, ...] = (), **environment: str
    ) -> subprocess.Popen:
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
        return program

    def _open_screen(self) -> str:
        """Start an X server, which chooses a free display and says which."""
        read, write = os.pipe()
        size = f"{self.size[0]}x{self.size[1]}x24"
        log = self._folder / "xvfb.log"
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
        for source in (SERVE, PROBE):
            shutil.copy(source, self._folder)
        script = self._folder / SERVE.name
        self._socket.unlink(missing_ok=True)
        geometry = ("--window-geometry", "0", "0", *map(str, self.size))
        arguments = ("--gpu-backend", self.backend, *geometry, "--python", script, "--", self._socket, MODULE)
        where = {"DISPLAY": self._display, "BLENDER_USER_RESOURCES": str(self.home)}
        where[DIRECTORY_VARIABLE] = str(self.cache)
        if self._small_disk:
            self.cache.mkdir()
            where["SMALL_DISK"] = str(self.cache)
        self._blender = self._start("blender", *arguments, log=self.log, **where)
        deadline = time.monotonic() + START_S
        while not self._socket.exists():
            if self._blender.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"Blender did not open its window: {self.last_words()}")
            time.sleep(0.1)
        self._connection = Client(str(self._socket), "AF_UNIX")
        self.settle()
