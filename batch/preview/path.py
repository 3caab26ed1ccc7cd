"""The path of a camera: sampled while flying, kept as JSON, played again."""

import json
from dataclasses import dataclass
from functools import cached_property
from math import degrees, radians
from pathlib import Path

import numpy as np

from ...addon.errors import SceneError, UsageError
from ..results import atomically
from .camera import STEEPEST, Pose

EXTENSION = ".path.json"

_SCHEMA = 1
_INTERVAL = 1 / 30
_LONGEST = 3600.0


@dataclass(frozen=True, eq=False)
class CameraPath:
    """Where a camera was: `times` (K,) seconds that grow from 0 on, K at least 2, and `keys` (K, 5).

    A key is x, y, z in metres, yaw and pitch in radians.
    """

    times: np.ndarray
    keys: np.ndarray

    @property
    def duration(self) -> float:
        """Seconds from the first key to the last."""
        return float(self.times[-1])

    def at(self, seconds: float) -> Pose:
        """The pose at that time, held at both ends.

        Between keys runs a cubic, whose slope at a key is that of the parabola through it and its neighbours.
        """
        time = float(np.clip(seconds, 0.0, self.duration))
        after = int(np.clip(np.searchsorted(self.times, time, side="right"), 1, len(self.times) - 1))
        before = after - 1
        span = self.times[after] - self.times[before]
        t = (time - self.times[before]) / span
        rise = (2.0 * t - 3.0) * t * t + 1.0
        value = rise * self.keys[before] + (1.0 - rise) * self.keys[after]
        value += span * t * (1.0 - t) * ((1.0 - t) * self._slopes[before] - t * self._slopes[after])
        return Pose(value[:3], float(value[3]), float(np.clip(value[4], -STEEPEST, STEEPEST)))

    @cached_property
    def _slopes(self) -> np.ndarray:
        return np.gradient(self.keys, self.times, axis=0)

    def save(self, path: Path) -> None:
        """Write the path, whole or not at all."""
        rows = [
            {
                "time": round(float(time), 4),
                "position": [round(float(value), 5) for value in key[:3]],
                "yaw": round(degrees(key[3]), 4),
                "pitch": round(degrees(key[4]), 4),
            }
            for time, key in zip(self.times, self.keys, strict=True)
        ]
        with atomically(path) as temporary:
            lines = ",\n  ".join(json.dumps(row) for row in rows)
            temporary.write_text(f'{{"schema": {_SCHEMA}, "keys": [\n  {lines}\n]}}\n', encoding="utf-8")

    @classmethod
    def load(cls, path: Path) -> "CameraPath":
        """Read what `save` wrote, or a person did. Raises `UsageError`, which says what is wrong."""
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if not isinstance(content, dict) or content.get("schema") != _SCHEMA:
                raise ValueError(f"it is not a camera path of schema {_SCHEMA}")
            times = np.array([key["time"] for key in content["keys"]], np.float64)
            rows = [[*key["position"], radians(key["yaw"]), radians(key["pitch"])] for key in content["keys"]]
            keys = np.array(rows, np.float64)
        except OSError as error:
            raise UsageError(f"cannot read {path}: {error.strerror}") from None
        except KeyError as missing:
            raise UsageError(f"{path} is no camera path: a key lacks {missing}") from None
        except (ValueError, TypeError) as error:
            raise UsageError(f"{path} is no camera path: {error}") from None
        _check(path, times, keys)
        return cls(times - times[0], keys)


def _check(path: Path, times: np.ndarray, keys: np.ndarray) -> None:
    if len(times) < 2:
        raise UsageError(f"{path} is no camera path: it needs two keys or more")
    if keys.shape != (len(times), 5) or not (np.isfinite(keys).all() and np.isfinite(times).all()):
        raise UsageError(f"{path} is no camera path: each key has a time, a position of 3 numbers, a yaw and a pitch")
    if (np.diff(times) <= 0.0).any():
        raise UsageError(f"{path} is no camera path: its times must grow from key to key")
    if times[-1] - times[0] > _LONGEST:
        raise UsageError(f"{path} lasts {times[-1] - times[0]:,.0f} s: a path may last an hour")


class Recorder:
    """Takes down where a camera is, at most 30 times a second."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self._times: list[float] = []
        self._keys: list[list[float]] = []

    @property
    def seconds(self) -> float:
        """How long the path is so far."""
        return self._times[-1] - self._times[0] if self._times else 0.0

    def add(self, now: float, pose: Pose, last: bool = False) -> None:
        """The camera is at `pose` at `now` seconds; the `last` pose is taken down however near the one before."""
        if self._times and now - self._times[-1] < (1e-3 if last else _INTERVAL):
            return
        self._times.append(now)
        self._keys.append([*pose.position, pose.yaw, pose.pitch])

    def path(self) -> CameraPath:
        """What was taken down. Raises `SceneError` where it is nothing."""
        if len(self._times) < 2:
            raise SceneError("nothing was recorded: fly for a moment between the two presses of R")
        times = np.array(self._times)
        return CameraPath(times - times[0], np.array(self._keys))
