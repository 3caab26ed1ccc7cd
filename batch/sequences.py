"""Methods over many frames: curves, and what they come to."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import inf

from .charts import Box, Chart, Point, draw
from .results import Result

BASELINE = "ray-traced"
"""The method that others are to be faster than."""

SHOWN_WHOLE = 6
"""Of so many frames each is shown; of more, those that tell most."""

_MOST_WORST, _BETWEEN = 4, 2
_FAR = 10
"""So many times another's is a curve that needs a scale of powers of ten beside it."""

Value = Callable[[Result], float | None]


@dataclass(frozen=True)
class Span:
    """The most, the least and the mean of what was measured over the frames; None where nothing was."""

    most: float | None = None
    least: float | None = None
    mean: float | None = None


@dataclass(frozen=True)
class Row:
    """What one method comes to over a sequence (Xie et al., Table 1).

    `fps` pictures a second (the mean is frames over time), `frame` and `reflection` mean milliseconds, `speedup` over
    the baseline, `interval` frames from key frame to key frame, `retraced` the mean share of the reflectors' pixels
    between key frames, `traced` that over all frames; `efficiency` is the speed-up of the reflection pass as a share
    of what it would be if nothing but tracing took time.
    """

    method: str
    frames: int
    fps: Span
    frame: float | None
    reflection: float | None
    speedup: float | None
    interval: Span
    retraced: float | None
    traced: float | None
    efficiency: float | None


