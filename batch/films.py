"""Films of methods over many frames, beside what they are held against."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..addon.metrics import PictureError, to_bytes
from ..addon.progress import Progress, silent
from .pictures import film_stem, load_mask, load_picture, reddened, save_bytes
from .results import Result

if TYPE_CHECKING:
    from .preview.video import Video

RATE = 30
"""Pictures a second."""

_GAP, _GREY = 4, 128


def make(results: Sequence[Result], directory: Path, progress: Progress = silent) -> list[Path]:
    """Film every method of `results`, whose pictures lie in `directory`, over all its frames; where the films are.

    Left to right a film shows the reference, where there is one; the method; and, of a method that takes over from
    earlier frames, its picture with what it traced anew in red (Xie et al., figure 7). It is an .mp4; a folder of PNGs
    where nothing here writes one. A method that was measured in one frame has none.
    """
    strips = {method: _strip(results, method) for method in dict.fromkeys(result.method for result in results)}
    strips = [strip for strip in strips.values() if len(strip) > 1]
    rows = sorted((result for strip in strips for result in strip), key=_frame)
    with ExitStack() as stack:
        films = {strip[0].method: stack.enter_context(_film(strip[0], directory)) for strip in strips}
        done = 0
        for frame, group in groupby(rows, _frame):
            progress(f"frame {frame}", done / len(rows))
            done += _add(list(group), films, directory)
    return [film.path for film in films.values()]


def _add(results: list[Result], films: Mapping[str, "Video | _Folder"], directory: Path) -> int:
    """Add a frame to the films of all methods, what they are held against read once; how many pictures there were."""
    references: dict[str, np.ndarray] = {}
    for result in results:
        path = result.images.reference
        if path and path not in references:
            references[path] = _shown(result, directory, path)
        films[result.method].add(_joined(result, directory, references.get(path)))
    return len(results)


def _frame(result: Result) -> int:
    return result.frame


def _strip(results: Sequence[Result], method: str) -> list[Result]:
    """A method's frames that go together: of the size of the last one, held against the same."""
    own = sorted((result for result in results if result.method == method), key=lambda result: result.frame)
    return [result for result in own if _kind(result) == _kind(own[-1])]


def _kind(result: Result) -> tuple:
    return result.width, result.height, result.against, result.reuse is None, result.images.reference is None


def _joined(result: Result, directory: Path, reference: np.ndarray | None) -> np.ndarray:
    """A picture of the film, (H, W, 3) uint8, both sides even; `reference` (H, W, 3) uint8 as a screen shows it."""
    shown = _shown(result, directory, result.images.method)
    parts = [shown] if reference is None else [reference, shown]
    if result.images.retraced:
        parts.append(retraced_view(result, directory, shown))
    gap = np.full((result.height, _GAP, 3), _GREY, np.uint8)
    joined = np.concatenate([piece for part in parts for piece in (gap, part)][1:], axis=1)
    # H.264 takes even sides alone.
    return np.pad(joined, [(0, side % 2) for side in joined.shape[:2]] + [(0, 0)], mode="edge")


def _shown(result: Result, directory: Path, path: str) -> np.ndarray:
    """A picture as a screen shows it; grey if it cannot be read, so that the film still keeps time."""
    blank = _blank(result)
    try:
        picture = to_bytes(load_picture(directory / path))
    except PictureError:
        return blank
    return picture if picture.shape == blank.shape else blank


def _blank(result: Result) -> np.ndarray:
    return np.full((result.height, result.width, 3), _GREY, np.uint8)


def retraced_view(result: Result, directory: Path, shown: np.ndarray) -> np.ndarray:
    """`shown`, the method's picture (H, W, 3) uint8, with what it traced anew in red; as it is if nobody knows."""
    try:
        mask = load_mask(directory / result.images.retraced)
    except PictureError:
        return shown
    return reddened(shown, mask) if mask.shape == shown.shape[:2] else shown


def _film(first: Result, directory: Path) -> "Video | _Folder":
    """A method's film: an .mp4, or a folder of PNGs where PyAV is missing, as inside Blender."""
    stem = directory / film_stem(first.scene, first.lighting, first.method)
    try:
        from .preview.video import EXTENSION, Video
    except ImportError:
        return _Folder(stem)
    shape = _joined(first, directory, _blank(first) if first.images.reference else None).shape
    return Video(stem.with_name(stem.name + EXTENSION), shape[1::-1], RATE)


class _Folder:
    """A film as a folder of numbered pictures."""

    def __init__(self, path: Path) -> None:
        self.path, self._count = path, 0

    def __enter__(self) -> "_Folder":
        return self

    def add(self, picture: np.ndarray) -> None:
        self._count += 1
        save_bytes(self.path / f"{self._count:04d}.png", picture)

    def __exit__(self, *_) -> None:
        pass


def found(directory: Path, result: Result) -> str | None:
    """Where the film of a result's method lies, relative to `directory`; None if there is none."""
    stem = film_stem(result.scene, result.lighting, result.method)
    return next((path for path in (f"{stem}.mp4", stem) if (directory / path).exists()), None)
