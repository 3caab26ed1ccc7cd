"""Attenuation planes: a floor's blur and Fresnel term as a stack of partially transparent planes.

Source: the paper on glossy planar reflections, section 3. The reflected scene is drawn under the floor, then planes
are drawn over it. Each lets a share of the light through, so that the planes between the geometry and the viewer give
its attenuation. Planes parallel to the floor fade the reflection with height (figure 13); tilted ones fade it with
height and with the angle of incidence (figures 7 and 14).

Here the mirrored scene is turned up again: a point has its `distance` along the floor from under the eye, in the
direction of view, and its `height` above the floor, both in metres, and the eye is at height -`eye_height`. A plane
is a line there, and lies between a point and the eye where the point is above the line. In the world, heights count
downwards from the floor. Planes instead of cones mean that the distance is measured along the view, not around the
eye, as the paper says.

What the paper leaves open, and what is done here:

- How fast the blur fades the reflection, which it found by experiment: see `Fading` and its `detail`.
- How both functions combine: they are multiplied.
- How much a plane takes: all take the same amount of light, at most 1/count, so that no step is seen first.
  Their factors therefore differ.
- Where the tilted planes turn. Points of one Fresnel factor lie on a line through the eye; those of one fade, on
  nearly a level line. A plane in between meets the vertical under the eye between the eye and about the floor,
  and each gets the height there that fits it best. Planes that all turn about the viewer's foot itself
  (`foot_height` 0) cannot darken what touches the floor, and miss by far more: see `tilted_planes`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...errors import UsageError
from .gloss import filter_radius, fresnel, fresnel_factor, positive

DETAIL = 0.05
"""The r/d at which blur halves the reflection: the width of half a metre seen ten metres away."""

_SAMPLES = 32
"""Points of a curve of equal attenuation that a plane is fitted to; more do not move it visibly."""

_HALVINGS = 40
"""Of an interval, to find a point of such a curve: to less than a nanometre."""

_SHORT_OF_THE_EYE = 0.98
"""No plane comes closer to the eye than this share of its height: from the eye itself a plane is a line."""


@dataclass(frozen=True)
class Fading:
    """What the planes approximate: the share of its light, 0 to 1, that a mirrored point keeps.

    It is detail / (detail + r/d), with r/d of figure 5: what a feature as wide as `detail` keeps of its contrast
    when it is blurred by r/d. With `ior`, times the Fresnel factor of figure 6, but never less than that at normal
    incidence: above an index of 2 + √3 the factor dips below it before it rises, and planes, which only darken what
    is higher, cannot follow. `lobe_angle` in radians from 0 to below π/4, `eye_height` in metres.
    """

    lobe_angle: float
    eye_height: float
    ior: float | None = None
    detail: float = DETAIL

    def __call__(self, distance: ArrayLike, height: ArrayLike) -> np.ndarray:
        """float64, of the shape that `distance` and `height` have together: falls with height, not with distance."""
        kept = self.detail / (self.detail + filter_radius(distance, height, self.eye_height, self.lobe_angle))
        if self.ior is None:
            return kept
        return kept * np.maximum(fresnel_factor(distance, height, self.eye_height, self.ior), fresnel(1.0, self.ior))


@dataclass(frozen=True)
class AttenuationPlanes:
    """A stack of planes, in the order in which a point that rises from the floor far away comes through them.

    `foot_heights` (N,): metres, where a plane meets the vertical through the viewer's foot. `tilts` (N,): radians,
    0 to below π/2, by which it rises with the distance. `factors` (N,): the share of light that it lets through.
    `strength` is the share that is left where no plane is crossed; `fading` is what they stand for.
    """

    foot_heights: np.ndarray
    tilts: np.ndarray
    factors: np.ndarray
    strength: float
    fading: Fading

    @property
    def step(self) -> float:
        """The light that the plane which takes most takes, of 1: the height of the steps in the picture."""
        return float(np.abs(np.diff(self.strength * np.cumprod([1.0, *self.factors]))).max())


@dataclass(frozen=True)
class Deviation:
    """How far planes are from what they approximate, of 1: root of the mean square, and the worst."""

    rms: float
    worst: float


def parallel_planes(
    count: int,
    lobe_angle: float,
    eye_height: float = 1.65,
    highest: float = 2.5,
    nearest: float = 5.0,
    farthest: float = 20.0,
    detail: float = DETAIL,
) -> AttenuationPlanes:
    """`count` planes parallel to the floor: the fade by blur alone, as in figure 13.

    Each is at the height that fits its fade best, by least squares, over points from `nearest` to `farthest`
    metres away and up to `highest`. Five metres are where r/d begins to be nearly constant (section 2); nearer the
    true fade is stronger. Raises `UsageError` for what is out of range.
    """
    fading = _checked(Fading(lobe_angle, eye_height, None, detail))
    return _fitted(fading, count, _Box(nearest, farthest, highest), _level)


def tilted_planes(
    count: int,
    lobe_angle: float,
    ior: float,
    eye_height: float = 1.65,
    farthest: float = 20.0,
    highest: float = 2.5,
    detail: float = DETAIL,
    foot_height: float | None = None,
) -> AttenuationPlanes:
    """`count` planes at increasing angles to the floor: the fade by blur and the Fresnel factor, as in figure 14.

    Each is the line of least squares through points of equal attenuation, up to `farthest` metres away and up to
    `highest`; farther and higher it goes on straight. A lobe angle of 0 gives the Fresnel factor alone. `ior` is
    above 1. With `foot_height`, in metres from -0.98 `eye_height` up, all turn about a line at that height above
    the viewer's foot: 64 at height 0 miss figures 5 and 6 by 0.047 in root mean square, where free ones miss by
    0.003, and on the floor they miss by up to 0.58. Raises `UsageError` for what is out of range.
    """
    fading = _checked(Fading(lobe_angle, eye_height, ior, detail))
    closest = -_SHORT_OF_THE_EYE * eye_height
    if foot_height is not None and not closest <= foot_height < math.inf:
        raise UsageError(
            f"foot height: {foot_height:g} m is out of range: give {closest:g} m, just short of the eye, or more"
        )
    fit = _Tilted(closest) if foot_height is None else _Pinned(foot_height)
    return _fitted(fading, count, _Box(0.0, farthest, highest), fit)


def attenuation(planes: AttenuationPlanes, distance: ArrayLike, height: ArrayLike) -> np.ndarray:
    """The share of its light, 0 to 1, that each point keeps: the product over the planes between it and the eye.

    `distance` and `height`, in metres, are numbers or arrays that broadcast.
    """
    distance, height = np.broadcast_arrays(np.asarray(distance, np.float64), np.asarray(height, np.float64))
    kept = np.full(distance.shape, planes.strength)
    for foot, slope, factor in zip(planes.foot_heights, np.tan(planes.tilts), planes.factors, strict=True):
        kept[height > foot + slope * distance] *= factor
    return kept


def deviation(planes: AttenuationPlanes, distances: ArrayLike, heights: ArrayLike) -> Deviation:
    """How far the planes are from their `fading` over all (D,) `distances` at all (H,) `heights`, in metres."""
    along, up = np.meshgrid(distances, heights)
    off = np.abs(attenuation(planes, along, up) - planes.fading(along, up))
    return Deviation(float(np.sqrt(np.mean(off**2))), float(off.max()))


# ---- Levels: how much light is left beyond each plane


@dataclass(frozen=True)
class _Box:
    nearest: float
    farthest: float
    highest: float

    def __post_init__(self):
        positive("nearest", self.nearest, zero=True)
        positive("farthest", self.farthest)
        positive("highest", self.highest)
        if self.farthest <= self.nearest:
            raise UsageError(f"farthest: {self.farthest:g} m is not beyond the nearest, {self.nearest:g} m")


_Fit = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""From (N, S) distances, heights and weights of points to (N,) heights at the foot and slopes."""


