"""The judge: a picture by Cycles, with the noise that is left in it."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ..cache import Cache, key_of
from ..errors import MachineError, UsageError
from ..progress import Progress, silent
from ..scene import Lighting, Scene
from .override import same_light
from .render_fingerprint import fingerprint
from .render_settings import changed, plain_picture, take_picture

CHUNK = 16
"""Samples rendered between two looks at the progress callback, which may cancel."""


@dataclass(frozen=True, eq=False)
class Reference:
    """A picture by Cycles. `color` (H, W, 3) float32 scene-linear radiance, row 0 at the top.

    `half` (H, W, 3) float32 is the same made of one half of the samples; the other half gives
    2 `color` - `half`. `samples` a pixel it was made of, and the `seconds` they took.
    """

    color: np.ndarray
    half: np.ndarray
    samples: int
    seconds: float

    @property
    def noise(self) -> np.ndarray:
        """(H, W) float32, the standard error of `color`, the root mean square of its channels.

        A difference below it is no difference. A half has twice the variance of the mean, and lies
        as far from the mean as, in the root mean square, the mean from the truth.
        """
        return np.sqrt(np.mean((self.half - self.color) ** 2, axis=-1))


def render_reference(
    bpy_scene: bpy.types.Scene,
    scene: Scene,
    lighting: Lighting,
    width: int,
    height: int,
    samples: int = 256,
    cache: Cache | None = None,
    progress: Progress = silent,
    device: str = "CPU",
) -> Reference:
    """Render `bpy_scene`, from which `scene` was extracted, by Cycles; leaves it as it was.

    Adaptive sampling, denoiser, clamps and caustics are off, the pixel filter is a box one pixel
    wide. `samples` is rounded up to an even number: two halves with seeds of their own are rendered
    and averaged. `device` is "CPU" or "GPU". Raises `SceneError` without a camera, `UsageError` for
    an impossible size, `MachineError` where Cycles cannot run; passes on what `progress` raises.
    """
    if samples < 2:
        raise UsageError(f"a reference of {samples} samples cannot tell its noise: give at least 2")
    half = (samples + 1) // 2
    with cycles_engine(bpy_scene, device), plain_picture(bpy_scene, width, height):
        key = key_of("reference 2", fingerprint(bpy_scene, scene), lighting, width, height, half, device)
        known = cache.get("reference", key) if cache else None
        if known is not None:
            return Reference(known.arrays["color"], known.arrays["half"], 2 * half, known.meta["seconds"])
        start = time.perf_counter()
        with same_light(bpy_scene, scene, lighting):
            first, second = _halves(bpy_scene, half, progress)
    reference = Reference((first + second) / 2, first, 2 * half, time.perf_counter() - start)
    if cache:
        arrays = {"color": reference.color, "half": reference.half}
        cache.put("reference", key, arrays, {"seconds": reference.seconds})
    return reference


@contextmanager
def cycles_engine(bpy_scene: bpy.types.Scene, device: str = "CPU") -> Iterator[None]:
    """Cycles as a judge: every sample counts the same, none is clamped, blurred, guided or denoised."""
    if not hasattr(bpy_scene, "cycles"):
        raise MachineError("Cycles is switched off: enable it in Blender's preferences, under Add-ons")
    judge = {
        "device": device,
        "seed": 0,
        "use_animated_seed": False,
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "use_layer_samples": "IGNORE",
        "time_limit": 0.0,
        "sampling_pattern": "TABULATED_SOBOL",
        "pixel_filter_type": "BOX",
        "filter_width": 1.0,
        "use_pixel_jitter": False,  # it gives every sample of a pixel the same place
        "film_exposure": 1.0,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "blur_glossy": 0.0,
        "caustics_reflective": False,
        "caustics_refractive": False,
        "use_fast_gi": False,
        "use_guiding": False,
        "auto_scrambling_distance": False,
        "scrambling_distance": 1.0,
        "use_sample_subset": False,
    }
    with changed(bpy_scene.render, engine="CYCLES"), changed(bpy_scene.cycles, **judge):
        yield


def _halves(bpy_scene: bpy.types.Scene, half: int, progress: Progress) -> list[np.ndarray]:
    """Two pictures of `half` samples with different seeds, in pieces of one sequence each."""
    halves = []
    for seed in (0, 1):
        total = 0.0
        for offset in range(0, half, CHUNK):
            progress("Cycles", (seed * half + offset) / (2 * half))
            length = min(CHUNK, half - offset)
            piece = {"use_sample_subset": True, "sample_offset": offset, "sample_subset_length": length}
            with changed(bpy_scene.cycles, seed=seed, samples=half, **piece):
                total = total + take_picture(bpy_scene).astype(np.float64) * (length / half)
        halves.append(total.astype(np.float32))
    progress("Cycles", 1.0)
    return halves
