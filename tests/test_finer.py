"""Meshes made finer than they are drawn: onto what surface, and where rays meet it."""

import numpy as np
import pytest
from catoptric.addon.baking.finer import finer, met_by
from hypothesis import given, settings
from hypothesis import strategies as st

from .search_stage import sphere, unit

# ------------------------------------------------------------------ finer


def test_finer_brings_a_ball_nearer_to_its_sphere():
    mesh = sphere(2)
    errors = []
    for levels in range(4):
        corners, normals = finer(mesh.corners.astype(float), mesh.normals.astype(float), levels)
        assert len(corners) == len(mesh.triangles) * 4**levels
        assert np.allclose(np.linalg.norm(normals, axis=2), 1, atol=1e-6)
        errors.append(np.abs(np.linalg.norm(corners.mean(axis=1), axis=1) - 1).max())
    # A piece's middle lies below the sphere by the square of its size, till what is left is the cubic's own error.
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.4 * errors[1]
    assert errors[3] < 1e-3


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000), levels=st.integers(0, 3))
def test_finer_leaves_what_is_flat_flat(seed, levels):
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    flat = np.concatenate([rng.normal(size=(5, 3, 2)), np.zeros((5, 3, 1))], axis=2) @ turn.T
    normals = np.broadcast_to(turn[:, 2], flat.shape)
    corners, turned = finer(flat, normals, levels)
    assert np.abs(corners @ turn[:, 2]).max() < 1e-12
    assert np.allclose(turned, turn[:, 2])
    area = np.linalg.norm(np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]), axis=1).sum()
    pieces = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    assert pieces == pytest.approx(area)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000), levels=st.integers(1, 3))
def test_finer_keeps_neighbours_together(seed, levels):
    rng = np.random.default_rng(seed)
    points, normals = rng.normal(size=(4, 3)), unit(rng.normal(size=(4, 3)) + (0, 0, 3))
    corners, turned = finer(points[[[0, 1, 2], [2, 1, 3]]], normals[[[0, 1, 2], [2, 1, 3]]], levels)
    one, other = corners.reshape(2, -1, 3)
    apart = np.linalg.norm(one[:, None] - other[None], axis=2)
    # The points along the edge that they share stand in both.
    assert len(np.unique(np.round(one[(apart < 1e-9).any(axis=1)], 9), axis=0)) == 2**levels + 1
    shared = np.argwhere(apart < 1e-9)
    ours, theirs = turned.reshape(2, -1, 3)
    assert np.allclose(ours[shared[:, 0]], theirs[shared[:, 1]])


# ------------------------------------------------------------------ met_by


def through(corners, rng):
    """Rays from 0 through random points of triangles, of any length."""
    shares = rng.dirichlet((1, 1, 1), size=len(corners))
    return np.einsum("nk,nkc->nc", shares, corners) * rng.uniform(0.01, 100, size=(len(corners), 1))


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000), size=st.floats(1e-3, 0.2), side=st.sampled_from([1, -1]))
def test_rays_meet_the_sphere_that_triangles_stand_for(seed, size, side):
    rng = np.random.default_rng(seed)
    middles, corner = unit(rng.normal(size=(50, 3))), unit(rng.normal(size=(50, 3)))
    across = unit(np.cross(middles, corner))
    turns = np.radians([0, 120, 240])[:, None] + rng.uniform(-0.5, 0.5, size=(50, 3, 1))
    aside = np.cos(turns) * across[:, None] + np.sin(turns) * np.cross(middles, across)[:, None]
    corners = unit(middles[:, None] + size * aside)
    ways = through(corners, rng)
    points, normals = met_by(ways, corners, side * corners)
    assert np.allclose(unit(points), unit(ways), atol=1e-12)
    # What is off is of the fourth order, where the facet's own error is of the second.
    assert np.abs(np.linalg.norm(points, axis=1) - 1).max() < size**4 + 1e-12
    assert np.linalg.norm(normals - side * unit(ways), axis=1).max() < 1e-9


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_rays_meet_flat_triangles_where_they_are(seed):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(50, 3, 3)) + (0, 0, 5)
    facing = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    ways = through(corners, rng)
    points, normals = met_by(ways, corners, np.repeat(facing[:, None], 3, axis=1))
    expected = ways * ((corners[:, 0] * facing).sum(axis=1) / (ways * facing).sum(axis=1))[:, None]
    assert np.allclose(points, expected, rtol=1e-6)
    assert np.allclose(normals, facing)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_neighbours_meet_a_ray_through_their_edge_at_the_same_point(seed):
    rng = np.random.default_rng(seed)
    points, normals = rng.normal(size=(4, 3)) + (0, 0, 8), unit(rng.normal(size=(4, 3)) + (0, 0, 3))
    pair = np.array([[0, 1, 2], [2, 1, 3]])
    way = rng.uniform(0.1, 1, size=2) @ points[1:3]
    (one, other), (turned, also) = met_by(np.array([way, way]), points[pair], normals[pair])
    assert np.allclose(one, other)
    assert np.allclose(turned, also)


@pytest.mark.parametrize("width", [1e-6, 0.0])
def test_a_ray_beside_a_sliver_stays_beside_it(width):
    sliver = np.array([[[0, 0, 1], [1, 0, 1], [0.5, width, 1.0]]])
    normals = unit(np.array([[[-0.3, 0, 1], [0.3, 0, 1], [0, 0.3, 1.0]]]))
    (point,), (normal,) = met_by(np.array([[0.5, 1e-3, 1.0]]), sliver, normals)
    assert np.linalg.norm(point - (0.5, 0, 1)) < 0.3
    assert normal[2] > 0.5
