"""Which way a surface is curved, from the change of its shading normals."""

from enum import Enum

import numpy as np

from .surface import Groups, Surface, connected

_SMOOTHING = 4
"""Times that curvatures are averaged with the neighbours'."""

_FLAT = 0.1
"""Curvature that counts for none, in turns of a radian over the size of the body."""

_NONE = 0.05
"""Share of the greater principal curvature below which the lesser counts for none: a cylinder is convex."""

_BENDING = 0.15
"""Least bending of a region of its own: the integral of k₁² + k₂², which is 2.3 for a sphere's cap of 35°."""

_RIDGE = 1e-6
"""Of the sum of squared edges: keeps the fit from failing on needles."""


class Curvature(Enum):
    """Towards the side that the normals point to; one principal curvature may be none where both have one sign."""

    FLAT = 0
    CONVEX = 1
    CONCAVE = 2
    SADDLE = 3


def curvature_classes(surface: Surface, body: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The `Curvature` value of every triangle, (G,) int8, as estimated; and its bending, (G,), k₁² + k₂² times area.

    `body` (G,) numbers the component, whose size says what is flat. The shape operator is fitted to the
    differences of the shading normals along the edges; its trace and determinant are averaged over neighbours.
    """
    mean, gauss = _smoothed(surface, *_shape_operator(surface))
    root = np.sqrt(np.maximum(mean**2 - gauss, 0.0))
    greater, lesser = mean + root, mean - root
    groups = Groups(body)
    spans = groups.max(surface.corners.max(axis=1)) - groups.min(surface.corners.min(axis=1))
    tolerance = _FLAT / np.linalg.norm(spans, axis=1)[body]
    tolerance = np.maximum(tolerance, _NONE * np.maximum(np.abs(greater), np.abs(lesser)))
    out, inwards = greater > tolerance, lesser < -tolerance
    kind = np.select(
        [out & inwards, out, inwards],
        [Curvature.SADDLE.value, Curvature.CONVEX.value, Curvature.CONCAVE.value],
        Curvature.FLAT.value,
    )
    return kind.astype(np.int8), (greater**2 + lesser**2) * surface.areas


def regions(surface: Surface, kind: np.ndarray, bending: np.ndarray) -> np.ndarray:
    """(G,) int8: `kind` where regions that hardly bend have taken that of the neighbour they border on most.

    Noise is absorbed so, and what is flat, which may join anything.
    """
    one, other = surface.links.T
    kind = kind.copy()
    while True:
        region = connected(len(kind), surface.links[kind[one] == kind[other]])
        bends = np.bincount(region, bending)
        borders = np.concatenate([region[surface.links], region[surface.links[:, ::-1]]])
        greater = (bends[borders[:, 0]] < np.minimum(bends[borders[:, 1]], _BENDING)) & (borders[:, 0] != borders[:, 1])
        if not greater.any():
            return kind
        pairs, place = np.unique(borders[greater], axis=0, return_inverse=True)
        shared = np.bincount(place.reshape(-1), np.tile(surface.lengths, 2)[greater])
        order = np.lexsort([shared, pairs[:, 0]])
        last = order[np.flatnonzero(np.diff(pairs[order, 0], append=-1))]
        of_region = np.empty(len(bends), np.int8)
        of_region[region] = kind
        taken = of_region.copy()
        taken[pairs[last, 0]] = of_region[pairs[last, 1]]
        kind = taken[region]


def _shape_operator(surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Half the trace and the determinant of the symmetric (2, 2) that best takes edges to differences of normals."""
    edges = np.roll(surface.corners, -1, axis=1) - surface.corners
    turns = np.roll(surface.shading, -1, axis=1) - surface.shading
    right = edges[:, 0] / np.linalg.norm(edges[:, 0], axis=1, keepdims=True)
    frame = np.stack([right, np.cross(surface.normals, right)], axis=2)
    (x, y), (u, v) = np.moveaxis(edges @ frame, 2, 0), np.moveaxis(turns @ frame, 2, 0)
    xx, xy, yy = (x * x).sum(axis=1), (x * y).sum(axis=1), (y * y).sum(axis=1)
    ridge, none = _RIDGE * (xx + yy), np.zeros(len(xx))
    matrix = np.stack([xx + ridge, xy, none, xy, xx + yy + ridge, xy, none, xy, yy + ridge], axis=1).reshape(-1, 3, 3)
    aim = np.stack([(x * u).sum(axis=1), (y * u + x * v).sum(axis=1), (y * v).sum(axis=1)], axis=1)
    a, b, c = np.linalg.solve(matrix, aim[..., None])[..., 0].T
    return (a + c) / 2.0, a * c - b * b


def _smoothed(surface: Surface, *values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Each averaged with its neighbours', by area."""
    there = surface.across >= 0
    weights = np.where(there, surface.areas[surface.across], 0.0)
    total = surface.areas + weights.sum(axis=1)
    for _ in range(_SMOOTHING):
        values = tuple(
            (surface.areas * value + (weights * value[surface.across]).sum(axis=1)) / total for value in values
        )
    return values
