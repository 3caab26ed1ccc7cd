"""`compare`: every scene, frame and method down the corridor, kept on disk step by step."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..addon.cache import Cache
from ..addon.errors import CatoptricError, SceneError
from ..addon.methods.contract import Frame
from ..addon.methods.registry import METHODS
from ..addon.parameters import Value
from ..addon.progress import Progress, part_of, silent
from ..addon.scene import Lighting, Scene
from . import plates, searches
from .judging import Shot, supersampling
from .machine import check_size, describe, own_version
from .pictures import plates_folder
from .progress import Bar, Terminal
from .report import write_report
from .results import Result, Results, Skipped, Times
from .sources import Source

SAMPLES = {Lighting.UNLIT: 64, Lighting.CYCLES: 256, Lighting.DIRECT: 128}
"""Cycles' samples a pixel: without light, only edges are noisy."""

_LONGEST_SIDE = 768
_LEAST_LIGHT = 32  # samples of a texel; denoised, and seen from every pixel around
_PLATES_SIDE = 3  # samples along a side of a pixel, for pictures that are only looked at
_LIT, _JUDGED = 0.1, 0.6
"""Where on a scene's bar the light is ready, and the reference."""


@dataclass(frozen=True)
class Job:
    """What one `compare` is asked for. None for `resolution` and `frames`: as each scene has it.

    `settings` holds the value of every parameter, by method, in the order of the rows.
    """

    sources: tuple[Source, ...]
    settings: Mapping[str, Mapping[str, Value]]
    lighting: Lighting
    samples: int
    out: Path
    resolution: tuple[int, int] | None = None
    frames: tuple[int, ...] | None = None
    peers: tuple[str, ...] = ()
    resume: bool = False


def run(job: Job, terminal: Terminal) -> Results:
    """Do the job; leaves results.json, the pictures and report.html in `job.out`.

    A scene or a method that fails is noted among `skipped`, and the rest goes on. Whatever stops
    the run, each row that was finished is on disk.
    """
    return _Comparison(job, terminal).run()


def fitted(resolution: tuple[int, int]) -> tuple[int, int]:
    """`resolution`, shrunk in proportion until no side is longer than 768 pixels."""
    scale = min(1.0, _LONGEST_SIDE / max(resolution))
    return tuple(max(1, round(side * scale)) for side in resolution)


def require_reflectors(scene: Scene) -> None:
    """Raise `SceneError` if nothing in the scene mirrors."""
    if not scene.reflectors:
        raise SceneError(
            f"{scene.name}: nothing reflects here; give an object a metallic or glossy material of low roughness"
        )


