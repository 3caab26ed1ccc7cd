"""What the add-on asks of the process beside it: the command line's own work, without the command line."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from ..addon.parameters import Value
from ..addon.scene import Lighting
from . import jobs, tasks
from .ending import WRONG, status_of
from .progress import Terminal, blender_on_stderr
from .sources import locate


def compare(
    terminal: Terminal, scene: str, out: str, lighting: str, settings: Mapping[str, Mapping[str, Value]], samples: int
) -> int:
    """Measure methods, with their `settings`, against Cycles."""
    job = jobs.Job((locate(scene),), settings, Lighting(lighting), samples, Path(out))
    return 0 if jobs.run(job, terminal).results else WRONG


def export(terminal: Terminal, scene: str, out: str, lighting: str) -> int:
    """Write the scene, with its light, as an archive."""
    tasks.export(locate(scene), Lighting(lighting), Path(out), terminal)
    return 0


def export_engine(
    terminal: Terminal, scene: str, out: str, lighting: str, objects: list[str], settings: Mapping[str, Value]
) -> int:
    """Write the bakes of `objects` for an engine."""
    tasks.export_engine(locate(scene), objects, Lighting(lighting), settings, Path(out), terminal)
    return 0


_KNOWN = {kind.__name__: kind for kind in (compare, export, export_engine)}


def main(request: str) -> int:
    """Do what `request` says, the JSON of [name, arguments]; returns the exit status."""
    name, arguments = json.loads(request)

    def run() -> int:
        with blender_on_stderr(), Terminal() as terminal:
            return _KNOWN[name](terminal, **arguments)

    status = status_of(run)
    sys.stdout.flush()
    sys.stderr.flush()
    return status
