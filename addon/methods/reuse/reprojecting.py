"""What the methods share that reproject the reflections of earlier pictures."""

from abc import abstractmethod
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ...drawing import FREE_UNIT, Part, ScreenPass, Visibility
from ...gl import program
from ...parameters import Parameter
from ...progress import Progress
from ...scene import Scene, only_seen_from_elsewhere
from ..contract import Reuse, View
from ..deferred import Clock, DeferredMethod
from ..traced import reflections_left
from ..tracers import prepare_tracer, tracer_defines
from .buffers import PIXEL_BYTES, ReflectionBuffers, Sample
from .gathering import Gathering

_LIGHT_UNIT = FREE_UNIT + 1

THRESHOLD = Parameter(
    "threshold",
    "Threshold",
    0.3,
    "Share of the reflectors' pixels to be traced again from which on the whole picture is, as the next key frame",
    minimum=0.0,
    maximum=1.0,
    section="Xie et al., 4.3",
)
SCHEDULE = Parameter(
    "schedule",
    "Schedule",
    24,
    "Pictures after which there is a new key frame in any case; 0: never",
    unit="pictures",
    minimum=0,
    maximum=100_000,
    section="Xie et al., 4.3",
)

MEMORY = Parameter(
    "memory",
    "Memory",
    1024,
    "What earlier pictures may take on the GPU; of a pixel's samples those that find no room are traced",
    unit="MiB",
    minimum=1,
    maximum=1_000_000,
)


class ReprojectingMethod(DeferredMethod):
    """A method that traces key frames, and makes the pictures after one of its reflections.

    A subclass's `reuse` finds what of them shows in the picture; what it leaves is traced. Where that is too much,
    the picture is a key frame itself, so that a cut of the camera is no special case.
    """

    takes_over = True
    shader = "traced/traced.frag"

    @property
    def defines(self) -> dict[str, int]:
        """Which tracer."""
        return tracer_defines(self.settings["tracer"])

    def bake(self, progress: Progress) -> None:
        """Get the passes ready; what is known of pictures stays, since what has moved after one can be told."""
        prepare_tracer(self.settings["tracer"], self.resident, progress)
        self._trace_all, self._trace_listed = self.passes("reprojection/traced.frag")
        self._compose = ScreenPass("reprojection/compose.frag", self.resident, Part.REFLECTORS)
        if not hasattr(self, "_histories"):
            self._histories: WeakKeyDictionary[Visibility, History] = WeakKeyDictionary()

    def passes(self, fragment: str, **defines: int) -> tuple[ScreenPass, moderngl.Program]:
        """A shader on gpu_shaders/reprojection/kept.glsl, for whole pictures and for `Gathering.fill`."""
        listed, whole = ({**self.defines, **defines, "LISTED": number} for number in (1, 0))
        return (
            ScreenPass(fragment, self.resident, Part.REFLECTORS, whole),
            program(None, fragment, {**self.resident.defines, **listed}),
        )

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """How often a path reflects, in a picture without a history: one that is seen in a mirror."""
        shader["reflections"] = reflections_left(self.scene, view)

    def keep(self, key: ReflectionBuffers, seen: Visibility) -> None:
        """Note what the method wants to know of a key frame besides, while it is what is `seen`."""

    @abstractmethod
    def reuse(self, clock: Clock, picture: ReflectionBuffers, history: "History", seen: Visibility) -> int:
        """Draw into a picture what of it is known from earlier ones; how many of its pixels mirror.

        Where nothing is known, the alpha of `picture.light` is to be below 0.
        """

    def follows(self, known: ReflectionBuffers) -> bool:
        """Whether an earlier picture is of any use for the scene as it is now."""
        return only_seen_from_elsewhere(self.scene, known.scene)

    def reflect_in_stages(self, clock: Clock, view: View, seen: Visibility, target, **sample) -> None:
        """Take over what is known, trace the rest, and show it."""
        if seen not in self._histories:
            self._histories[seen] = History(seen, self.settings["memory"])
        picture = self._picture(clock, self._histories[seen], Sample(view, sample["offset"]), seen)
        with clock("blend shading"):
            picture.light.use(_LIGHT_UNIT)
            self._compose.shader["arriving"] = _LIGHT_UNIT
            self._compose.draw(view.camera, seen, target, **sample)

    def _picture(self, clock: Clock, history: "History", sample: Sample, seen: Visibility) -> ReflectionBuffers:
        """What arrives at the reflectors."""
        key = history.key_of(sample)
        if key.sample is None or 0 < self.settings["schedule"] <= key.age or not self.follows(key):
            return self._key_frame(clock, history, sample, seen)
        key.age += 1
        if key.sample.view.shows_the_same(sample.view) and only_seen_from_elsewhere(self.scene, key.scene):
            history.note(sample, Taken(0.0, np.zeros((0, 2), int)))
            return key
        picture = history.begin(sample, self.scene)
        shown = self.reuse(clock, picture, history, seen)
        with clock("gathering"):
            missing = history.gathering.gather(picture)
        if missing > self.settings["threshold"] * shown:
            return self._key_frame(clock, history, sample, seen)
        history.note(sample, Taken(missing / max(1, shown), history.gathering.listed()))
        with clock("reflection re-computation"):
            self._trace_listed["reflections"] = reflections_left(self.scene, sample.view)
            history.gathering.fill(picture, self._trace_listed, self.resident, seen)
        history.finish(picture)
        return picture

    def _key_frame(self, clock: Clock, history: "History", sample: Sample, seen: Visibility) -> ReflectionBuffers:
        with clock("key frame"):
            key = history.begin_key(sample, self.scene)
            self._trace_all.shader["reflections"] = reflections_left(self.scene, sample.view)
            self._trace_all.draw(sample.view.camera, seen, key.target, offset=sample.offset, blend=False)
            self.keep(key, seen)
        history.note(sample, Taken(1.0, None))
        return key

    def reused_on(self, seen: Visibility) -> Reuse | None:
        """Of the sample in the middle of the pixels."""
        return self._histories[seen].reuse() if seen in self._histories else None

    def free(self) -> None:
        """Nothing: see `bake`."""

    def release(self) -> None:
        """Give everything back, what is known of pictures too."""
        super().release()
        for history in self._histories.values():
            history.release()
        self._histories.clear()


