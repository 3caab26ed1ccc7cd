"""The report: one HTML file that shows results, tables and pictures, and needs nothing else."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np

from ..addon.metrics import MAGMA, Figures, PictureError, to_bytes
from .comparisons import Comparison, compared, sequences_of, telling
from .films import retraced_view
from .page import templates, texts
from .pictures import load_picture, plates_folder, searches_path
from .plates_page import FILE_NAME as PLATES
from .published import SEQUENCES, STAGES
from .report_pictures import jpeg, pack_flip, pack_picture, thumbnail, window_of_interest
from .results import Result, Results, Skipped, atomically
from .searches import METHODS as SEARCHES
from .searches import STEPS, Curve, load
from .sequences import Sequence

FILE_NAME = "report.html"

EMBEDDED_LIMIT = 60 << 20
"""Bytes of pictures in one page. What is beyond, best scenes last, keeps its figures and small pictures."""


@dataclass(frozen=True)
class Column:
    """A column of the tables: how to get its number from a result, to write it, and which number is best."""

    label: str
    help: str
    value: Callable[[Result, str], float | None]
    digits: int
    best: Callable = min

    @property
    def first(self) -> str:
        """The direction, in ARIA's words, that brings the best number to the top of a table."""
        return "ascending" if self.best is min else "descending"


def _figure(name: str) -> Callable[[Result, str], float | None]:
    def value(result: Result, scope: str) -> float | None:
        figures: Figures = getattr(result, scope)
        infinite = name == "psnr" and figures.psnr is None and figures.flip is not None
        return inf if infinite else getattr(figures, name)

    return value


def _time(name: str) -> Callable[[Result, str], float | None]:
    return lambda result, _: getattr(result.time_ms, name)


COLUMNS = (
    Column("FLIP", "what a person sees when the pictures alternate; 0 is equal, 1 the most", _figure("flip"), 4),
    Column("HDR-FLIP", "the same over all exposures, so that highlights count", _figure("flip_hdr"), 4),
    Column("PSNR dB", "peak signal to noise of the displayed picture; more is better", _figure("psnr"), 1, max),
    Column("SSIM", "likeness of structure; 1 is equal", _figure("ssim"), 4, max),
    Column("MAE /255", "mean absolute difference in steps of an 8-bit screen", _figure("mae_8bit"), 2),
    Column("rel. MSE", "mean squared difference of radiance over the reference's square", _figure("rel_mse"), 4),
    Column("reflection ms", "the reflection pass alone, each frame", _time("reflection"), 2),
    Column("frame ms", "the whole frame", _time("frame"), 2),
    Column("bake ms", "what is computed once before the first frame", _time("bake"), 0),
)

SCOPES = {"over_reflectors": "reflectors", "over_frame": "whole frame"}


