"""The stopwatch by timer queries, as on a GPU."""

from catoptric.addon.gl import Stopwatch, call, require, timers


def timed(stages: int) -> dict[str, float]:
    watch = Stopwatch()
    for number in range(stages):
        with watch.stage(f"stage {number % 2}"):
            require().simple_framebuffer((8, 8)).clear()
    return watch.medians()


def test_queries_are_used_again(monkeypatch):
    """Moderngl never gives one back to OpenGL, and a viewport asks for several in every frame."""
    monkeypatch.setattr(timers, "is_software", lambda _: False)
    monkeypatch.setattr(timers, "_queries", [])
    times = call(timed, 6)
    assert set(times) == {"stage 0", "stage 1"}
    assert all(time >= 0.0 for time in times.values())
    assert len(timers._queries) == 6
    for _ in range(5):
        call(timed, 4)
    assert len(timers._queries) == 6
