"""A mesh made finer than it is drawn."""

import numpy as np

_MOST_BESIDE = 0.5
"""Of a triangle's height: how far a ray may pass beside it."""

_LEAST_SLOPE = 0.1
"""Sine of the angle between a ray and the surface from which on it meets tangent planes near their corners."""


def finer(corners: np.ndarray, normals: np.ndarray, levels: int) -> tuple[np.ndarray, np.ndarray]:
    """Quarter every triangle `levels` times, onto the curved surface that its corners' normals stand for.

    `corners` and unit `normals` are (T, 3, 3) float64, by triangle and corner; so are the results, of
    T × 4 ** `levels` triangles. What is flat stays flat, and neighbours that share normals stay together.

    Source: Vlachos, Peters, Boyd and Mitchell, *Curved PN triangles*, 2001: cubic positions; normals go linearly.
    """
    if levels == 0 or not len(corners):
        return corners, normals
    weights, pieces = _quartered(levels)
    positions = _cubic(corners, normals, weights)
    turned = np.einsum("wk,tkc->twc", weights, normals)
    turned /= np.maximum(np.linalg.norm(turned, axis=2, keepdims=True), 1e-300)
    return positions[:, pieces].reshape(-1, 3, 3), turned[:, pieces].reshape(-1, 3, 3)


def met_by(ways: np.ndarray, corners: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where rays from the origin meet the curved surface that small triangles stand for: points and normals, (N, 3).

    Ray n goes along `ways` (N, 3) through triangle n, of `corners` and unit `normals` (N, 3, 3). A point is halfway
    between the flat triangle and the tangent planes of its corners, which is right to the third order.

    Source: after Boubekeur and Alexa, *Phong tessellation*, 2008.
    """
    after, before = np.roll(corners, -1, axis=1), np.roll(corners, 1, axis=1)
    shares = np.einsum("nkc,nc->nk", np.cross(after, before), ways)
    total = shares.sum(axis=1, keepdims=True)
    weights = np.divide(shares, total, out=np.full_like(shares, 1 / 3), where=total != 0.0)
    # Rays that pass a sliver by a hair are as far from it, in its own measure, as they like.
    weights = np.clip(weights, -_MOST_BESIDE, 1.0 + _MOST_BESIDE)
    weights /= weights.sum(axis=1, keepdims=True)
    ahead = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    points = np.einsum("nk,nkc,nc->n", weights, corners, ahead)[:, None] * ahead
    turned = np.einsum("nk,nkc->nc", weights, normals)
    height = np.einsum("nk,nkc,nkc->n", weights, normals, corners - points[:, None])[:, None]
    slope = np.einsum("nc,nc->n", turned, ahead)[:, None]
    # Planes that a ray grazes would be met anywhere.
    points += 0.5 * height * slope / np.maximum(slope * slope, _LEAST_SLOPE**2) * ahead
    return points, turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-300)


def _quartered(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """Barycentric weights (W, 3) of the points of a triangle cut 2 ** `levels` times a side, and its pieces (P, 3)."""
    side = 2**levels
    rows = [(row, column) for row in range(side + 1) for column in range(side + 1 - row)]
    number = {point: index for index, point in enumerate(rows)}
    pieces = []
    for row, column in rows:
        if row + column < side:
            pieces.append((number[row, column], number[row, column + 1], number[row + 1, column]))
        if row + column < side - 1:
            pieces.append((number[row, column + 1], number[row + 1, column + 1], number[row + 1, column]))
    weights = np.array([(side - row - column, column, row) for row, column in rows]) / side
    return weights, np.array(pieces)


def _cubic(corners: np.ndarray, normals: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """(T, W, 3) points of the cubic patches."""
    after, before = np.roll(corners, -1, axis=1), np.roll(corners, 1, axis=1)
    # Control points a third along each edge, on the tangent plane of the corner that is nearer.
    forth = (2 * corners + after - _height(after - corners, normals)) / 3
    back = (2 * corners + before - _height(before - corners, normals)) / 3
    edges = (forth + back).sum(axis=1) / 6
    middle = edges + (edges - corners.mean(axis=1)) / 2
    w, w_after, w_before = weights, np.roll(weights, -1, axis=1), np.roll(weights, 1, axis=1)
    points = np.einsum("wk,tkc->twc", w**3, corners)
    points += 3 * np.einsum("wk,tkc->twc", w**2 * w_after, forth)
    points += 3 * np.einsum("wk,tkc->twc", w**2 * w_before, back)
    return points + 6 * weights.prod(axis=1)[None, :, None] * middle[:, None]


def _height(edge: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return (edge * normal).sum(axis=2, keepdims=True) * normal