class History:
    """What is known of the pictures of one canvas, for each sample of the pixel. On the GL thread."""

    def __init__(self, seen: Visibility, memory: float) -> None:
        """For pictures of the size of what is `seen`; as many samples are kept as `memory` MiB hold, at least two."""
        self._size, self._parts = seen.size, seen.parts
        self._most = max(2, int(memory * 2**20 / (2 * PIXEL_BYTES * seen.size[0] * seen.size[1])))
        self.gathering = Gathering(seen.size)
        self._keys: dict[tuple[float, float], ReflectionBuffers] = {}
        self._recent: dict[tuple[float, float], ReflectionBuffers] = {}
        self._spare: ReflectionBuffers | None = None
        self._taken: Taken | None = None

    def key_of(self, sample: Sample) -> ReflectionBuffers:
        """The key frame of this sample of the pixel, an empty one at first or where there is no room to keep it."""
        if sample.offset not in self._keys:
            if len(self._keys) < self._most:
                key = ReflectionBuffers(self._size, self._parts)
            else:
                # The sample in the middle stays: by it is told what was taken over.
                offset = next(offset for offset in reversed(self._keys) if any(offset))
                key = self._keys.pop(offset)
                key.sample = None
                self._spare = self._recent.pop(offset, self._spare)
            self._keys[sample.offset] = key
        return self._keys[sample.offset]

    def recent_of(self, sample: Sample) -> ReflectionBuffers | None:
        """The last picture of this sample of the pixel, unless that was the key frame."""
        return self._recent.get(sample.offset)

    def begin(self, sample: Sample, scene: Scene) -> ReflectionBuffers:
        """An empty picture; `finish` keeps it."""
        if self._spare is None:
            self._spare = ReflectionBuffers(self._size, self._parts)
        self._spare.begin(sample, scene)
        return self._spare

    def finish(self, picture: ReflectionBuffers) -> None:
        """Keep a picture as the last one."""
        offset = picture.sample.offset
        self._spare, self._recent[offset] = self._recent.get(offset), picture

    def begin_key(self, sample: Sample, scene: Scene) -> ReflectionBuffers:
        """An empty key frame; what was known before is forgotten."""
        self._spare = self._recent.pop(sample.offset, self._spare)
        key = self.key_of(sample)
        key.begin(sample, scene)
        return key

    def note(self, sample: Sample, taken: "Taken") -> None:
        """Remember what the sample in the middle took over."""
        if not any(sample.offset):
            self._taken = taken

    def reuse(self) -> Reuse | None:
        """What was noted last."""
        if self._taken is None:
            return None
        retraced, pixels = np.zeros(self._size[::-1], bool), self._taken.pixels
        if pixels is None:
            retraced = self._keys[0.0, 0.0].mask()
        else:
            retraced[pixels[:, 1], pixels[:, 0]] = True
        return Reuse(retraced[::-1], self._taken.share, pixels is None)

    def release(self) -> None:
        """Give the memory back."""
        spare = () if self._spare is None else (self._spare,)
        for part in (self.gathering, *self._keys.values(), *self._recent.values(), *spare):
            part.release()


@dataclass(frozen=True, eq=False)
class Taken:
    """Share of the reflectors' pixels that were traced, and which: (N, 2) columns and rows; None for a key frame."""

    share: float
    pixels: np.ndarray | None