def _checked(fading: Fading) -> Fading:
    positive("eye height", fading.eye_height)
    positive("detail", fading.detail)
    positive("lobe angle", fading.lobe_angle, zero=True)
    if fading.lobe_angle >= 0.25 * math.pi:
        raise UsageError(f"lobe angle: {fading.lobe_angle:g} leaves no reflection to fade: give radians below π/4")
    if fading.ior is not None and not 1.0 < fading.ior < math.inf:
        raise UsageError(f"ior: {fading.ior:g} gives no Fresnel factor to fit: give a number above 1")
    return fading


def _fitted(fading: Fading, count: int, box: _Box, fit: _Fit) -> AttenuationPlanes:
    """`count` planes at equal steps between the most and the least light that a point in the box keeps."""
    if count < 1:
        raise UsageError(f"count: {count} planes attenuate nothing: give 1 or more")
    most, least = fading(box.farthest, 0.0), fading(box.nearest, box.highest)
    step = (most - least) / (count + 1)
    # Between two planes the light is the middle of what the function has there: half a step off at most.
    light = most - step * (np.arange(count + 1) + 0.5)
    foot_heights, slopes = fit(*_curves(fading, most - step * np.arange(1, count + 1), box))
    return AttenuationPlanes(foot_heights, np.arctan(slopes), light[1:] / light[:-1], float(light[0]), fading)


