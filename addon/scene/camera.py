"""Where the picture is taken from."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np


class SensorFit(StrEnum):
    """Which side of the picture the sensor's size belongs to."""

    AUTO = "AUTO"
    HORIZONTAL = "HORIZONTAL"
    VERTICAL = "VERTICAL"


@dataclass(frozen=True, eq=False)
class Camera:
    """A Blender camera: looks along its own -Z, +Y up.

    `matrix` (4, 4) float64 camera to world, without scale; `lens` and the sensor in millimetres;
    `shift` in units of the larger side; `ortho_scale` in metres, for an orthographic camera (None
    for a perspective one); `near` and `far` in metres; `pixel_aspect` height over width of a pixel.
    """

    matrix: np.ndarray
    lens: float = 50.0
    sensor: tuple[float, float] = (36.0, 24.0)
    sensor_fit: SensorFit = SensorFit.AUTO
    shift: tuple[float, float] = (0.0, 0.0)
    ortho_scale: float | None = None
    near: float = 0.1
    far: float = 1000.0
    pixel_aspect: float = 1.0

    @classmethod
    def of_matrices(cls, view: np.ndarray, projection: np.ndarray, width: int, height: int) -> "Camera":
        """The camera of a `width` × `height` viewport, from the matrices that OpenGL draws it with.

        `view` (4, 4) world to camera, `projection` (4, 4) as of `projection`.
        """
        p = np.asarray(projection, np.float64)
        across, up = 2.0 / p[0, 0], 2.0 / p[1, 1]
        if is_ortho := p[3, 3] == 1.0:
            centre = -p[:2, 3] * (across, up) / 2.0
            near, far = (p[2, 3] + 1.0) / p[2, 2], (p[2, 3] - 1.0) / p[2, 2]
        else:
            centre = p[:2, 2] * (across, up) / 2.0
            near, far = p[2, 3] / (p[2, 2] - 1.0), p[2, 3] / (p[2, 2] + 1.0)
        return cls(
            np.linalg.inv(np.asarray(view, np.float64)),
            lens=1.0 / across,
            sensor=(1.0, 1.0),
            sensor_fit=SensorFit.HORIZONTAL,
            shift=(centre[0] / across, centre[1] / across),
            ortho_scale=across if is_ortho else None,
            near=near,
            far=far,
            pixel_aspect=up / across * width / height,
        )

    @property
    def position(self) -> np.ndarray:
        """(3,) float64 world position."""
        return self.matrix[:3, 3]

    def window(self, width: int, height: int) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the picture at distance 1 (metres, for an orthographic camera)."""
        shown = (float(width), height * self.pixel_aspect)
        horizontal = self.sensor_fit is SensorFit.HORIZONTAL or (
            self.sensor_fit is SensorFit.AUTO and shown[0] >= shown[1]
        )
        fitted = shown[0] if horizontal else shown[1]
        sensor = self.sensor[1] if self.sensor_fit is SensorFit.VERTICAL else self.sensor[0]
        size = self.ortho_scale if self.ortho_scale is not None else sensor / self.lens
        half_x, half_y = (0.5 * size * side / fitted for side in shown)
        centre_x, centre_y = self.shift[0] * size, self.shift[1] * size
        return centre_x - half_x, centre_x + half_x, centre_y - half_y, centre_y + half_y

    def projection(self, width: int, height: int) -> np.ndarray:
        """(4, 4) float64 from camera space to OpenGL's clip space."""
        left, right, bottom, top = self.window(width, height)
        near, far = self.near, self.far
        if self.ortho_scale is not None:
            return np.array(
                [
                    [2 / (right - left), 0, 0, -(right + left) / (right - left)],
                    [0, 2 / (top - bottom), 0, -(top + bottom) / (top - bottom)],
                    [0, 0, -2 / (far - near), -(far + near) / (far - near)],
                    [0, 0, 0, 1.0],
                ]
            )
        return np.array(
            [
                [2 / (right - left), 0, (right + left) / (right - left), 0],
                [0, 2 / (top - bottom), (top + bottom) / (top - bottom), 0],
                [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
                [0, 0, -1.0, 0],
            ]
        )
