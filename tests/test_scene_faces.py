"""No two things of a demonstration scene lie in one plane where it is seen: whichever came first would show."""

from dataclasses import replace

import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.scene import Scene
from catoptric.scenes import SCENES, path_of

from .stage import Judge, camera_rays

SIZE = (384, 256)
BY_CHANCE = 2  # pixels whose centres lie on a line where two things cross
TOGETHER = 1e-6  # of the distance from the camera: what single precision leaves of one plane


def distances(scene: Scene, numbers: np.ndarray) -> np.ndarray:
    """How far the first of some instances is from the camera in each pixel; infinite where there is none."""
    origins, directions = camera_rays(scene.camera, *SIZE)
    met = Judge(replace(scene, instances=tuple(scene.instances[number] for number in numbers))).meet(
        origins, directions
    )
    return np.where(met.instance < 0, np.inf, met.distance)


def in_one_plane(scene: Scene) -> int:
    """Pixels in which two instances are first. Any two differ in a bit of their numbers."""
    numbers = np.arange(len(scene.instances))
    found = np.zeros(SIZE[0] * SIZE[1], bool)
    for bit in range((len(numbers) - 1).bit_length()):
        one, other = (distances(scene, numbers[(numbers >> bit & 1) == side]) for side in (0, 1))
        nearer, farther = np.minimum(one, other), np.maximum(one, other)
        found |= np.isfinite(farther) & (farther <= (1.0 + TOGETHER) * nearer)
    return int(found.sum())


@pytest.mark.parametrize("name", SCENES)
def test_no_two_faces_lie_in_one_plane(name):
    assert in_one_plane(extract(open_blend(path_of(name)))) <= BY_CHANCE
