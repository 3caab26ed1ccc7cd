"""What a viewport may show in place of the picture."""

import numpy as np

from ..methods.studio import Picture

_FAR = 1e29


def colored(picture: Picture, overlay: str) -> np.ndarray:
    """(H, W, 4) float32 scene-linear, opaque: the picture, or what `overlay` (see `properties`) tells of it."""
    shown = picture.pixels.copy()
    reflectors = shown[..., 3].copy()
    shown[..., 3] = 1.0
    if overlay == "REFLECTORS":
        shown[..., :3] = shown[..., :3] * 0.2 + reflectors[..., None] * np.float32([0.05, 0.6, 0.1])
    elif overlay == "DISTANCE":
        shown[..., :3] = _distances(picture.distance)
    return shown


def _distances(distance: np.ndarray) -> np.ndarray:
    """Grey by distance over its median, from white at the surface to black far off; the world blue, no mirror black."""
    met = (distance > 0.0) & (distance < _FAR)
    middle = float(np.median(distance[met])) if met.any() else 1.0
    colors = np.zeros((*distance.shape, 3), np.float32)
    colors[met] = (middle / (middle + distance[met]))[:, None]
    colors[distance >= _FAR] = (0.0, 0.05, 0.3)
    return colors
