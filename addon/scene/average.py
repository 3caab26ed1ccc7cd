"""What a surface looks like from so far away that its images blur."""

import numpy as np

from .material import LUMINANCE, ColorSource, Material
from .scene import Scene


def mean_color(scene: Scene, source: ColorSource) -> np.ndarray:
    """(3,) float64, linear: a colour, the mean of its image taken for the image; vertex colours do not count."""
    color = np.array(source.color, np.float64)
    if source.image is None:
        return color
    image = scene.images[source.image]
    values = image.pixels[..., :3].reshape(-1, 3)
    if values.dtype == np.uint8:
        values = values / 255.0
        if image.srgb:
            values = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return color * values.mean(axis=0, dtype=np.float64)


def mean_roughness(scene: Scene, material: Material) -> float:
    """Blender's roughness of a material, 0 to 1; where an image gives it, the mean over the image."""
    return float(np.clip(mean_color(scene, material.roughness) @ LUMINANCE, 0.0, 1.0))
