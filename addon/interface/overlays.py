"""What a viewport may show: the picture, or what is known of it. Colours are scene-linear and opaque."""

import numpy as np

from ..methods.studio import Develop

_LARGEST_HALF = 65504.0
_FAR = 1e29


def picture(color: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The picture itself, as far as half floats reach."""
    shown = np.minimum(color, _LARGEST_HALF)
    shown[..., 3] = 1.0
    return shown


def reflectors(color: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Where a reflector shows: green over the darkened picture."""
    shown = picture(color, distance)
    shown[..., :3] = shown[..., :3] * 0.2 + color[..., 3:] * np.float32([0.05, 0.6, 0.1])
    return shown


def hit_distance(color: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """How far off is what a mirror shows: white at its surface, grey at the median, black far away, the world blue."""
    met = (distance > 0.0) & (distance < _FAR)
    middle = float(np.median(distance[met])) if met.any() else 1.0
    shown = np.zeros_like(color)
    shown[met, :3] = (middle / (middle + distance[met]))[:, None]
    shown[distance >= _FAR, :3] = (0.0, 0.05, 0.3)
    shown[..., 3] = 1.0
    return shown


DEVELOPS: dict[str, Develop] = {"PICTURE": picture, "REFLECTORS": reflectors, "DISTANCE": hit_distance}
"""By the identifiers of the setting."""
