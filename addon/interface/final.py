"""A final render (F12): the picture, and passes for the compositor."""

from collections.abc import Callable

import bpy
import numpy as np

from ..blender.extract import extract
from ..blender.extract_memo import Memo
from ..drawing import Canvas
from ..gl import call
from ..methods.contract import View
from ..methods.mixed import Mixed
from ..progress import Progress, part_of
from . import lights, stages

PASSES = (
    ("Combined", "RGBA", "COLOR"),
    ("Reflection", "RGB", "COLOR"),
    ("Reflectors", "X", "VALUE"),
    ("Reflector ID", "X", "VALUE"),
    ("Hit Distance", "X", "VALUE"),
)
"""Name, channels and kind. Combined is Reflection and the rest; Reflectors is the share of the pixel that shows
one; Reflector ID counts them from 1 in the order of the scene, 0 where there is none, without smooth edges;
Hit Distance is metres from the mirror to what it shows at the pixel's centre, 0 off the mirrors."""

_FAR = 1e10
"""What Blender's own Depth pass has where there is nothing."""


def final_passes(
    depsgraph: bpy.types.Depsgraph, progress: Progress, warn: Callable[[str], None]
) -> dict[str, np.ndarray]:
    """PASSES by name, (H, W) or (H, W, channels), row 0 the top. Raises as `extract` and methods do."""
    scene = depsgraph.scene.original
    settings = scene.catoptric
    stage = stages.known(scene, depsgraph.view_layer)
    memo = Memo(world=stage.memo.world if stage else None, may_render=False)
    found = extract(scene, depsgraph, progress=part_of(progress, 0.0, 0.3), memo=memo)
    for warning in found.warnings:
        warn(warning)
    found, lighting = lights.shown(scene, found, wait=True)
    if lighting != settings.lighting:
        warn("the light is not baked yet; lamps stand in for it (press Bake Light in the panel)")
    method = Mixed(stages.assignment(scene, found))
    try:
        method.prepare(found, lighting, part_of(progress, 0.3, 0.6))
        view = View(found.camera, *found.resolution, int(settings.samples))
        return call(_painted, method, view, np.array([0, *_numbers(found.instances)]), part_of(progress, 0.6, 1.0))
    finally:
        method.release()


def _numbers(instances) -> np.ndarray:
    reflectors = np.array([instance.reflector for instance in instances], bool)
    return np.where(reflectors, np.cumsum(reflectors), 0)


def _painted(method: Mixed, view: View, numbers: np.ndarray, progress: Progress) -> dict[str, np.ndarray]:
    """`numbers` are the reflectors' by instance + 1."""
    canvas = Canvas(view.width, view.height, apart=True)
    try:
        method.paint(view, canvas, progress)
        color, reflectors, distance = canvas.read()
        return {
            "Combined": np.dstack([color, np.ones_like(reflectors)]),
            "Reflection": canvas.read_reflection(),
            "Reflectors": reflectors,
            "Reflector ID": numbers[canvas.read_instances() + 1],
            "Hit Distance": np.nan_to_num(distance, nan=0.0, posinf=_FAR),
        }
    finally:
        canvas.release()
