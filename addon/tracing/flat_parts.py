"""The flat parts of a mesh: triangles that lie in one plane, whatever their outline."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class FlatParts:
    """Which triangles lie in which plane.

    `part` (T,) int32, -1 for a triangle in none; `planes` (P, 4) float64, unit normal and offset, so that
    points with normal · point + offset = 0 lie in it; `share` 0..1, of the area that was asked about.
    """

    part: np.ndarray
    planes: np.ndarray
    share: float


def flat_parts(
    corners: np.ndarray, normals: np.ndarray, among: np.ndarray, degrees: float, metres: float, most: int
) -> FlatParts:
    """The `most` largest flat parts, found greedily from the largest triangle on.

    `corners` (T, 3, 3) metres; `normals` (T, 3, 3) shading normals, which must agree with the plane as well,
    since they say where light goes; `among` (T,) bool, the triangles that count. A triangle belongs to a plane
    if it and its normals turn away from it by at most `degrees`, and its corners lie within `metres`.
    Triangles face either way; parts need not hang together: one plane makes one mirror image.
    """
    corners = np.asarray(corners, np.float64)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.where(among, 0.5 * np.linalg.norm(across, axis=1), 0.0)
    areas[~np.isfinite(areas) | ~np.isfinite(normals).all(axis=(1, 2))] = 0.0
    shading = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-30)
    part = np.full(len(corners), -1, np.int32)
    planes = []
    left = areas.copy()
    for number in range(most):
        seed = int(left.argmax()) if len(left) else 0
        if not len(left) or left[seed] <= 0.0:
            break
        within = _within(_plane(across[seed], corners[seed]), corners, across, areas, shading, degrees, metres)
        within = (within & (left > 0.0)) | (np.arange(len(left)) == seed)
        turned = np.sign(across[within] @ across[seed])[:, None] * across[within]
        planes.append(_plane(turned.sum(axis=0), np.average(corners[within], axis=0, weights=areas[within])))
        part[within] = number
        left[within] = 0.0
    total = areas.sum()
    share = float(areas[part >= 0].sum() / total) if total > 0.0 else 0.0
    return FlatParts(part, np.array(planes, np.float64).reshape(-1, 4), share)


def _plane(normal: np.ndarray, points: np.ndarray) -> np.ndarray:
    normal = normal / np.linalg.norm(normal)
    return np.array([*normal, -float(normal @ points.mean(axis=0))])


def _within(plane, corners, across, areas, shading, degrees: float, metres: float) -> np.ndarray:
    """(T,) bool: which triangles lie in the plane."""
    least = np.cos(np.radians(degrees))
    near = np.abs(corners @ plane[:3] + plane[3]).max(axis=1) <= metres
    level = np.abs(across @ plane[:3]) >= 2.0 * areas * least
    even = (np.abs(shading @ plane[:3]) >= least).all(axis=1)
    return near & level & even
