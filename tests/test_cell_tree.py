"""Cells in cells around meshes (Estalella et al., 8)."""

import numpy as np
import pytest
from catoptric.addon.tracing import EDGES, MIDDLES, cell_tree
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

FEW = 4

points = arrays(np.float32, st.tuples(st.integers(1, 80), st.just(3)), elements=st.floats(-100, 100, width=32))


def slack_of(vertices):
    return 1e-6 * np.abs(vertices).max() + 1e-30


@given(points)
@settings(max_examples=80, deadline=None)
def test_each_cell_holds_its_vertices_and_its_parts_hold_them_all(vertices):
    tree = cell_tree(vertices, FEW)
    ordered, slack = vertices[tree.order].astype(float), slack_of(vertices)
    assert sorted(tree.order) == list(range(len(vertices)))
    assert (tree.first[0], tree.count[0]) == (0, len(vertices))
    for cell in range(len(tree.first)):
        inside = ordered[tree.first[cell] :][: tree.count[cell]]
        assert len(inside) > 0
        assert (inside >= tree.low[cell] - slack).all()
        assert (inside <= tree.high[cell] + slack).all()
        parts = slice(tree.child[cell], tree.child[cell] + tree.children[cell])
        if tree.children[cell]:
            assert tree.first[parts][0] == tree.first[cell]
            assert tree.count[parts].sum() == tree.count[cell]
            np.testing.assert_array_equal(tree.first[parts][1:], (tree.first + tree.count)[parts][:-1])
            assert (tree.low[parts] >= tree.low[cell] - slack).all()
            assert (tree.high[parts] <= tree.high[cell] + slack).all()


@given(points)
@settings(max_examples=80, deadline=None)
def test_corners_and_middles_are_where_the_box_has_them(vertices):
    tree, slack = cell_tree(vertices, FEW), slack_of(vertices)
    cut = tree.children > 0
    assert (tree.corners[~cut] == -1).all()
    at = tree.points[tree.corners[cut]]
    np.testing.assert_allclose(at[:, 0], tree.low[cut], atol=slack)
    np.testing.assert_allclose(at[:, 1] - at[:, 0], (tree.high - tree.low)[cut] * [1, 0, 0], atol=slack)
    np.testing.assert_allclose(at[:, 4] - at[:, 2], (tree.high - tree.low)[cut] * [0, -1, 1], atol=slack)
    middles = at[:, MIDDLES:]
    np.testing.assert_allclose(middles[:, :3], at[:, EDGES].mean(axis=2), atol=slack)
    np.testing.assert_allclose(middles[:, 3], (tree.low + tree.high)[cut] / 2.0, atol=slack)
    for axis, ends in enumerate(EDGES):
        apart = np.ptp(at[:, ends], axis=1) > 0.0
        np.testing.assert_array_equal(apart, ((tree.high - tree.low)[cut] > 0.0) & (np.arange(3) == axis))


def test_few_vertices_are_left_together_and_many_are_not():
    rng = np.random.default_rng(3)
    tree = cell_tree(rng.uniform(size=(5000, 3)), FEW)
    assert (tree.count[tree.children == 0] <= FEW).all()
    assert (tree.count[tree.children > 0] > FEW).all()


def test_vertices_in_one_place_are_never_parted():
    tree = cell_tree(np.ones((20, 3)), FEW)
    assert tree.count[tree.children == 0].tolist() == [20]


@pytest.mark.parametrize("shape", [(1.0, 1.0, 1.0), (8.0, 1.0, 0.5), (1.0, 30.0, 0.0)])
def test_cells_are_near_cubes(shape):
    rng = np.random.default_rng(4)
    tree = cell_tree(rng.uniform(size=(4000, 3)) * shape, FEW)
    sides = (tree.high - tree.low)[tree.children == 0]
    wide = np.array(shape) > 0.0
    assert (sides[:, ~wide] == 0.0).all()
    assert (sides[:, wide].max(axis=1) <= 2.0 * sides[:, wide].min(axis=1)).all()


def test_neighbours_share_their_corners():
    x, y = np.meshgrid(np.arange(16.0), np.arange(16.0))
    tree = cell_tree(np.c_[x.ravel(), y.ravel(), np.zeros(256)], 1)
    assert len(np.unique(tree.points, axis=0)) == len(tree.points)
    assert len(np.unique(tree.corners[tree.children > 0])) == len(tree.points) <= 4 * (tree.children > 0).sum()
