"""Layered depth textures whose texels hold triangles: what `layered-depth` and shadow rays search.

A layered depth texture (Zhang et al., 3.3, 3.4) shows an object from the six faces of its box, by
samples at texel centres. Here the faces of one axis share a grid of *columns*, and a column lists
the triangles that pass through it instead of samples of them. Each triangle stands in the grid of
the axis it faces most, so that it covers few columns and its depth changes little in each. A search
then meets the surface itself: thin parts and open meshes cannot be stepped over, and texel size
decides speed alone. A pyramid says which depth slices of a block of columns hold anything.
"""

from dataclasses import dataclass

import numpy as np

SLICES = 64
"""Depth slices of a column: two 32-bit words; gpu_shaders/common/layers.glsl holds the same number."""

LARGEST = 512
"""Most columns along a side."""

_MARGIN = 0.01
"""Columns by which a triangle is widened, so that rounding in the search cannot miss it."""

_CHUNK = 1 << 22


@dataclass(frozen=True, eq=False)
class Grid:
    """The columns along one axis. `shape` (columns along u, columns along v), `levels` in the pyramid.

    `nodes` (N, 4) uint32, finest level first, u fastest: occupied slices (two words) and, at the
    finest level, the first entry and how many. `entries` (E, 2) uint32: triangle, and its first slice
    in the column plus 256 times its last.
    """

    shape: tuple[int, int]
    levels: int
    nodes: np.ndarray
    entries: np.ndarray


@dataclass(frozen=True, eq=False)
class Layers:
    """The grids of the X, Y and Z axis in the box from `low` to `low + size`, (3,) float64 each.

    Grid `a` has its depth along axis a, u along axis a + 1 and v along axis a + 2 (modulo 3).
    """

    low: np.ndarray
    size: np.ndarray
    grids: tuple[Grid, Grid, Grid]


def build(corners: np.ndarray, largest: int = LARGEST) -> Layers:
    """The layers of a mesh from its corners (T, 3, 3), T ≥ 1; at most `largest` columns along a side."""
    low, size = _padded_box(corners)
    side = _side(len(corners), largest)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = np.abs(normals).argmax(axis=1)
    unit = (corners.astype(np.float64) - low) / size
    return Layers(low, size, tuple(_grid(axis, np.flatnonzero(facing == axis), unit, size, side) for axis in range(3)))


