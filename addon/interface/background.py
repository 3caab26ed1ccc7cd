"""A Blender of its own beside this one: Cycles works there, and this window never waits."""

import atexit
import json
import os
import queue
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import IO

import bpy

from ..errors import MachineError
from .work import Task

_SCRIPT = Path(__file__).resolve().parents[2] / "batch" / "beside.py"
_PROGRESS = re.compile(r"progress (\d\.\d+) (.*)")
_OURS = "catoptric: "
_PATIENCE_S = 3.0
_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0) | getattr(subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0)
"""On Windows; elsewhere the process itself gives way to others."""

_running: "set[ProcessTask]" = set()


class ProcessTask(Task):
    """One of `batch.requests`, on a copy of the open file.

    The copy and all else that is temporary lie in `folder`, which goes with the task. The process ends with it,
    with Blender, and at once if Blender is killed. `results` are the lines it has printed.
    """

    def __init__(self, label: str, name: str, **arguments: object) -> None:
        """`name` and `arguments` are those of a request; the copy's path is added to them as `scene`."""
        super().__init__(label)
        self.results: list[str] = []
        self.folder: Path | None = None
        self._name, self._arguments = name, arguments
        self._process: subprocess.Popen | None = None
        self._lines: queue.SimpleQueue[tuple[str, str]] = queue.SimpleQueue()
        self._readers: list[threading.Thread] = []
        self._last = ""

    def start(self) -> None:
        """Write the copy, start the process."""
        try:
            self.folder = Path(tempfile.mkdtemp(prefix="catoptric-", dir=bpy.app.tempdir or None))
        except OSError as error:
            raise MachineError(f"cannot make a temporary folder: {error.strerror}; see Blender's File Paths") from error
        copy = self.folder / (Path(bpy.data.filepath).name or "unsaved.blend")
        _write_copy(copy)
        request = json.dumps([self._name, {"scene": str(copy), **self.arguments(self.folder)}])
        command = [*_program(), os.pathsep.join(sys.path), request]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                creationflags=_FLAGS,
            )
        except OSError as error:
            raise MachineError(f"cannot start {command[0]}: {error.strerror}") from error
        _running.add(self)
        self.stage = "starting Blender"
        for name, stream in (("results", self._process.stdout), ("errors", self._process.stderr)):
            reader = threading.Thread(target=self._read, args=(name, stream), daemon=True)
            reader.start()
            self._readers.append(reader)

    def arguments(self, folder: Path) -> dict[str, object]:
        """What is asked for; what is temporary may lie in `folder`."""
        return self._arguments

    def look(self) -> bool:
        """Read what it has said; whether it has ended."""
        ended = self._process.poll() is not None and not any(reader.is_alive() for reader in self._readers)
        while not self._lines.empty():
            self._take(*self._lines.get())
        if ended and not self.stopped and self._process.returncode != 0:
            self.problem = self._last or f"the process beside Blender ended with status {self._process.returncode}"
        return ended

    def stop(self) -> None:
        """Let go of the process; it ends by itself, or is made to."""
        super().stop()
        if self._process is not None:
            self._process.terminate()

    def drop(self) -> None:
        """End the process and remove the temporary folder, without waiting for either."""
        _running.discard(self)
        threading.Thread(target=self._end, name="catoptric-end", daemon=False).start()

    def end_now(self) -> None:
        """Do so at once: Blender quits."""
        self._process.kill()
        self._end()

    def _end(self) -> None:
        if self._process is not None:
            try:
                self._process.wait(0.0 if self._process.poll() is not None else _PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
            for reader in self._readers:
                reader.join()
            for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
                stream.close()
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)

    def _read(self, name: str, stream: IO[str]) -> None:
        for line in stream:
            self._lines.put((name, line.rstrip()))

    def _take(self, name: str, line: str) -> None:
        if name == "results":
            self.results.append(line)
        elif progress := _PROGRESS.fullmatch(line):
            self.fraction, self.stage = float(progress[1]), progress[2]
        elif line.startswith(_OURS):
            self._last = line.removeprefix(_OURS)
            self.notes.append(self._last)


def _program() -> list[str]:
    """This very Blender, or the Python that Blender is a module of."""
    if not bpy.app.binary_path:
        return [sys.executable, str(_SCRIPT), "--"]
    return [bpy.app.binary_path, "--background", "--factory-startup", "--python", str(_SCRIPT), "--"]


def _write_copy(path: Path) -> None:
    """Save the open file to `path` as it is in memory; it keeps its own name, and what it is to be saved as."""
    paths = bpy.context.preferences.filepaths
    before, dirty = paths.file_preview_type, bpy.context.preferences.is_dirty
    try:
        paths.file_preview_type = "NONE"  # Blender would draw every window for it
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, check_existing=False, compress=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0].removeprefix("Error: ")
        raise MachineError(f"cannot write a copy of the file to {path.parent}: {reason}; free some space") from None
    finally:
        paths.file_preview_type = before
        bpy.context.preferences.is_dirty = dirty


@atexit.register
def end_all() -> None:
    """End every process."""
    for task in list(_running):
        task.end_now()
    _running.clear()


def register() -> None:
    """Nothing to add."""


def unregister() -> None:
    """Leave no process behind."""
    end_all()
