"""Films of mirrors, for methods that make pictures of earlier ones."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.ray_traced import RayTraced
from catoptric.addon.scene import Lighting

from .stage import looking, mesh_of, placed, scene_of

SIZE = (160, 100)
EYE = (0.5, -4.5, 1.0)
SKY = (0.1, 0.3, 0.8)


def stage(eye=EYE):
    """A mirror ball and a wall mirror over a floor, a box and a torus between them."""
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True)
    box = mesh_of(trimesh.creation.box())
    torus = mesh_of(trimesh.creation.torus(0.7, 0.25, major_sections=48, minor_sections=24), smooth=True)
    floor = mesh_of(trimesh.creation.box((9, 9, 0.2)))
    pane = mesh_of(trimesh.creation.box((5, 0.1, 3)))
    parts = [
        (ball, placed(), True),
        (pane, placed((0, 3.0, 0.5)), True),
        (box, placed((1.9, 0.4, -0.5)), False),
        (torus, placed((-1.9, 0.0, 0.0), turn=0.7, axis=(1, 0, 0)), False),
        (floor, placed((0, 0, -1.2)), False),
    ]
    return scene_of(parts, looking(eye, (0.0, 0.5, 0.0)), world=SKY)


def seen_from(scene, eye, target=(0.0, 0.5, 0.0)):
    return replace(scene, camera=looking(eye, target))


def with_placed(scene, index, matrix):
    instances = list(scene.instances)
    instances[index] = replace(instances[index], matrix=matrix)
    return replace(scene, instances=tuple(instances))


class Film:
    """One method and the truth, picture by picture."""

    def __init__(self, scene, method, settings=None, size=SIZE, samples=1, lighting=Lighting.UNLIT):
        self.size, self.samples, self.scene = size, samples, scene
        self.taken, self.truth = method(settings), RayTraced()
        for one in (self.taken, self.truth):
            one.prepare(scene, lighting)

    def show(self, scene):
        """The method's frame of a scene, and how much each reflector's pixel (N,) is off the traced one."""
        view = View(scene.camera, *self.size, self.samples)
        for one in (self.taken, self.truth):
            one.update(scene)
        frame, truth = self.taken.render(view), self.truth.render(view)
        return frame, np.abs(frame.color - truth.color).max(axis=-1)[truth.reflectors > 0]

    def close(self):
        for one in (self.taken, self.truth):
            one.release()


@contextmanager
def filming():
    """Makes films, and closes them in the end."""
    opened = []

    def begin(scene, method, **given):
        opened.append(Film(scene, method, **given))
        return opened[-1]

    yield begin
    for one in opened:
        one.close()


def is_right(off) -> bool:
    return np.mean(off > 1e-3) < 0.005


def pillars():
    """A mirror on the wall, and before it a thin pillar that hides a farther one, as in figure 9 of the paper.

    Seen in the mirror from x = 0: both pillars stand on the way of one ray from the camera's image.
    """
    pane = mesh_of(trimesh.creation.box((12, 0.1, 6)))
    pillar = mesh_of(trimesh.creation.box((1, 1, 6)))
    wall = mesh_of(trimesh.creation.box((40, 0.1, 12)))
    parts = [
        (pane, placed((0, 0, 0)), True),
        (pillar, placed((0.0, -2.0, 0), (0.10, 0.02, 1)), False),
        (pillar, placed((0.0, -4.0, 0), (0.08, 0.02, 1)), False),
        (wall, placed((0, -12.0, 0)), False),
    ]
    # The lens is wider than that of `seen_from`, so that a key frame of it shows what comes into view beside it.
    return scene_of(parts, looking((0.0, -1.0, 0.0), (0.0, 0.0, 0.0), lens=20.0), bounces=0)
