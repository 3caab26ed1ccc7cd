"""The camera and the lamps."""

import bpy
import numpy as np

from ..errors import SceneError
from ..scene import Camera, Lamp, LampKind, SensorFit
from .materials_colors import read_constant, read_constant_vector
from .nodes import Unsupported, source, surface_plug, tree_in_use
from .notes import Notes


def read_camera(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, notes: Notes) -> Camera:
    """The scene's camera, which `check_camera` has passed."""
    holder = scene.camera.evaluated_get(depsgraph)
    data, render = holder.data, scene.render
    if data.dof.use_dof:
        notes.add(f'camera "{holder.name}"', "depth of field is not supported; everything is sharp")
    return Camera(
        matrix=unscaled(np.array(holder.matrix_world, dtype=np.float64)),
        lens=data.lens,
        sensor=(data.sensor_width, data.sensor_height),
        sensor_fit=SensorFit(data.sensor_fit),
        shift=(data.shift_x, data.shift_y),
        ortho_scale=data.ortho_scale if data.type == "ORTHO" else None,
        near=data.clip_start,
        far=data.clip_end,
        pixel_aspect=render.pixel_aspect_y / render.pixel_aspect_x,
    )


def check_camera(scene: bpy.types.Scene) -> None:
    """Raise `SceneError` unless `scene` has a camera that the methods can draw with."""
    holder = scene.camera
    if holder is None or holder.type != "CAMERA":
        raise SceneError(f'scene "{scene.name}" has no camera; add one and make it active (Ctrl+Numpad 0)')
    if holder.data.type not in {"PERSP", "ORTHO"}:
        kind = {"PANO": "panoramic"}.get(holder.data.type, holder.data.type.lower())
        raise SceneError(f'camera "{holder.name}" is {kind}; make it perspective or orthographic')


def unscaled(matrix: np.ndarray) -> np.ndarray:
    """(4, 4) with the scale taken out of its axes, as Blender does with cameras and lamps."""
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    result = matrix.copy()
    result[:3, :3] /= np.where(lengths == 0.0, 1.0, lengths)
    return result


def read_lamp(holder: bpy.types.Object, matrix: np.ndarray, name: str, notes: Notes) -> Lamp:
    """An evaluated light object placed at `matrix` (4, 4)."""
    data = holder.data
    kind = LampKind[data.type]
    color = np.array(data.color) * data.energy * 2.0 ** getattr(data, "exposure", 0.0)
    if getattr(data, "use_temperature", False):
        color *= np.array(data.temperature_color)[:3]
    color *= _node_factor(data, notes)
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    size = _size(data, kind, scale)
    if not getattr(data, "normalize", True):
        color *= _shining_area(kind, size)
    if kind is LampKind.AREA and data.shape in {"DISK", "ELLIPSE"}:
        notes.add(f'light "{data.name}"', f"{data.shape.lower()} area is not supported; a rectangle as large is used")
    return Lamp(
        name=name,
        kind=kind,
        matrix=unscaled(matrix),
        color=tuple(float(channel) for channel in color),
        size=size,
        cone=(data.spot_size / 2.0, data.spot_blend) if kind is LampKind.SPOT else (0.785, 0.15),
    )


def _size(data: bpy.types.Light, kind: LampKind, scale: np.ndarray) -> tuple[float, float]:
    """`Lamp.size`; only an area light grows with its object."""
    if kind is LampKind.SUN:
        return data.angle / 2.0, 0.0
    if kind is not LampKind.AREA:
        return data.shadow_soft_size, data.shadow_soft_size
    sides = (data.size, data.size_y if data.shape in {"RECTANGLE", "ELLIPSE"} else data.size)
    # A disk becomes the square of its area.
    factor = np.sqrt(np.pi) / 2.0 if data.shape in {"DISK", "ELLIPSE"} else 1.0
    return float(sides[0] * scale[0] * factor / 2.0), float(sides[1] * scale[1] * factor / 2.0)


def _shining_area(kind: LampKind, size: tuple[float, float]) -> float:
    """What Blender leaves out of the power of a light that is not normalised."""
    if kind is LampKind.AREA:
        return 4.0 * size[0] * size[1]
    return 1.0 if kind is LampKind.SUN else 4.0 * np.pi * size[0] ** 2


def _node_factor(data: bpy.types.Light, notes: Notes) -> np.ndarray:
    """(3,) what the light's own nodes multiply its colour with: a constant Emission, or 1 with a warning."""
    tree = tree_in_use(data)
    plug = tree and surface_plug(tree)
    if plug is None:
        return np.ones(3)
    found = source(plug)
    try:
        if found.node is None:
            return np.zeros(3)
        if found.node.bl_idname != "ShaderNodeEmission":
            raise Unsupported(found.node, "is not supported")
        return np.array(read_constant_vector(found.input("Color"))) * read_constant(found.input("Strength"))
    except Unsupported as gap:
        notes.add(f'light "{data.name}", node "{gap.node.name}"', f"{gap}; the light's own colour is used")
        return np.ones(3)
