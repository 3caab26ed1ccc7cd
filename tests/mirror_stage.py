"""Flat mirrors of any outline, and what they show by Embree, bounce by bounce."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh
from catoptric.addon.methods.contract import Frame, View
from catoptric.addon.methods.planar import Planar
from catoptric.addon.scene import Lighting, Mesh, Scene

from .stage import Judge, camera_rays, mesh_of, mirrored

SIZE = (120, 80)
SKY = (0.0, 0.0, 0.5)


def grid(columns: int, rows: int, keep=None, name: str = "grid") -> Mesh:
    """A unit square in x and z around the origin, in squares; `keep(x, z)` says which, by their middles."""
    x, z = np.meshgrid(np.linspace(-0.5, 0.5, columns + 1), np.linspace(-0.5, 0.5, rows + 1))
    vertices = np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
    first = (np.arange(columns)[None] + (columns + 1) * np.arange(rows)[:, None]).reshape(-1)
    middle = vertices[first] + [0.5 / columns, 0.0, 0.5 / rows]
    if keep is not None:
        first = first[keep(middle[:, 0], middle[:, 2])]
    square = first[:, None] + [0, 1, columns + 2, 0, columns + 2, columns + 1]
    return mesh_of(trimesh.Trimesh(vertices, square.reshape(-1, 3), process=False), name=name)


def pane() -> Mesh:
    """A unit square in x and z, of two triangles."""
    return grid(1, 1, name="pane")


def holed() -> Mesh:
    """A square pane with a square hole."""
    return grid(9, 9, lambda x, z: np.maximum(abs(x), abs(z)) > 0.2, "holed")


def bent() -> Mesh:
    """A pane with the outline of an L."""
    return grid(8, 8, lambda x, z: (x < 0) | (z < 0), "bent")


def arch() -> Mesh:
    """A pane under a round arch: 13 edges, more than clip planes hold."""
    angle = np.linspace(0.0, np.pi, 12)
    edge = np.c_[0.5 * np.cos(angle), np.zeros(12), 0.5 * np.sin(angle)]
    around = np.vstack([edge, [[-0.5, 0, -0.5], [0.5, 0, -0.5]]])
    fan = [[14, number, (number + 1) % 14] for number in range(14)]
    return mesh_of(trimesh.Trimesh(np.vstack([around, [[0.0, 0.0, 0.0]]]), fan, process=False), name="arch")


def frame_of(scene: Scene, settings=None, size=SIZE, samples: int = 1, lighting=Lighting.UNLIT, method=Planar) -> Frame:
    """The scene's picture by `method`."""
    drawn = method(settings)
    drawn.prepare(scene, lighting)
    try:
        return drawn.render(View(scene.camera, *size, samples))
    finally:
        drawn.release()


@dataclass
class Truth:
    """What Embree sees: `color` (H, W, 3), `distance` (H, W) as of a Frame, `grazing` (H, W) rays along a surface."""

    color: np.ndarray
    distance: np.ndarray
    grazing: np.ndarray


def truth(scene: Scene, size=SIZE, most: int | None = None) -> Truth:
    """Every pixel's centre, through as many mirrors as the scene's glossy bounces allow, or `most`."""
    width, height = size
    most = scene.glossy_bounces + 1 if most is None else most
    eye, others = _Seeing(scene, "in_camera"), _Seeing(scene, "in_reflections")
    reflectors = np.array([instance.reflector for instance in scene.instances])
    bases = np.array([scene.materials[instance.materials[0]].base.color for instance in scene.instances])
    origins, directions = camera_rays(scene.camera, width, height)
    count = len(origins)
    color, distance, grazing = np.zeros((count, 3)), np.full(count, np.nan), np.zeros(count, bool)
    left = np.arange(count)
    depth = -directions @ scene.camera.matrix[:3, 2]
    origins = origins + directions * (scene.camera.near / depth)[:, None]
    met = eye.meet(origins, directions)
    met.instance[scene.camera.near + met.distance * depth > scene.camera.far] = -1
    for bounce in range(most + 1):
        outside = met.instance < 0
        color[left[outside]] = scene.world.color
        mirrors = reflectors[met.instance] & ~outside
        plain = ~outside & ~mirrors
        color[left[plain]] = bases[met.instance[plain]]
        if bounce == most or not mirrors.any():
            break
        origins, directions = mirrored(met, directions)
        grazing[left] |= mirrors & (abs((directions * met.flat).sum(axis=1)) < 0.02)
        left, origins, directions = left[mirrors], origins[mirrors], directions[mirrors]
        met = others.meet(origins, directions)
        if bounce == 0:
            distance[left] = met.distance
    return Truth(color.reshape(height, width, 3), distance.reshape(height, width), grazing.reshape(height, width))


class _Seeing:
    """A Judge of the instances that rays of one kind see."""

    def __init__(self, scene: Scene, flag: str) -> None:
        self._kept = np.array([i for i, instance in enumerate(scene.instances) if getattr(instance, flag)])
        self._judge = Judge(replace(scene, instances=tuple(scene.instances[index] for index in self._kept)))

    def meet(self, origins, directions):
        met = self._judge.meet(origins, directions)
        met.instance = np.where(met.instance < 0, -1, self._kept[met.instance])
        return met


def differing(color: np.ndarray, other: np.ndarray, limit: float = 1e-3) -> np.ndarray:
    """(H, W) bool: the pixels that differ."""
    return np.abs(color - other).max(axis=-1) > limit


def apart(color: np.ndarray, other: np.ndarray, limit: float = 1e-3) -> np.ndarray:
    """(H, W) bool: the pixels that differ from `other`'s at their place and from all eight around it."""
    padded = np.pad(other, ((1, 1), (1, 1), (0, 0)), mode="edge")
    height, width = color.shape[:2]
    far = np.ones((height, width), bool)
    for down in range(3):
        for across in range(3):
            far &= differing(color, padded[down : down + height, across : across + width], limit)
    return far
