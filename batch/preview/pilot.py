"""Where the camera is: flown by keys and mouse, or along a path."""

from dataclasses import replace

import numpy as np

from ...addon.drawing import world_boxes
from ...addon.scene import Camera, Scene
from .camera import Flight, Pose
from .keys import FLYING, wish_of
from .path import CameraPath, Recorder

_FASTER = 4.0
_SECONDS_ACROSS = 4.0
"""What a flight to the middle of the reflectors takes at first."""
_LEAST_SPEED = 0.05


class Pilot:
    """Takes the camera along. Until it moves for the first time it is the scene's own, roll included."""

    def __init__(self, scene: Scene, path: CameraPath | None = None) -> None:
        """Begin at the scene's camera, with a `path` to play or none."""
        self._home = scene.camera
        self.camera = scene.camera
        self.path = path
        self.recorder: Recorder | None = None
        self.played: float | None = None
        self.held: set[str] = set()
        self.speed = _first_speed(scene)
        self._flight = Flight(Pose.of(scene.camera.matrix))
        self._clock = 0.0

    @property
    def is_moving(self) -> bool:
        """Whether the camera will be elsewhere after the next `advance`."""
        return self._flight.is_moving or bool(self.held & FLYING) or self.played is not None

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        self._clock += seconds
        if self.held & FLYING:
            self.played = None
        if self.played is not None:
            self._play(seconds)
        elif self.is_moving:
            speed = self.speed * (_FASTER if "shift" in self.held else 1.0)
            self._flight.step(wish_of(self.held), speed, seconds)
            self._look_from(self._flight.pose)
        if self.recorder is not None:
            self.recorder.add(self._clock, self._flight.pose)

    def _play(self, seconds: float) -> None:
        self.played += seconds
        self._flight.jump(self.path.at(self.played))
        self._look_from(self._flight.pose)
        if self.played >= self.path.duration:
            self.played = None

    def _look_from(self, pose: Pose) -> None:
        self.camera = replace(self._home, matrix=pose.matrix)

    def turn(self, right: float, down: float) -> None:
        """Look elsewhere, by radians; ends a replay."""
        self.played = None
        self._flight.turn(-right, -down)
        self._look_from(self._flight.pose)

    def change_speed(self, steps: float) -> None:
        """Fly faster by so many quarters, or slower."""
        self.speed = float(np.clip(self.speed * 1.25**steps, 1e-4, 1e5))

    def go_home(self) -> None:
        """Back to the scene's camera."""
        self.played = None
        self._flight.jump(Pose.of(self._home.matrix))
        self.camera = self._home

    def rehome(self, camera: Camera) -> None:
        """The scene's camera is another one now. Who has flown away stays there, with the new lens."""
        stays = self.camera is not self._home
        self._home = self.camera = camera
        if stays:
            self._look_from(self._flight.pose)
        else:
            self._flight.jump(Pose.of(camera.matrix))

    def toggle_replay(self) -> None:
        """Play the path from its beginning, or stop; there must be one."""
        self.played = 0.0 if self.played is None else None

    def record(self) -> None:
        """Take down the flight from now on."""
        self.played, self.recorder = None, Recorder()
        self.recorder.add(self._clock, self._flight.pose)

    def end_recording(self) -> CameraPath:
        """The path flown since `record`; raises `SceneError` where there is none."""
        recorder, self.recorder = self.recorder, None
        recorder.add(self._clock, self._flight.pose, last=True)
        self.path = recorder.path()
        return self.path


def turn_per_pixel(camera: Camera, size: tuple[int, int]) -> float:
    """Radians that the middle of the picture takes for a pixel."""
    left, right, _, _ = camera.window(*size)
    return (right - left) / size[0] if camera.ortho_scale is None else 1.0 / size[0]


def _first_speed(scene: Scene) -> float:
    """Metres a second."""
    boxes = world_boxes(scene, scene.reflectors)
    if not len(boxes):
        return 1.0
    distance = np.linalg.norm(np.mean(boxes, axis=(0, 1)) - scene.camera.position)
    return max(_LEAST_SPEED, float(distance) / _SECONDS_ACROSS)
