"""Layered depth textures whose texels hold triangles: what `layered-depth` and shadow rays search.

A layered depth texture (Zhang et al., 3.3, 3.4) shows an object from a face of its box, by samples at
texel centres. Here a texel is a *column* cut into slices of depth, and each slice lists the triangles
that pass through it instead of a sample of one. A search then meets the surface itself: thin parts
and open meshes cannot be stepped over, surfaces seen edge-on are there as well, so one face does the
work of six, and texel size decides speed alone. A pyramid tells which slices of a block of columns
hold anything.
"""

from dataclasses import dataclass

import numpy as np

SLICES = 64
"""Depth slices of a column: two 32-bit words; gpu_shaders/common/layers.glsl holds the same number."""

LARGEST = 256
"""Most columns along a side."""

_MARGIN = 0.01
"""Columns by which a triangle is widened, so that rounding in the search cannot miss it."""

_CHUNK = 1 << 22


@dataclass(frozen=True, eq=False)
class Layers:
    """The columns of a mesh in the box from `low` to `low + size`, (3,) float64 each.

    Depth runs along `axis`, the box's shortest, u along axis + 1 and v along axis + 2 (modulo 3).
    `shape` is columns along u and v, `levels` those of the pyramid. `nodes` (N, 3) uint32, finest
    level first, u fastest: occupied slices (two words) and, at the finest level, the span of the
    first of them; the others' follow. `spans` (S, 2) uint32: first entry and how many. `entries`
    (E,) uint32 triangle indices.
    """

    low: np.ndarray
    size: np.ndarray
    axis: int
    shape: tuple[int, int]
    levels: int
    nodes: np.ndarray
    spans: np.ndarray
    entries: np.ndarray


def build(corners: np.ndarray, largest: int = LARGEST) -> Layers:
    """The layers of a mesh from its corners (T, 3, 3), T ≥ 1; at most `largest` columns along a side."""
    low, size = padded_box(corners)
    axis = depth_axis(size)
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    across = size[order[:2]]
    shape = np.maximum(1, np.ceil(_side(len(corners), largest) * across / across.max())).astype(np.int64)
    points = ((corners.astype(np.float64) - low) / size)[:, :, order] * [*shape, SLICES]
    finest, spans, entries = _columns(*_overlaps(points, shape), shape)
    levels = _pyramid(finest, shape)
    return Layers(low, size, axis, (int(shape[0]), int(shape[1])), len(levels), np.concatenate(levels), spans, entries)


def depth_axis(size: np.ndarray) -> int:
    """Along which axis of a box of that size, (3,), depth runs."""
    return int(size.argmin())


def padded_box(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Low corner and size, (3,) float64, of the box around triangles (T, 3, 3), which none of them touches."""
    low, high = corners.min(axis=(0, 1)).astype(np.float64), corners.max(axis=(0, 1)).astype(np.float64)
    pad = np.maximum(1e-4 * (high - low).max(), 1e-6 * np.abs([low, high]).max() + 1e-9)
    return low - pad, high - low + 2 * pad


def _side(triangles: int, largest: int) -> int:
    """Columns along the longer side: a few columns for each triangle."""
    return int(min(largest, 2 ** np.ceil(np.log2(4.0 * np.sqrt(triangles)))))


def _columns(column, triangle, first, last, shape) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Finest nodes, spans and entries from each column that a triangle passes, and its slices there."""
    count = last - first + 1
    pair = np.repeat(np.arange(len(column)), count)
    depth = first[pair] + np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
    cell = column[pair] * SLICES + depth
    by_cell = np.argsort(cell, kind="stable")
    cells, start, length = np.unique(cell[by_cell], return_index=True, return_counts=True)
    finest = np.zeros((shape.prod(), 3), np.uint32)
    columns, begin = np.unique(cells // SLICES, return_index=True)
    bits = np.uint64(1) << (cells % SLICES).astype(np.uint64)
    words = np.bitwise_or.reduceat(bits, begin)
    finest[columns, 0], finest[columns, 1] = words & np.uint64(0xFFFFFFFF), words >> np.uint64(32)
    finest[columns, 2] = begin
    spans = np.stack([start, length], axis=1).astype(np.uint32)
    return finest, spans, triangle[pair[by_cell]].astype(np.uint32)


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


def _pyramid(finest: np.ndarray, shape: np.ndarray) -> list[np.ndarray]:
    """The finest level and every coarser one, down to a single node; each ORs the words of 2 × 2 finer nodes."""
    levels = [finest]
    words = finest[:, :2].reshape(shape[1], shape[0], 2)
    while words.shape[0] * words.shape[1] > 1:
        rows, columns = (-(-words.shape[0] // 2), -(-words.shape[1] // 2))
        padded = np.zeros((2 * rows, 2 * columns, 2), np.uint32)
        padded[: words.shape[0], : words.shape[1]] = words
        words = np.bitwise_or.reduce(padded.reshape(rows, 2, columns, 2, 2), axis=(1, 3))
        level = np.zeros((rows * columns, 3), np.uint32)
        level[:, :2] = words.reshape(-1, 2)
        levels.append(level)
    return levels
