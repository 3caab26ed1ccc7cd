"""A camera that flies: where it stands, which way it looks, and how it moves. Pure NumPy."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, exp, radians, sin

import numpy as np

STEEPEST = radians(89.0)
"""The camera never looks straight up or down, where left and right would swap."""

_PITCHES = (-STEEPEST, STEEPEST)
_QUICKNESS = 8.0  # 1/s: after a quarter of a second a flight is at 86 % of its speed
_AT_REST = 1e-3  # of the speed asked for


@dataclass(frozen=True, eq=False)
class Pose:
    """A camera without roll: `position` (3,) float64 metres, `yaw` and `pitch` in radians.

    At yaw 0 it looks along +Y, and turns left as yaw grows; pitch is positive upwards.
    """

    position: np.ndarray
    yaw: float = 0.0
    pitch: float = 0.0

    @classmethod
    def of(cls, matrix: np.ndarray) -> "Pose":
        """The pose that looks where a camera with that (4, 4) matrix does; its roll is lost."""
        _, up, back = matrix[:3, :3].T
        level = up * np.sign(back[2] or 1.0) if abs(back[2]) > sin(STEEPEST) else -back
        yaw = np.arctan2(-level[0], level[1])
        return cls(matrix[:3, 3].copy(), float(yaw), float(np.clip(np.arcsin(np.clip(-back[2], -1, 1)), *_PITCHES)))

    @cached_property
    def matrix(self) -> np.ndarray:
        """(4, 4) float64 camera to world, as of `Camera`."""
        right = np.array([cos(self.yaw), sin(self.yaw), 0.0])
        level = np.array([-sin(self.yaw), cos(self.yaw), 0.0])
        forward = cos(self.pitch) * level + np.array([0.0, 0.0, sin(self.pitch)])
        matrix = np.eye(4)
        matrix[:3] = np.stack([right, np.cross(right, forward), -forward, self.position], axis=1)
        return matrix

    def turned(self, yaw: float, pitch: float) -> "Pose":
        """Turned by these radians."""
        return replace(self, yaw=self.yaw + yaw, pitch=float(np.clip(self.pitch + pitch, *_PITCHES)))

    def moved(self, offset: np.ndarray) -> "Pose":
        """Moved by `offset` (3,) in world space."""
        return replace(self, position=self.position + offset)


class Flight:
    """A pose in movement: it gathers speed and comes to rest smoothly, at any frame rate alike."""

    def __init__(self, pose: Pose) -> None:
        """Begin at rest."""
        self.pose = pose
        self._velocity = np.zeros(3)

    @property
    def is_moving(self) -> bool:
        """Whether another `step` without any wish would still move the camera."""
        return bool(self._velocity.any())

    def step(self, wish: np.ndarray, speed: float, seconds: float) -> None:
        """Fly on for `seconds`.

        `wish` (3,) says where to: right, up (the world's) and forward, each -1..1; `speed` in metres a second is
        reached when it is of unit length or longer. The velocity v nears the wished one w as v' = k (w - v),
        which is solved exactly, so that two half steps are one whole.
        """
        right, _, back = self.pose.matrix[:3, :3].T
        wanted = np.stack([right, np.array([0.0, 0.0, 1.0]), -back], axis=1) @ wish
        wanted *= speed / max(1.0, float(np.linalg.norm(wish)))
        faded = exp(-_QUICKNESS * seconds)
        behind = self._velocity - wanted
        self.pose = self.pose.moved(wanted * seconds + behind * (1.0 - faded) / _QUICKNESS)
        self._velocity = wanted + behind * faded
        if not np.any(wish) and np.linalg.norm(self._velocity) < _AT_REST * speed:
            self._velocity = np.zeros(3)

    def turn(self, yaw: float, pitch: float) -> None:
        """Look elsewhere, at once."""
        self.pose = self.pose.turned(yaw, pitch)

    def jump(self, pose: Pose) -> None:
        """Be at `pose`, at rest."""
        self.pose = pose
        self._velocity = np.zeros(3)
