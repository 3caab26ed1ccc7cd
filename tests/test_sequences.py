"""What methods over many frames come to, and how a page shows it."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from catoptric.addon.metrics import Figures
from catoptric.batch.charts import Box, Point, draw
from catoptric.batch.comparisons import compared, sequences_of, telling
from catoptric.batch.report import write_report
from catoptric.batch.results import Images, Result, Results, Reused, Skipped, Times
from hypothesis import given
from hypothesis import strategies as st

from .report_stage import SOFTWARE, measured


def row(method, frame, ms=10.0, flip=0.1, reuse=None, against="ray-traced", **times):
    """A method in a frame that took `ms`, its reflections half of it."""
    figures = Figures(512, flip=flip, mae_8bit=flip) if flip is not None else Figures(512)
    return Result(
        scene="box",
        frame=frame,
        method=method,
        lighting="unlit",
        width=32,
        height=32,
        settings={},
        over_reflectors=figures,
        over_frame=figures,
        time_ms=Times(0.0, ms / 2, ms, times),
        images=Images(f"{method}.exr", "ray-traced.exr", None),
        reuse=reuse,
        against=against if flip is not None else None,
    )


def sequence_of(rows):
    """The one sequence that the rows make."""
    (sequence,) = sequences_of(compared(rows), Path()).values()
    return sequence


def reusing(shares, method="reprojection", **values):
    """Frames 1, 2, ... of a method that retraces these shares; 1 is a key frame."""
    reuses = [Reused(share, share == 1.0) for share in shares]
    return [row(method, frame, reuse=reuse, **values) for frame, reuse in enumerate(reuses, start=1)]


def test_a_sequence_comes_to_what_its_frames_do():
    times = {1: 900.0, 2: 10.0, 3: 20.0, 4: 60.0}  # the first is not counted
    ours = [replace(one, time_ms=Times(0, 1, times[one.frame])) for one in reusing([1.0, 0.1, 0.3, 1.0])]
    traced = [row("ray-traced", frame, ms=60.0, flip=None) for frame in times]
    sequence = sequence_of([*ours, *traced])
    assert sequence.against == sequence.baseline == "ray-traced"
    one, judge = sequence.rows("over_frame")
    assert (one.method, judge.method) == ("reprojection", "ray-traced")
    assert one.fps.most == pytest.approx(100.0)
    assert one.fps.least == pytest.approx(1000 / 60)
    assert one.fps.mean == pytest.approx(3000 / 90)
    assert one.speedup == pytest.approx(180 / 90)
    assert judge.speedup == pytest.approx(1.0)
    assert (one.interval.most, one.interval.mean) == (3, 2.0)
    assert one.retraced == pytest.approx(0.2)
    assert one.traced == pytest.approx((1.0 + 0.1 + 0.3 + 1.0) / 4)
    assert one.efficiency == pytest.approx((90 / 3) * (0.1 + 0.3 + 1.0) / 3)
    assert judge.retraced is None
    assert judge.efficiency is None
    assert sequence.reflectors().mean == 0.5


@given(st.lists(st.booleans(), min_size=1, max_size=60))
def test_key_frames_serve_every_frame_once(keys):
    rows = reusing([1.0 if key else 0.2 for key in keys])
    (found,) = sequence_of([*rows, row("other", 99, flip=0.9)]).rows("over_frame")[:1]
    served = [part for part in re.split("(?=k)", "".join("k" if key else "-" for key in keys)) if part]
    assert found.interval.most == max(map(len, served))
    assert found.interval.mean == pytest.approx(len(keys) / len(served))


def test_speed_is_over_the_frames_that_both_have():
    rows = [row("ray-traced", frame, ms=30.0) for frame in (1, 2, 3)] + [row("other", frame) for frame in (1, 3, 4)]
    assert {one.method: one.speedup for one in sequence_of(rows).rows("over_frame")}["other"] == pytest.approx(3.0)


def test_stages_are_means_over_all_frames():
    rows = [row("a", 1, gathering=99.0), row("a", 2, gathering=4.0), row("a", 3, tracing=6.0), row("b", 2, light=1.0)]
    stages = dict(sequence_of(rows).stages())
    assert stages["gathering"] == {"a": 2.0}
    assert stages["tracing"] == {"a": 3.0}
    assert stages["light"] == {"b": 1.0}
    assert stages["whole frame"] == {"a": 10.0, "b": 10.0}


def test_curves_break_where_frames_are_missing():
    rows = [row("a", frame, flip=0.1 * frame) for frame in (1, 2, 4, 5)]
    flip, *_ = sequence_of(rows).charts("over_frame", 400.0, 100.0)
    (line,) = flip.lines
    assert [len(run.split()) for run in line.runs] == [2, 2]
    assert line.runs[0].split()[0] == "0.0,80.0"
    assert line.runs[1].split()[1] == "400.0,0.0"
    assert [label for _, label in flip.ticks] == ["0", "0.25", "0.5"]


def test_times_stand_on_a_scale_of_powers_of_ten():
    rows = [row("a", 1, ms=99999.0), row("a", 2, ms=1.0), row("a", 3, ms=10.0), row("a", 4, ms=100.0)]
    frame, *_ = sequence_of(rows).cost_charts(300.0, 100.0)
    (line,) = frame.lines
    assert line.runs == ["100.0,100.0 200.0,50.0 300.0,0.0"]
    assert frame.ticks == [("100.0", "1"), ("50.0", "10"), ("0.0", "100")]


@pytest.mark.parametrize(
    ("flip", "ticks"), [(0.05, ["0", "0.1", "0.2"]), (2e-3, ["0.0001", "0.001", "0.01", "0.1", "1"])]
)
def test_errors_of_methods_far_apart_stand_on_powers_of_ten(flip, ticks):
    rows = [row("a", frame, flip=0.2) for frame in (1, 2, 3)]
    rows += [row("b", frame, flip=1e-9 if frame == 2 else flip) for frame in (1, 2, 3)]
    chart, _ = sequence_of(rows).charts("over_frame", 200.0, 100.0)
    assert [label for _, label in chart.ticks] == ticks
    (run,) = chart.lines[1].runs
    assert run.split()[1] == "100.0,100.0"  # a stray pixel's error is as good as none


def test_key_frames_are_marked_beside_what_was_retraced():
    *_, retraced = sequence_of(reusing([1.0, 0.1, 0.2, 1.0, 0.05])).cost_charts(400.0, 100.0)
    (line,) = retraced.lines
    assert line.keys == [("0.0", "0.0"), ("300.0", "0.0")]
    assert line.runs == ["100.0,50.0 200.0,0.0", "400.0,75.0 400.0,75.0"]
    assert retraced.ticks[-1] == ("0.0", "20")


@given(st.lists(st.none() | st.floats(0.0, 1e6), min_size=1, max_size=20), st.booleans())
def test_every_value_stands_in_its_box(values, decades):
    box = Box(100.0, 50.0, 1, len(values))
    chart = draw("", {"a": [Point(frame, value) for frame, value in enumerate(values, start=1)]}, box, decades)
    points = {point for line in chart.lines for run in line.runs for point in run.split()}
    places = [tuple(map(float, point.split(","))) for point in points]
    assert len(places) == sum(value is not None for value in values)
    assert all(0.0 <= x <= 100.0 and -0.05 <= y <= 50.0 for x, y in places)


def test_of_many_frames_those_that_tell_are_shown():
    shares = [1.0, 0.1, 0.2, 0.29, 1.0, *[0.1] * 15]
    rows = [replace(one, over_reflectors=Figures(512, flip=0.5 if one.frame == 9 else 0.1)) for one in reusing(shares)]
    views = compared(rows)
    shown = telling(views, sequences_of(views, Path()))
    reasons = {view.first.frame: " ".join(view.why) for view in shown}
    assert sorted(reasons) == [1, 4, 5, 7, 9, 13, 20]
    assert reasons[7] == reasons[13] == "on the way"
    assert "before a key frame" in reasons[4]
    assert "key frame" in reasons[5]
    assert "worst" in reasons[9]
    assert sorted(view.number for view in shown) == [1, 2, 3, 4, 5, 6, 7]


def test_few_frames_are_all_shown():
    views = compared([row("a", frame) for frame in range(1, 7)])
    assert len(telling(views, sequences_of(views, Path()))) == 6


def test_rows_that_were_held_against_something_else_stand_apart():
    rows = [row("a", 1), row("ray-traced", 1, flip=None), row("b", 1, against=None), row("ray-traced", 2, against=None)]
    groups = sorted([one.method for one in view.results] for view in compared(rows))
    assert groups == [["a", "ray-traced"], ["b"], ["ray-traced"]]


def test_a_page_of_500_frames_stays_small(tmp_path):
    results = Results("0.1.0", SOFTWARE)
    measured(tmp_path, results, "box", "m", 0.05)
    (one,) = results.results
    reuses = [Reused(1.0, True) if frame % 20 == 0 else Reused(0.1, False) for frame in range(500)]
    results.results = [
        replace(one, frame=frame, method=method, reuse=reuse if method == "reprojection" else None)
        for frame, reuse in enumerate(reuses, start=1)
        for method in ("reprojection", "image-warp", "ray-traced", "layered-depth")
    ]
    results.skipped = [Skipped("box", "planar", "no flat mirror", frame=frame) for frame in range(1, 501)]
    page = write_report(results, tmp_path).read_text()
    assert len(page) < 1_000_000
    assert page.count("<canvas") <= 8
    assert page.count("no flat mirror") == 1
    assert "500 frames from 1 to 500" in page
    assert "Xie et al., Toilet" in page
    assert page.count('class="key"') >= 25


def test_a_page_without_reuse_leaves_the_paper_out(tmp_path):
    results = Results("0.1.0", SOFTWARE)
    measured(tmp_path, results, "box", "m", 0.05)
    results.results.append(replace(results.results[0], frame=2))
    page = write_report(results, tmp_path).read_text()
    assert 'id="sequence-1"' in page
    assert "Xie et al., Toilet" not in page
    assert "against Cycles" in page
