"""A Blender scene seen by a camera of ours."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ..scene import Camera
from .render_settings import changed

_SENSOR_MM = 36.0


@contextmanager
def seen_by(bpy_scene: bpy.types.Scene, camera: Camera, width: int, height: int) -> Iterator[None]:
    """Within, `bpy_scene` is rendered through `camera`, `width` × `height` pixels; afterwards as it was.

    `camera`'s window must be that of `SensorFit.HORIZONTAL`, as `Camera.of_matrices` gives it.
    """
    data = bpy.data.cameras.new("Catoptric view")
    holder = bpy.data.objects.new("Catoptric view", data)
    bpy_scene.collection.objects.link(holder)
    try:
        data.sensor_fit, data.sensor_width = "HORIZONTAL", _SENSOR_MM
        data.shift_x, data.shift_y = camera.shift
        data.clip_start, data.clip_end = max(camera.near, 1e-6), camera.far
        if camera.ortho_scale is None:
            data.lens = _SENSOR_MM * camera.lens / camera.sensor[0]
        else:
            data.type, data.ortho_scale = "ORTHO", camera.ortho_scale
        holder.matrix_world = camera.matrix.T.tolist()
        size = {"resolution_x": width, "resolution_y": height, "resolution_percentage": 100}
        aspect = camera.pixel_aspect
        size |= {"pixel_aspect_x": max(1.0, 1.0 / aspect), "pixel_aspect_y": max(1.0, aspect)}
        with changed(bpy_scene, camera=holder), changed(bpy_scene.render, **size):
            bpy_scene.view_layers.update()
            yield
    finally:
        bpy.data.objects.remove(holder)
        bpy.data.cameras.remove(data)