@dataclass(eq=False)
class Sequence:
    """All that was measured in the frames of a scene under one light, at one size, against one judge.

    `series` is what its views have in common, `films` lie where it says for a method, relative to the page.
    """

    number: int
    series: tuple
    results: list[Result]
    films: dict[str, str]

    @property
    def first(self) -> Result:
        """Any of the results."""
        return self.results[0]

    @cached_property
    def by_method(self) -> dict[str, list[Result]]:
        """Each method's results, by frame."""
        ordered = sorted(self.results, key=lambda result: result.frame)
        names = dict.fromkeys(result.method for result in self.results)
        return {name: [result for result in ordered if result.method == name] for name in names}

    @cached_property
    def frames(self) -> list[int]:
        """The frames that anything was measured in."""
        return sorted({result.frame for result in self.results})

    @cached_property
    def against(self) -> str | None:
        """The method that is the reference, None if Cycles is, or nothing."""
        return next((result.against for result in self.results if result.against), None)

    @cached_property
    def reusing(self) -> list[str]:
        """The methods that take over from earlier frames."""
        return [name for name, rows in self.by_method.items() if any(row.reuse for row in rows)]

    @cached_property
    def baseline(self) -> str | None:
        """What speed is held against: ray tracing, else the method that is the reference."""
        return next((name for name in (BASELINE, self.against) if name in self.by_method), None)

    @cached_property
    def warnings(self) -> list[str]:
        """What went wrong without stopping a method, each once."""
        return list(dict.fromkeys(note for result in self.results for note in result.warnings))

    def reflectors(self) -> Span:
        """The share of the picture that shows reflectors."""
        counted = {row.frame: row.over_reflectors.pixels / (row.width * row.height) for row in self.results}
        return _span(counted.values())

    def mean_of(self, method: str, scope: str, figure: str) -> float | None:
        """The mean of one of the `Figures` over a method's frames."""
        return _span(getattr(getattr(row, scope), figure) for row in self.by_method.get(method, ())).mean

    def rows(self, scope: str) -> list[Row]:
        """What the methods come to, the one with the least error over `scope` first."""
        errors = {method: self.mean_of(method, scope, "flip") for method in self.by_method}
        ranked = sorted(errors, key=lambda method: inf if errors[method] is None else errors[method])
        return [self._row(method, self.by_method[method]) for method in ranked]

    def _timed(self, rows: list[Result]) -> list[Result]:
        """Without the sequence's first frame, which is slow in ways that no other is."""
        return [row for row in rows if row.frame != self.frames[0]] or rows

    def _row(self, method: str, rows: list[Result]) -> Row:
        timed = self._timed(rows)
        frame = _span(row.time_ms.frame for row in timed)
        lengths = _intervals(rows)
        traced = _traced(timed)
        faster = self._speedup(timed, "reflection")
        return Row(
            method=method,
            frames=len(rows),
            fps=Span(*(1e3 / ms if ms else None for ms in (frame.least, frame.most, frame.mean))),
            frame=frame.mean,
            reflection=_span(row.time_ms.reflection for row in timed).mean,
            speedup=self._speedup(timed, "frame"),
            interval=_span(lengths),
            retraced=_span(row.reuse.retraced for row in rows if row.reuse and not row.reuse.key).mean,
            traced=_traced(rows),
            efficiency=faster * traced if faster and traced is not None else None,
        )

    def _speedup(self, timed: list[Result], stage: str) -> float | None:
        """How many times as long the baseline takes for a stage of the same frames."""
        slow = {row.frame: getattr(row.time_ms, stage) for row in self.by_method.get(self.baseline, ())}
        pairs = [(slow.get(row.frame), getattr(row.time_ms, stage)) for row in timed]
        pairs = [(theirs, ours) for theirs, ours in pairs if theirs and ours]
        return sum(theirs for theirs, _ in pairs) / sum(ours for _, ours in pairs) if pairs else None

    def stages(self) -> list[tuple[str, dict[str, float]]]:
        """Mean milliseconds of every stage by method, as they are drawn, and in all (Xie et al., Table 2)."""
        stages: dict[str, dict[str, float]] = {}
        for method, rows in self.by_method.items():
            timed = [row.time_ms.stages for row in self._timed(rows)]
            for stage in dict.fromkeys(name for times in timed for name in times):
                # A stage that only some frames have, such as a key frame's, still is a part of the mean frame.
                stages.setdefault(stage, {})[method] = sum(times.get(stage, 0.0) for times in timed) / len(timed)
        for title, name in (("reflection pass", "reflection"), ("whole frame", "frame")):
            means = {
                method: _span(getattr(row.time_ms, name) for row in self._timed(rows)).mean
                for method, rows in self.by_method.items()
            }
            stages[title] = {method: mean for method, mean in means.items() if mean is not None}
        return list(stages.items())

    def charts(self, scope: str, width: float, height: float) -> list[Chart]:
        """The curves of error over `scope`, in boxes of that size."""
        figures = {"FLIP": "flip", "mean absolute difference, of 255": "mae_8bit"}
        drawn = [
            self._chart(title, lambda row, name=name: getattr(getattr(row, scope), name), width, height)
            for title, name in figures.items()
        ]
        return [chart for chart in drawn if chart.lines]

    def cost_charts(self, width: float, height: float) -> list[Chart]:
        """The curves of time and of what was retraced."""
        passes = {"frame, ms": "frame", "reflection pass, ms": "reflection"}
        drawn = [
            self._chart(title, lambda row, name=name: getattr(row.time_ms, name), width, height, timed=True)
            for title, name in passes.items()
        ]
        title = "retraced between key frames (○), % of the reflectors' pixels"
        drawn.append(self._chart(title, _retraced, width, height))
        return [chart for chart in drawn if chart.lines]

    def box(self, width: float, height: float = 0.0) -> Box:
        """Where curves of that size are drawn."""
        return Box(width, height, self.frames[0], self.frames[-1])

    def _chart(self, title: str, value: Value, width: float, height: float, timed: bool = False) -> Chart:
        """Times are on a scale of powers of ten: by so much methods differ, and single frames from others.

        So is everything else where that of one method is far from that of another, which else would not be seen.
        """
        chosen = {name: self._timed(rows) if timed else rows for name, rows in self.by_method.items()}
        points = {
            name: [Point(row.frame, value(row), row.reuse is not None and row.reuse.key) for row in rows]
            for name, rows in chosen.items()
        }
        return draw(title, points, self.box(width, height), decades=timed or _far_apart(points.values()))

    def telling(self) -> dict[int, list[str]]:
        """The frames to show, and why each; all of them where there are few."""
        if len(self.frames) <= SHOWN_WHOLE:
            return {frame: [] for frame in self.frames}
        shown: dict[int, list[str]] = {self.frames[0]: ["the first"], self.frames[-1]: ["the last"]}
        legs = len(self.frames) // (_BETWEEN + 1)
        shown |= {self.frames[leg * legs]: ["on the way"] for leg in range(1, _BETWEEN + 1)}
        worst: dict[int, list[str]] = {}
        rows = [max(rows, key=lambda row: row.over_reflectors.flip or 0.0) for rows in self.by_method.values()]
        for row in [row for row in rows if row.over_reflectors.flip][:_MOST_WORST]:
            worst.setdefault(row.frame, []).append(row.method)
        for frame, methods in worst.items():
            shown.setdefault(frame, []).append(f"the worst of {', '.join(methods)}")
        for before, key in self._key_after_reuse():
            shown.setdefault(before.frame, []).append(f"before a key frame of {before.method}")
            shown.setdefault(key.frame, []).append(f"a key frame of {key.method}")
        return dict(sorted(shown.items()))

    def _key_after_reuse(self) -> list[tuple[Result, Result]]:
        """The first key frame that follows a frame which took something over, and that frame before it."""
        rows = [row for name in self.reusing[:1] for row in self.by_method[name] if row.reuse]
        return [(old, new) for old, new in pairwise(rows) if new.reuse.key and not old.reuse.key][:1]


def _retraced(row: Result) -> float | None:
    """Per cent; nothing for key frames, beside which all others would look alike."""
    return None if row.reuse is None or row.reuse.key else 100.0 * row.reuse.retraced


def _far_apart(lines: Iterable[list[Point]]) -> bool:
    """Whether the mean of one line is many times that of another."""
    means = [mean for points in lines if (mean := _span(point.value for point in points).mean)]
    return len(means) > 1 and max(means) > _FAR * min(means)


def _span(values: Iterable[float | None]) -> Span:
    known = [value for value in values if value is not None]
    return Span(max(known), min(known), sum(known) / len(known)) if known else Span()


def _traced(rows: list[Result]) -> float | None:
    """The mean share of the reflectors' pixels that was traced, key frames whole."""
    return _span(1.0 if row.reuse.key else row.reuse.retraced for row in rows if row.reuse).mean


def _intervals(rows: list[Result]) -> list[int]:
    """How many frames each key frame serves, itself among them; the end of the sequence cuts the last one short."""
    lengths: list[int] = []
    for row in rows:
        if row.reuse is not None and (row.reuse.key or not lengths):
            lengths.append(0)
        if row.reuse is not None:
            lengths[-1] += 1
    return lengths
