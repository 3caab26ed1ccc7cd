"""Lamps, the world, and which light a picture is drawn with."""

from dataclasses import dataclass
from enum import IntEnum, StrEnum

import numpy as np


class Lighting(StrEnum):
    """Where a surface's radiance comes from, the same on the real-time side and in Cycles.

    UNLIT: emission if the material emits, else its base colour; tests geometry alone. CYCLES:
    diffuse light baked by Cycles into lightmaps. DIRECT: lamps in the shader, with shadows.
    """

    UNLIT = "unlit"
    CYCLES = "cycles"
    DIRECT = "direct"


class LampKind(IntEnum):
    """Blender's four lamps."""

    SUN = 0
    POINT = 1
    SPOT = 2
    AREA = 3


@dataclass(frozen=True, eq=False)
class Lamp:
    """A Blender lamp. `matrix` (4, 4) float64 to the world; it shines along its own -Z.

    `color` is linear RGB times power: W/m² for a sun, W for the others, as Blender has it. `size`
    is the radius in metres (point, spot), half the sides (area) or (half the angle in radians, 0)
    (sun). `cone` is (half angle in radians, blend 0..1) of a spot.
    """

    name: str
    kind: LampKind
    matrix: np.ndarray
    color: tuple[float, float, float]
    size: tuple[float, float] = (0.0, 0.0)
    cone: tuple[float, float] = (0.785, 0.15)


@dataclass(frozen=True, eq=False)
class World:
    """What lies behind everything: `color` (linear RGB), or `panorama` (H, W, 3) float32, which replaces it.

    The panorama is equirectangular as Cycles maps it, row 0 straight down: direction (x, y, z) lies at
    u = 0.5 - atan2(y, x) / 2π, v = 0.5 + atan2(z, |(x, y)|) / π.
    """

    color: tuple[float, float, float] = (0.0, 0.0, 0.0)
    panorama: np.ndarray | None = None
