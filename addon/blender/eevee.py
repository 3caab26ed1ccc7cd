"""A peer: the same picture by EEVEE, Blender's own real-time renderer, with its ray tracing on."""

import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ..cache import Cache, key_of
from ..progress import Progress, silent
from ..scene import Lighting, Scene
from .override import same_light
from .render_fingerprint import fingerprint
from .render_settings import changed, plain_picture, take_picture

ENGINE = "BLENDER_EEVEE" if bpy.app.version >= (5, 0, 0) else "BLENDER_EEVEE_NEXT"


@dataclass(frozen=True, eq=False)
class EeveePicture:
    """`color` (H, W, 3) float32 scene-linear, row 0 at the top; `seconds_per_sample` without set-up and shaders."""

    color: np.ndarray
    seconds_per_sample: float


def render_eevee(
    bpy_scene: bpy.types.Scene,
    scene: Scene,
    lighting: Lighting,
    width: int,
    height: int,
    samples: int = 16,
    cache: Cache | None = None,
    progress: Progress = silent,
) -> EeveePicture:
    """Render `bpy_scene`, from which `scene` was extracted, by EEVEE; leaves it as it was.

    The first picture, of one sample, compiles the shaders; the time of a sample is what the full
    picture takes beyond a second one of one sample. Errors as of `render_reference`.
    """
    samples = max(samples, 2)
    with plain_picture(bpy_scene, width, height), _eevee_engine(bpy_scene):
        key = key_of("eevee 1", fingerprint(bpy_scene, scene), lighting, width, height, samples)
        known = cache.get("eevee", key) if cache else None
        if known is not None:
            return EeveePicture(known.arrays["color"], known.meta["seconds_per_sample"])
        with same_light(bpy_scene, scene, lighting):
            progress("EEVEE: shaders", 0.0)
            _timed(bpy_scene, 1)
            progress("EEVEE", 0.3)
            single, _ = _timed(bpy_scene, 1)
            progress("EEVEE", 0.4)
            full, color = _timed(bpy_scene, samples)
    progress("EEVEE", 1.0)
    picture = EeveePicture(color, max(full - single, 0.0) / (samples - 1))
    if cache:
        cache.put("eevee", key, {"color": color}, {"seconds_per_sample": picture.seconds_per_sample})
    return picture


@contextmanager
def _eevee_engine(bpy_scene: bpy.types.Scene) -> Iterator[None]:
    """Ray tracing at full resolution, unclamped, filtered by a pixel; lamps without highlights of their own."""
    eevee = {
        "use_raytracing": True,
        "ray_tracing_method": "SCREEN",
        "use_shadows": True,
        "clamp_surface_direct": 0.0,
        "clamp_surface_indirect": 0.0,
        "use_overscan": False,
    }
    tracing = {"resolution_scale": "1", "screen_trace_quality": 1.0, "trace_max_roughness": 0.5}
    with ExitStack() as stack:
        stack.enter_context(changed(bpy_scene.render, engine=ENGINE, filter_size=1.0))
        stack.enter_context(changed(bpy_scene.eevee, **eevee))
        stack.enter_context(changed(bpy_scene.eevee.ray_tracing_options, **tracing))
        for lamp in bpy.data.lights:
            stack.enter_context(changed(lamp, specular_factor=0.0))
        yield


def _timed(bpy_scene: bpy.types.Scene, samples: int) -> tuple[float, np.ndarray]:
    with changed(bpy_scene.eevee, taa_render_samples=samples):
        start = time.perf_counter()
        color = take_picture(bpy_scene)
        return time.perf_counter() - start, color
