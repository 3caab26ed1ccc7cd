"""`layered-depth` against Embree, ray by ray."""

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.scene import Lighting

from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed, scene_of

SIZE = (160, 120)


def frame_of(scene):
    """The scene's picture, one sample a pixel."""
    method = LayeredDepth()
    method.prepare(scene, Lighting.UNLIT)
    try:
        return method.render(View(scene.camera, *SIZE, samples=1))
    finally:
        method.release()


def wrong_share(scene):
    """Share of reflector pixels that show another object than Embree finds, and distance errors where they agree."""
    judge = Judge(scene)
    origins, directions = camera_rays(scene.camera, *SIZE)
    first = judge.meet(origins, directions)
    mirrors = np.array([instance.reflector for instance in scene.instances])
    chosen = (first.instance >= 0) & mirrors[first.instance]
    start, reflected = mirrored(first, directions)
    # A ray that an interpolated normal sends under the surface is another test's business.
    above = (reflected * first.flat).sum(-1) > 0.01
    chosen &= above
    second = judge.meet(start[chosen], reflected[chosen])
    frame = frame_of(scene)
    seen = frame.color.reshape(-1, 3)[chosen, 0].round().astype(int) - 1
    expected = np.where((second.instance >= 0) & ~mirrors[second.instance], second.instance, -1)
    distance = frame.distance.reshape(-1)[chosen]
    both = np.isfinite(distance) & np.isfinite(second.distance)
    return (seen != expected).mean(), np.abs(distance[both] - second.distance[both]), chosen.sum()


def ball():
    """A chrome ball that is round to within a texel."""
    return mesh_of(trimesh.creation.icosphere(subdivisions=4, radius=1.0), smooth=True)


def stages():
    """Scenes by name."""
    floor = mesh_of(
        trimesh.Trimesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    )
    box, sphere = mesh_of(trimesh.creation.box()), ball()
    torus = mesh_of(trimesh.creation.torus(1.0, 0.05, major_sections=96, minor_sections=8), smooth=True)
    room = trimesh.creation.box((8, 8, 5))
    room.invert()
    return {
        "open floor and boxes": [
            (sphere, placed((0, 0, 1)), True),
            (floor, placed(), False),
            (box, placed((1.8, 0.4, 0.5), turn=0.4), False),
            (box, placed((-1.9, -0.6, 0.3), (0.5, 1.2, 0.6), 1.1, (1, 1, 0)), False),
        ],
        "thin ring, mirrored instance": [
            (sphere, placed(), True),
            (torus, placed((0, -1.8, 0.2), turn=1.2, axis=(1, 0.3, 0)), False),
            (torus, placed((1.9, 0.2, 0), (-1.0, 0.7, 1.3), 0.8, (0, 1, 0.2)), False),
        ],
        "room around": [
            (sphere, placed(), True),
            (mesh_of(room), placed(), False),
            (box, placed((1.7, 0, 0), (0.02, 1.5, 1.5)), False),
        ],
        "dense mesh": [
            (sphere, placed(), True),
            (
                mesh_of(trimesh.creation.icosphere(subdivisions=6, radius=0.7), smooth=True),
                placed((1.9, -0.5, 0.1)),
                False,
            ),
        ],
        "reflector in itself": [
            (
                mesh_of(trimesh.creation.torus(1.2, 0.45, major_sections=64, minor_sections=32), smooth=True),
                placed(turn=0.9, axis=(1, 0, 0)),
                True,
            ),
            (floor, placed((0, 0, -2)), False),
        ],
    }


@pytest.mark.parametrize("name", stages())
def test_hits_what_embree_hits(name):
    scene = scene_of(stages()[name], looking((1.0, -3.6, 1.9), (0.0, 0.0, 0.3), lens=45), bounces=0)
    wrong, errors, rays = wrong_share(scene)
    assert rays > 2000
    assert wrong <= 0.0005
    assert np.median(errors) < 1e-4
