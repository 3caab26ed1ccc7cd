"""An evaluated Blender mesh as arrays, without a loop in Python over its elements."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ..scene import Mesh
from ..scene.soundness import check_positions, face_normals, solid_triangles, unit_normals
from .materials_lookup import IDENTITY, Coordinates, Lookup


@dataclass(frozen=True)
class Surfacing:
    """What a material slot asks of the mesh: where it looks textures up, and its colour attribute (None: none)."""

    lookup: Lookup
    attribute: str | None


def read_mesh(mesh: bpy.types.Mesh, surfacings: Sequence[Surfacing]) -> Mesh:
    """`mesh` with the texture coordinates and colours of one surfacing per material slot.

    Raises `Empty` if it has no triangles, only degenerate ones, or a coordinate that is not a number.
    """
    positions = _get(mesh.vertices, "co", 3)
    check_positions(positions)
    mesh.calc_loop_triangles()
    triangles = _get(mesh.loop_triangles, "vertices", 3, np.int32)
    crosses, solid = solid_triangles(positions[triangles])
    if solid.all():
        solid = slice(None)  # keeps every step below from copying
    triangles, crosses = triangles[solid], crosses[solid]
    loops = _get(mesh.loop_triangles, "loops", 3, np.int32)[solid]
    slots = _get(mesh.loop_triangles, "material_index", 1, np.int32)[solid, 0]
    slots = np.clip(slots, 0, len(surfacings) - 1)
    corners = _Corners(mesh, positions, triangles, loops, solid)
    return Mesh(
        name=mesh.name,
        positions=positions,
        triangles=triangles,
        normals=_normals(mesh, triangles, loops, crosses, solid),
        uvs=_uvs(corners, surfacings, slots),
        slots=slots,
        colors=_colors(corners, surfacings, slots),
    )


def _get(collection, name: str, width: int, dtype=np.float32) -> np.ndarray:
    """(len(collection), width) of one property of every element."""
    values = np.empty(len(collection) * width, dtype=dtype)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def _normals(
    mesh: bpy.types.Mesh, triangles: np.ndarray, loops: np.ndarray, crosses: np.ndarray, kept: np.ndarray | slice
) -> np.ndarray:
    """(T, 3, 3) unit normals of the corners.

    They are those of Cycles, which for reflections on quads that are not plane is not quite what the viewport
    shows: a mesh that is flat all over is shaded by each triangle's own normal, not its polygon's. Before 5.0
    so are the flat faces of any mesh without custom normals, and they do not part the smooth faces beside them.
    """
    faces = face_normals(crosses)
    if mesh.normals_domain == "FACE":
        return np.repeat(faces[:, None], 3, axis=1).astype(np.float32)
    flat_by_triangle = bpy.app.version < (5, 0) and not mesh.has_custom_normals
    if flat_by_triangle and "sharp_edge" not in mesh.attributes:
        normals = _get(mesh.vertex_normals, "vector", 3)[triangles]
    else:
        normals = _get(mesh.corner_normals, "vector", 3)[loops]
    smooth = _get(mesh.loop_triangles, "use_smooth", 1, np.bool_)[kept, :, None] if flat_by_triangle else True
    return unit_normals(normals, faces, smooth)


class _Corners:
    """Values at the corners of a mesh's triangles, read on demand."""

    def __init__(
        self,
        mesh: bpy.types.Mesh,
        positions: np.ndarray,
        triangles: np.ndarray,
        loops: np.ndarray,
        kept: np.ndarray | slice,
    ) -> None:
        """`kept` says which of the mesh's loop triangles `triangles` and `loops` are."""
        self.mesh, self.positions, self.triangles, self.loops, self.kept = mesh, positions, triangles, loops, kept

    def __len__(self) -> int:
        return len(self.triangles)

    def coordinates(self, lookup: Lookup, chosen: np.ndarray | slice) -> np.ndarray:
        """(N, 3, 3) what `lookup` starts from, at the corners of the chosen triangles."""
        if lookup.coordinates is Coordinates.OBJECT:
            return self.positions[self.triangles[chosen]]
        if lookup.coordinates is Coordinates.GENERATED:
            location, size = np.array(self.mesh.texspace_location), np.array(self.mesh.texspace_size)
            rest = _get(self.mesh.vertices, "undeformed_co", 3)
            generated = (rest - location) / (2.0 * np.where(size == 0.0, 1.0, size)) + 0.5
            return generated.astype(np.float32)[self.triangles[chosen]]
        found = self.uv_map(lookup.name, chosen) if lookup.coordinates is Coordinates.UV else None
        count = len(self.triangles[chosen])
        return np.zeros((count, 3, 3), np.float32) if found is None else found

    def uv_map(self, name: str, chosen: np.ndarray | slice) -> np.ndarray | None:
        """(N, 3, 3) of a UV map (or another attribute of that name), third coordinate 0; None if there is none."""
        layers = self.mesh.uv_layers
        layer = layers.get(name) if name else next((layer for layer in layers if layer.active_render), None)
        if layer is None:
            return self.attribute(name, chosen, 3) if name else None
        flat = _get(layer.uv, "vector", 2)[self.loops[chosen]]
        return np.concatenate([flat, np.zeros_like(flat[..., :1])], axis=2)

    def attribute(self, name: str, chosen: np.ndarray | slice, width: int) -> np.ndarray | None:
        """(N, 3, width) of an attribute of points, corners or faces; None if there is none that fits.

        A float counts for every component, a missing last one (alpha) is 1, as in Cycles.
        """
        attribute = self.mesh.attributes.get(name)
        reading = attribute and _READINGS.get(attribute.data_type)
        if not reading:
            return None
        values = _get(attribute.data, *reading)
        if reading[1] == 1:
            values = values.repeat(3, axis=1)
        missing = np.ones if width == 4 else np.zeros
        filler = missing((len(values), max(width - values.shape[1], 0)), np.float32)
        values = np.concatenate([values[:, :width], filler], axis=1)
        if attribute.domain == "POINT":
            return values[self.triangles[chosen]]
        if attribute.domain == "CORNER":
            return values[self.loops[chosen]]
        if attribute.domain == "FACE":
            polygons = _get(self.mesh.loop_triangles, "polygon_index", 1, np.int32)[self.kept, 0]
            return values[polygons[chosen]][:, None].repeat(3, axis=1)
        return None


