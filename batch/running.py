"""Methods that go on from frame to frame."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

from ..addon.methods.contract import Frame, Method
from ..addon.methods.registry import METHODS
from ..addon.parameters import Value
from ..addon.progress import Progress, part_of
from .judging import Shot
from .results import Times

_WHOLE = "reflection", "frame"


@dataclass
class _Act:
    """A prepared method, the frame it drew last, and whether that took over from earlier ones."""

    method: Method
    frame: int | None = None
    temporal: bool = False


@dataclass(frozen=True, eq=False)
class Taken:
    """A method's picture, the milliseconds that it baked for it, and whether it began anew in the middle."""

    frame: Frame
    bake_ms: float
    anew: bool = False

    @property
    def times(self) -> Times:
        """What it took, as a row has it."""
        stages = {name: float(time) for name, time in self.frame.time_ms.items() if name not in _WHOLE}
        return Times(self.bake_ms, *(self.frame.time_ms.get(name) for name in _WHOLE), stages)


class Running:
    """Methods of one scene that are prepared once and then told of each frame. All stay on the GPU until `leave`."""

    def __init__(self) -> None:
        """Begin with none."""
        self._acts: dict[str, _Act] = {}

    def take(
        self, shot: Shot, name: str, settings: Mapping[str, Value], progress: Progress, before: int | None = None
    ) -> Taken:
        """The method's picture of the shot.

        `before` is the frame before this one, None for the first. A method that takes over from earlier frames and
        did not draw that one begins anew; so does one that has failed.
        """
        act = self._acts.get(name)
        if act and act.temporal and act.frame != before:
            self.leave(name)
        first = name not in self._acts
        try:
            bake_ms = self._prepare(shot, name, settings, part_of(progress, 0.0, 0.5))
            act = self._acts[name]
            frame = shot.take(act.method, part_of(progress, 0.5, 1.0))
        except BaseException:
            self.leave(name)
            raise
        act.frame, act.temporal = shot.scene.frame, frame.reuse is not None
        return Taken(frame, bake_ms, first and act.temporal and before is not None)

    def _prepare(self, shot: Shot, name: str, settings: Mapping[str, Value], progress: Progress) -> float:
        start = time.perf_counter()
        if name in self._acts:
            self._acts[name].method.update(shot.scene, progress)
        else:
            self._acts[name] = _Act(METHODS[name](settings))
            self._acts[name].method.prepare(shot.scene, shot.lighting, progress)
        bake_ms = (time.perf_counter() - start) * 1e3
        if self._acts[name].frame is None:
            shot.warm_up(self._acts[name].method)
        return bake_ms

    def leave(self, name: str) -> None:
        """Give back what a method holds, if it was prepared."""
        if name in self._acts:
            self._acts.pop(name).method.release()

    def close(self) -> None:
        """Give back what all of them hold."""
        for name in list(self._acts):
            self.leave(name)
