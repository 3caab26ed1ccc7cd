"""A mesh as a surface: sound triangles, turned to the side their normals point to, and who borders on whom."""

from dataclasses import dataclass

import numpy as np

_CREASE = 2.0 * np.sin(np.radians(1.0) / 2.0)
"""Chord between unit normals that differ by 1°: more than that along an edge is a crease."""

_SLIVER = 1e-10
"""Least area of a triangle, in squares of its longest edge."""


@dataclass(frozen=True, eq=False)
class Surface:
    """G sound triangles; vertices that coincide are one.

    `index` (G,) in the mesh; `vertices` (G, 3) welded, wound so that `normals` (G, 3), unit, lie on the side of
    `shading` (G, 3, 3), unit; `flipped` (G,) where that is not the mesh's own winding; `corners` (G, 3, 3);
    `areas` (G,). `links` (L, 2) are pairs that share an edge across which the surface goes on smoothly, with
    `lengths` (L,); `across` (G, 3) is the same by edge, corner i to i + 1, -1 where it ends; `touching` (E, 2)
    are pairs that share an edge at all; `closed` (G,) says that every edge is shared with one that goes on.
    """

    index: np.ndarray
    vertices: np.ndarray
    corners: np.ndarray
    normals: np.ndarray
    shading: np.ndarray
    areas: np.ndarray
    flipped: np.ndarray
    links: np.ndarray
    lengths: np.ndarray
    across: np.ndarray
    touching: np.ndarray
    closed: np.ndarray

    @classmethod
    def of(cls, positions: np.ndarray, triangles: np.ndarray, normals: np.ndarray) -> "Surface":
        """The surface of a mesh: see `star_parts`."""
        positions = np.asarray(positions, np.float64).reshape(-1, 3)
        triangles = np.asarray(triangles, np.int64).reshape(-1, 3)
        shading = np.asarray(normals, np.float64).reshape(-1, 3, 3)
        index, across = _sound(positions[triangles], shading)
        shading = shading[index] / np.linalg.norm(shading[index], axis=2, keepdims=True)
        doubled = np.linalg.norm(across, axis=1)
        flipped = np.einsum("tcx,tx->t", shading, across) < 0.0
        order = np.where(flipped[:, None], [0, 2, 1], [0, 1, 2])
        used = np.take_along_axis(triangles[index], order, axis=1)
        shading = np.take_along_axis(shading, order[..., None], axis=1)
        facing = across / (doubled * np.where(flipped, -1.0, 1.0))[:, None]
        corners, vertices = positions[used], welded(positions)[used]
        pairs, touching = _shared_edges(vertices)
        smooth = _goes_on(shading, pairs)
        links, sides = pairs[smooth] // 3, np.full(3 * len(index), -1)
        sides[pairs[smooth]] = links[:, ::-1]
        manifold = np.zeros(3 * len(index), bool)
        manifold[pairs] = True
        ends = corners.reshape(-1, 3)[pairs[smooth]]
        return cls(
            index=index,
            vertices=vertices,
            corners=corners,
            normals=facing,
            shading=shading,
            areas=doubled / 2.0,
            flipped=flipped,
            links=links,
            lengths=np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1),
            across=sides.reshape(-1, 3),
            touching=touching,
            closed=manifold.reshape(-1, 3).all(axis=1),
        )

    def without(self, gone: np.ndarray) -> "Surface":
        """The surface without whole components `gone` (G,) bool."""
        number = np.append(np.cumsum(~gone) - 1, -1)
        kept = {name: getattr(self, name)[~gone] for name in _BY_TRIANGLE}
        kept["across"] = number[kept["across"]]
        smooth = ~gone[self.links[:, 0]]
        links, touching = number[self.links[smooth]], number[self.touching[~gone[self.touching[:, 0]]]]
        return Surface(**kept, links=links, lengths=self.lengths[smooth], touching=touching)


_BY_TRIANGLE = ("index", "vertices", "corners", "normals", "shading", "areas", "flipped", "across", "closed")