def _padded_box(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    low, high = corners.min(axis=(0, 1)).astype(np.float64), corners.max(axis=(0, 1)).astype(np.float64)
    pad = np.maximum(1e-4 * (high - low).max(), 1e-6 * np.abs([low, high]).max() + 1e-9)
    return low - pad, high - low + 2 * pad


def _side(triangles: int, largest: int) -> int:
    """Columns along the longest side: about as many columns on a face as there are triangles."""
    return int(min(largest, 2 ** np.ceil(np.log2(2.0 * np.sqrt(triangles)))))


def _grid(axis: int, members: np.ndarray, unit: np.ndarray, size: np.ndarray, side: int) -> Grid:
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    shape = np.maximum(1, np.ceil(side * size[order[:2]] / size.max())).astype(np.int64)
    points = unit[members][:, :, order] * [*shape, SLICES]
    column, triangle, first, last = _overlaps(points, shape)
    by_column = np.argsort(column, kind="stable")
    column, triangle, first, last = (part[by_column] for part in (column, triangle, first, last))
    count = np.bincount(column, minlength=shape.prod())
    start = np.concatenate([[0], np.cumsum(count)[:-1]])
    finest = np.zeros((shape.prod(), 4), np.uint32)
    occupied = count > 0
    if len(column):
        finest[occupied, :2] = np.bitwise_or.reduceat(_slice_words(first, last), start[occupied], axis=0)
    finest[:, 2], finest[:, 3] = start, count
    levels = _pyramid(finest, shape)
    entries = np.stack([members[triangle], first | last << 8], axis=1).astype(np.uint32)
    return Grid((int(shape[0]), int(shape[1])), len(levels), np.concatenate(levels), entries)


def _overlaps(points: np.ndarray, shape: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Column, triangle, first and last slice of every column that a triangle (T, 3 corners, uvw) passes through."""
    low = np.clip(np.floor(points[..., :2].min(axis=1) - _MARGIN), 0, shape - 1).astype(np.int64)
    high = np.clip(np.floor(points[..., :2].max(axis=1) + _MARGIN), 0, shape - 1).astype(np.int64)
    spans = high - low + 1
    ends = np.concatenate([[0], np.cumsum(spans.prod(axis=1))])
    found = [tuple(np.zeros(0, np.int64) for _ in range(4))]
    begin = 0
    while begin < len(points):
        end = max(begin + 1, int(np.searchsorted(ends, ends[begin] + _CHUNK, side="right")) - 1)
        part = slice(begin, end)
        column, triangle, first, last = _overlaps_of(points[part], low[part], spans[part], shape)
        found.append((column, triangle + begin, first, last))
        begin = end
    return tuple(np.concatenate(part) for part in zip(*found, strict=True))


def _overlaps_of(points, low, spans, shape):
    """Separating-axis test of each triangle against the columns of its rectangle."""
    count = spans.prod(axis=1)
    triangle = np.repeat(np.arange(len(points)), count)
    step = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    u, v = low[triangle, 0] + step % spans[triangle, 0], low[triangle, 1] + step // spans[triangle, 0]
    edges = np.roll(points, -1, axis=1) - points
    turn = np.where(_cross(edges[:, 0], edges[:, 1]) < 0, -1.0, 1.0)
    inside = np.ones(len(triangle), bool)
    for corner in range(3):
        normal = np.stack([-edges[:, corner, 1] * turn, edges[:, corner, 0] * turn], axis=1)
        offset = -(normal * points[:, corner, :2]).sum(axis=1) + (0.5 + _MARGIN) * np.abs(normal).sum(axis=1)
        inside &= normal[triangle, 0] * (u + 0.5) + normal[triangle, 1] * (v + 0.5) + offset[triangle] >= 0
    triangle, u, v = triangle[inside], u[inside], v[inside]
    first, last = _slices(points, triangle, u, v)
    return u + shape[0] * v, triangle, first, last


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _slices(points, triangle, u, v):
    """First and last slice of each triangle within its column: its plane over the column, within its corners."""
    edge1, edge2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    area = _cross(edge1, edge2)
    flat = np.abs(area) > 1e-12
    safe = np.where(flat, area, 1.0)
    slope_u = np.where(flat, (edge1[:, 2] * edge2[:, 1] - edge2[:, 2] * edge1[:, 1]) / safe, 0.0)
    slope_v = np.where(flat, (edge2[:, 2] * edge1[:, 0] - edge1[:, 2] * edge2[:, 0]) / safe, 0.0)
    reach = np.where(flat, (0.5 + _MARGIN) * (np.abs(slope_u) + np.abs(slope_v)), np.inf)
    centre = points[:, 0, 2] - slope_u * (points[:, 0, 0] - 0.5) - slope_v * (points[:, 0, 1] - 0.5)
    plane = centre[triangle] + slope_u[triangle] * u + slope_v[triangle] * v
    lowest = np.maximum(plane - reach[triangle], points[..., 2].min(axis=1)[triangle]) - _MARGIN
    highest = np.minimum(plane + reach[triangle], points[..., 2].max(axis=1)[triangle]) + _MARGIN
    first = np.clip(np.floor(np.minimum(lowest, highest)), 0, SLICES - 1).astype(np.int64)
    last = np.clip(np.floor(np.maximum(lowest, highest)), 0, SLICES - 1).astype(np.int64)
    return first, last


def _slice_words(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """(N, 2) uint32 with the bits of slices `first` to `last` set."""
    bits = np.uint64(0xFFFFFFFFFFFFFFFF)
    span = (bits >> (63 - (last - first)).astype(np.uint64)) << first.astype(np.uint64)
    return np.stack([span & np.uint64(0xFFFFFFFF), span >> np.uint64(32)], axis=1).astype(np.uint32)


def _pyramid(finest: np.ndarray, shape: np.ndarray) -> list[np.ndarray]:
    """The finest level and every coarser one, down to a single node; each ORs the words of 2 × 2 finer nodes."""
    levels = [finest]
    words = finest[:, :2].reshape(shape[1], shape[0], 2)
    while words.shape[0] * words.shape[1] > 1:
        rows, columns = (-(-words.shape[0] // 2), -(-words.shape[1] // 2))
        padded = np.zeros((2 * rows, 2 * columns, 2), np.uint32)
        padded[: words.shape[0], : words.shape[1]] = words
        words = np.bitwise_or.reduce(padded.reshape(rows, 2, columns, 2, 2), axis=(1, 3))
        level = np.zeros((rows * columns, 4), np.uint32)
        level[:, :2] = words.reshape(-1, 2)
        levels.append(level)
    return levels
