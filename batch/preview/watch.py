"""Notices that a file was saved again, and reads it while the window lives on."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from time import perf_counter

from ...addon.scene import Scene

_EVERY = 0.5  # seconds between two looks at the file


class Watch:
    """Looks after one file. Reading goes on in a thread of its own."""

    def __init__(self, path: Path, read: Callable[[], Scene]) -> None:
        """`read` gives the scene as the file has it; what it raises comes out of `news`."""
        self._path, self._read = path, read
        self._seen = self._state()
        self._looked_at = perf_counter()
        self._reading: Future[Scene] | None = None
        self._reader = ThreadPoolExecutor(1, thread_name_prefix="catoptric-watch")

    @property
    def is_reading(self) -> bool:
        """Whether the file is being read again."""
        return self._reading is not None

    def news(self) -> Scene | None:
        """The scene, once after every change; costs next to nothing otherwise."""
        if self._reading is None:
            self._look()
        elif self._reading.done():
            done, self._reading = self._reading, None
            return done.result()
        return None

    def _look(self) -> None:
        if perf_counter() - self._looked_at < _EVERY:
            return
        self._looked_at = perf_counter()
        state = self._state()
        if state is not None and state != self._seen:
            self._seen = state
            self._reading = self._reader.submit(self._read)

    def _state(self) -> tuple[int, int, int] | None:
        """What tells two versions of the file apart; None while there is none."""
        try:
            status = self._path.stat()
        except OSError:
            return None
        return status.st_mtime_ns, status.st_size, status.st_ino

    def close(self) -> None:
        """Look no more; what is being read is read to its end."""
        self._reader.shutdown()
