"""Results put together as a report shows them: methods in one view, and over many frames."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from pathlib import Path

from . import films
from .results import Result
from .searches import Curve
from .sequences import Sequence


@dataclass
class Comparison:
    """All methods in one frame of one scene under one lighting; pictures are data for the page, by method.

    The reference, where there is one, is the picture of the method "". `plates` is where the page of the paper's
    plates lies, if there is one; `searches` are the curves of what searched for reflection points.
    """

    number: int
    results: list[Result]
    pictures: dict[str, str] = field(default_factory=dict)
    flips: dict[str, str] = field(default_factory=dict)
    thumbnails: dict[str, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    plates: str | None = None
    searches: list[Curve] = field(default_factory=list)
    why: list[str] = field(default_factory=list)
    retraced: dict[str, str] = field(default_factory=dict)

    @property
    def first(self) -> Result:
        """Any of the results; they share scene, frame, lighting and size."""
        return self.results[0]

    @cached_property
    def by_method(self) -> dict[str, Result]:
        """The results by the name of their method."""
        return {result.method: result for result in self.results}

    @cached_property
    def warnings(self) -> list[str]:
        """What went wrong without stopping a method, each once."""
        return list(dict.fromkeys([note for result in self.results for note in result.warnings] + self.problems))

    @cached_property
    def reference(self) -> str | None:
        """Where the reference lies, None if there was none."""
        return next(filter(None, (result.images.reference for result in self.results)), None)

    @cached_property
    def against(self) -> str | None:
        """The method that is the reference, None if Cycles is, or nothing."""
        return next((result.against for result in self.results if result.against), None)

    @property
    def series(self) -> tuple:
        """What it has in common with the other frames of a sequence."""
        first = self.first
        return first.scene, first.lighting, first.width, first.height, self.against

    def ranked(self, scope: str) -> list[Result]:
        """Least FLIP over `scope` first."""
        return sorted(self.results, key=lambda result: or_infinite(getattr(result, scope).flip))

    def least(self, scope: str) -> float:
        """The least FLIP any method reaches."""
        return min(or_infinite(getattr(result, scope).flip) for result in self.results)

    def noise(self, scope: str) -> float | None:
        """FLIP of the reference's own noise, None if nobody measured it."""
        known = [result.noise for result in self.results if result.noise]
        return getattr(known[0], scope).flip if known else None

    @property
    def samples(self) -> int | None:
        """Samples a pixel of Cycles' picture, None where it is not the reference."""
        return self.first.samples.reference


def compared(results: list[Result]) -> list[Comparison]:
    """The views, those first where even the best method is far from the truth."""
    judges = {(_view(result), result.against) for result in results if result.against}
    groups: dict[tuple, list[Result]] = defaultdict(list)
    for result in sorted(results, key=_view):
        # What others are held against belongs to them, though it is held against nothing.
        is_judge = (_view(result), result.method) in judges and result.over_frame.flip is None
        groups[_view(result), result.method if is_judge else result.against].append(result)
    worst_first = sorted(groups.values(), key=_least_error, reverse=True)
    return [Comparison(number, group) for number, group in enumerate(worst_first, start=1)]


def sequences_of(comparisons: list[Comparison], directory: Path) -> dict[tuple, Sequence]:
    """What was measured over several frames, by the `series` of the views; films lie in `directory`."""
    groups: dict[tuple, list[Comparison]] = defaultdict(list)
    for comparison in comparisons:
        groups[comparison.series].append(comparison)
    several = {series: group for series, group in groups.items() if len(group) > 1}
    sequences = {}
    for number, (series, group) in enumerate(several.items(), start=1):
        rows = [row for view in group for row in view.results]
        sequences[series] = Sequence(number, series, rows, _films(rows, directory))
    return sequences


def _films(rows: list[Result], directory: Path) -> dict[str, str]:
    found = {row.method: films.found(directory, row) for row in rows}
    return {method: path for method, path in found.items() if path}


def telling(comparisons: list[Comparison], sequences: Mapping[tuple, Sequence]) -> list[Comparison]:
    """The views to show, numbered from 1 on: of many frames those that tell most, each with a word why."""
    chosen = {series: sequence.telling() for series, sequence in sequences.items()}
    shown = []
    for comparison in comparisons:
        frames = chosen.get(comparison.series)
        if frames is None or comparison.first.frame in frames:
            comparison.why = frames[comparison.first.frame] if frames else []
            comparison.number = len(shown) + 1
            shown.append(comparison)
    return shown


def _view(result: Result) -> tuple:
    return result.scene, result.lighting, result.frame, result.width, result.height


def _least_error(group: list[Result]) -> float:
    """The least FLIP over the reflectors, -1 where nothing was judged: of such scenes nothing is known."""
    return min((result.over_reflectors.flip for result in group if result.over_reflectors.flip is not None), default=-1)


def or_infinite(value: float | None) -> float:
    """`value`, infinite for None, to sort by."""
    return inf if value is None else value
