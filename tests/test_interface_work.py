"""Several tasks as one: in order, with one progress, one stop, and one line at the end."""

import pytest
from catoptric.addon.errors import SceneError
from catoptric.addon.interface import work

from .interface_stage import registered, until


@pytest.fixture(autouse=True)
def blender():
    with registered():
        yield


def steps(log, name, count=4, fails=False):
    """A task on the GL thread that reports, and writes down what it does."""

    def run(progress):
        for number in range(count):
            progress(name, number / count)
            log.append(f"{name} {number}")
            yield
        if fails:
            raise SceneError(f"{name} went wrong")

    return work.GlTask(name, run)


def run(parts):
    task = work.Chain("Both", parts)
    work.begin(task)
    seen = []
    until(lambda: seen.append(task.fraction) or task.over)
    return task, seen


def test_parts_follow_each_other_with_one_progress():
    log, waited = [], []

    def parts(chain):
        yield steps(log, "one"), 0.6
        for _ in range(3):
            waited.append(list(log))
            yield None, 0.6
        yield steps(log, "two"), 1.0
        chain.outcome = "both"

    task, seen = run(parts)
    assert log == [f"{name} {number}" for name in ("one", "two") for number in range(4)]
    assert waited == [log[:4]] * 3
    assert seen == sorted(seen)
    assert 0.6 < max(seen) <= 1.0
    assert any(0.0 < fraction <= 0.45 for fraction in seen)
    assert (task.stopped, task.problem, work.last(), work.current()) == (False, "", "both", None)


def test_what_fails_ends_it_with_its_own_line():
    log = []

    def parts(chain):
        yield steps(log, "one", fails=True), 0.5
        yield steps(log, "two"), 1.0

    task, _ = run(parts)
    assert task.problem == work.last() == "one went wrong"
    assert not any(line.startswith("two") for line in log)


def test_what_cannot_go_on_in_between_says_so():
    def parts(chain):
        yield steps([], "one"), 0.5
        raise SceneError("the scene is gone")

    task, _ = run(parts)
    assert task.problem == "the scene is gone"


@pytest.mark.parametrize("when", ["one 1", "waiting", "two 1"])
def test_a_stop_ends_the_part_under_way_and_begins_no_other(when):
    log, ended = [], []

    def parts(chain):
        try:
            yield steps(log, "one", 30), 0.3
            for _ in range(5):
                log.append("waiting")
                yield None, 0.5
            yield steps(log, "two", 30), 1.0
            log.append("after")
        finally:
            ended.append(True)

    task = work.Chain("Both", parts)
    work.begin(task)
    until(lambda: when in log)
    work.cancel()
    until(lambda: task.over)
    assert task.stopped
    assert ended == [True]
    assert work.last() == "Both: stopped"
    assert "after" not in log
    assert ("two 0" in log) == when.startswith("two")
