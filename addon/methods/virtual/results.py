"""What a frame's searches found, for drawing and for the next frame to begin from."""

from collections.abc import Iterator, Sequence

import moderngl

from ...gl import require
from ...gl.textures import WIDTH as ROW
from .bundles import Bundle, Run

TEXTURES = 3
"""Of results: first reflection points, where they are shown, and second ones, as virtual/search.frag has them."""

_LIKE = 0.25
"""Of a bundle's radius and spread: how far its rays may have moved, and still begin where the last ones ended."""


class Results:
    """Tables of results, and the runs that they are of. Lives on the GL thread."""

    def __init__(self) -> None:
        """Hold nothing."""
        self.textures: list[moderngl.Texture] = []
        self.target: moderngl.Framebuffer | None = None
        self._runs: dict[tuple[int, ...], tuple[Bundle, Sequence[Run]]] = {}

    @property
    def height(self) -> int:
        """Rows of the tables."""
        return self.target.height

    def make_room(self, count: int, paths: Sequence[tuple[Bundle, list[Run]]]) -> None:
        """Have space for so many results, which will be those of `paths`."""
        self._runs = {bundle.path: (bundle, runs) for bundle, runs in paths}
        height = -(-max(1, count) // ROW)
        if self.target is None or self.height < height:
            self.release()
            self.textures = [require().texture((ROW, height), 4, dtype="f4") for _ in range(TEXTURES)]
            self.target = require().framebuffer(self.textures)

    def runs_like(self, bundle: Bundle) -> Sequence[Run]:
        """The runs of the bundle of the same path, if its rays were nearly these; in order."""
        before, runs = self._runs.get(bundle.path, (None, ()))
        return runs if before is not None and bundle.is_near(before, _LIKE) else ()

    def release(self) -> None:
        """Give the memory back."""
        for part in (self.target, *self.textures):
            if part:
                part.release()
        self.target, self.textures = None, []


def pieces(run: Run, before: Sequence[Run]) -> Iterator[tuple[int, int, Run | None]]:
    """A run in pieces: first and last chunk, plus 1, and the one of the runs `before`, in order, it lies in, if any."""
    at = run.first
    for one in before:
        if one.end <= at or one.first >= run.end:
            continue
        if at < one.first:
            yield at, one.first, None
        first, at = max(at, one.first), min(run.end, one.end)
        yield first, at, one
    if at < run.end:
        yield at, run.end, None
