"""Which paths of light a picture's mirrored rays belong to, and where those of each go."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

SLACK = 0.02
"""Radians that the rays of other samples of the same pixels may go beside."""

SAMPLES = 16
"""Rays of a bundle that searches begin from; gpu_shaders/virtual/newton.glsl holds the same number."""


@dataclass(frozen=True, eq=False)
class Bundle:
    """The mirrored rays of a picture that took the same path, `count` of them.

    `path`: the numbers of the parts that it is reflected at, from the eye on. The rays begin in a ball (`centre` (3,),
    `radius`) and go along `axis` (3,) or up to `spread`, in radians, off it. `bounds`: the pixels that they are seen
    in, and one around: left, bottom, and right and top beyond, row 0 at the bottom. `samples` (SAMPLES, 2, 3): where
    some of the rays begin and where they go, and `met` where each part of the path reflects them, (SAMPLES, 3) each.
    """

    path: tuple[int, ...]
    centre: np.ndarray
    radius: float
    axis: np.ndarray
    spread: float
    bounds: tuple[int, int, int, int]
    count: int
    samples: np.ndarray
    met: tuple[np.ndarray, ...]

    def reaches(self, centres: np.ndarray, radii: np.ndarray) -> np.ndarray:
        """(N,) bool: whether a ray may meet each of the balls of `centres` (N, 3) and `radii` (N,)."""
        return may_meet(self.centre, self.radius, self.axis, self.spread, centres, radii)

    def is_near(self, other: "Bundle", share: float) -> bool:
        """Whether the rays are nearly those of another bundle: apart by a share of how far they are from each other."""
        turned = np.arccos(np.clip(self.axis @ other.axis, -1.0, 1.0))
        moved = np.linalg.norm(self.centre - other.centre)
        return bool(turned <= share * self.spread and moved <= share * self.radius)


def may_meet(
    centre: np.ndarray, radius: np.ndarray, axis: np.ndarray, spread: np.ndarray, centres: np.ndarray, radii: np.ndarray
) -> np.ndarray:
    """(N,) bool: whether rays as of a bundle's, of one or of N of them, may meet N balls."""
    ways = centres - centre
    square = np.einsum("ij,ij->i", ways, ways)
    near = radii + radius
    along = (ways * axis).sum(axis=-1) if axis.ndim > 1 else ways @ axis
    aside = np.sqrt(np.maximum(square - along * along, 0.0))
    # Around the apex, in the cone, or no farther than the radius from its side. No angles: they are dear.
    cosine, sine = np.cos(np.minimum(spread, np.pi)), np.sin(np.minimum(spread, np.pi))
    beside = (aside * cosine - along * sine <= near) & (along * cosine + aside * sine >= 0.0)
    return (square <= near * near) | (along >= np.sqrt(square) * cosine) | beside


class Run(NamedTuple):
    """A path, and what stands in a row that it may show, from `first` to before `end`: results begin at `result`."""

    bundle: Bundle
    first: int
    end: int
    result: int


def bundles_of(origins: np.ndarray, directions: np.ndarray, before: np.ndarray | None = None) -> list[Bundle]:
    """The bundles of a picture's rays, (H, W, 4) each as gpu_shaders/virtual/rays.glsl writes them.

    `before` (H, W, 4): where the rays began that these are mirrored from, unless they come from the camera.
    """
    order = 1 if before is None else 2
    rows, columns = np.nonzero(origins[..., 3])
    starts, ways = origins[rows, columns], directions[rows, columns]
    number = starts[:, 3].astype(np.int64) + (ways[:, 3].astype(np.int64) << 32)
    sorting = np.argsort(number, kind="stable")
    rows, columns, starts, ways, number = (part[sorting] for part in (rows, columns, starts, ways, number))
    first = np.flatnonzero(np.diff(number, prepend=-1))
    if not len(first):
        return []
    counts = np.diff(first, append=len(number))
    low, high = (f.reduceat(starts[:, :3], first, axis=0) for f in (np.minimum, np.maximum))
    axes = np.add.reduceat(ways[:, :3].astype(np.float64), first, axis=0)
    axes /= np.maximum(np.linalg.norm(axes, axis=1, keepdims=True), 1e-12)
    cosines = np.minimum.reduceat((ways[:, :3] * np.repeat(axes, counts, axis=0)).sum(axis=1), first)
    edges = [np.minimum.reduceat(part, first) - 1 for part in (columns, rows)]
    edges += [np.maximum.reduceat(part, first) + 2 for part in (columns, rows)]
    chosen = first[:, None] + (np.arange(SAMPLES) + 0.5) / SAMPLES * counts[:, None]
    chosen = chosen.astype(int)
    return [
        Bundle(
            tuple(int(part) for part in (number[at] >> 32, number[at] & 0xFFFFFFFF))[2 - order :],
            (low[row] + high[row]) / 2.0,
            float(np.linalg.norm(high[row] - low[row])) / 2.0,
            axes[row],
            float(np.arccos(np.clip(cosines[row], -1.0, 1.0))) + SLACK,
            tuple(int(edge[row]) for edge in edges),
            int(counts[row]),
            np.stack([starts[chosen[row], :3], ways[chosen[row], :3]], axis=1),
            tuple(part[rows[chosen[row]], columns[chosen[row]], :3] for part in (before, origins)[2 - order :]),
        )
        for row, at in enumerate(first)
    ]
