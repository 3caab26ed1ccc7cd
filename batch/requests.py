"""What the add-on asks of the process beside it: the command line's own work, without the command line."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..addon.parameters import Value
from ..addon.scene import Camera, Lighting, SensorFit
from . import jobs, tasks
from .ending import WRONG, status_of
from .progress import Terminal, blender_on_stderr
from .sources import locate


def compare(
    terminal: Terminal, scene: str, out: str, lighting: str, settings: Mapping[str, Mapping[str, Value]], samples: int
) -> int:
    """Measure methods, with their `settings`, against Cycles; 0 `samples`: as many as it takes."""
    job = jobs.Job((locate(scene),), settings, Lighting(lighting), samples or None, Path(out))
    return 0 if jobs.run(job, terminal).results else WRONG


def reference(
    terminal: Terminal,
    scene: str,
    out: str,
    lighting: str,
    samples: int,
    camera: Mapping[str, object],
    width: int,
    height: int,
) -> int:
    """Write Cycles' picture of what `camera` sees, the arguments of a `Camera`, to the EXR file `out`.

    0 `samples`: as many as it takes.
    """
    size = width, height
    tasks.reference(locate(scene), _camera(camera), size, Lighting(lighting), samples or None, Path(out), terminal)
    return 0


def _camera(given: Mapping[str, object]) -> Camera:
    pairs = {name: tuple(given[name]) for name in ("sensor", "shift")}
    matrix = np.array(given["matrix"])
    return Camera(**{**given, **pairs, "matrix": matrix, "sensor_fit": SensorFit.HORIZONTAL})


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


_KNOWN = {kind.__name__: kind for kind in (compare, reference, export, export_engine)}


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
