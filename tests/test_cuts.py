"""What virtual objects are cut into is kept where nothing has changed, and is what a fresh start would make."""

from dataclasses import fields, replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.virtual.cuts import Cuts
from catoptric.addon.tracing import Near

from .stage import looking, mesh_of, placed, scene_of

SHARE = 0.5


@pytest.fixture
def scene():
    """A mirror between two boxes of one mesh, and a third that reflections do not see."""
    box, ball = mesh_of(trimesh.creation.box()), mesh_of(trimesh.creation.icosphere(subdivisions=3))
    parts = [(ball, placed(), True), (box, placed((2.0, 0.0, 0.0)), False), (box, placed((-2.0, 0.0, 0.0)), False)]
    made = scene_of([*parts, (box, placed((0.0, 0.0, 5.0)), False)], looking((0.0, -6.0, 1.0)))
    return replace(made, instances=(*made.instances[:3], replace(made.instances[3], in_reflections=False)))


def near(radius=1.0):
    return [Near(np.array([[[-radius] * 3, [radius] * 3]]), np.array([0.1]))]


def moved(scene, index, by):
    """The scene as Blender gives it once more: every instance is another object."""
    instances = [replace(one, matrix=one.matrix.copy()) for one in scene.instances]
    instances[index].matrix[0, 3] += by
    return replace(scene, instances=tuple(instances))


def same(one, other):
    return all(np.array_equal(getattr(one, field.name), getattr(other, field.name)) for field in fields(one))


def test_what_stands_as_it_stood_is_kept_and_the_rest_is_as_after_a_fresh_start(scene):
    cuts = Cuts()
    before = cuts.of(scene, near(), SHARE)
    later = moved(scene, 1, 0.3)
    after = cuts.of(later, near(), SHARE)
    assert list(before) == list(after) == [0, 1, 2]
    assert [before[index] is after[index] for index in after] == [True, False, True]
    fresh = Cuts().of(later, near(), SHARE)
    assert all(same(after[index], fresh[index]) for index in fresh)


@pytest.mark.parametrize("change", [{"near": near(0.5)}, {"share": 0.25}])
def test_other_reflectors_or_shares_cut_everything_anew(scene, change):
    cuts, asked = Cuts(), {"near": near(), "share": SHARE}
    before = cuts.of(scene, **asked)
    after, fresh = cuts.of(scene, **(asked | change)), Cuts().of(scene, **(asked | change))
    assert not any(before[index] is after[index] for index in after)
    assert all(same(after[index], fresh[index]) for index in fresh)


def test_pieces_are_whole_and_short_and_lie_in_their_balls(scene):
    for index, pieces in Cuts().of(scene, near(), SHARE).items():
        corners = pieces.points[pieces.corners].astype(float)
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0
        mesh = scene.meshes[scene.instances[index].mesh]
        whole = trimesh.Trimesh(mesh.positions, mesh.triangles, process=False).area
        assert areas.sum() == pytest.approx(whole, rel=1e-5)
        chunk = np.searchsorted(pieces.first_triangles, np.arange(len(corners)), side="right") - 1
        held = np.searchsorted(pieces.first_points, pieces.corners.ravel(), side="right") - 1
        assert (held.reshape(-1, 3) == chunk[:, None]).all()
        away = np.linalg.norm(corners - pieces.centres[chunk, None], axis=2)
        assert (away <= pieces.radii[chunk, None] + 1e-6).all()


def test_a_scene_of_nothing_has_no_pieces(scene):
    assert Cuts().of(replace(scene, instances=()), near(), SHARE) == {}
