"""`compare`: every scene, frame and method down the corridor, kept on disk step by step."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..addon.cache import Cache
from ..addon.errors import CatoptricError, SceneError
from ..addon.methods.registry import METHODS
from ..addon.metrics import Enough, PictureError
from ..addon.parameters import Value
from ..addon.progress import Progress, silent
from ..addon.scene import Lighting
from . import films, plates, searches
from .footage import Footage
from .judging import Shot
from .machine import check_size, describe, own_version
from .pictures import load_picture, plates_folder
from .progress import Bar, Terminal
from .report import write_report
from .results import Result, Results, Skipped, Times
from .running import Running
from .sampling import LIGHT, enough, supersampling
from .sources import Source

AUTO = "auto"
"""What a row's settings say of samples that were not asked for."""

_LONGEST_SIDE = 768
_PLATES_SIDE = 3  # samples along a side of a pixel, for pictures that are only looked at
_LIT, _JUDGED = 0.1, 0.6
"""Where on a frame's bar the light is ready, and Cycles' picture."""

_SEARCHED, _MEASURED = 0.01, 0.95
"""Where on the bar of many frames it is known what moves, and all pictures are there."""

HDR_FRAMES = 6
"""So many frames are measured by HDR-FLIP as well; more would take too long."""


@dataclass(frozen=True)
class Job:
    """What one `compare` is asked for. None for `resolution` and `frames`: as each scene has it.

    `samples` a pixel are the reference's; None: until its noise is low, in the first of several frames.

    `settings` holds the value of every parameter, by method, in the order of the rows. `against` is one of these
    methods, whose picture is then the reference in place of Cycles'. `videos`: methods in several frames are filmed.
    """

    sources: tuple[Source, ...]
    settings: Mapping[str, Mapping[str, Value]]
    lighting: Lighting
    samples: int | None
    out: Path
    resolution: tuple[int, int] | None = None
    frames: tuple[int, ...] | None = None
    peers: tuple[str, ...] = ()
    resume: bool = False
    against: str | None = None
    videos: bool = True

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods, the one that the others are held against first."""
        return tuple(sorted(self.settings, key=lambda name: name != self.against))


def run(job: Job, terminal: Terminal) -> Results:
    """Do the job; leaves results.json, the pictures and report.html in `job.out`.

    A scene, a frame or a method that fails is noted among `skipped`, and the rest goes on. Whatever stops
    the run, each row that was finished is on disk.
    """
    return _Comparison(job, terminal).run()


def fitted(resolution: tuple[int, int]) -> tuple[int, int]:
    """`resolution`, shrunk in proportion until no side is longer than 768 pixels."""
    scale = min(1.0, _LONGEST_SIDE / max(resolution))
    return tuple(max(1, round(side * scale)) for side in resolution)


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
        self._warned: set[str] = set()

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
        footage = Footage(source, self.job.lighting, self.cache, self.job.samples or LIGHT)
        try:
            frames = self._frames(footage, bar)
            if len(frames) == 1:
                self._compare_frames(footage, frames, bar)
            else:
                self._compare_frames(footage, frames, bar.part("", _SEARCHED, _MEASURED))
                self._film(source, frames, bar.step("videos", _MEASURED, 1.0))
        except CatoptricError as error:
            self._skip(Skipped(source.name, "", str(error), error=True))
        finally:
            bar.finish()

    def _frames(self, footage: Footage, bar: Bar) -> tuple[int, ...]:
        """The frames to measure; of a scene in which nothing moves the first alone, which all the others repeat."""
        source, frames = footage.source, self.job.frames or (footage.source.frame,)
        if len(frames) == 1:
            return frames
        first, last = source.span
        if not source.needs_blender:
            raise SceneError(f"--frames: {source.path.name} holds frame {first} alone; name the .blend file for more")
        if frames[0] < first or frames[-1] > last:
            self._warn(
                f"{source.name}: frames {frames[0]} to {frames[-1]} go beyond the scene's own, {first} to {last}"
            )
        if footage.first_change(frames, bar.step("frames", 0.0, _SEARCHED)) is None:
            self._warn(
                f"{source.name}: neither the camera nor anything else moves from frame {frames[0]} to {frames[-1]}; "
                f"frame {frames[0]} is measured for all of them"
            )
            return frames[:1]
        return frames

    def _compare_frames(self, footage: Footage, frames: tuple[int, ...], bar: Bar) -> None:
        """Frame by frame, so that what is there when somebody stops is whole; methods stay prepared in between."""
        running, before = Running(), None
        edges = np.linspace(0.0, 1.0, len(frames) + 1)
        try:
            for frame, start, end in zip(frames, edges[:-1], edges[1:], strict=True):
                label = f"frame {frame}" if len(frames) > 1 else ""
                shooting = _Shooting(footage, running, frame, before, len(frames))
                self._compare_frame(shooting, bar.part(label, float(start), float(end)))
                before = frame
        finally:
            running.close()
            self.results.save(self.job.out)

    def _compare_frame(self, shooting: "_Shooting", bar: Bar) -> None:
        source, frame = shooting.footage.source, shooting.frame
        missing = [name for name in (*self.job.methods, *self.job.peers) if not self._is_done(source, frame, name)]
        if not missing:
            return
        try:
            shot = self._stage(shooting, bar)
        except SceneError as error:
            self._skip(Skipped(source.name, "", str(error), True, frame, str(self.job.lighting)))
            return
        begin = self._judge(source, shot, missing, bar)
        edges = np.linspace(begin, 1.0, len(missing) + 1)
        for name, start, end in zip(missing, edges[:-1], edges[1:], strict=True):
            row = self._peer if name in self.job.peers else self._method
            try:
                row(shooting, shot, name, bar.step(name, float(start), float(end)))
                if shooting.alone or shooting.before is None:
                    self._explain(shot, name, bar.step("plates", float(end), float(end)))
            except CatoptricError as error:
                self._skip(self._not_measured(shot, name, str(error), error=True))
        self.results.save(self.job.out)

    def _explain(self, shot: Shot, name: str, progress: Progress) -> None:
        """What the page tells of some methods besides their pictures; of many frames, in the first."""
        if name == plates.PUBLISHED:
            self._draw_plates(shot, progress)
        if name in searches.METHODS:
            searches.follow(shot, self.job.settings[name], self.cache)

    def _draw_plates(self, shot: Shot, progress: Progress) -> None:
        """The paper's plates of what was measured; without light there is nothing to show."""
        measured = self.results.find(scene=shot.name, frame=shot.scene.frame, method=plates.PUBLISHED)
        if measured is None or shot.lighting is Lighting.UNLIT:
            return
        folder = plates_folder(shot.name, shot.scene.frame, str(shot.lighting))
        truths = {} if shot.half is None else {True: shot.reference}
        sitting = plates.Sitting(shot.name, shot.scene, shot.lighting, shot.size, min(shot.side, _PLATES_SIDE))
        plates.draw(sitting, self.job.out / folder, truths, progress)

    def _stage(self, shooting: "_Shooting", bar: Bar) -> Shot:
        footage = shooting.footage
        scene = footage.read(shooting.frame, bar.step("scene", 0.0, 0.05))
        for warning in scene.warnings:
            self._warn(f"{footage.source.name}: {warning}")
        size = self.job.resolution or fitted(scene.resolution)
        shot = Shot(
            footage.source.name,
            footage.light(scene, bar.step("light", 0.05, _LIT)),
            self.job.lighting,
            size,
            self.job.out,
            against=self.job.against,
            one_of_many=shooting.count > HDR_FRAMES,
        )
        if self.job.samples:
            shot.side = supersampling(self.job.samples, self.job.against)
        return shot

    def _judge(self, source: Source, shot: Shot, missing: list[str], bar: Bar) -> float:
        """Have the shot's reference ready, if it is not about to be drawn by a method; how far the bar is then."""
        if self.job.against:
            if self.job.against not in missing:
                self._judge_by_kept(shot)
            return _LIT
        if not source.needs_blender:
            reason = "Cycles cannot render an archive: errors need the .blend file, or a method, with --against"
            self._skip(self._not_measured(shot, "cycles", reason))
            return _LIT
        from ..addon.blender.reference import render_reference

        reference = render_reference(
            source.bpy_scene,
            shot.scene,
            self.job.lighting,
            *shot.size,
            samples=self._samples(source, shot),
            cache=self.cache,
            progress=bar.step("reference", _LIT, _JUDGED),
        )
        shot.judge_by(reference.color, reference.half, reference.samples)
        return _JUDGED

    def _samples(self, source: Source, shot: Shot) -> int | Enough:
        """As many as asked for, as the scene's other rows have them, or as it takes."""
        if self.job.samples:
            return self.job.samples
        taken = (row.samples.reference for row in self.results.results if self._stands(row, source))
        return next(filter(None, taken), None) or enough(shot.scene, shot.size)

    def _judge_by_kept(self, shot: Shot) -> None:
        """Take the picture that an earlier run drew with the method that is the reference."""
        try:
            shot.reference = load_picture(self.job.out / shot.images(self.job.against).method)
        except PictureError as error:
            raise SceneError(str(error)) from None

    def _method(self, shooting: "_Shooting", shot: Shot, name: str, progress: Progress) -> None:
        reflectors = [shot.scene.instances[index] for index in shot.scene.reflectors]
        settings = self.job.settings[name]
        reasons = {each.name: METHODS[name].applies_to(shot.scene, each, settings) for each in reflectors}
        refusals = [f"{reflector}: {reason}" for reflector, reason in reasons.items() if reason]
        if len(refusals) == len(reasons):
            self._skip(self._not_measured(shot, name, refusals[0]))
            return
        taken = shooting.running.take(shot, name, settings, progress, shooting.before)
        if shooting.alone:
            shooting.running.leave(name)
        if taken.anew:
            anew = f"{name} goes on at frame {shot.scene.frame} with a key frame: it did not draw the frame before"
            self._warn(f"{shot.name}: {anew}")
            refusals.append(anew)
        frame = taken.frame
        if name == self.job.against:
            shot.reference = frame.color
        row = shot.result(name, frame.color, self._settings(name), taken.times, refusals, frame.reuse)
        self._keep(row)

    def _peer(self, shooting: "_Shooting", shot: Shot, name: str, progress: Progress) -> None:
        source = shooting.footage.source
        if not source.needs_blender:
            raise SceneError("EEVEE cannot render an archive: it needs the .blend file")
        from ..addon.blender.eevee import render_eevee

        if shot.mask is None:
            first = next(iter(METHODS))
            shooting.running.take(shot, first, {}, silent)
        picture = render_eevee(
            source.bpy_scene, shot.scene, self.job.lighting, *shot.size, cache=self.cache, progress=progress
        )
        times = Times(frame=picture.seconds_per_sample * 1e3)
        self._keep(shot.result(name, picture.color, self._settings(name), times, []))

    def _film(self, source: Source, frames: tuple[int, ...], progress: Progress) -> None:
        """Films of all methods, if they are wanted."""
        if not self.job.videos:
            return
        rows = [row for row in self.results.results if row.scene == source.name and row.frame in frames]
        rows = [row for row in rows if row.lighting == str(self.job.lighting)]
        shown = {*self.job.methods, *self.job.peers} - {self.job.against}  # that one is beside all the others
        wanted = [row for row in rows if row.method in shown]
        for path in films.make(wanted, self.job.out, progress):
            self.terminal.say(f"video: {path}")

    def _keep(self, result: Result) -> None:
        self.results.add(result)
        flip = result.over_reflectors.flip
        error = "not judged" if flip is None else f"FLIP {flip:.4f}"
        reflection = result.time_ms.reflection
        cost = "" if reflection is None else f"  reflection {reflection:.1f} ms"
        reuse = result.reuse
        share = "" if reuse is None else "  key frame" if reuse.key else f"  retraced {reuse.retraced:.1%}"
        self.terminal.say(f"{result.scene:16} frame {result.frame}  {result.method:24} {error}{cost}{share}")

    def _skip(self, skipped: Skipped) -> None:
        self.results.skip(skipped)
        self.results.save(self.job.out)
        subject = f"{skipped.scene}: {skipped.method}" if skipped.method else skipped.scene
        self._warn(f"{subject}: {skipped.reason}")

    def _warn(self, line: str) -> None:
        """Say it once, however many frames it holds for."""
        if line not in self._warned:
            self._warned.add(line)
            self.terminal.warn(line)

    def _not_measured(self, shot: Shot, method: str, reason: str, error: bool = False) -> Skipped:
        return Skipped(shot.name, method, reason, error, shot.scene.frame, str(self.job.lighting))

    def _settings(self, name: str) -> dict[str, Value]:
        return {**self.job.settings.get(name, {}), "samples": self.job.samples or AUTO}

    def _is_done(self, source: Source, frame: int, name: str) -> bool:
        """Whether an earlier run has this row, with these settings, from the file as it still is."""
        row = self.results.find(scene=source.name, frame=frame, method=name, settings=self._settings(name))
        if row is None or not self._stands(row, source):
            return False
        judged = name != self.job.against and (bool(self.job.against) or source.needs_blender)
        return row.against == (self.job.against if judged else None) and judged == (row.over_frame.flip is not None)

    def _stands(self, row: Result, source: Source) -> bool:
        """Whether a row is of this light, size and number of samples, and of the file as it still is."""
        if (row.scene, row.lighting) != (source.name, str(self.job.lighting)):
            return False
        if self.job.resolution not in (None, (row.width, row.height)):
            return False
        if row.settings.get("samples") != (self.job.samples or AUTO):
            return False
        pictures = [self.job.out / row.images.method]
        if row.over_frame.flip is not None:
            pictures.append(self.job.out / row.images.reference)
        changed = source.path.stat().st_mtime
        return all(picture.is_file() and picture.stat().st_mtime >= changed for picture in pictures)


@dataclass(frozen=True)
class _Shooting:
    """A frame of the `count` that are measured, the one `before` it (None for the first), and who draws."""

    footage: Footage
    running: Running
    frame: int
    before: int | None
    count: int

    @property
    def alone(self) -> bool:
        """Whether it is the only frame: then no method stays prepared after its picture."""
        return self.count == 1
