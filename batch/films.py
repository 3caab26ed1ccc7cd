"""Films of methods over many frames, beside what they are held against."""

from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from ..addon.metrics import PictureError, to_bytes
from ..addon.progress import Progress, part_of, silent
from .pictures import film_stem, load_mask, load_picture, reddened, save_bytes
from .results import Result

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
    edges = np.linspace(0.0, 1.0, len(strips) + 1)
    return [
        _film(strip, directory, part_of(progress, float(start), float(end)))
        for strip, start, end in zip(strips, edges[:-1], edges[1:], strict=True)
    ]


def _film(strip: list[Result], directory: Path, progress: Progress) -> Path:
    def pictures() -> Iterator[np.ndarray]:
        for number, result in enumerate(strip):
            progress(result.method, number / len(strip))
            yield _joined(result, directory)

    first = strip[0]
    return _write(directory / film_stem(first.scene, first.lighting, first.method), pictures())


def _strip(results: Sequence[Result], method: str) -> list[Result]:
    """A method's frames that go together: of the size of the last one, held against the same."""
    own = sorted((result for result in results if result.method == method), key=lambda result: result.frame)
    return [result for result in own if _kind(result) == _kind(own[-1])]


def _kind(result: Result) -> tuple:
    return result.width, result.height, result.against, result.reuse is None, result.images.reference is None


def _joined(result: Result, directory: Path) -> np.ndarray:
    """A picture of the film, (H, W, 3) uint8, both sides even."""
    shown = _shown(result, directory, result.images.method)
    parts = [shown] if result.images.reference is None else [_shown(result, directory, result.images.reference), shown]
    if result.images.retraced:
        parts.append(retraced_view(result, directory, shown))
    gap = np.full((result.height, _GAP, 3), _GREY, np.uint8)
    joined = np.concatenate([piece for part in parts for piece in (gap, part)][1:], axis=1)
    # H.264 takes even sides alone.
    return np.pad(joined, [(0, side % 2) for side in joined.shape[:2]] + [(0, 0)], mode="edge")


def _shown(result: Result, directory: Path, path: str) -> np.ndarray:
    """A picture as a screen shows it; grey if it cannot be read, so that the film still keeps time."""
    size = result.height, result.width, 3
    try:
        picture = to_bytes(load_picture(directory / path))
    except PictureError:
        return np.full(size, _GREY, np.uint8)
    return picture if picture.shape == size else np.full(size, _GREY, np.uint8)


def retraced_view(result: Result, directory: Path, shown: np.ndarray) -> np.ndarray:
    """`shown`, the method's picture (H, W, 3) uint8, with what it traced anew in red; as it is if nobody knows."""
    try:
        mask = load_mask(directory / result.images.retraced)
    except PictureError:
        return shown
    return reddened(shown, mask) if mask.shape == shown.shape[:2] else shown


def _write(stem: Path, pictures: Iterator[np.ndarray]) -> Path:
    """Write a film as an .mp4, or as a folder of PNGs where PyAV is missing, as inside Blender; where it is."""
    try:
        from .preview.video import EXTENSION, Video
    except ImportError:
        for number, picture in enumerate(pictures, start=1):
            save_bytes(stem / f"{number:04d}.png", picture)
        return stem
    path, first = stem.with_name(stem.name + EXTENSION), next(pictures)
    with Video(path, first.shape[1::-1], RATE) as video:
        for picture in chain([first], pictures):
            video.add(picture)
    return path


def found(directory: Path, result: Result) -> str | None:
    """Where the film of a result's method lies, relative to `directory`; None if there is none."""
    stem = film_stem(result.scene, result.lighting, result.method)
    return next((path for path in (f"{stem}.mp4", stem) if (directory / path).exists()), None)
