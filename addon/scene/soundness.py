"""What of a scene can be drawn, and what is left out because its numbers place or show nothing."""

import operator
from dataclasses import replace

import numpy as np

from ..errors import SceneError
from .mesh import Instance, Mesh
from .scene import Scene

NOWHERE = "has a scale of zero"

_SLIVER = 1e-8
"""Twice a triangle's area over its longest edge squared, below which it is a line: under a float's precision."""


class Empty(Exception):
    """A mesh has nothing to draw; the message says why."""


def is_placed(matrix: np.ndarray) -> bool:
    """Whether a matrix (4, 4) puts a mesh somewhere, without flattening it."""
    return bool(np.isfinite(matrix).all()) and int(np.linalg.matrix_rank(matrix[:3, :3], tol=1e-12)) == 3


def check_positions(positions: np.ndarray) -> None:
    """Raise `Empty` if a coordinate of (V, 3) is not a number."""
    if not np.isfinite(positions).all():
        raise Empty("has vertices that are not numbers (NaN or infinite)")


def solid_triangles(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of triangles (T, 3, 3): cross products of two edges (T, 3), and (T,) whether there is an area.

    Raises `Empty` if no triangle has one.
    """
    if not len(corners):
        raise Empty("has no faces")
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    crosses = np.cross(first, second)
    third = second - first
    longest = np.maximum.reduce([np.einsum("ij,ij->i", edge, edge) for edge in (first, second, third)])
    area = np.sqrt(np.einsum("ij,ij->i", crosses, crosses))
    solid = area > _SLIVER * longest
    if not solid.any():
        raise Empty("has only faces without area")
    return crosses, solid


def face_normals(crosses: np.ndarray) -> np.ndarray:
    """(T, 3) of triangles from cross products of their edges."""
    return crosses / np.maximum(np.linalg.norm(crosses, axis=1, keepdims=True), np.finfo(np.float32).tiny)


def unit_normals(normals: np.ndarray, faces: np.ndarray, smooth: np.ndarray | bool = True) -> np.ndarray:
    """(T, 3, 3) float32: shading normals at unit length; those of the faces (T, 3) where one is no direction.

    So do all triangles have that are not `smooth` (T, 1, 1).
    """
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    used = np.isfinite(lengths) & (lengths > 0.5) & smooth
    return np.where(used, normals / np.where(used, lengths, 1.0), faces[:, None]).astype(np.float32)


def sound(scene: Scene) -> Scene:
    """The scene without what cannot be drawn, each of it named in `warnings`; itself where there is nothing such.

    What Blender made has been looked through when it was read: this is for a file that anyone may have written.
    Raises `SceneError` if the camera is nowhere.
    """
    if not np.isfinite(scene.camera.matrix).all():
        raise SceneError(f"{scene.name}: the camera's place is not a number; export the scene again")
    meshes, faults = list(scene.meshes), {}
    for index, mesh in enumerate(scene.meshes):
        try:
            meshes[index] = _mended(mesh)
        except Empty as fault:
            faults[index] = str(fault)
    lost = {one: fault for one in scene.instances if (fault := faults.get(one.mesh) or _fault(one))}
    dark = [lamp for lamp in scene.lamps if not np.isfinite(lamp.matrix).all()]
    if not lost and not dark and not faults and all(map(operator.is_, meshes, scene.meshes)):
        return scene
    warnings = [f'object "{one.name}": {fault}; it is left out' for one, fault in lost.items()]
    warnings += [f'lamp "{lamp.name}": its place is not a number; it is left out' for lamp in dark]
    kept = [index for index in range(len(meshes)) if index not in faults]
    places = {index: place for place, index in enumerate(kept)}
    return replace(
        scene,
        meshes=tuple(meshes[index] for index in kept),
        instances=tuple(replace(one, mesh=places[one.mesh]) for one in scene.instances if one not in lost),
        lamps=tuple(lamp for lamp in scene.lamps if lamp not in dark),
        warnings=(*scene.warnings, *warnings),
    )


def _fault(one: Instance) -> str | None:
    return None if is_placed(one.matrix) else NOWHERE


def _mended(mesh: Mesh) -> Mesh:
    """The mesh itself, or with directions for normals where it has others; raises `Empty`."""
    check_positions(mesh.positions)
    crosses, _ = solid_triangles(mesh.corners)
    lengths = np.linalg.norm(mesh.normals, axis=2)
    if (np.abs(lengths - 1.0) < 0.5).all():
        return mesh
    return replace(mesh, normals=unit_normals(mesh.normals, face_normals(crosses)))
