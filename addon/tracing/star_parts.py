"""A mirror's mesh as star-shaped parts, each of which a map projected from one centre can hold.

Reflector cube maps (Estalella et al. 2005, section 4.1) hold positions and normals as seen from a centre, so that
each direction must meet the mirror once. The paper has reflectors split into concave and convex pieces by hand
(6.2); here they split themselves.
"""

from dataclasses import dataclass

import numpy as np

from .convexity import is_convex
from .curvature import Curvature, curvature_classes, regions
from .patches import cut, halved, joined
from .projection import LEAST_FACING, Projections, overlapping, projections
from .surface import Groups, Surface, connected, numbered

_CURVED = 0.1
"""Least share of a part's area that is curved for the part not to count as flat."""


_NARROWEST = 0.25
"""Least width of a margin, of the full one."""


@dataclass(frozen=True, eq=False)
class StarPart:
    """A connected part of a mesh, every triangle of which faces away from one point, and none of which hides another.

    `triangles` (K,) int32 of the mesh are the part's own, `margin` (M,) int32 those around it that can be projected
    as well, so that the map goes on beyond the part's border. `centre` (3,) float64 in the mesh's space; `frame`
    (3, 3) float64 has the rows right, up and axis, orthonormal and right-handed; the axis leads from the centre
    through the part. `reach` is the tangent of the half-angle about the axis that holds part and margin, at most
    1, or inf for a whole body, which surrounds its centre. `curvature` is that of most of it.
    """

    triangles: np.ndarray
    margin: np.ndarray
    centre: np.ndarray
    frame: np.ndarray
    reach: float
    curvature: Curvature


def star_parts(
    positions: np.ndarray, triangles: np.ndarray, normals: np.ndarray, spread: float = 35.0
) -> list[StarPart]:
    """The parts of a mesh, largest first. Each triangle is in exactly one, but for those without area or normals.

    `positions` (V, 3), `triangles` (T, 3) and the corners' shading `normals` (T, 3, 3), of any length. Vertices in
    the same place are one. A triangle faces the side that its shading normals lie on, whichever way it is wound.
    `spread`, in degrees, 5 to 60, is how far normals turn from a patch's axis.

    *Whole bodies*: a closed convex body, wound outwards, is one part seen from its centroid; not if it is so thin
    that its surface would be seen at a grazing angle (a pane, a coin).

    *Patches*: the rest is cut along creases (shading normals that differ by more than 1° across an edge) and where
    the curvature changes its kind, then halved until the triangles' own and the shading normals keep to `spread`
    and no patch is much longer than wide; neighbours that fit together are joined again. A triangle whose own
    normals differ by more is a patch of its own. The centre lies behind the patch, far enough for
    normal · direction >= 0.2 at every corner. A surface that passes over itself as seen from there (a spiral stair)
    is halved until it does not: the turns of the patch's border about points just inside of it count its layers.
    """
    surface = Surface.of(positions, triangles, normals)
    if not len(surface.index):
        return []
    body = connected(len(surface.index), surface.touching)
    parts = _bodies(surface, body)
    whole = np.isin(surface.index, np.concatenate([[], *(part.triangles for part in parts)]))
    if not whole.all():
        rest = surface.without(whole) if whole.any() else surface
        parts += _patches(rest, numbered(body[~whole]), np.radians(spread))
    areas = np.zeros(len(triangles))
    areas[surface.index] = surface.areas
    return sorted(parts, key=lambda part: -areas[part.triangles].sum())


def _bodies(surface: Surface, body: np.ndarray) -> list[StarPart]:
    """The components that are closed, convex and seen well from their centroid."""
    groups = Groups(body)
    candidates = groups.min(surface.closed & ~surface.flipped)
    members = groups.members()
    found = (_whole(surface, members[number]) for number in np.flatnonzero(candidates))
    return [part for part in found if part is not None]


def _whole(surface: Surface, members: np.ndarray) -> StarPart | None:
    corners = surface.corners[members]
    _, first, vertices = np.unique(surface.vertices[members], return_index=True, return_inverse=True)
    if not is_convex(corners.reshape(-1, 3)[first], vertices.reshape(-1, 3)):
        return None
    apart = corners - corners[0, 0]
    volumes = np.linalg.det(apart)
    centre = corners[0, 0] + (volumes[:, None] * apart.sum(axis=1)).sum(axis=0) / (4.0 * volumes.sum())
    rays = corners - centre
    facing = np.einsum("tcx,tx->tc", rays, surface.normals[members])
    if (facing < LEAST_FACING * np.linalg.norm(rays, axis=2)).any():
        return None
    own, none = surface.index[members].astype(np.int32), np.zeros(0, np.int32)
    return StarPart(own, none, centre, np.eye(3), np.inf, Curvature.CONVEX)


def _patches(surface: Surface, body: np.ndarray, spread: float) -> list[StarPart]:
    """The patches of a surface that has components `body` (G,)."""
    kind, bending = curvature_classes(surface, body)
    region = regions(surface, kind, bending)
    patch = joined(surface, region, cut(surface, region, spread), spread)
    seen = _seen_once(surface, patch, spread)
    curvatures = _curvatures(kind, seen, surface.areas)
    ends = np.flatnonzero(np.diff(seen.part)) + 1
    own, index = np.split(seen.own, ends), np.split(surface.index[seen.triangle].astype(np.int32), ends)
    return [
        StarPart(
            index[p][own[p]], index[p][~own[p]], seen.centre[p], seen.frame[p], float(seen.reach[p]), curvatures[p]
        )
        for p in range(len(index))
    ]


def _seen_once(surface: Surface, patch: np.ndarray, spread: float) -> Projections:
    """The patches, halved until none is seen twice, with margins that are halved, or left out, for the same reason."""
    width = np.ones(patch.max() + 1)
    while True:
        seen = projections(surface, patch, spread, width)
        twice = overlapping(surface, seen, own=True)
        if twice.any():
            patch = halved(surface, patch, twice)
            width = np.ones(patch.max() + 1)
            continue
        crowded = overlapping(surface, seen, own=False)
        if not crowded.any():
            return seen
        width[crowded] = np.where(width[crowded] > _NARROWEST, width[crowded] / 2.0, 0.0)


def _curvatures(kind: np.ndarray, seen: Projections, areas: np.ndarray) -> list[Curvature]:
    """What most of each patch is, by area; flat only if hardly any of it is anything else."""
    part, triangle = seen.part[seen.own], seen.triangle[seen.own]
    shares = np.zeros((len(seen.reach), len(Curvature)))
    np.add.at(shares, (part, kind[triangle]), areas[triangle])
    flat = shares[:, 1:].sum(axis=1) < _CURVED * shares.sum(axis=1)
    most = np.where(flat, Curvature.FLAT.value, 1 + shares[:, 1:].argmax(axis=1))
    return [Curvature(value) for value in most]
