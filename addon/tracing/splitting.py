"""Triangles as pieces whose boxes hold less of nothing.

Ernst and Greiner 2007, Early split clipping for bounding volume hierarchies: the box of a long triangle that lies
askew is mostly empty, and every ray through it pays for it. The pieces stand for the triangle in the tree alone;
a ray that meets one's box is held against the whole triangle.
"""

import numpy as np

from .cutting import halved

_ROUNDS = 8
_FULL = 4.0
"""How large a box may be for what its triangle covers of it, as seen along the axes; a right triangle's is 2."""

_LEAST = 1e-3
"""Of the mesh's own box: what is wasted beyond that is worth a piece more."""


def split(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pieces (P, 3, 3) float64 of triangles (T, 3, 3) in the unit cube, and (P,) the triangle that each is of.

    There are at most a quarter more than triangles, or 4,096 more: those that waste most are cut first.
    """
    corners, source = corners.astype(np.float64), np.arange(len(corners))
    most = len(corners) + max(4096, len(corners) // 4)
    extent = np.ptp(corners.reshape(-1, 3), axis=0)
    for _ in range(_ROUNDS):
        waste = _surface(np.ptp(corners, axis=1)) - _FULL * _shadows(corners)
        chosen = np.flatnonzero(waste > _LEAST * _surface(extent))
        chosen = chosen[np.argsort(-waste[chosen], kind="stable")][: most - len(corners)]
        if not len(chosen):
            break
        rest = np.ones(len(corners), bool)
        rest[chosen] = False
        corners = np.concatenate([corners[rest], halved(corners[chosen], _longest(corners[chosen]))])
        source = np.concatenate([source[rest], np.tile(source[chosen], 2)])
    return corners, source


def _surface(extent: np.ndarray) -> np.ndarray:
    return (extent * np.roll(extent, 1, axis=-1)).sum(axis=-1)


def _shadows(corners: np.ndarray) -> np.ndarray:
    """What triangles cover as seen along x, y and z, together."""
    edges = corners[:, 1:] - corners[:, :1]
    return 0.5 * np.abs(np.cross(edges[:, 0], edges[:, 1])).sum(axis=-1)


def _longest(corners: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).argmax(axis=1)