def _curves(fading: Fading, levels: np.ndarray, box: _Box) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points where the fading has each of (N,) `levels`: (N, S) distances, heights, and weights of a height's error.

    A curve enters the box at its left or its floor and leaves at its right or its top, for the fading grows with the
    distance and falls with the height.
    """
    first = _where(lambda distance: fading(distance, 0.0) < levels, box.nearest, box.farthest, levels.shape)
    last = _where(lambda distance: fading(distance, box.highest) < levels, box.nearest, box.farthest, levels.shape)
    along = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    distance = first[:, None] + (last - first)[:, None] * along
    height = _where(lambda height: fading(distance, height) > levels[:, None], 0.0, box.highest, distance.shape)
    # An error of the height is worth the error of the attenuation that it makes.
    rise = 1e-4 * box.highest
    slope = (fading(distance, height) - fading(distance, height + rise)) / rise
    return distance, height, np.maximum(slope, 1e-12) ** 2


def _where(before: Callable[[np.ndarray], np.ndarray], low: float, high: float, shape: tuple) -> np.ndarray:
    """The place between `low` and `high` up to which `before` holds, by halving; an end where it holds all along."""
    lows, highs = np.full(shape, low), np.full(shape, high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (lows + highs)
        holds = before(middle)
        lows, highs = np.where(holds, middle, lows), np.where(holds, highs, middle)
    return 0.5 * (lows + highs)


# ---- Fits: a line through the points of each level


def _level(distance: np.ndarray, height: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines parallel to the floor."""
    return np.average(height, 1, weight), np.zeros(len(height))


@dataclass(frozen=True)
class _Pinned:
    """Lines through one height at the foot."""

    foot_height: float

    def __call__(self, distance: np.ndarray, height: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        slope = _slope(distance, height - self.foot_height, weight)
        return np.full(len(slope), self.foot_height), slope


@dataclass(frozen=True)
class _Tilted:
    """Free lines, but for those that would meet the vertical at the foot below `lowest`, at the eye: pinned there."""

    lowest: float

    def __call__(self, distance: np.ndarray, height: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        centre = np.average(distance, 1, weight), np.average(height, 1, weight)
        away = distance - centre[0][:, None]
        slope = _slope(away, height - centre[1][:, None], weight)
        foot = centre[1] - slope * centre[0]
        pinned, steeper = _Pinned(self.lowest)(distance, height, weight)
        behind = foot < self.lowest
        return np.where(behind, pinned, foot), np.where(behind, steeper, slope)


def _slope(along: np.ndarray, up: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """(N,) slopes, 0 or more, of the lines of least squares through the origin."""
    return np.maximum((weight * along * up).sum(1) / np.maximum((weight * along**2).sum(1), 1e-300), 0.0)
