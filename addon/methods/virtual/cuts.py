"""The triangles of a scene as its reflections need them: small for their distance from the reflectors."""

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from ...scene import Mesh, Scene
from ...tracing import Near, cut_near

_CHUNK = 64
"""Triangles that are searched, or left out, together."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """The triangles of an instance, cut, in chunks of what lies together.

    `points` (P, 3) float32 in the world, each once in a chunk; `corners` (T, 3) int32 into them; `sources` (T,) which
    of the mesh's triangles each is of. Chunk n has the points `first_points[n]` to `first_points[n + 1]`, the triangles
    likewise, and lies in the ball of `centres` (C, 3) and `radii` (C,).
    """

    points: np.ndarray
    corners: np.ndarray
    sources: np.ndarray
    first_points: np.ndarray
    first_triangles: np.ndarray
    centres: np.ndarray
    radii: np.ndarray


class Cuts:
    """The pieces of a scene's instances; kept for the next scene, where most stand as they stood."""

    def __init__(self) -> None:
        """Know nothing yet."""
        self._around: Hashable = None
        self._known: dict[Hashable, Pieces] = {}

    def of(self, scene: Scene, near: list[Near], share: float) -> dict[int, Pieces]:
        """The pieces of each instance that reflections see; no edge is longer than `cut_near` has it."""
        around = tuple((thing.boxes.tobytes(), thing.least.tobytes()) for thing in near), share
        before, self._known = (self._known if around == self._around else {}), {}
        self._around = around
        pieces = {}
        for index, instance in enumerate(scene.instances):
            if instance.in_reflections:
                mesh = scene.meshes[instance.mesh]
                key = mesh, instance.matrix.tobytes()
                pieces[index] = before.get(key) or self._known.get(key) or _cut(mesh, instance.matrix, near, share)
                self._known[key] = pieces[index]
        return pieces


def _cut(mesh: Mesh, matrix: np.ndarray, near: list[Near], share: float) -> Pieces:
    corners = mesh.corners.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    good = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
    cut, piece_of = cut_near(corners[good], near, share)
    order = _by_place(cut)
    cut, first = cut[order], np.arange(0, len(order), _CHUNK)
    points, indices, first_points = _shared_points(cut.astype(np.float32), np.arange(len(cut)) // _CHUNK)
    balls = _balls(cut, first)
    return Pieces(points, indices, good[piece_of[order]], first_points, np.append(first, len(cut)), *balls)


def _by_place(corners: np.ndarray) -> np.ndarray:
    """(T,) an order of triangles in which neighbours stand together: along Morton's curve."""
    if not len(corners):
        return np.zeros(0, np.int64)
    middles = corners.mean(axis=1)
    low, size = middles.min(axis=0), max(float(np.ptp(middles, axis=0).max()), 1e-30)
    cells = ((middles - low) / size * 1023).astype(np.int64)
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | cells << shift) & mask
    return np.argsort(cells[:, 0] | cells[:, 1] << 1 | cells[:, 2] << 2, kind="stable")


def _shared_points(corners: np.ndarray, chunk: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The points (P, 3) of triangles (T, 3, 3), each once in a chunk; (T, 3) int32 into them; where chunks begin."""
    rows = np.empty(3 * len(corners), [("chunk", np.int32), ("x", np.float32), ("y", np.float32), ("z", np.float32)])
    rows["chunk"] = np.repeat(chunk, 3)
    rows["x"], rows["y"], rows["z"] = (corners.reshape(-1, 3) + np.float32(0.0)).T  # no -0 beside 0
    keys = np.frombuffer(rows.tobytes(), np.dtype((np.void, rows.dtype.itemsize)))
    _, first, indices = np.unique(keys, return_index=True, return_inverse=True)
    order = np.lexsort([first, rows["chunk"][first]])
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order))
    chosen = first[order]
    counts = np.bincount(rows["chunk"][chosen], minlength=int(chunk[-1]) + 1 if len(chunk) else 0)
    points = corners.reshape(-1, 3)[chosen]
    return points, rank[indices].reshape(-1, 3), np.concatenate([[0], np.cumsum(counts)])


def _balls(corners: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Balls that hold the triangles of each chunk: middles of their boxes, half of their diagonals."""
    if not len(first):
        return np.zeros((0, 3)), np.zeros(0)
    low = np.minimum.reduceat(corners.min(axis=1), first, axis=0)
    high = np.maximum.reduceat(corners.max(axis=1), first, axis=0)
    return (low + high) / 2.0, np.linalg.norm(high - low, axis=1) / 2.0
