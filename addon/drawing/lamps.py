"""Lamps and the world's light as `direct` lighting reads them."""

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from ..scene import Lamp, LampKind, World

_SH_FACTORS = np.pi * np.array([1.0, *[2.0 / 3.0] * 3, *[0.25] * 5])
_LARGEST_PANORAMA = 512

_LIGHT: "WeakKeyDictionary[World, np.ndarray]" = WeakKeyDictionary()


def lamp_rows(lamps: Sequence[Lamp]) -> np.ndarray:
    """(3 a lamp, 4) float32, at least one lamp's rows; the layout is in gpu_shaders/common/lamps.glsl."""
    rows = np.zeros((max(1, len(lamps)), 3, 4), np.float32)
    for row, lamp in zip(rows, lamps, strict=False):
        axis = -lamp.matrix[:3, 2] / np.linalg.norm(lamp.matrix[:3, 2])
        half, blend = lamp.cone
        row[0] = *lamp.matrix[:3, 3], lamp.kind
        row[1] = *axis, np.cos(half) if lamp.kind is LampKind.SPOT else -1.0
        row[2] = *lamp.color, _inner_cosine(half, blend)
    return rows.reshape(-1, 4)


def _inner_cosine(half: float, blend: float) -> float:
    """Where a spot's edge ends: Blender fades it over `blend` of the cone's cosine range."""
    return float(np.cos(half) + blend * (1.0 - np.cos(half)))


def world_light(world: World) -> np.ndarray:
    """(9, 3) float32: irradiance over pi in real spherical harmonics, bands 0 to 2; kept as long as the world lives.

    Source: Ramamoorthi and Hanrahan, *An efficient representation for irradiance environment maps*, 2001.
    """
    if world not in _LIGHT:
        _LIGHT[world] = _light_of(world)
    return _LIGHT[world]


def _light_of(world: World) -> np.ndarray:
    if world.panorama is None:
        light = np.zeros((9, 3), np.float32)
        light[0] = np.asarray(world.color) / 0.282095
        return light
    step = max(1, world.panorama.shape[0] // _LARGEST_PANORAMA)
    radiance = world.panorama[::step, ::step, :3].astype(np.float64)
    height, width = radiance.shape[:2]
    azimuth = np.pi * (1.0 - 2.0 * (np.arange(width) + 0.5) / width)
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)
    x, y = (np.cos(elevation)[:, None] * turn(azimuth) for turn in (np.cos, np.sin))
    z = np.sin(elevation)[:, None] * np.ones(width)
    solid_angle = 2.0 * np.pi**2 / (width * height) * np.cos(elevation)
    projected = np.einsum("bhw,hwc,h->bc", _basis(x, y, z), radiance, solid_angle)
    return (projected * _SH_FACTORS[:, None] / np.pi).astype(np.float32)


def _basis(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(9, ...) real spherical harmonics of unit directions."""
    return np.stack(
        [
            np.full_like(x, 0.282095),
            0.488603 * y,
            0.488603 * z,
            0.488603 * x,
            1.092548 * x * y,
            1.092548 * y * z,
            0.315392 * (3.0 * z * z - 1.0),
            1.092548 * x * z,
            0.546274 * (x * x - y * y),
        ]
    )