def lit(
    source: Source, scene: Scene, lighting: Lighting, cache: Cache, progress: Progress = silent, samples: int = 256
) -> Scene:
    """The scene with what `lighting` needs baked into it, as fine as suits a reference of `samples` a pixel."""
    has_lightmaps = any(instance.lightmap is not None for instance in scene.instances)
    if lighting is not Lighting.CYCLES or has_lightmaps:
        return scene
    if not source.needs_blender:
        raise SceneError(f"{source.path.name} holds no lightmaps: export it with --lighting cycles")
    from ..addon.blender.lightmap import bake_lightmaps

    quality = max(_LEAST_LIGHT, samples // 8)
    return bake_lightmaps(source.bpy_scene, scene, quality, cache=cache, progress=progress)


class _Comparison:
    def __init__(self, job: Job, terminal: Terminal) -> None:
        machine = describe()
        self.job, self.terminal = job, terminal
        self.cache = Cache()
        self.results = Results(own_version(), machine)
        if job.resume:
            self.results, damage = Results.resume(job.out, own_version(), machine)
            if damage:
                terminal.warn(damage)
        self.results.sources |= {name: METHODS[name].source for name in job.settings}

    def run(self) -> Results:
        if self.job.resolution:
            check_size(*self.job.resolution)
        self.results.save(self.job.out)
        try:
            for source in self.job.sources:
                self._compare(source)
        finally:
            if self.results.results:
                write_report(self.results, self.job.out)
        return self.results

    def _compare(self, source: Source) -> None:
        bar = self.terminal.bar(source.name)
        try:
            for frame in self.job.frames or (source.frame,):
                self._compare_frame(source, frame, bar)
        except CatoptricError as error:
            self._skip(Skipped(source.name, "", str(error), error=True))
        finally:
            bar.finish()

    def _compare_frame(self, source: Source, frame: int, bar: Bar) -> None:
        missing = [name for name in (*self.job.settings, *self.job.peers) if not self._is_done(source, frame, name)]
        if not missing:
            return
        shot = self._stage(source, frame, bar)
        self._judge(source, shot, bar)
        edges = np.linspace(_JUDGED, 1.0, len(missing) + 1)
        for name, start, end in zip(missing, edges[:-1], edges[1:], strict=True):
            row = self._peer if name in self.job.peers else self._method
            try:
                row(source, shot, name, bar.step(name, float(start), float(end)))
                if name == plates.PUBLISHED:
                    self._draw_plates(shot, bar.step("plates", float(end), float(end)))
                if name in searches.METHODS.values():
                    searches.follow(shot, self.job.settings[name], self.cache)
            except CatoptricError as error:
                self._skip(self._not_measured(shot, name, str(error), error=True))

    def _draw_plates(self, shot: Shot, progress: Progress) -> None:
        """The paper's plates of what was measured; without light there is nothing to show."""
        measured = self.results.find(scene=shot.name, frame=shot.scene.frame, method=plates.PUBLISHED)
        if measured is None or shot.lighting is Lighting.UNLIT:
            return
        folder = plates_folder(shot.name, shot.scene.frame, str(shot.lighting))
        truths = {} if shot.reference is None else {True: shot.reference}
        sitting = plates.Sitting(shot.name, shot.scene, shot.lighting, shot.size, min(shot.side, _PLATES_SIDE))
        plates.draw(sitting, self.job.out / folder, truths, progress)

    def _stage(self, source: Source, frame: int, bar: Bar) -> Shot:
        scene = source.scene(frame, bar.step("scene", 0.0, 0.05))
        for warning in scene.warnings:
            self.terminal.warn(f"{source.name}: {warning}")
        require_reflectors(scene)
        size = self.job.resolution or fitted(scene.resolution)
        light = bar.step("light", 0.05, _LIT)
        scene = lit(source, scene, self.job.lighting, self.cache, light, self.job.samples)
        return Shot(source.name, scene, self.job.lighting, size, self.job.out, supersampling(self.job.samples))

    def _judge(self, source: Source, shot: Shot, bar: Bar) -> None:
        if not source.needs_blender:
            reason = "Cycles cannot render an archive: errors need the .blend file"
            self._skip(self._not_measured(shot, "cycles", reason))
            return
        from ..addon.blender.reference import render_reference

        reference = render_reference(
            source.bpy_scene,
            shot.scene,
            self.job.lighting,
            *shot.size,
            samples=self.job.samples,
            cache=self.cache,
            progress=bar.step("reference", _LIT, _JUDGED),
        )
        shot.judge_by(reference.color, reference.half)

    def _method(self, source: Source, shot: Shot, name: str, progress: Progress) -> None:
        reflectors = [shot.scene.instances[index] for index in shot.scene.reflectors]
        settings = self.job.settings[name]
        reasons = {each.name: METHODS[name].applies_to(shot.scene, each, settings) for each in reflectors}
        refusals = [f"{reflector}: {reason}" for reflector, reason in reasons.items() if reason]
        if len(refusals) == len(reasons):
            self._skip(self._not_measured(shot, name, refusals[0]))
            return
        frame, bake_ms = photograph(shot, name, settings, progress)
        times = Times(bake_ms, frame.time_ms.get("reflection"), frame.time_ms.get("frame"))
        self._keep(shot.result(name, frame.color, self._settings(name), times, refusals))

    def _peer(self, source: Source, shot: Shot, name: str, progress: Progress) -> None:
        if not source.needs_blender:
            raise SceneError("EEVEE cannot render an archive: it needs the .blend file")
        from ..addon.blender.eevee import render_eevee

        if shot.mask is None:
            photograph(shot, next(iter(METHODS)), {}, silent)
        picture = render_eevee(
            source.bpy_scene, shot.scene, self.job.lighting, *shot.size, cache=self.cache, progress=progress
        )
        times = Times(frame=picture.seconds_per_sample * 1e3)
        self._keep(shot.result(name, picture.color, self._settings(name), times, []))

    def _keep(self, result: Result) -> None:
        self.results.add(result)
        self.results.save(self.job.out)
        flip = result.over_reflectors.flip
        error = "not judged" if flip is None else f"FLIP {flip:.4f}"
        reflection = result.time_ms.reflection
        cost = "" if reflection is None else f"  reflection {reflection:.1f} ms"
        self.terminal.say(f"{result.scene:16} frame {result.frame}  {result.method:24} {error}{cost}")

    def _skip(self, skipped: Skipped) -> None:
        self.results.skip(skipped)
        self.results.save(self.job.out)
        subject = f"{skipped.scene}: {skipped.method}" if skipped.method else skipped.scene
        self.terminal.warn(f"{subject}: {skipped.reason}")

    def _not_measured(self, shot: Shot, method: str, reason: str, error: bool = False) -> Skipped:
        return Skipped(shot.name, method, reason, error, shot.scene.frame, str(self.job.lighting))

    def _settings(self, name: str) -> dict[str, Value]:
        return {**self.job.settings.get(name, {}), "samples": self.job.samples}

    def _is_done(self, source: Source, frame: int, name: str) -> bool:
        """Whether an earlier run has this row, with these settings, from the file as it still is."""
        row = self.results.find(
            scene=source.name,
            frame=frame,
            method=name,
            lighting=str(self.job.lighting),
            settings=self._settings(name),
        )
        if row is None or self.job.resolution not in (None, (row.width, row.height)):
            return False
        pictures = [self.job.out / row.images.method]
        if row.over_frame.flip is not None:
            pictures.append(self.job.out / row.images.reference)
        changed = source.path.stat().st_mtime
        return all(picture.is_file() and picture.stat().st_mtime >= changed for picture in pictures)


def photograph(shot: Shot, name: str, settings: Mapping[str, Value], progress: Progress) -> tuple[Frame, float]:
    """The method's picture of the shot, and the milliseconds that its bake took."""
    method = METHODS[name](settings)
    start = time.perf_counter()
    method.prepare(shot.scene, shot.lighting, part_of(progress, 0.0, 0.5))
    bake_ms = (time.perf_counter() - start) * 1e3
    try:
        return shot.take(method, part_of(progress, 0.5, 1.0)), bake_ms
    finally:
        method.release()
