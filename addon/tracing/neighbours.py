"""Which triangle lies across an edge."""

import numpy as np

from .surface import welded

BORDER, BRANCH = -1, -2
"""What lies across an edge of one triangle alone, and across one of three or more, or of no length."""


def across_edges(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(T, 3) int32: the triangle across the edge from each corner to the next, or BORDER or BRANCH.

    `positions` (V, 3), `triangles` (T, 3) into them; vertices in the same place count as one.
    """
    corners = welded(positions)[triangles]
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    key = np.minimum(start, end) * (len(positions) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    _, first, counts = np.unique(key[order], return_index=True, return_counts=True)
    across = np.full(corners.size, BRANCH, np.int32)
    across[order[first[counts == 1]]] = BORDER
    one, other = order[first[counts == 2]], order[first[counts == 2] + 1]
    across[one], across[other] = other // 3, one // 3
    across[start == end] = BRANCH
    return across.reshape(-1, 3)
