"""Whether a mesh is convex, so that a ray that leaves it need not be tested against it again."""

import numpy as np

_TOLERANCE = 1e-5
_SOME, _COARSE = 16, 1e-3


def is_convex(positions: np.ndarray, triangles: np.ndarray) -> bool:
    """True if (V, 3) `positions` and (T, 3) `triangles` bound a convex body, wound outwards.

    A closed, connected surface that is convex around every edge and vertex is convex as a whole
    (Tietze 1928, Nakajima 1928). Edges may be flat, or bent inwards by rounding.
    """
    if len(triangles) < 4 or _is_seen_not_to_be(positions, triangles):
        return False
    neighbour = _neighbours(triangles)
    if neighbour is None or not _connected(neighbour):
        return False
    corners = positions[triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    if (lengths == 0).any():
        return False
    normals /= lengths
    centres = corners.mean(axis=1)
    size = np.ptp(positions, axis=0).max()
    outwards = np.einsum("tnk,tk->tn", centres[neighbour] - centres[:, None], normals)
    return bool(outwards.max() <= _TOLERANCE * size) and _turns_once(corners, triangles)


def _is_seen_not_to_be(positions: np.ndarray, triangles: np.ndarray) -> bool:
    """Whether a vertex lies before one of a few triangles: what tells most meshes apart without their edges."""
    some = positions[triangles[:: max(1, len(triangles) // _SOME)]].astype(np.float64)
    normals = np.cross(some[:, 1] - some[:, 0], some[:, 2] - some[:, 0])
    is_used = np.zeros(len(positions), bool)
    is_used[triangles] = True
    used = positions[is_used].astype(np.float64)
    tolerance = _COARSE * np.ptp(positions, axis=0).max() * np.linalg.norm(normals, axis=1)
    reach = [(used @ normal).max() for normal in normals]
    return bool((reach - np.einsum("sk,sk->s", normals, some[:, 0]) > tolerance).any())


def _neighbours(triangles: np.ndarray) -> np.ndarray | None:
    """(T, 3) the triangle across each edge, or None where an edge is open, shared by three or wound both ways."""
    start, end = triangles, np.roll(triangles, -1, axis=1)
    size = int(triangles.max()) + 1
    forward = (start.astype(np.int64) * size + end).ravel()
    backward = (end.astype(np.int64) * size + start).ravel()
    order = np.argsort(forward)
    place = np.minimum(np.searchsorted(forward[order], backward), len(forward) - 1)
    if len(np.unique(forward)) < len(forward) or (forward[order][place] != backward).any():
        return None
    return (order[place] // 3).reshape(-1, 3)


def _connected(neighbour: np.ndarray) -> bool:
    """Whether every triangle reaches every other: labels shrink to the least one they touch."""
    label = np.arange(len(neighbour))
    while True:
        least = np.minimum(label, label[neighbour].min(axis=1))
        least = least[least]
        if (least == label).all():
            return bool((label == label[0]).all())
        label = least


def _turns_once(corners: np.ndarray, triangles: np.ndarray) -> bool:
    """Whether the angles around each vertex sum to at most a full turn: no cone that winds twice."""
    edges = np.roll(corners, -1, axis=1) - corners
    edges /= np.maximum(np.linalg.norm(edges, axis=2, keepdims=True), 1e-300)
    cosines = -(edges * np.roll(edges, 1, axis=1)).sum(axis=2)
    angles = np.bincount(triangles.ravel(), np.arccos(np.clip(cosines, -1, 1)).ravel())
    return bool(angles.max() <= 2 * np.pi * (1 + _TOLERANCE))
