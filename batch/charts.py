"""Curves over frames, as the points of an SVG."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10
from typing import NamedTuple

_NOTHING = 1e-30
"""What is less counts as 0."""

_TOP = 1.0
_MOST_TICKS = 6
_MOST_DECADES = 4
"""What lies farther below the largest value stands at the bottom: a stray pixel's error is as good as none."""


class Point(NamedTuple):
    """What was measured in a frame, None for nothing; `key`: a key frame, which is marked all the same, at the top."""

    frame: int
    value: float | None
    key: bool = False


@dataclass(frozen=True)
class Line:
    """A method's curve: runs of points in a box, broken where nothing was measured, and the points of key frames."""

    method: str
    runs: list[str]
    keys: list[tuple[str, str]]


@dataclass(frozen=True)
class Chart:
    """Curves of several methods over one axis of frames; `ticks` are heights in the box, 0 at the top, and labels."""

    title: str
    lines: list[Line]
    ticks: list[tuple[str, str]]


@dataclass(frozen=True)
class Box:
    """Where curves are drawn: from the `first` frame to the `last` along `width`, row 0 at the top."""

    width: float
    height: float
    first: int
    last: int

    def across(self, frame: int) -> float:
        """Where a frame stands."""
        return self.width * (frame - self.first) / max(1, self.last - self.first)

    def down(self, share: float) -> float:
        """Where this share of the height stands."""
        return self.height * (1.0 - share)


def draw(title: str, measured: Mapping[str, Sequence[Point]], box: Box, decades: bool = False) -> Chart:
    """The curves of all methods that have any; on a scale of powers of ten if `decades`, else from 0 to the most."""
    values = [point.value for points in measured.values() for point in points if point.value is not None]
    share, ticks = (_decades if decades else _from_zero)(values)
    lines = [_line(method, points, box, share) for method, points in measured.items()]
    return Chart(
        title,
        [line for line in lines if line.runs or line.keys],
        [(f"{box.down(share(tick)):.1f}", f"{tick:.4g}") for tick in ticks],
    )


Scale = tuple[Callable[[float], float], list[float]]
"""At which share of the height a value stands, and the values that are named."""


def _from_zero(values: list[float]) -> Scale:
    top = _ceiling(max(values, default=0.0))
    return (lambda value: value / top), [0.0, 0.5 * top, top]


def _decades(values: list[float]) -> Scale:
    known = [log10(value) for value in values if value >= _NOTHING] or [0.0]
    low, high = floor(min(known)), ceil(max(known))
    high = max(high, low + 1)
    low = max(low, high - _MOST_DECADES)

    def share(value: float) -> float:
        return 0.0 if value < _NOTHING else max(0.0, (log10(value) - low) / (high - low))

    return share, [10.0**power for power in range(low, high + 1, ceil((high - low) / _MOST_TICKS))]


def _ceiling(most: float) -> float:
    """The next of 1, 2, 5, 10, ...; 1 for nothing."""
    if most < _NOTHING:
        return 1.0
    unit = 10.0 ** floor(log10(most))
    return next((step * unit for step in (1.0, 2.0, 5.0) if most <= step * unit * (1 + 1e-9)), 10.0 * unit)


def _line(method: str, points: Sequence[Point], box: Box, share: Callable[[float], float]) -> Line:
    runs: list[list[str]] = [[]]
    keys, expected = [], None
    for point in points:
        if point.value is None or point.frame != expected:
            runs.append([])
        expected = point.frame + 1
        height = _TOP if point.value is None else share(point.value)
        x, y = f"{box.across(point.frame):.1f}", f"{box.down(height):.1f}"
        runs[-1] += [] if point.value is None else [f"{x},{y}"]
        keys += [(x, y)] if point.key else []
    # A point alone is a line to itself, else nothing would show.
    return Line(method, [" ".join(run if len(run) > 1 else run * 2) for run in runs if run], keys)
