"""Patches of a surface as seen from behind: from where, with what around them, and whether anything is seen twice."""

from dataclasses import dataclass

import numpy as np

from .patches import beside, shapes_of
from .surface import Groups, Surface, among

LEAST_FACING = 0.2
"""Least cosine between a triangle's normal and the direction from the centre to any corner of it."""

_FACING = LEAST_FACING + 0.01
"""The same, as it is aimed at."""

_SLOPE = np.tan(np.radians(38.0))
"""Farthest from the axis that a patch is seen."""

_BEYOND = np.radians(15.0)
"""Normals of the margin may turn so much farther from the axis than the patch's own."""

_MARGIN = 0.2
"""Width of the margin in diameters of the patch."""

_AT_ONCE = 2_000_000
"""Pairs of border edges that are compared at a time."""

_TOUCHES = 1e-5
"""Sine of an angle that counts for none: edges that touch do not cross."""


@dataclass(frozen=True, eq=False)
class Projections:
    """P patches seen from their centres: `centre` (P, 3), `frame` (P, 3, 3) with rows right, up and axis, `reach`
    (P,) the tangent of the half-angle. `part` and `triangle` (N,) pair each patch with what it projects, sorted;
    `own` (N,) where that is its own."""

    centre: np.ndarray
    frame: np.ndarray
    reach: np.ndarray
    part: np.ndarray
    triangle: np.ndarray
    own: np.ndarray


def projections(surface: Surface, patch: np.ndarray, spread: float, width: np.ndarray) -> Projections:
    """How the patches (G,) of normals within `spread` radians are seen, with margins of `width` (P,), 1 is full.

    The centre lies behind the middle of what is seen, so far that every triangle faces away from it and that
    it is seen within 38° of the axis.
    """
    groups = Groups(patch)
    shapes = shapes_of(surface, np.arange(len(patch)), patch)
    # A triangle whose shading is far off is alone, and seen straight.
    straight = groups.sum(surface.normals)
    axis = np.where(((shapes.turn > spread) & (np.bincount(patch) == 1))[:, None], straight, shapes.axis)
    wide = 2.0 * np.sqrt(groups.sum(surface.areas) / np.pi)
    part, triangle = _with_margins(surface, patch, axis, np.cos(spread + _BEYOND), _MARGIN * width * wide)
    frame = np.stack([*beside(axis), axis], axis=1)
    seen = Groups(part)
    local = surface.corners[triangle] @ frame[part].transpose(0, 2, 1)
    middle = (seen.min(local.min(axis=1)) + seen.max(local.max(axis=1))) / 2.0
    local -= middle[part, None]
    away = seen.max(_least_distance(local, np.einsum("tx,tfx->tf", surface.normals[triangle], frame[part])))
    flat = np.linalg.norm(local[..., :2], axis=2)
    reach = seen.max((flat / (local[..., 2] + away[part, None])).max(axis=1))
    middle[:, 2] -= away
    centre = np.einsum("pf,pfx->px", middle, frame)
    return Projections(centre, frame, reach, part, triangle, patch[triangle] == part)


def overlapping(surface: Surface, seen: Projections, own: bool) -> np.ndarray:
    """(P,) whether a patch, its margin included unless `own`, is seen twice in some direction.

    Where everything faces the same way, the layers in a direction are the turns of the border around it. So there
    are two only where the border crosses itself, or, should it merely touch itself, turns twice around places just
    inside of it.
    """
    part, start, end, inner = _borders(surface, seen, own)
    low = np.minimum(np.minimum(start, end), inner)[:, 1]
    high = np.maximum(np.maximum(start, end), inner)[:, 1]
    count = np.bincount(part, minlength=len(seen.reach))
    first = (np.cumsum(count) - count)[part]
    work = np.cumsum(count[part]) // _AT_ONCE
    result = np.zeros(len(count), bool)
    for chunk in np.split(np.arange(len(part)), np.flatnonzero(np.diff(work)) + 1):
        repeat = count[part[chunk]]
        one = np.repeat(chunk, repeat)
        other = np.arange(len(one)) + np.repeat(first[chunk] - np.cumsum(repeat) + repeat, repeat)
        level = (low[one] <= high[other]) & (high[one] >= low[other])
        one, other = one[level], other[level]
        turns = np.bincount(one, _passes(start[other], end[other], inner[one]), len(part))
        result[part[turns > 1.0]] = True
        result[part[one[_cross(start[one], end[one], start[other], end[other])]]] = True
    return result


