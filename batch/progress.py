"""Progress on a terminal: one bar a scene, with the time left; nothing where nobody looks."""

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn


class Bar:
    """A bar that is shared out over steps of unequal length.

    `advance_to(start, end, label)` gives the callback for a step that fills the bar from `start` to
    `end`, both 0..1. Time left is for the whole bar, so the shares should be near the truth.
    """

    def __init__(self, progress: Progress, task: TaskID) -> None:
        """A bar of `progress`, whose task runs from 0 to 1."""
        self._progress = progress
        self._task = task

    def step(self, label: str, start: float, end: float):
        """The progress callback of one step."""

        def report(stage: str, fraction: float) -> None:
            done = start + (end - start) * min(max(fraction, 0.0), 1.0)
            self._progress.update(self._task, completed=done, step=f"{label}: {stage}" if stage else label)

        report("", 0.0)
        return report

    def finish(self) -> None:
        """Take the bar away."""
        self._progress.remove_task(self._task)


class Terminal:
    """Where bars, lines and warnings go. Bars and warnings to stderr, results to stdout."""

    def __init__(self) -> None:
        """Bars show only if stderr is a terminal."""
        self.errors = Console(stderr=True, highlight=False, soft_wrap=True)
        self._out = Console(highlight=False, soft_wrap=True)
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.fields[step]}", style="dim"),
            console=self.errors,
            disable=not self.errors.is_terminal,
            transient=True,
        )

    def __enter__(self) -> "Terminal":
        self._bars.start()
        return self

    def __exit__(self, *failure: object) -> None:
        self._bars.stop()

    def bar(self, description: str) -> Bar:
        """A new bar."""
        return Bar(self._bars, self._bars.add_task(description, total=1.0, step=""))

    def say(self, line: str) -> None:
        """A line of results."""
        self._out.print(line, markup=False)

    def warn(self, line: str) -> None:
        """A line that a person should read, though the work goes on."""
        self.errors.print(f"catoptric: {line}", markup=False)
