"""How a program of ours ends: with a status, and at most one line of complaint."""

import sys
from collections.abc import Callable

from ..addon.errors import Cancelled, CatoptricError

WRONG, STOPPED = 2, 130
"""Exit statuses: something in the input or the machine is wrong; stopped by Ctrl-C."""


def status_of(run: Callable[[], int | None]) -> int:
    """The exit status of `run`, whose errors become one line on stderr."""
    try:
        return run() or 0
    except CatoptricError as error:
        complain(str(error))
        return WRONG
    except MemoryError:
        complain("not enough memory: choose a smaller --resolution, or fewer and smaller textures")
        return WRONG
    except (Cancelled, KeyboardInterrupt):
        complain("stopped")
        return STOPPED


def complain(message: str) -> None:
    """Write one line to stderr."""
    print("catoptric:", " ".join(message.split()), file=sys.stderr)