def _borders(surface: Surface, seen: Projections, own: bool) -> tuple[np.ndarray, ...]:
    """The border edges of patches, sorted: of which (E,), and as seen, (E, 2), start, end and a place just inside."""
    chosen = seen.own if own else slice(None)
    part, triangle = seen.part[chosen], seen.triangle[chosen]
    count, across = len(surface.index), surface.across[triangle]
    row, side = np.nonzero((across < 0) | ~among(part * count + triangle, part[:, None] * count + across))
    part = part[row]
    local = (surface.corners[triangle[row]] - seen.centre[part, None]) @ seen.frame[part].transpose(0, 2, 1)
    flat = local[..., :2] / local[..., 2:]
    start, end, third = (flat[np.arange(len(row)), (side + step) % 3] for step in range(3))
    return part, start, end, 0.45 * (start + end) + 0.1 * third


def _passes(start: np.ndarray, end: np.ndarray, place: np.ndarray) -> np.ndarray:
    """(N,) 1 where an edge (N, 2) passes upwards to the right of a place, -1 downwards, else 0."""
    left = _area(end - start, place - start)
    above, below = end[:, 1] > place[:, 1], start[:, 1] > place[:, 1]
    return 1.0 * (above & ~below & (left > 0.0)) - 1.0 * (below & ~above & (left < 0.0))


def _cross(start, end, other_start, other_end) -> np.ndarray:
    """(N,) whether edges (N, 2) cross, and do not merely touch."""

    def parted(start, end, *points):
        sides = []
        for point in points:
            area = _area(end - start, point - start)
            nothing = _TOUCHES * np.linalg.norm(end - start, axis=1) * np.linalg.norm(point - start, axis=1)
            sides.append(np.sign(area) * (np.abs(area) > nothing))
        return sides[0] * sides[1] < 0.0

    return parted(start, end, other_start, other_end) & parted(other_start, other_end, start, end)


def _area(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def _with_margins(surface: Surface, patch, axis, least: float, width: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of patch and triangle (N,), sorted: the patches' own, and what lies within `width` (P,) of their border.

    Margins grow by smooth edges over triangles whose normals have the cosine `least` with the `axis` (P, 3). A
    triangle right at the border belongs to it even if it is larger, but not beyond the size of the patch.
    """
    count, middles = len(surface.index), surface.corners.mean(axis=1)
    margin = np.zeros(0, np.int64)  # sorted keys, part times count plus triangle
    row, side = np.nonzero((surface.across >= 0) & (patch[surface.across] != patch[:, None]))
    part, triangle = patch[row], surface.across[row, side]
    origin = (surface.corners[row, side] + surface.corners[row, (side + 1) % 3]) / 2.0
    far = np.linalg.norm(surface.corners[triangle] - origin[:, None], axis=2).max(axis=1)
    allowed = far <= width[part] / _MARGIN
    while len(part):
        distance = np.linalg.norm(middles[triangle] - origin, axis=1)
        facing = np.einsum("tx,tx->t", surface.normals[triangle], axis[part]) >= least
        taken = np.flatnonzero(facing & (allowed | (distance <= width[part])))
        key = part[taken] * count + triangle[taken]
        order = np.lexsort([distance[taken], key])
        order = order[np.diff(key[order], prepend=-1) > 0]
        order = order[~among(margin, key[order])]
        fresh = taken[order]
        margin = np.sort(np.concatenate([margin, key[order]]), kind="stable")
        following = surface.across[triangle[fresh]]
        row, side = np.nonzero((following >= 0) & (patch[following] != part[fresh, None]))
        part, origin, triangle = part[fresh][row], origin[fresh][row], following[row, side]
        allowed = np.zeros(len(part), bool)
    known = np.sort(np.concatenate([margin, patch * count + np.arange(count)]))
    return known // count, known % count


def _least_distance(local: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(N,) how far back along the axis the centre must lie for triangles (N, 3, 3) of `normals` (N, 3).

    Far enough for the slope of what is seen, and for n · (p + d a) >= f |p + d a|: the greater root in d of a
    quadratic, since n · a > f.
    """
    slope = np.linalg.norm(local[..., :2], axis=2) / _SLOPE - local[..., 2]
    across, along = np.einsum("tcf,tf->tc", local, normals), normals[:, 2:]
    square = _FACING**2
    a = along**2 - square
    b = across * along - square * local[..., 2]
    c = across**2 - square * (local**2).sum(axis=2)
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    return np.maximum(slope, np.maximum((root - b) / a, -across / along)).max(axis=1)
