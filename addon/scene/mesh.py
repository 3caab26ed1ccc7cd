"""Triangles and where they stand."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh in its own space, in metres. T triangles, V vertices.

    `positions` (V, 3) float32; `triangles` (T, 3) int32 into them; `normals` (T, 3, 3) float32 unit
    shading normals of each corner (flat, smooth or custom, as Blender evaluated them); `uvs`
    (T, 3, 2) float32, the coordinates that the triangle's own material looks its textures up with;
    `lightmap_uvs` (T, 3, 2) float32 in 0..1 without overlaps, or None; `colors` (T, 3, 4) float32
    scene-linear vertex colours, or None; `slots` (T,) int32, which of the instance's materials.
    """

    name: str
    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    slots: np.ndarray
    lightmap_uvs: np.ndarray | None = None
    colors: np.ndarray | None = None

    @cached_property
    def corners(self) -> np.ndarray:
        """(T, 3, 3) float32 positions of the corners of every triangle."""
        return self.positions[self.triangles]

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) float32: the least and the greatest corner of the box around the triangles."""
        corners = self.corners.reshape(-1, 3)
        return np.stack([corners.min(axis=0), corners.max(axis=0)])


@dataclass(frozen=True, eq=False)
class Instance:
    """A mesh placed in the world.

    `mesh` is an index into `Scene.meshes`, `materials` indices into `Scene.materials` (one per
    slot of the mesh), `matrix` (4, 4) float64 from the mesh's space to the world. `reflector` says
    that a mirror image is to be drawn on it; `in_reflections` and `in_camera` that rays of that
    kind see it. `lightmap` is an index into `Scene.images`, or None.
    """

    name: str
    mesh: int
    matrix: np.ndarray
    materials: tuple[int, ...]
    reflector: bool = False
    in_reflections: bool = True
    in_camera: bool = True
    lightmap: int | None = None