_READINGS = {
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),  # Blender hands bytes out decoded, scene-linear
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT2": ("vector", 2),
    "FLOAT": ("value", 1),
}


def _uvs(corners: _Corners, surfacings: Sequence[Surfacing], slots: np.ndarray) -> np.ndarray:
    """(T, 3, 2) float32: each triangle's coordinates as its own material's texture sees them."""
    uvs = np.zeros((len(corners), 3, 2), np.float32)
    for lookup, chosen in _by_slot([surfacing.lookup for surfacing in surfacings], slots):
        coordinates = corners.coordinates(lookup, chosen)
        if lookup.rows == IDENTITY:
            uvs[chosen] = coordinates[..., :2]
        else:
            rows = np.array(lookup.rows)[:2]
            uvs[chosen] = coordinates @ rows[:, :3].T + rows[:, 3]
    return uvs


def _colors(corners: _Corners, surfacings: Sequence[Surfacing], slots: np.ndarray) -> np.ndarray | None:
    """(T, 3, 4) float32: each triangle's attribute, black where the mesh lacks it, as in Cycles; None if unused."""
    names = [surfacing.attribute for surfacing in surfacings]
    if all(name is None for name in names):
        return None
    colors = np.ones((len(corners), 3, 4), np.float32)
    for name, chosen in _by_slot(names, slots):
        if name is None:
            continue
        active = corners.mesh.color_attributes
        name = name or (active[active.render_color_index].name if len(active) else "")
        found = corners.attribute(name, chosen, 4)
        colors[chosen] = 0.0 if found is None else found
    return colors


def _by_slot(values: Sequence, slots: np.ndarray):
    """Each different value, with the triangles that it holds for."""
    distinct = list(dict.fromkeys(values))
    if len(distinct) == 1:
        yield distinct[0], slice(None)
        return
    kinds = np.array([distinct.index(value) for value in values])[slots]
    for number, value in enumerate(distinct):
        chosen = np.flatnonzero(kinds == number)
        if len(chosen):
            yield value, chosen
