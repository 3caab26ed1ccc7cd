"""A surface cut into patches that bend little enough to be seen whole from behind."""

from dataclasses import dataclass

import numpy as np

from .surface import Groups, Surface, among, connected, numbered

_LONGEST, _LONGEST_JOINED = 5.0, 3.5
"""Length over width of a patch beyond which it is cut across, and neighbours do not join.

A rectangle's variance along its length a is a² / 12, so that its width over its length is area / (12 variance).
That is small for bands, rings and horseshoes alike.
"""

_MIXED = 0.2
"""Share of a neighbour's area up to which a patch may join it though it is curved otherwise."""

_ROUNDS = 64
"""At most, of halving and of joining."""


@dataclass(frozen=True, eq=False)
class Shapes:
    """What P patches look like.

    `area` (P,); `axis` (P, 3), unit, amid the normals; `turn` (P,) the largest angle of a normal from it, radians;
    `length` (P,) in widths; `along` (P, 3) the longest direction; `coarse` (P,) where a triangle has a quarter of
    that length, so that cutting across is of no use.
    """

    area: np.ndarray
    axis: np.ndarray
    turn: np.ndarray
    length: np.ndarray
    along: np.ndarray
    coarse: np.ndarray

    def only(self, which: np.ndarray) -> "Shapes":
        """Those of `which` (P,) bool."""
        return Shapes(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def changed(self, number: np.ndarray, which: np.ndarray, by: "Shapes") -> "Shapes":
        """The shapes of patches that are now called `number` (P,), with those of `which` (N,) replaced."""

        def each(old, new):
            values = np.empty((number.max() + 1, *old.shape[1:]), old.dtype)
            values[number], values[which] = old, new
            return values

        return Shapes(*(each(getattr(self, name), getattr(by, name)) for name in self.__dataclass_fields__))


def cut(surface: Surface, kind: np.ndarray, spread: float) -> np.ndarray:
    """(G,) the patch of each triangle, from 0: connected, of one `kind`, normals within `spread` radians, not long.

    Halved along the widest direction of the normals, or across what is too long, until that holds. One triangle
    alone is a patch whatever its normals.
    """
    one, other = surface.links.T
    rest = np.arange(len(kind))
    links = surface.links[kind[one] == kind[other]]
    patch, count = np.zeros(len(kind), np.int64), 0
    for _ in range(_ROUNDS):
        label = connected(len(rest), links)
        shapes = shapes_of(surface, rest, label)
        fits = (shapes.turn <= spread) & ((shapes.length <= _LONGEST) | shapes.coarse)
        fits |= np.bincount(label) == 1
        patch[rest] = count + label
        count += len(fits)
        stays = ~fits[label]
        if not stays.any():
            break
        side = _halves(surface, rest, label, shapes, shapes.turn > spread)
        rest, links = _kept(rest, links, stays, side)
    return numbered(patch)


def joined(surface: Surface, kind: np.ndarray, patch: np.ndarray, spread: float) -> np.ndarray:
    """(G,) patches, where neighbours of one `kind`, or one of them small, that fit `spread` (radians) together have
    become one.

    In each round every patch asks the neighbour with which it bends least; those that ask one another join,
    unless that proves too much.
    """
    one, other = surface.links.T
    borders = surface.links[patch[one] != patch[other]]
    shapes = shapes_of(surface, np.arange(len(patch)), patch)
    kinds = np.zeros(len(shapes.turn), kind.dtype)
    kinds[patch] = kind
    refused = np.zeros((0, 2), np.int64)
    for _ in range(_ROUNDS):
        pairs = _suitors(patch[borders], shapes, kinds, spread, refused)
        if not len(pairs):
            break
        couple = np.full(len(shapes.turn), -1)
        couple[pairs] = np.arange(len(pairs))[:, None]
        members = np.flatnonzero(couple[patch] >= 0)
        union = shapes_of(surface, members, couple[patch[members]])
        longest = np.maximum(shapes.length[pairs].max(axis=1), _LONGEST_JOINED)
        good = (union.turn <= spread) & (union.length <= longest)
        greater = np.take_along_axis(pairs, shapes.area[pairs].argmax(axis=1)[:, None], axis=1)[:, 0]
        kinds[pairs] = kinds[np.where(good[:, None], greater[:, None], pairs)]
        name = np.arange(len(shapes.turn))
        name[pairs[good, 1]] = pairs[good, 0]
        number = numbered(name)
        kinds = kinds[name == np.arange(len(name))]
        # What was refused holds as long as neither has changed.
        refused = np.concatenate([refused, pairs[~good]])
        same = np.isin(refused, pairs[good], invert=True).all(axis=1)
        refused = number[refused[same]]
        shapes = shapes.changed(number, number[pairs[good, 0]], union.only(good))
        patch = number[patch]
    return patch


def halved(surface: Surface, patch: np.ndarray, which: np.ndarray) -> np.ndarray:
    """(G,) patches, with those that `which` (P,) bool names cut in two across their length, and into what is left
    connected."""
    rest = np.flatnonzero(which[patch])
    label = numbered(patch[rest])
    side = np.zeros(len(patch), bool)
    shapes = shapes_of(surface, rest, label)
    side[rest] = _halves(surface, rest, label, shapes, np.zeros(len(shapes.turn), bool))
    one, other = surface.links.T
    return connected(len(patch), surface.links[(patch[one] == patch[other]) & (side[one] == side[other])])


def shapes_of(surface: Surface, triangles: np.ndarray, label: np.ndarray) -> Shapes:
    """The shapes of groups of `triangles` (N,), numbered by `label` (N,)."""
    order = np.argsort(label, kind="stable")
    triangles, groups = triangles[order], Groups(label[order])
    areas, corners = surface.areas[triangles], surface.corners[triangles]
    normals = np.concatenate([surface.shading[triangles], surface.normals[triangles, None]], axis=1)
    axis = _amid(_unit(groups.sum(areas[:, None] * normals[:, 3])), normals, groups)
    cosine = groups.min((normals @ axis[groups.label, :, None]).min(axis=(1, 2)))
    total, variances, directions = _moments(areas, corners, groups)
    along = directions[..., 2]
    placed = (corners @ along[groups.label, :, None])[..., 0]
    low, high = placed.min(axis=1), placed.max(axis=1)
    coarse = groups.max(high - low) > (groups.max(high) - groups.min(low)) / 4.0
    turn = np.arccos(np.clip(cosine, -1.0, 1.0))
    return Shapes(total, axis, turn, 12.0 * variances[:, 2] / total, along, coarse)


def _amid(axis: np.ndarray, normals: np.ndarray, groups: Groups) -> np.ndarray:
    """The middle of the normals' range in the stereographic view from `axis`; what lies behind counts for little."""
    right, up = beside(axis)
    seen = normals @ np.stack([right, up, axis], axis=2)[groups.label]
    flat = seen[..., :2] / np.maximum(1.0 + seen[..., 2:], 1e-3)
    x, y = (groups.min(flat.min(axis=1)) + groups.max(flat.max(axis=1))).T[..., None] / 2.0
    square = x * x + y * y
    return (2.0 * (x * right + y * up) + (1.0 - square) * axis) / (1.0 + square)


def beside(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Right and up (P, 3), unit, so that right x up = `axis` (P, 3)."""
    least = np.eye(3)[np.abs(axis).argmin(axis=1)]
    right = _unit(np.cross(least, axis))
    return right, np.cross(axis, right)


def _moments(areas: np.ndarray, corners: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each group: area, variances (P, 3) in ascending order, and their directions in the columns of (P, 3, 3)."""
    total, middles = groups.sum(areas), corners.mean(axis=1)
    middle = groups.sum(areas[:, None] * middles) / total[:, None]
    points = np.concatenate([corners, 3.0 * middles[:, None]], axis=1)
    points -= middle[groups.label, None] * np.array([1.0, 1.0, 1.0, 3.0])[:, None]
    squares = points.transpose(0, 2, 1) @ points * (areas / 12.0)[:, None, None]
    return total, *np.linalg.eigh(groups.sum(squares) / total[:, None, None])


def _halves(surface: Surface, triangles, label, shapes: Shapes, by_normal: np.ndarray) -> np.ndarray:
    """(N,) bool: on which side of the middle of its group's widest direction, of normals or of places."""
    groups, weights = Groups(label), surface.areas[triangles, None]
    normals = surface.shading[triangles].mean(axis=1) + surface.normals[triangles]
    total = groups.sum(weights)
    from_mean = normals - (groups.sum(weights * normals) / total)[label]
    scatter = groups.sum(weights[..., None] * from_mean[:, :, None] * from_mean[:, None, :])
    widest = np.linalg.eigh(scatter / total[..., None])[1][..., 2]
    turned = (normals * widest[label]).sum(axis=1)
    by_normal = by_normal & (groups.max(turned) - groups.min(turned) > 1e-9)
    placed = (surface.corners[triangles].mean(axis=1) * shapes.along[label]).sum(axis=1)
    value = np.where(by_normal[label], turned, placed)
    return value > ((groups.min(value) + groups.max(value)) / 2.0)[label]


def _kept(rest: np.ndarray, links: np.ndarray, stays: np.ndarray, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The triangles that stay, and the links among them that do not cross over, numbered anew."""
    one, other = links.T
    links = links[stays[one] & stays[other] & (side[one] == side[other])]
    return rest[stays], (np.cumsum(stays) - 1)[links]


def _suitors(borders: np.ndarray, shapes: Shapes, kinds: np.ndarray, spread: float, refused: np.ndarray) -> np.ndarray:
    """(N, 2) pairs of patches that would each rather join the other than anyone else; none twice.

    `borders` (L, 2) are the patches on both sides of edges.
    """
    count = len(shapes.turn)
    keys = np.unique(borders.min(axis=1) * count + borders.max(axis=1))
    keys = keys[~among(np.sort(refused.min(axis=1) * count + refused.max(axis=1)), keys)]
    pairs = np.stack([keys // count, keys % count], axis=1)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    areas = shapes.area[pairs]
    pairs = pairs[(kinds[pairs[:, 0]] == kinds[pairs[:, 1]]) | (areas.min(axis=1) <= _MIXED * areas.max(axis=1))]
    between = np.arccos(np.clip(np.einsum("px,px->p", *shapes.axis[pairs.T]), -1.0, 1.0))
    turns = shapes.turn[pairs]
    bound = np.maximum(turns.max(axis=1), (turns.sum(axis=1) + between) / 2.0)
    pairs, bound = pairs[between <= spread], bound[between <= spread]
    order = np.lexsort([pairs[:, 1], pairs[:, 0], bound])
    rank = np.empty(len(pairs), np.int64)
    rank[order] = np.arange(len(pairs))
    best = np.full(count, len(pairs))
    np.minimum.at(best, pairs[:, 0], rank)
    np.minimum.at(best, pairs[:, 1], rank)
    return pairs[(best[pairs[:, 0]] == rank) & (best[pairs[:, 1]] == rank)]


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)
