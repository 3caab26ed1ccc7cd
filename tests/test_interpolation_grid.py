"""Grids around meshes (Estalella et al., 5)."""

import numpy as np
import pytest
from catoptric.addon.tracing import interpolation_grid
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

SHARES = (0.041, 0.055, 0.096, 0.143, 0.5)

points = arrays(np.float32, st.tuples(st.integers(1, 60), st.just(3)), elements=st.floats(-100, 100, width=32))


@given(points, st.sampled_from(SHARES))
@settings(max_examples=60, deadline=None)
def test_vertices_lie_in_their_cells_and_are_given_back(vertices, share):
    grid = interpolation_grid(vertices, share)
    corners = grid.corners[grid.cells[grid.cell]].astype(float)
    slack = 1e-5 * np.abs(vertices).max() + 1e-30
    assert (corners.min(axis=1) - slack <= vertices).all()
    assert (vertices <= corners.max(axis=1) + slack).all()
    assert ((grid.weights >= 0) & (grid.weights <= 1)).all()
    np.testing.assert_allclose(grid.weights.sum(axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose((grid.weights[..., None] * corners).sum(axis=1), vertices, atol=slack)


@given(points, st.sampled_from(SHARES))
@settings(max_examples=60, deadline=None)
def test_only_cells_that_hold_vertices_are_kept(vertices, share):
    grid = interpolation_grid(vertices, share)
    assert np.array_equal(np.unique(grid.cell), np.arange(len(grid.cells)))
    assert np.array_equal(np.unique(grid.cells), np.arange(len(grid.corners)))
    assert len(grid.corners) <= max(8, share * len(vertices))


def ball(count: int = 8000) -> np.ndarray:
    """Points of a stretched sphere."""
    directions = np.random.default_rng(3).normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True) * (3.0, 1.0, 0.5)


@pytest.mark.parametrize("share", SHARES[:4])
def test_the_share_is_met_within_a_layer_of_cells(share):
    vertices = ball()
    grid = interpolation_grid(vertices, share)
    assert 0.75 * share <= len(grid.corners) / len(vertices) <= share


def test_cells_are_near_cubes():
    grid = interpolation_grid(ball(), 0.143)
    sizes = np.ptp(grid.corners[grid.cells], axis=1)
    assert sizes.max() / sizes.min() < 1.5


def test_a_plane_has_flat_cells():
    vertices = ball() * (1.0, 1.0, 0.0) + (0.0, 0.0, 7.0)
    grid = interpolation_grid(vertices, 0.1)
    assert (grid.corners[:, 2] == 7.0).all()
    assert all(len(np.unique(cell)) == 4 for cell in grid.cells)
    assert 0.07 * len(vertices) <= len(grid.corners) <= 0.1 * len(vertices)


@pytest.mark.parametrize("count", [1, 100])
def test_points_that_coincide_have_one_cell(count):
    grid = interpolation_grid(np.ones((count, 3)), 1.0)
    assert len(grid.corners) == 1
    assert np.array_equal(grid.corners[grid.cells[grid.cell]], np.ones((count, 8, 3)))