def _sound(corners: np.ndarray, shading: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which triangles have an area and normals, and the cross product of two of each one's edges."""
    with np.errstate(invalid="ignore", over="ignore"):
        edges = np.roll(corners, -1, axis=1) - corners
        across = np.cross(edges[:, 0], edges[:, 1])
        longest = (edges**2).sum(axis=2).max(axis=1)
        wide = np.linalg.norm(across, axis=1) > _SLIVER * longest
        lit = (np.linalg.norm(shading, axis=2) > 0.0).all(axis=1)
    index = np.flatnonzero(wide & lit & np.isfinite(longest) & np.isfinite(shading).all(axis=(1, 2)))
    return index, across[index]


def welded(positions: np.ndarray) -> np.ndarray:
    """(V,) the same number for vertices in the same place."""
    order = np.lexsort(positions.T)
    placed = positions[order]
    differs = (placed[1:] != placed[:-1]).any(axis=1)
    number = np.zeros(len(positions), np.int64)
    number[order[1:]] = np.cumsum(differs)
    return number


def _shared_edges(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (L, 2) of edges, 3 t + i, that are one edge of two triangles wound alike; and all triangles that touch."""
    start, end = vertices.ravel(), np.roll(vertices, -1, axis=1).ravel()
    key = np.minimum(start, end) * (vertices.max(initial=0) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = np.diff(key[order]) == 0
    first = np.flatnonzero(same)
    touching = np.stack([order[first], order[first + 1]], axis=1) // 3
    lonely = np.concatenate([[False], same, [False]])  # before, between and after
    first = first[~lonely[first] & ~lonely[first + 2]]
    pairs = np.stack([order[first], order[first + 1]], axis=1)
    return pairs[start[pairs[:, 0]] == end[pairs[:, 1]]], touching


def _goes_on(shading: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """(L,) whether the shading normals agree along a shared edge."""
    start = shading.reshape(-1, 3)
    end = np.roll(shading, -1, axis=1).reshape(-1, 3)
    one, other = pairs.T
    apart = np.maximum(np.linalg.norm(start[one] - end[other], axis=1), np.linalg.norm(end[one] - start[other], axis=1))
    return apart <= _CREASE


def connected(count: int, links: np.ndarray) -> np.ndarray:
    """(count,) numbers from 0 without gaps: the same for what `links` (L, 2) join."""
    label = np.arange(count)
    one, other = links.T
    while True:
        root = label[label]
        least = np.minimum(root[one], root[other])
        for end in (one, other):  # also the roots, so that whole trees join at once
            np.minimum.at(root, label[end], least)
            np.minimum.at(root, end, least)
        root = root[root]
        if (root == label).all():
            return numbered(label)
        label = root


def numbered(label: np.ndarray) -> np.ndarray:
    """The labels, integers from 0, without gaps."""
    used = np.zeros(label.max(initial=-1) + 1, bool)
    used[label] = True
    return (np.cumsum(used) - 1)[label]


def among(sorted_keys: np.ndarray, keys: np.ndarray) -> np.ndarray:
    """Which of `keys` are in `sorted_keys`."""
    if not len(sorted_keys):
        return np.zeros(keys.shape, bool)
    place = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
    return sorted_keys[place] == keys


class Groups:
    """Sums and extremes over the members of each group. `label` (N,) from 0, without gaps; fast where it ascends."""

    def __init__(self, label: np.ndarray):
        self.label = label
        ascends = (np.diff(label) >= 0).all()
        self.order = slice(None) if ascends else np.argsort(label, kind="stable")
        self.starts = np.flatnonzero(np.diff(label[self.order], prepend=-1))
        self.count = len(self.starts)

    def sum(self, values: np.ndarray) -> np.ndarray:
        """(P, …) of values (N, …)."""
        return np.add.reduceat(values[self.order], self.starts, axis=0)

    def max(self, values: np.ndarray) -> np.ndarray:
        """(P, …) of values (N, …)."""
        return np.maximum.reduceat(values[self.order], self.starts, axis=0)

    def min(self, values: np.ndarray) -> np.ndarray:
        """(P, …) of values (N, …)."""
        return np.minimum.reduceat(values[self.order], self.starts, axis=0)

    def members(self) -> list[np.ndarray]:
        """The members of each group, in order."""
        return np.split(np.arange(len(self.label))[self.order], self.starts[1:])
