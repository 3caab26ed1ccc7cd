"""`virtual-objects` against Embree, ray by ray."""

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.virtual_objects import VirtualObjects

from .mirror_stage import differing, frame_of, truth
from .stage import looking, mesh_of, placed, scene_of

SIZE = (160, 120)
ALONE = {"worth": 1_000_000, "rest": "environment-map"}  # nothing is left to layered depth


def floor(size: float = 9.0):
    """A square of two triangles."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * size
    return mesh_of(trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False))


def box():
    """A unit cube, flat."""
    return mesh_of(trimesh.creation.box())


def ball():
    """A chrome ball of radius 1."""
    return mesh_of(trimesh.creation.icosphere(subdivisions=4, radius=1.0), smooth=True)


def torus():
    """A smooth ring, 1.65 m across to its outside."""
    return mesh_of(trimesh.creation.torus(1.2, 0.45, major_sections=64, minor_sections=32), smooth=True)


def shell(depth: float = 0.5):
    """The lower part of a sphere, an open sheet that faces its inside."""
    sphere = trimesh.creation.icosphere(subdivisions=4)
    low = sphere.vertices[sphere.faces].mean(axis=1)[:, 2] < -depth
    sphere.update_faces(low)
    sphere.invert()
    return mesh_of(sphere, smooth=True)


def stages():
    """Scenes by name, and the share of reflector pixels that may differ from Embree's."""
    around = [
        (floor(), placed((0, 0, -1)), False),
        (box(), placed((1.9, 0.4, -0.5), turn=0.4), False),
        (box(), placed((-1.9, -0.9, -0.7), (0.5, 1.2, 0.6), 1.1, (1, 1, 0)), False),
    ]
    room = trimesh.creation.box((8, 8, 5))
    room.invert()
    return {
        "ball": ([(ball(), placed(), True), *around], 0.001),
        "squeezed ball": ([(ball(), placed(scale=(1.0, 0.6, 0.8), turn=0.5), True), *around], 0.001),
        "ball in a room": ([(ball(), placed(), True), (mesh_of(room), placed(), False)], 0.001),
        "two balls": (
            [(ball(), placed((-1.05, 0, 0)), True), (ball(), placed((1.05, 0, 0)), True), *around[:1]],
            0.002,
        ),
        "torus": ([(torus(), placed(turn=0.9, axis=(1, 0, 0)), True), (floor(), placed((0, 0, -2)), False)], 0.01),
        "shell": ([(shell(), placed((0, 0, 0.4)), True), *around], 0.01),
    }


@pytest.mark.parametrize("name", stages())
def test_shows_what_embree_sees(name):
    parts, share = stages()[name]
    scene = scene_of(parts, looking((1.0, -3.6, 1.9), (0.0, 0.0, 0.0), lens=45), bounces=1, world=(0.0, 0.0, 0.7))
    frame = frame_of(scene, ALONE, size=SIZE, method=VirtualObjects)
    expected = truth(scene, size=SIZE, most=2)
    mirrors = (frame.reflectors > 0) & ~expected.grazing
    wrong = differing(frame.color, expected.color)[mirrors]
    assert mirrors.sum() > 2000
    assert wrong.mean() <= share
