"""An automatic second UV layer: where in a lightmap each triangle lies."""

import itertools

import bpy
import numpy as np

from ..scene import Mesh
from .lightmap_stage import triangle_mesh

_STEEPEST = 0.9
"""Radians between a chart and its plane: flat enough that a chart hardly ever folds over itself."""

_GAPS = (1.5, 0.75, 0.4)
"""Texels around every chart, and so twice that between two; less where there are too many charts."""

_LEAST_USE = 0.08
"""The share of the image that must hold charts; below it the gaps have eaten it up."""


_EVEN = (0.3, 0.45, 0.6, 0.8)
"""The share of texels along each side that is dealt out evenly: it keeps charts apart where little is seen."""

_STRIPS = 64
"""Columns and rows of the image that may be widened or narrowed, each as a whole."""

_SMOOTH = np.hanning(13)[1:-1] / np.hanning(13).sum()
"""How widening spreads over strips: a long thin triangle turns over where it changes within the triangle."""


def unwrap(mesh: Mesh, size: int, seen: np.ndarray | None = None) -> np.ndarray:
    """Lightmap coordinates of `mesh` for an image of `size` texels a side: (T, 3, 2) float32 in 0..1.

    Charts do not overlap, and lie three texels apart as long as there is room. Blender's smart
    projection makes them; where a mesh falls to pieces under it, each triangle is a chart. With
    `seen` (T,), how large a metre of each triangle appears, columns and rows of the image are
    widened where they hold what appears large.
    """
    uvs = _charts(mesh, size)
    return uvs if seen is None else _widened(uvs, seen)


def _widened(uvs: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Each side stretched by a monotone map, as far as no triangle turns over, so that none come to overlap."""
    before = _doubled_areas(uvs)
    for even in _EVEN:
        wide = np.stack([_stretched(uvs[..., axis], seen, even) for axis in (0, 1)], axis=-1).astype(np.float32)
        if not ((before * _doubled_areas(wide) < 0) & (np.abs(before) > 1e-12)).any():
            return wide
    return uvs


def _stretched(places: np.ndarray, seen: np.ndarray, even: float) -> np.ndarray:
    edges = np.linspace(0.0, 1.0, _STRIPS + 1)
    low, high = places.min(axis=1), places.max(axis=1)
    held = [(low < right) & (high > left) for left, right in itertools.pairwise(edges)]
    largest = np.array([seen[inside].max(initial=0.0) for inside in held])
    largest = np.convolve(np.pad(largest, len(_SMOOTH) // 2, mode="edge"), _SMOOTH, "valid")
    widths = even + (1.0 - even) * largest / max(largest.mean(), 1e-30)
    return np.interp(places, edges, np.concatenate([[0.0], np.cumsum(widths)]) / widths.sum())


def _charts(mesh: Mesh, size: int) -> np.ndarray:
    a, b, c = mesh.triangles.T
    sound = (a != b) & (b != c) & (c != a)  # of a mesh without any, the projection never returns
    uvs = np.zeros((len(sound), 3, 2), np.float32)
    for gap in _GAPS if sound.any() else ():
        projected = _smart_project(mesh.positions, mesh.triangles[sound], gap / size)
        if projected is not None and _fits(projected):
            uvs[sound] = projected
            return uvs
    return _one_by_one(len(sound), size)


def _fits(uvs: np.ndarray) -> bool:
    return uvs.min() >= 0.0 and uvs.max() <= 1.0 and np.abs(_doubled_areas(uvs)).sum() / 2 >= _LEAST_USE


def _doubled_areas(uvs: np.ndarray) -> np.ndarray:
    """Twice the signed area of each triangle, (T,)."""
    (ux, uy), (vx, vy) = (uvs[:, 1] - uvs[:, 0]).T, (uvs[:, 2] - uvs[:, 0]).T
    return ux * vy - uy * vx


def _smart_project(positions: np.ndarray, triangles: np.ndarray, margin: float) -> np.ndarray | None:
    """Blender's smart projection, on a copy in a scene of its own; None if Blender refuses a triangle."""
    scene = bpy.data.scenes.new("Catoptric unwrap")
    data = triangle_mesh("Catoptric unwrap", positions, triangles)
    holder = bpy.data.objects.new("Catoptric unwrap", data)
    try:
        data.uv_layers.new(name="UVMap")
        scene.collection.objects.link(holder)
        layer = scene.view_layers[0]
        layer.objects.active = holder
        holder.select_set(True, view_layer=layer)
        shown = {"scene": scene, "view_layer": layer, "object": holder, "active_object": holder}
        with bpy.context.temp_override(**shown):
            bpy.ops.object.mode_set(mode="EDIT")
        with bpy.context.temp_override(**shown, edit_object=holder):
            bpy.ops.mesh.select_all(action="SELECT")
            bpy.ops.uv.smart_project(angle_limit=_STEEPEST, island_margin=margin, margin_method="FRACTION")
        with bpy.context.temp_override(**shown):
            bpy.ops.object.mode_set(mode="OBJECT")
        if len(data.polygons) != len(triangles):
            return None
        uvs = np.empty(6 * len(triangles), np.float32)
        data.uv_layers[0].data.foreach_get("uv", uvs)
        return uvs.reshape(-1, 3, 2)
    finally:
        bpy.data.objects.remove(holder)
        bpy.data.meshes.remove(data)
        bpy.data.scenes.remove(scene)


def _one_by_one(count: int, size: int) -> np.ndarray:
    """Every triangle in a cell of its own, two to a square, as far apart as there is room."""
    side = int(np.ceil(np.sqrt((count + 1) // 2)))
    gap = min(_GAPS[0] * side / size, 0.2)
    lower = np.array([[gap, gap], [1 - 2.5 * gap, gap], [gap, 1 - 2.5 * gap]])
    corners = np.stack([lower, 1.0 - lower])
    number = np.arange(count)
    cells = np.stack([number // 2 % side, number // 2 // side], axis=-1)
    return ((corners[number % 2] + cells[:, None]) / side).astype(np.float32)
