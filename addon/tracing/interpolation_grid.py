"""A coarse grid around a mesh, so that little has to be searched and the rest is interpolated."""

from dataclasses import dataclass

import numpy as np

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
"""Of a cell: bit 0 of a corner's number is its place along x, bit 1 along y, bit 2 along z."""


@dataclass(frozen=True, eq=False)
class InterpolationGrid:
    """The cells of a regular isothetic grid that hold a mesh's vertices (Estalella et al., 5). V vertices.

    `corners` (G, 3) float32 are the grid vertices, in the mesh's space; `cells` (C, 8) int32 which of them each cell
    has, x fastest; `cell` (V,) int32 the cell of each vertex and `place` (V, 3) float32 where it is in there, 0 to 1.
    """

    corners: np.ndarray
    cells: np.ndarray
    cell: np.ndarray
    place: np.ndarray

    @property
    def weights(self) -> np.ndarray:
        """(V, 8) float64 how much of each corner of its cell a vertex has, trilinearly."""
        place = self.place[:, None].astype(np.float64)
        return np.where(CORNERS, place, 1.0 - place).prod(axis=2)


def interpolation_grid(points: np.ndarray, share: float) -> InterpolationGrid:
    """A grid around `points` (V, 3), all finite, with as many vertices as `share` (0 to 1) of theirs, but one cell.

    Cells are as near cubes as whole numbers of them allow; where the points lie in a plane across an axis, cells have
    no height there and but four corners. Of the numbers of cells along the longest axis it is the last before the
    grid vertices are more than asked for.
    """
    points = np.asarray(points, np.float64)
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    most = share * len(points)
    fewest, too_many = 1, 2
    # Of points that coincide there are never enough.
    while too_many <= len(points) and _corner_count(points, low, _shape(extent, too_many), extent) <= most:
        fewest, too_many = too_many, 2 * too_many
    while too_many - fewest > 1:
        middle = (fewest + too_many) // 2
        if _corner_count(points, low, _shape(extent, middle), extent) <= most:
            fewest = middle
        else:
            too_many = middle
    return _grid(points, low, _shape(extent, fewest), extent)


def _shape(extent: np.ndarray, longest: int) -> np.ndarray:
    """(3,) cells along each axis, `longest` along the longest; 0 where there is no extent."""
    size = max(float(extent.max()), 1e-30) / longest
    return np.where(extent > 0.0, np.maximum(1, np.round(extent / size)), 0).astype(np.int64)


def _places(points: np.ndarray, low: np.ndarray, shape: np.ndarray, extent: np.ndarray) -> tuple[np.ndarray, ...]:
    """(V, 3) the cell of each point, counted along the axes, and (V, 3) where it is in there."""
    at = (points - low) / np.where(extent > 0.0, extent, 1.0) * shape
    cell = np.clip(np.floor(at), 0, np.maximum(shape - 1, 0)).astype(np.int64)
    return cell, np.clip(at - cell, 0.0, 1.0)


def _occupied(cell: np.ndarray, shape: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(C, 8) numbers that tell grid vertices apart, of the cells that hold points; (V,) which of these holds each."""
    cells, of_point = np.unique(np.ravel_multi_index(cell.T, np.maximum(shape, 1)), return_inverse=True)
    cells = np.stack(np.unravel_index(cells, np.maximum(shape, 1)), axis=1)
    corners = np.minimum(cells[:, None] + CORNERS, shape)
    return np.ravel_multi_index(tuple(np.moveaxis(corners, 2, 0)), shape + 1), of_point.reshape(-1)


def _corner_count(points: np.ndarray, low: np.ndarray, shape: np.ndarray, extent: np.ndarray) -> int:
    return len(np.unique(_occupied(_places(points, low, shape, extent)[0], shape)[0]))


def _grid(points: np.ndarray, low: np.ndarray, shape: np.ndarray, extent: np.ndarray) -> InterpolationGrid:
    cell, place = _places(points, low, shape, extent)
    names, of_point = _occupied(cell, shape)
    kept, cells = np.unique(names, return_inverse=True)
    steps = np.stack(np.unravel_index(kept, shape + 1), axis=1)
    corners = low + steps / np.maximum(shape, 1) * extent
    return InterpolationGrid(
        corners.astype(np.float32),
        cells.reshape(-1, 8).astype(np.int32),
        of_point.astype(np.int32),
        place.astype(np.float32),
    )
