"""What Xie, Wang and Dutré printed of their sequences, to stand beside ours."""

from typing import NamedTuple


class Printed(NamedTuple):
    """A row of their Table 1; `fps` and `interval` as (most, least, mean) and (most, mean), shares in 0..1."""

    scene: str
    fps: tuple[float, float, float]
    traced_fps: float
    interval: tuple[int, float]
    retraced: float

    @property
    def speedup(self) -> float:
        """Over tracing every frame."""
        return self.fps[2] / self.traced_fps


SEQUENCES = (
    Printed("Toilet, first path", (54.9, 13.0, 33.4), 18.5, (51, 20.6), 0.208),
    Printed("Toilet, second path", (49.5, 12.6, 34.9), 18.0, (63, 20.0), 0.189),
    Printed("Living room, first path", (50.8, 7.0, 34.7), 9.4, (164, 53.1), 0.187),
    Printed("Living room, second path", (48.4, 6.6, 32.0), 8.8, (92, 24.2), 0.185),
)
"""Table 1: 500 frames of 1024×1024 each, on a GeForce GTX 980M, against OptiX."""

STAGES = (
    ("diffuse shading", 0.6, 0.7),
    ("pixel searching", 3.4, 2.2),
    ("reflection shifting", 1.3, 1.7),
    ("reflection warping", 2.7, 2.1),
    ("reflection re-computation", 20.3, 23.2),
    ("blend shading", 0.9, 0.7),
    ("total", 29.3, 30.5),
)
"""Table 2: milliseconds in the toilet and in the living room."""
