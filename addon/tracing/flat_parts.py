"""The flat parts of a mesh: triangles that lie in one plane, whatever their outline."""

from dataclasses import dataclass

import numpy as np

_TRIES = 4
"""Planes that are tried for each that is wanted, since the largest triangles need not lie in the largest part."""

_FITS = 8
"""Times that a plane is fitted anew; the first already takes what is exactly flat."""

_ROUNDING = 1e-12
"""Of cosines near 1; as much as 0.0001° make."""


@dataclass(frozen=True, eq=False)
class FlatParts:
    """Which triangles lie in which plane.

    `part` (T,) int32, -1 for a triangle in none; `planes` (P, 4) float64, unit normal and offset, so that
    points with normal · point + offset = 0 lie in it; `share` 0..1, of the area that was asked about, NaN where
    there is none.
    """

    part: np.ndarray
    planes: np.ndarray
    share: float


def flat_parts(
    corners: np.ndarray, normals: np.ndarray, among: np.ndarray, degrees: float, metres: float, most: int
) -> FlatParts:
    """The `most` largest flat parts, largest first, of those found greedily from the largest triangles on.

    `corners` (T, 3, 3) metres; `normals` (T, 3, 3) shading normals, which must agree with the plane as well,
    since they say where light goes; `among` (T,) bool, the triangles that count. A triangle belongs to a plane
    if it and its normals turn away from it by at most `degrees`, and its corners lie within `metres`.
    Triangles face either way; parts need not hang together: one plane makes one mirror image. What has no area,
    or a corner or normal that is not a number, counts for nothing.
    """
    corners = np.asarray(corners, np.float64)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.where(among, 0.5 * np.linalg.norm(across, axis=1), 0.0)
    areas[~np.isfinite(areas) | ~np.isfinite(normals).all(axis=(1, 2))] = 0.0
    shading = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-30)
    left = np.where(_even(across, areas, shading, degrees), areas, 0.0)
    found: list[tuple[float, np.ndarray, np.ndarray]] = []
    while len(found) < _TRIES * most and left.any():
        plane, within = _grown(corners, across, shading, left, degrees, metres)
        found.append((float(left[within].sum()), plane, within))
        left[within] = 0.0
    found.sort(key=lambda each: -each[0])
    part, planes = np.full(len(corners), -1, np.int32), np.zeros((min(most, len(found)), 4))
    for number, (_, plane, within) in enumerate(found[:most]):
        part[within], planes[number] = number, plane
    total, loose = areas.sum(), areas[part < 0].sum()
    return FlatParts(part, planes, float(1.0 - loose / total) if total > 0.0 else np.nan)


def _grown(corners, across, shading, areas, degrees: float, metres: float) -> tuple[np.ndarray, np.ndarray]:
    """The plane that fits around the largest triangle, and which triangles lie in it.

    It starts as the triangle's own, and is fitted to what lies in it as long as that adds to them: of an uneven
    mirror, each triangle alone points elsewhere.
    """
    seed = int(areas.argmax())
    within, fitted = np.array([seed]), _plane(across[seed], corners[seed])
    for _ in range(_FITS):
        grown = np.union1d(_within(fitted, corners, across, shading, areas, degrees, metres), seed)
        if areas[grown].sum() <= areas[within].sum():
            break
        within = grown
        turned = np.sign(across[within] @ across[seed])[:, None] * across[within]
        fitted = _plane(turned.sum(axis=0), np.average(corners[within], axis=0, weights=areas[within]))
    return fitted, within


def _plane(normal: np.ndarray, points: np.ndarray) -> np.ndarray:
    normal = normal / np.linalg.norm(normal)
    return np.array([*normal, -float(normal @ points.mean(axis=0))])


def _even(across, areas, shading, degrees: float) -> np.ndarray:
    """(T,) bool: whose shading normals agree with the triangle itself."""
    along = np.abs(np.einsum("tcx,tx->tc", shading, across)).min(axis=1)
    return along >= 2.0 * areas * _least_cosine(degrees)


def _within(plane, corners, across, shading, areas, degrees: float, metres: float) -> np.ndarray:
    """Which triangles lie in the plane, normals and all; none of those without an area."""
    least = _least_cosine(degrees)
    level = np.flatnonzero((np.abs(across @ plane[:3]) >= 2.0 * areas * least) & (areas > 0.0))
    near = np.abs(corners[level] @ plane[:3] + plane[3]).max(axis=1) <= metres
    even = (np.abs(shading[level] @ plane[:3]) >= least).all(axis=1)
    return level[near & even]


def _least_cosine(degrees: float) -> float:
    return float(np.cos(np.radians(degrees))) - _ROUNDING
