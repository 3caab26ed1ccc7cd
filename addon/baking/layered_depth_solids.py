"""Which parts of a mesh close a volume, and which are open surfaces."""

import numpy as np

LARGEST_HOLE = 0.05
"""Share of a part's area that its holes may have for it still to count as closed (a scan's cracks)."""


def solid_triangles(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(T,) bool: whether each of `triangles` (T, 3) belongs to a connected part that closes a volume.

    Vertices of `positions` (V, 3) that coincide count as one. A part is closed where its edges cancel:
    each runs as often one way as the other. Small holes are forgiven.
    """
    points, welded = np.unique(positions, axis=0, return_inverse=True)
    corners = welded.reshape(-1)[triangles]
    part = _labels(len(points), corners[:, [0, 1]], corners[:, [1, 2]])[corners[:, 0]]
    area = np.bincount(part, _area(points[corners]), len(points))
    return (_hole_area(points.astype(np.float64), corners, part) <= LARGEST_HOLE * area)[part]


def _area(corners: np.ndarray) -> np.ndarray:
    edges = corners[:, 1:].astype(np.float64) - corners[:, :1]
    return 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)


def _hole_area(points: np.ndarray, corners: np.ndarray, part: np.ndarray) -> np.ndarray:
    """(V,) the area of the holes in each part; a hole is a connected set of edges that do not cancel."""
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    forward = edges[:, 0] < edges[:, 1]
    codes = edges.min(axis=1) * np.int64(len(points)) + edges.max(axis=1)
    unique, first, group = np.unique(codes, return_index=True, return_inverse=True)
    surplus = np.bincount(group.reshape(-1), np.where(forward, 1.0, -1.0) * (edges[:, 0] != edges[:, 1]), len(unique))
    loose = surplus != 0.0
    ends = np.stack([unique[loose] // len(points), unique[loose] % len(points)], axis=1)
    hole = _labels(len(points), ends)[ends[:, 0]] if len(ends) else np.zeros(0, np.int64)
    # Relative to a corner of its own hole, so that a mesh far from its origin keeps its digits.
    start, end = points[ends[:, 0]] - points[hole], points[ends[:, 1]] - points[hole]
    swept = 0.5 * surplus[loose, None] * np.cross(start, end)
    vectors = np.stack([np.bincount(hole, swept[:, axis], len(points)) for axis in range(3)], axis=1)
    owner = np.zeros(len(points), np.int64)
    owner[hole] = np.repeat(part, 3)[first[loose]]
    return np.bincount(owner, np.linalg.norm(vectors, axis=1), len(points))


def _labels(count: int, *edges: np.ndarray) -> np.ndarray:
    """(count,) the least vertex of each vertex's connected part; `edges` (E, 2) each."""
    joined = np.concatenate(edges)
    label = np.arange(count)
    while True:
        first, second = label[joined[:, 0]], label[joined[:, 1]]
        apart = first != second
        if not apart.any():
            return label
        np.minimum.at(label, np.maximum(first, second)[apart], np.minimum(first, second)[apart])
        while (label[label] != label).any():
            label = label[label]
