"""The hierarchy of boxes: every box is reached, and the nearer ones first."""

import numpy as np
from catoptric.addon.tracing import build_hierarchy
from hypothesis import given
from hypothesis import strategies as st


def boxes_of(seed, count):
    random = np.random.default_rng(seed)
    low = random.uniform(-5, 5, (count, 3))
    return np.stack([low, low + random.uniform(0.01, 1, (count, 3))], axis=1)


def walk(nodes, origin, direction):
    """Boxes in the order that a ray visits them, as gpu_shaders/common/layers.glsl does."""
    visited, node = [], 0
    while node < len(nodes):
        low, high = nodes[node].astype(float)
        a, b = (low[:3] - origin) / direction, (high[:3] - origin) / direction
        if np.minimum(a, b).max() > np.maximum(a, b).min() or np.maximum(a, b).min() < 0:
            node = int(low[3])
        else:
            if high[3] >= 0:
                visited.append(int(high[3]))
            node += 1
    return visited


@given(st.integers(0, 10_000), st.integers(1, 40))
def test_a_ray_visits_the_boxes_it_meets(seed, count):
    boxes = boxes_of(seed, count)
    random = np.random.default_rng(seed + 1)
    origin, direction = random.uniform(-6, 6, 3), random.normal(size=3)
    octant = int((direction < 0) @ [1, 2, 4])
    a, b = (boxes[:, 0] - origin) / direction, (boxes[:, 1] - origin) / direction
    enter, leave = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
    met = np.flatnonzero((enter <= leave - 1e-4) & (leave > 1e-4))
    assert set(met) <= set(walk(build_hierarchy(boxes)[octant], origin, direction))


@given(st.integers(0, 10_000))
def test_boxes_in_a_row_are_visited_front_to_back(seed):
    order = np.random.default_rng(seed).permutation(9)
    low = np.zeros((9, 3))
    low[:, 0] = 2.0 * order
    nodes = build_hierarchy(np.stack([low, low + 1], axis=1))
    forward = walk(nodes[0], np.array([-1, 0.5, 0.5]), np.array([1, 1e-9, 1e-9]))
    backward = walk(nodes[1], np.array([30, 0.5, 0.5]), np.array([-1, 1e-9, 1e-9]))
    assert [order[box] for box in forward] == list(range(9))
    assert [order[box] for box in backward] == list(range(8, -1, -1))


def test_no_boxes_give_no_nodes():
    assert build_hierarchy(np.zeros((0, 2, 3))).shape == (8, 0, 2, 4)
