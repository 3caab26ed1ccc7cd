"""The judge: a picture by Cycles, with the noise that is left in it."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ..cache import Cache, key_of
from ..errors import MachineError, UsageError
from ..metrics import Enough
from ..progress import Progress, part_of, silent
from ..scene import Lighting, Scene
from .override import same_light
from .render_fingerprint import fingerprint
from .render_settings import changed, plain_picture, take_picture

CHUNK = 16
"""Samples rendered between two looks at the progress callback, which may cancel."""

_SEQUENCE = 8192
"""Cycles makes sequences of so many samples at most; a shorter one is no beginning of a longer one."""


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
    samples: int | Enough = 256,
    cache: Cache | None = None,
    progress: Progress = silent,
    device: str = "CPU",
) -> Reference:
    """Render `bpy_scene`, from which `scene` was extracted, by Cycles; leaves it as it was.

    Adaptive sampling, denoiser, clamps and caustics are off, the pixel filter is a box one pixel
    wide. `samples` is rounded up to an even number: two halves with seeds of their own are rendered
    and averaged. What `cache` has of fewer samples is gone on with, and gives the same picture bit by bit.
    `device` is "CPU" or "GPU". Raises `SceneError` without a camera, `UsageError` for
    an impossible size, `MachineError` where Cycles cannot run; passes on what `progress` raises.
    """
    most = samples.most if isinstance(samples, Enough) else samples
    if most < 2:
        raise UsageError(f"a reference of {most} samples cannot tell its noise: give at least 2")
    with cycles_engine(bpy_scene, device), plain_picture(bpy_scene, width, height):
        sequence = max(_SEQUENCE, _half(most))
        content = key_of("reference 3", fingerprint(bpy_scene, scene), lighting, width, height, device, sequence)
        kept = _Kept(content, cache)

        def taken(half: int, progress: Progress) -> _Halves:
            before = kept.nearest(half)
            if before is not None and before.count == half:
                return before
            with same_light(bpy_scene, scene, lighting):
                halves = _grown(bpy_scene, before, half, sequence, progress)
            kept.keep(halves)
            return halves

        if isinstance(samples, Enough):
            return _until(samples, taken, progress).reference
        return taken(_half(samples), progress).reference


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


@dataclass(frozen=True, eq=False)
class _Halves:
    """Two pictures of `count` samples with different seeds, and the `seconds` that they took."""

    first: np.ndarray
    second: np.ndarray
    count: int
    seconds: float

    @property
    def reference(self) -> Reference:
        """The mean of both."""
        return Reference((self.first + self.second) / 2, self.first, 2 * self.count, self.seconds)


@dataclass(frozen=True)
class _Kept:
    """Halves in the cache, if there is one, of what `content` is the key of."""

    content: str
    cache: Cache | None

    def nearest(self, count: int) -> _Halves | None:
        """Those of `count` samples, or else of the most that `count` can be made of in the same pieces."""
        if self.cache is None:
            return None
        for fewer in (count, *range((count - 1) // CHUNK * CHUNK, 0, -CHUNK)):
            known = self.cache.get("reference", self._key(fewer))
            if known is not None:
                return _Halves(known.arrays["first"], known.arrays["second"], fewer, known.meta["seconds"])
        return None

    def keep(self, halves: _Halves) -> None:
        """Put them into the cache."""
        if self.cache is not None:
            arrays = {"first": halves.first, "second": halves.second}
            self.cache.put("reference", self._key(halves.count), arrays, {"seconds": halves.seconds})

    def _key(self, count: int) -> str:
        return key_of(self.content, count)


def _half(samples: int) -> int:
    return (samples + 1) // 2


def _until(enough: Enough, taken: Callable[[int, Progress], _Halves], progress: Progress) -> _Halves:
    """`taken` halves that are enough. Which counts are tried hangs on the pictures alone, not on what is cached."""
    most, done = _half(enough.most), 0.1
    halves = taken(min(_half(enough.least), most), part_of(progress, 0.0, done))
    while halves.count < most:
        needed = halves.count * enough.more(halves.first, halves.second)
        if not needed > halves.count:
            break
        count = min(most, max(halves.count + CHUNK, round(needed / CHUNK) * CHUNK))
        expected = max(count, min(most, 2 * needed))
        start, done = done, done + (1.0 - done) * (count - halves.count) / (expected - halves.count)
        halves = taken(count, part_of(progress, start, done))
    progress("Cycles", 1.0)
    return halves


def _grown(
    bpy_scene: bpy.types.Scene, before: _Halves | None, count: int, sequence: int, progress: Progress
) -> _Halves:
    """Halves of `count` samples, of one `sequence` each, in pieces that go on where those `before` end."""
    start, known = time.perf_counter(), 0 if before is None else before.count
    halves = [np.float32(0.0)] * 2 if before is None else [before.first, before.second]
    for seed in (0, 1):
        for offset in range(known, count, CHUNK):
            progress("Cycles", (seed + (offset - known) / (count - known)) / 2)
            length = min(CHUNK, count - offset)
            piece = {"use_sample_subset": True, "sample_offset": offset, "sample_subset_length": length}
            with changed(bpy_scene.cycles, seed=seed, samples=sequence, **piece):
                picture = take_picture(bpy_scene)
            share = length / (offset + length)
            # To 32 bits after each piece, as the cache has them: what is gone on with is then what it would be at once.
            halves[seed] = (halves[seed] * (1.0 - share) + picture.astype(np.float64) * share).astype(np.float32)
    progress("Cycles", 1.0)
    seconds = time.perf_counter() - start + (0.0 if before is None else before.seconds)
    return _Halves(halves[0], halves[1], count, seconds)
