"""A scene for the preview, and what its methods make of it."""

import numpy as np
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS, named
from catoptric.addon.metrics import to_bytes
from catoptric.addon.parameters import resolve
from catoptric.addon.scene import Lighting
from catoptric.batch.preview.path import CameraPath
from catoptric.batch.preview.prepared import Choice

from .stage import looking, mesh_of, placed, scene_of

SIZE = (64, 48)


def stage():
    """A mirror ball, a box to its right, and a floor."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
    box = mesh_of(trimesh.creation.box())
    floor = mesh_of(trimesh.creation.box((8, 8, 0.2)))
    parts = [(ball, placed(), True), (box, placed((2, 0, 0), turn=0.4), False), (floor, placed((0, 0, -1.2)), False)]
    return scene_of(parts, looking((0.5, -4.5, 1.0)), world=(0.2, 0.3, 0.5))


def choice(name, **given):
    return Choice.of(name, resolve(METHODS[name].parameters, given), Lighting.UNLIT)


def rendered(scene, camera, name, samples):
    """What a method of its own makes of it, as a screen shows it."""
    method = named(name)()
    method.prepare(scene, Lighting.UNLIT)
    try:
        return to_bytes(method.render(View(camera, *SIZE, samples)).color)
    finally:
        method.release()


def path_of(keys):
    return CameraPath(np.array([key[0] for key in keys]), np.array([key[1:] for key in keys]))
