"""How long work tells its caller how far it is."""

from collections.abc import Callable

Progress = Callable[[str, float], None]
"""`progress(stage, fraction)`: `stage` is a short phrase for people, `fraction` runs from 0 to 1.

A callback may raise `Cancelled` to stop the work; whoever reports progress must leave nothing
half-written when it does.
"""


def silent(stage: str, fraction: float) -> None:
    """The progress callback that shows nothing."""


def part_of(progress: Progress, start: float, end: float) -> Progress:
    """A callback for one step of larger work: its 0 to 1 is `start` to `end` of `progress`."""
    return lambda stage, fraction: progress(stage, start + (end - start) * fraction)
