"""LDR-FLIP: how much a person sees two pictures differ that alternate on a screen (Andersson et al. 2020).

The evaluator of its authors needs over a second for a megapixel, too long for films. This is the same, within rounding,
in a tenth of that, and what it sees of a reference is kept for the next picture that is held against it.
"""

from dataclasses import dataclass

import numpy as np

from .filters import across, blurred, down

PIXELS_PER_DEGREE = 3840 * np.pi / 180
"""67, for FLIP's default observer: 0.7 m from a screen that is 0.7 m and 3840 pixels wide."""

# Section 4.1: contrast sensitivity, as sums of Gaussians of weight a and spread b, by opponent channel.
_SENSITIVITY = (((1.0, 0.0047),), ((1.0, 0.0053),), ((34.1, 0.04), (13.5, 0.025)))
_WIDEST = 0.04

# Section 4.1.3: compression of large colour differences. Section 4.2: width of the feature detector in degrees, and
# the exponent of the feature difference.
_COLOR_POWER, _KNEE, _KNEE_ERROR = 0.7, 0.4, 0.95
_FEATURE_WIDTH, _FEATURE_POWER = 0.082, 0.5

_PRIMARIES, _WHITE = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06)), (0.31271, 0.32902)


@dataclass(frozen=True, eq=False)
class Seen:
    """What the observer sees of a picture: Hunt-adjusted L*a*b* (3, H, W), and edges and points (H, W), float32."""

    color: np.ndarray
    edges: np.ndarray
    points: np.ndarray


def seen(linear: np.ndarray) -> Seen:
    """What is seen of a picture (3, H, W) float32 of linear light in 0..1."""
    blurs = [
        sum(share * blurred(channel, kernel) for share, kernel in kernels)
        for channel, kernels in zip(_mixed(_OPPONENT, linear), _KERNELS, strict=True)
    ]
    shown = np.clip(_mixed(_FROM_OPPONENT, np.stack(blurs)), 0.0, 1.0)
    return Seen(_adjusted_lab(shown), *_features(_mixed(_TO_XYZ[1:2], linear)[0]))


def flip(test: Seen, reference: Seen) -> np.ndarray:
    """(H, W) float32 in 0..1: FLIP of two pictures of one size."""
    color = _apart(test.color, reference.color) ** np.float32(_COLOR_POWER)
    knee = np.float32(_KNEE * _MOST_COLOR)
    slope = (1.0 - _KNEE_ERROR) / (_MOST_COLOR - knee)
    error = np.where(color < knee, color * np.float32(_KNEE_ERROR / knee), _KNEE_ERROR + (color - knee) * slope)
    feature = np.maximum(np.abs(test.edges - reference.edges), np.abs(test.points - reference.points))
    likeness = 1.0 - (feature * np.float32(0.5**0.5)) ** np.float32(_FEATURE_POWER)
    return np.clip(error, 0.0, 1.0).astype(np.float32) ** np.maximum(likeness, 0.0)


def _features(luminance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The strength of edges and of points in luminance (H, W) 0..1: derivatives of a Gaussian (section 4.2)."""
    flat, edge, point = _DETECTORS
    smooth, steep, curved = (across(luminance, kernel) for kernel in _DETECTORS)
    return _length(down(steep, flat), down(smooth, edge)), _length(down(curved, flat), down(smooth, point))


def _adjusted_lab(rgb: np.ndarray) -> np.ndarray:
    """L*a*b* (3, H, W) of linear colours (3, H, W) in 0..1, less colourful where it is dark, as Hunt found."""
    xyz = _mixed(_TO_XYZ, rgb)
    bent = 6.0 / 29.0
    x, y, z = np.where(xyz > bent**3, np.cbrt(xyz), xyz * np.float32(1.0 / (3.0 * bent**2)) + np.float32(4.0 / 29.0))
    lightness = 116.0 * y - 16.0
    return np.stack([lightness, 5.0 * lightness * (x - y), 2.0 * lightness * (y - z)])


def _mixed(matrix: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """float32 (N, H, W): `matrix` (N, 3) times the colours (3, H, W), a row of pixels at a time (see filters.py)."""
    found = np.empty((len(matrix), *planes.shape[1:]), np.float32)
    np.matmul(matrix, planes.swapaxes(0, 1), out=found.swapaxes(0, 1))
    return found


def _apart(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """HyAB: the distance (...) of colours (3, ...), lightness added to what lies across it."""
    lightness, a, b = one - other
    return np.abs(lightness) + _length(a, b)


def _length(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    # np.hypot takes care of numbers that do not occur here, and ten times as long.
    return np.sqrt(x * x + y * y)


def _to_xyz() -> np.ndarray:
    """sRGB's linear colours as XYZ over that of white, float32 (3, 3)."""
    columns = np.stack([_xyz(*primary) for primary in _PRIMARIES], axis=1)
    white = _xyz(*_WHITE)
    return (columns * np.linalg.solve(columns, white) / white[:, None]).astype(np.float32)


def _xyz(x: float, y: float) -> np.ndarray:
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


def _kernels(gaussians: tuple) -> list[tuple[np.float32, np.ndarray]]:
    """A channel's Gaussians: the share of each in the whole, and its kernel along a line, of sum 1 (equation 2)."""
    radius = int(np.ceil(3.0 * np.sqrt(_WIDEST / (2.0 * np.pi**2)) * PIXELS_PER_DEGREE))
    degrees = np.arange(-radius, radius + 1) / PIXELS_PER_DEGREE
    lines = [np.exp(-((np.pi * degrees) ** 2) / spread) for _, spread in gaussians]
    shares = [weight * np.sqrt(np.pi / b) * line.sum() ** 2 for (weight, b), line in zip(gaussians, lines, strict=True)]
    return [(np.float32(share / sum(shares)), line / line.sum()) for share, line in zip(shares, lines, strict=True)]


def _detectors() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A Gaussian of sum 1, its first derivative and its second; of those each sign comes to 1."""
    deviation = 0.5 * _FEATURE_WIDTH * PIXELS_PER_DEGREE
    radius = int(np.ceil(3.0 * deviation))
    pixels = np.arange(-radius, radius + 1)
    bell = np.exp(-(pixels**2) / (2.0 * deviation**2))
    slope, bend = -pixels * bell, (pixels**2 / deviation**2 - 1.0) * bell
    return bell / bell.sum(), *(np.where(k > 0, k / k[k > 0].sum(), -k / k[k < 0].sum()) for k in (slope, bend))


_TO_XYZ = _to_xyz()
_OPPONENT = np.float32([[0, 116, 0], [500, -500, 0], [0, 200, -200]]) @ _TO_XYZ
"""Linear colours to lightness, red against green and blue against yellow (YCxCz), black at 0."""

_FROM_OPPONENT = np.linalg.inv(_OPPONENT.astype(np.float64)).astype(np.float32)
_KERNELS = [_kernels(gaussians) for gaussians in _SENSITIVITY]
_DETECTORS = _detectors()

_GREEN, _BLUE = _adjusted_lab(np.eye(3, dtype=np.float32)[:, None, 1:])[:, 0].T
_MOST_COLOR = float(_apart(_GREEN, _BLUE) ** _COLOR_POWER)
"""The largest difference of two colours, compressed: green and blue."""
