"""Columns of triangles: nothing on a surface is left out, and the pyramid hides nothing."""

import numpy as np
import trimesh
from catoptric.addon.tracing import build_layers
from catoptric.addon.tracing.layers import LARGEST, SLICES
from hypothesis import given, settings
from hypothesis import strategies as st


def columns_of(layers):
    """Words and first span of the finest level, (rows, columns, 3)."""
    u, v = layers.shape
    return layers.nodes[: u * v].reshape(v, u, 3)


def listed(layers, u, v, depth):
    """Triangles that a slice of a column lists."""
    low, high, span = (int(number) for number in columns_of(layers)[v, u])
    words = low | high << 32
    if not words >> depth & 1:
        return np.zeros(0, np.uint32)
    first, count = layers.spans[span + (words & (1 << depth) - 1).bit_count()]
    return layers.entries[first : first + count]


def cells_of(layers, points):
    """Column and slice that hold points (N, 3)."""
    order = [(layers.axis + 1) % 3, (layers.axis + 2) % 3, layers.axis]
    unit = ((points - layers.low) / layers.size)[:, order]
    return np.floor(unit * [*layers.shape, SLICES]).astype(int)


@given(st.integers(0, 10_000), st.integers(1, 60), st.sampled_from([1.0, 1e-3, 1e4]), st.booleans())
@settings(max_examples=60, deadline=None)
def test_every_point_of_a_triangle_is_listed(seed, count, scale, flat):
    random = np.random.default_rng(seed)
    corners = random.normal(size=(count, 3, 3)) * scale * [1, 1, 0 if flat else 0.3]
    corners = corners.astype(np.float32)
    layers = build_layers(corners)
    weights = random.dirichlet([1, 1, 1], size=(count, 40))
    points = np.einsum("tsc,tck->tsk", weights, corners.astype(float))
    for triangle, inside in enumerate(points):
        for u, v, depth in cells_of(layers, inside).tolist():
            assert triangle in listed(layers, u, v, depth)


def test_entries_lie_near_their_column():
    """What is listed passes within a column's width and a slice's depth: lists stay short."""
    shape = trimesh.creation.icosphere(4)
    layers = build_layers(shape.triangles.astype(np.float32))
    assert layers.spans[:, 1].mean() < 3
    assert layers.spans[:, 1].max() < 20


def test_a_block_is_marked_where_any_column_below_it_is():
    layers = build_layers(trimesh.creation.torus(1.0, 0.2).triangles.astype(np.float32))
    words, (u, v), first = columns_of(layers)[..., :2], layers.shape, layers.shape[0] * layers.shape[1]
    for _ in range(1, layers.levels):
        padded = np.zeros((v + v % 2, u + u % 2, 2), np.uint32)
        padded[:v, :u] = words
        u, v = (u + 1) // 2, (v + 1) // 2
        words = layers.nodes[first : first + u * v, :2].reshape(v, u, 2)
        assert (words == np.bitwise_or.reduce(padded.reshape(v, 2, u, 2, 2), axis=(1, 3))).all()
        first += u * v
    assert (u, v) == (1, 1)
    assert first == len(layers.nodes)


def test_the_depth_is_the_shortest_side_and_columns_are_capped():
    slab = trimesh.creation.box((4.0, 0.1, 2.0)).subdivide_loop(7)
    layers = build_layers(slab.triangles.astype(np.float32))
    assert layers.axis == 1
    assert max(layers.shape) == LARGEST
