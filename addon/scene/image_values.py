"""Images as numbers, and what a surface looks like from so far away that they blur."""

from weakref import WeakKeyDictionary

import numpy as np

from .material import LUMINANCE, ColorSource, Image, Material
from .scene import Scene

_AVERAGES: "WeakKeyDictionary[Image, np.ndarray]" = WeakKeyDictionary()


def linear(image: Image) -> np.ndarray:
    """(H, W, 4) float32 scene-linear pixels of `image`."""
    if image.pixels.dtype != np.uint8:
        return image.pixels
    ramp = np.arange(256, dtype=np.float64) / 255.0
    if not image.srgb:
        return ramp.astype(np.float32)[image.pixels]
    decoded = np.where(ramp <= 0.04045, ramp / 12.92, ((ramp + 0.055) / 1.055) ** 2.4)
    pixels = decoded.astype(np.float32)[image.pixels]
    pixels[..., 3] = image.pixels[..., 3] / np.float32(255.0)
    return pixels


def average(image: Image) -> np.ndarray:
    """(4,) float64: the image's mean scene-linear colour and alpha; found once, as long as the image lives."""
    if image not in _AVERAGES:
        _AVERAGES[image] = linear(image).reshape(-1, 4).mean(axis=0, dtype=np.float64)
    return _AVERAGES[image]


def mean_color(scene: Scene, source: ColorSource) -> np.ndarray:
    """(3,) float64, linear: a colour, the mean of its image taken for the image; vertex colours do not count."""
    color = np.array(source.color, np.float64)
    return color if source.image is None else color * average(scene.images[source.image])[:3]


def mean_roughness(scene: Scene, material: Material) -> float:
    """Blender's roughness of a material, 0 to 1; where an image gives it, the mean over the image."""
    return float(np.clip(mean_color(scene, material.roughness) @ LUMINANCE, 0.0, 1.0))
