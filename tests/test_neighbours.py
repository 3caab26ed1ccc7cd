"""Which triangle lies across an edge."""

import numpy as np
import trimesh
from catoptric.addon.tracing import across_edges
from catoptric.addon.tracing.neighbours import BORDER, BRANCH
from hypothesis import given
from hypothesis import strategies as st

STRIP = np.array([[0, 1, 2], [2, 1, 3], [2, 3, 4]])
PLACES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 2, 0]], np.float32)


def test_a_strip_has_borders():
    assert across_edges(PLACES, STRIP).tolist() == [[BORDER, 1, BORDER], [0, BORDER, 2], [1, BORDER, BORDER]]


def test_vertices_in_one_place_are_one():
    """Every triangle with vertices of its own, as where a mesh is split at a crease."""
    apart = PLACES[STRIP].reshape(-1, 3)
    assert np.array_equal(across_edges(apart, np.arange(9).reshape(3, 3)), across_edges(PLACES, STRIP))


def test_an_edge_of_three_triangles_branches():
    fin = np.array([[0, 0, 1]], np.float32)
    across = across_edges(np.concatenate([PLACES, fin]), np.concatenate([STRIP, [[1, 2, 5]]]))
    assert across[0, 1] == across[1, 0] == across[3, 0] == BRANCH


def test_an_edge_of_no_length_branches():
    assert across_edges(PLACES, np.array([[0, 0, 1]]))[0, 0] == BRANCH


@given(st.integers(4, 40), st.integers(0, 2**32 - 1))
def test_neighbours_are_mutual_and_share_the_edge(count, seed):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    hull = trimesh.convex.convex_hull(points)
    triangles = np.asarray(hull.faces)
    across = across_edges(np.asarray(hull.vertices, np.float32), triangles)
    assert (across >= 0).all()  # a closed surface
    for triangle, edge in np.ndindex(across.shape):
        other = across[triangle, edge]
        ends = {triangles[triangle, edge], triangles[triangle, (edge + 1) % 3]}
        assert ends <= set(triangles[other])
        assert triangle in across[other]
