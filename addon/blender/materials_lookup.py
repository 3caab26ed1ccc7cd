"""Where a material looks its texture up: the Vector input of an Image Texture node."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import bpy
import numpy as np

from .nodes import Plug, Source, Unsupported, source

Rows = tuple[tuple[float, float, float, float], ...]

IDENTITY: Rows = tuple(tuple(row) for row in np.eye(4)[:3].tolist())


class Coordinates(StrEnum):
    """What the texture sticks to."""

    UV = "uv"
    GENERATED = "generated"
    OBJECT = "object"
    NOTHING = "nothing"


@dataclass(frozen=True)
class Lookup:
    """Coordinates and an affine map (three rows of four) behind them.

    `name` is the UV map (empty: the one active for renders) or, with OBJECT, the object whose space
    is meant (empty: its own). NOTHING looks up one fixed point.
    """

    coordinates: Coordinates = Coordinates.UV
    name: str = ""
    rows: Rows = IDENTITY


def read_lookup(plug: Plug, vector: Callable[[Plug], tuple[float, float, float]]) -> Lookup:
    """The lookup behind a Vector socket; `vector` reads three constants. Raises `Unsupported`."""
    matrix, first = np.eye(4), True
    while True:
        found = source(plug)
        if found.node is None:
            # Only an Image Texture's own unlinked Vector means the UV map; elsewhere it is a value.
            if first:
                return Lookup(rows=_rows(matrix))
            matrix[:3, 3] += matrix[:3, :3] @ found.socket.default_value[:3]
            matrix[:3, :3] = 0.0
            return Lookup(Coordinates.NOTHING, rows=_rows(matrix))
        if found.node.bl_idname != "ShaderNodeMapping":
            return _coordinates(found, _rows(matrix))
        matrix = matrix @ _mapping(found, vector)
        plug, first = found.input("Vector"), False


def _rows(matrix: np.ndarray) -> Rows:
    return tuple(tuple(row) for row in matrix[:3].tolist())


def _coordinates(found: Source, rows: Rows) -> Lookup:
    node, output = found.node, found.socket.name
    if getattr(node, "from_instancer", False):
        raise Unsupported(node, "takes its coordinates from the instancer, which is not supported")
    if node.bl_idname == "ShaderNodeUVMap":
        return Lookup(Coordinates.UV, node.uv_map, rows)
    if node.bl_idname == "ShaderNodeAttribute" and node.attribute_type == "GEOMETRY" and output in {"Vector", "Color"}:
        return Lookup(Coordinates.UV, node.attribute_name, rows)
    if node.bl_idname == "ShaderNodeTexCoord" and output in {"UV", "Generated"}:
        return Lookup(Coordinates(output.lower()), "", rows)
    if node.bl_idname == "ShaderNodeTexCoord" and output == "Object":
        return Lookup(Coordinates.OBJECT, node.object.name_full if node.object else "", rows)
    raise Unsupported(node, f"gives texture coordinates ({output}) that are not supported")


def _mapping(found: Source, vector: Callable) -> np.ndarray:
    """(4, 4) of a Mapping node: scaled, turned about X, Y, Z, moved; TEXTURE undoes just that."""
    node = found.node
    if node.vector_type == "NORMAL":
        raise Unsupported(node, "maps normals, which is not supported")
    location, rotation, scale = (np.array(vector(found.input(name))) for name in ("Location", "Rotation", "Scale"))
    matrix = np.eye(4)
    matrix[:3, :3] = _euler(rotation)
    if node.vector_type == "TEXTURE":
        # Cycles gives 0 where it would divide by 0.
        shrunk = np.diag(np.divide(1.0, scale, out=np.zeros(3), where=scale != 0.0))
        matrix[:3, :3] = shrunk @ matrix[:3, :3].T
        matrix[:3, 3] = -matrix[:3, :3] @ location
        return matrix
    matrix[:3, :3] = matrix[:3, :3] @ np.diag(scale)
    # Cycles gives 0 where nothing is left of the vector, and does not move it then.
    if node.vector_type == "POINT" and scale.any():
        matrix[:3, 3] = location
    return matrix


def _euler(angles: np.ndarray) -> np.ndarray:
    """(3, 3) rotation about X, then Y, then Z."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return z @ y @ x


def object_space(lookup: Lookup, matrix: np.ndarray, evaluated: Callable[[str], bpy.types.Object | None]) -> Lookup:
    """`lookup` with another object's space turned into the mesh's own, for an instance at `matrix` (4, 4)."""
    if lookup.coordinates is not Coordinates.OBJECT or not lookup.name:
        return lookup
    other = evaluated(lookup.name)
    if other is None:
        return Lookup(Coordinates.OBJECT, "", lookup.rows)
    to_other = np.linalg.inv(np.array(other.matrix_world, dtype=np.float64)) @ matrix
    return Lookup(Coordinates.OBJECT, "", _rows(np.array([*lookup.rows, (0.0, 0.0, 0.0, 1.0)]) @ to_other))
