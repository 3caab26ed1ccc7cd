"""What a viewport may show: the picture, or what is known of it.

Each is (H, W, 4) float32, scene-linear and opaque, row 0 at the bottom.
"""

import numpy as np

from ..baking.regions import region_view
from ..drawing import Canvas, layer_view
from ..methods.contract import View
from ..methods.mixed import Mixed
from ..methods.studio import Develop

_LARGEST_HALF = 65504.0
_FAR = 1e29
_RAMP = np.float32(
    [[0, 0, 0], [0.02, 0.05, 0.4], [0.02, 0.35, 0.35], [0.1, 0.5, 0.05], [0.7, 0.6, 0.02], [0.7, 0.08, 0.02]]
)
"""For 0 (the world) to 5 layers and more."""

_RED = (0.8, 0.02, 0.02, 1.0)


def picture(canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
    """The picture itself, as far as half floats reach."""
    color = canvas.rows(canvas.color)
    return opaque(np.minimum(color[..., :3], _LARGEST_HALF))


def reflectors(canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
    """Where a reflector shows: green over the darkened picture."""
    color = canvas.rows(canvas.color)
    dimmed = 0.2 * np.minimum(color[..., :3], 1.0)
    return opaque(dimmed + color[..., 3:] * np.float32([0.05, 0.6, 0.1]))


def hit_distance(canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
    """How far off is what a mirror shows: white at its surface, grey at the median, black far away, the world blue."""
    distance = canvas.rows(canvas.distance)[..., 0]
    met = (distance > 0.0) & (distance < _FAR)
    middle = float(np.median(distance[met])) if met.any() else 1.0
    shown = np.zeros((*distance.shape, 3), np.float32)
    shown[met] = (middle / (middle + distance[met]))[:, None]
    shown[distance >= _FAR] = (0.0, 0.05, 0.3)
    return opaque(shown)


def layers(canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
    """Layers of the layered depth textures: blue one, then teal, green, yellow, red for five and more."""
    counts = layer_view(method.resident, view.camera, canvas.visibility)
    return opaque(_RAMP[np.minimum(counts, len(_RAMP) - 1)])


def regions(canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
    """Reflection regions: green where an object may show in the reflector's triangle, red where none can."""
    found, _ = region_view(method.resident, view.camera, *canvas.size)
    color = canvas.rows(canvas.color)
    elsewhere = ~found.any(axis=-1, keepdims=True)[::-1]
    return opaque(found[::-1] + elsewhere * 0.2 * np.minimum(color[..., :3], 1.0))


def retraced(canvas: Canvas, method: Mixed, view: View) -> np.ndarray:
    """What was traced anew, where a method takes over the rest from earlier pictures: red (Xie et al., figure 7)."""
    shown, reuse = picture(canvas, method, view), method.reused(canvas)
    if reuse is not None:
        shown[reuse.retraced[::-1]] = _RED
    return shown


def opaque(color: np.ndarray) -> np.ndarray:
    """(H, W, 4) float32 from (H, W, 3)."""
    return np.concatenate([color, np.ones_like(color[..., :1])], axis=2).astype(np.float32, copy=False)


DEVELOPS: dict[str, Develop] = {
    "PICTURE": picture,
    "REFLECTORS": reflectors,
    "DISTANCE": hit_distance,
    "LAYERS": layers,
    "REGIONS": regions,
    "RETRACED": retraced,
}
"""By the identifiers of the setting; `in_place` adds those that hold the picture against one by Cycles."""

OF_MOTION = {retraced}
"""What tells of the last move: a smoother picture of the same view would have nothing to tell."""