def write_report(results: Results, directory: Path, limit: int = EMBEDDED_LIMIT) -> Path:
    """Write report.html into `directory`, where the pictures of `results` lie, and give its path.

    Scenes where even the best method is far from the truth come first. A picture that cannot be
    read is named in the page. At most `limit` bytes of pictures are embedded. Raises
    `MachineError` if the file cannot be written.
    """
    directory = Path(directory)
    every = compared(results.results)
    sequences = sequences_of(every, directory)
    comparisons = telling(every, sequences)
    for comparison in comparisons:
        comparison.plates = _plates(comparison.first, directory)
        comparison.searches = _searches(comparison, directory)
        limit -= _embed(comparison, directory, limit)
    environment = templates()
    environment.filters["number"] = write_number
    template = environment.get_template("report.html.j2")
    path = directory / FILE_NAME
    with atomically(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.writelines(template.generate(**_context(results, every, comparisons, list(sequences.values()))))
    return path


def write_number(value: float | None, digits: int = 4) -> str:
    """`value` for people: `digits` after the point, scientific where those would show only zeros, – for None."""
    if value is None:
        return "–"
    if value == inf:
        return "∞"
    if (value != 0 and abs(value) < 0.5 * 10**-digits) or abs(value) >= 1e7:
        return f"{value:.1e}"
    shorter = 0 if abs(value) >= 1000 else digits
    return f"{value:.{shorter}f}"


def _plates(result: Result, directory: Path) -> str | None:
    page = f"{plates_folder(result.scene, result.frame, result.lighting)}/{PLATES}"
    return page if (directory / page).is_file() else None


def _searches(comparison: Comparison, directory: Path) -> list[Curve]:
    first = comparison.first
    if comparison.by_method.keys().isdisjoint(SEARCHES):
        return []
    return load(directory / searches_path(first.scene, first.frame, first.lighting))


def _embed(comparison: Comparison, directory: Path, limit: int) -> int:
    """Load the pictures of `comparison` and pack them for the page, unless that takes more than `limit` bytes.

    Gives the bytes taken.
    """
    loaded, flips = _load(comparison, directory)
    if not loaded:
        return 0
    detail = window_of_interest(list(loaded.values()))
    comparison.thumbnails = {method: thumbnail(picture[detail]) for method, picture in loaded.items()}
    reference = loaded.get("")
    pictures = {method: pack_picture(picture, reference if method else None) for method, picture in loaded.items()}
    size = sum(map(len, [*pictures.values(), *flips.values()]))
    if size > limit:
        comparison.problems.append(
            "The pictures are left out here to keep the page small: they are in the folder images beside it."
        )
        return 0
    comparison.pictures, comparison.flips = pictures, flips
    return size


def _load(comparison: Comparison, directory: Path) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """The pictures by method, the reference's first, and the packed FLIP maps of what is held against it."""
    pictures, flips = {}, {}
    if comparison.reference is None:
        comparison.problems.append(
            "There is no reference for this scene: Cycles cannot render an archive. Compare its .blend file for errors."
        )
    else:
        pictures[""] = _picture(comparison, directory, comparison.reference)
    for result in comparison.results:
        pictures[result.method] = _picture(comparison, directory, result.images.method)
        if result.images.flip:
            flips[result.method] = _picture(comparison, directory, result.images.flip)
    pictures = {method: picture for method, picture in pictures.items() if picture is not None}
    comparison.retraced = {
        method: jpeg(retraced_view(result, directory, to_bytes(pictures[method])))
        for method, result in comparison.by_method.items()
        if result.images.retraced and method in pictures
    }
    flips = {method: pack_flip(flip) for method, flip in flips.items() if flip is not None}
    return pictures, flips


def _picture(comparison: Comparison, directory: Path, path: str) -> np.ndarray | None:
    """The picture at `path`; None, noted among the problems, if it cannot be shown."""
    try:
        picture = load_picture(directory / path)
    except PictureError as error:
        # Named from where the page lies: the folder may be moved.
        comparison.problems.append(str(error).replace(str(directory / path), path))
        return None
    if picture.shape[:2] == (comparison.first.height, comparison.first.width):
        return picture
    comparison.problems.append(f"the picture {path} has another size now: run compare again without --resume")
    return None


def _context(
    results: Results, every: list[Comparison], comparisons: list[Comparison], sequences: list[Sequence]
) -> dict:
    """What the template is filled with: `every` view counts, `comparisons` are shown."""
    methods = list(dict.fromkeys(result.method for result in results.results))
    return {
        "results": results,
        "machine": results.machine,
        "methods": methods,
        "hues": {method: round(360 * (0.1 + index / len(methods))) for index, method in enumerate(methods)},
        "keys": {method: key for key, method in enumerate(["", *methods])},
        "views": len(every),
        "judge": _judge(every),
        "comparisons": comparisons,
        "sequences": sequences,
        "skipped": _together(results.skipped),
        "columns": COLUMNS,
        "scopes": SCOPES,
        "wins": {scope: _wins(every, scope) for scope in SCOPES},
        "settings": {method: list(_settings(results, method)) for method in methods},
        "best_of": _best_of,
        "chart": _chart,
        "steps": STEPS,
        "published": SEQUENCES,
        "published_stages": STAGES,
        "magma": [f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in MAGMA[::17]],
        "palette": "".join(f"{value:02x}" for value in MAGMA.ravel()),
        "style": texts("report.css"),
        "script": texts("pictures.js", "viewer.js", "page.js"),
        "sorting": texts("sorting.js"),
    }


def _judge(comparisons: list[Comparison]) -> str:
    """What the methods are held against, for people."""
    judges = {comparison.against or "Cycles" for comparison in comparisons if comparison.reference} or {"Cycles"}
    return judges.pop() if len(judges) == 1 else "the reference"


def _together(skipped: list[Skipped]) -> list[tuple[Skipped, tuple[int, ...], list[str]]]:
    """What was left out for one reason, once, with its frames and its methods; failures first."""
    by_method: dict[Skipped, list[int]] = {}
    for entry in sorted(skipped, key=lambda entry: not entry.error):
        frames = by_method.setdefault(replace(entry, frame=None), [])
        if entry.frame is not None:
            frames.append(entry.frame)
    groups: dict[tuple[Skipped, tuple[int, ...]], list[str]] = {}
    for entry, frames in by_method.items():
        groups.setdefault((replace(entry, method=""), tuple(sorted(frames))), []).append(entry.method)
    return [(entry, frames, methods) for (entry, frames), methods in groups.items()]


def _wins(comparisons: list[Comparison], scope: str) -> list[tuple[str, int]]:
    """How often each method is the best one, most often first."""
    winners = [comparison.ranked(scope)[0].method for comparison in comparisons if comparison.least(scope) < inf]
    return sorted(((method, winners.count(method)) for method in set(winners)), key=lambda win: (-win[1], win[0]))


def _settings(results: Results, method: str) -> Iterator[dict]:
    """The different settings that `method` was measured with."""
    seen = []
    for result in results.results:
        if result.method == method and result.settings not in seen:
            seen.append(result.settings)
            yield result.settings


def _best_of(column: Column, results: list[Result], scope: str) -> float | None:
    """The best number of `column`, None if there is nothing to choose between."""
    values = [value for result in results if (value := column.value(result, scope)) is not None]
    return column.best(values) if len(set(values)) > 1 else None


def _chart(comparison: Comparison, scope: str) -> dict:
    """Bars of error and of time: a row a method, lengths as shares of the longest.

    The time is that of the reflection pass; of the whole frame where a peer has no such pass.
    """
    passes = all(result.time_ms.reflection is not None for result in comparison.results)
    rows = []
    for result in comparison.ranked(scope):
        time = result.time_ms.reflection if passes else result.time_ms.frame
        rows.append({"method": result.method, "flip": getattr(result, scope).flip, "time": time})
    noise = comparison.noise(scope)
    most_flip = max([row["flip"] or 0.0 for row in rows] + [noise or 0.0]) or 1.0
    most_time = max(row["time"] or 0.0 for row in rows) or 1.0
    for row in rows:
        row["flip_share"] = (row["flip"] or 0.0) / most_flip
        row["time_share"] = (row["time"] or 0.0) / most_time
    timed = "reflection pass" if passes else "frame"
    return {"rows": rows, "noise": noise, "noise_share": (noise or 0.0) / most_flip, "timed": timed}
