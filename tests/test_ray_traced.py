"""Both tracers against Embree triangle by triangle, and against each other under every light."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.ray_traced import RayTraced
from catoptric.addon.methods.tracers import TRACER
from catoptric.addon.scene import Lamp, LampKind, Lighting
from catoptric.scenes import path_of

from .ray_stage import agreement
from .stage import looking, mesh_of, placed, scene_of


@pytest.mark.parametrize("name", ["kitchen", "bathroom", "mirror-torus"])
def test_meets_the_triangles_that_embree_meets(name):
    scene = extract(open_blend(path_of(name)))
    for tracer in TRACER.choices:
        found = agreement(scene, tracer, 384, 256)
        assert found.rays > 20_000
        assert found.same >= 0.9999, tracer


def frame_of(method, scene, lighting):
    """A picture of a few pixels."""
    drawn = method()
    drawn.prepare(scene, lighting)
    try:
        return drawn.render(View(scene.camera, 96, 64, samples=1))
    finally:
        drawn.release()


def stage(bounces):
    """A torus and a ball that mirror each other, a box beside them, a floor, and a lamp that casts their shadows."""
    floor = trimesh.Trimesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    parts = [
        (mesh_of(trimesh.creation.torus(1.2, 0.4), smooth=True), placed((0, 0, 0.4)), True),
        (mesh_of(trimesh.creation.icosphere(3, radius=0.6), smooth=True), placed((0, 0, 0.8)), True),
        (mesh_of(trimesh.creation.box()), placed((2.2, 0.4, 0.5), turn=0.4), False),
        (mesh_of(floor), placed(), False),
    ]
    lamp = Lamp("lamp", LampKind.POINT, placed((1, -2, 5)), (500.0, 500.0, 500.0))
    return replace(scene_of(parts, looking((1, -5, 3), (0, 0, 0.5)), bounces, (0.2, 0.3, 0.4)), lamps=(lamp,))


@pytest.mark.parametrize("bounces", [0, 1, 4])
@pytest.mark.parametrize("lighting", [Lighting.UNLIT, Lighting.DIRECT])
def test_shows_what_layered_depth_shows(lighting, bounces):
    scene = stage(bounces)
    ours, theirs = (frame_of(method, scene, lighting) for method in (RayTraced, LayeredDepth))
    seen = ours.reflectors > 0.5
    assert seen.mean() > 0.1
    differs = (np.abs(ours.color - theirs.color).max(axis=-1) > 1e-4)[seen]
    assert differs.mean() < 0.003  # rays that pass edges
    ends = np.isfinite(ours.distance) & np.isfinite(theirs.distance)
    assert ends.sum() > 100
    assert np.median(np.abs(ours.distance[ends] - theirs.distance[ends])) < 1e-5


def test_a_path_ends_after_as_many_bounces_as_the_scene_allows():
    pictures = [frame_of(RayTraced, stage(bounces), Lighting.UNLIT).color for bounces in (0, 1, 4)]
    assert (pictures[1] - pictures[0]).max() > 0.1
    assert (pictures[2] - pictures[1]).max() > 0.1
    assert (pictures[1] >= pictures[0] - 1e-5).all()
