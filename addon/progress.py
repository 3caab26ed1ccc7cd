"""How long work tells its caller how far it is."""

from collections.abc import Callable

Progress = Callable[[str, float], None]
"""`progress(stage, fraction)`: `stage` is a short phrase for people, `fraction` runs from 0 to 1.

A callback may raise `Cancelled` to stop the work; whoever reports progress must leave nothing
half-written when it does.
"""


def silent(stage: str, fraction: float) -> None:
    """The progress callback that shows nothing."""
