"""Reading Blender's images as Cycles reads them."""

import bpy
import numpy as np

from ..scene import Image, average
from .notes import Notes

MAGENTA = np.array([[[255, 0, 255, 255]] * 2] * 2, dtype=np.uint8)
"""What Blender and Cycles show for an image that is not there."""

_DATA_SPACES = {"Non-Color", "Raw", "Linear Rec.709", "Linear", "Generic Data", "scene_linear"}


class ImageReader:
    """Reads each image once. `images` are the results, in the order of their indices."""

    def __init__(self, notes: Notes, known: "dict[tuple[str, bool], Image] | None" = None) -> None:
        """`known` images are taken as they are, and it takes up those that are read."""
        self.images: list[Image] = []
        self._notes = notes
        self._known = {} if known is None else known
        self._indices: dict[tuple[str, bool], int] = {}

    def index(self, image: bpy.types.Image | None, alpha_used: bool) -> int:
        """The index of `image` in `images`; `alpha_used` if the node's Alpha output is linked."""
        key = (image.name_full if image else "", alpha_used)
        if key not in self._indices:
            self._indices[key] = len(self.images)
            if key not in self._known:
                self._known[key] = read(image, alpha_used, self._notes)
            self.images.append(self._known[key])
        return self._indices[key]

    def average(self, index: int) -> np.ndarray:
        """(4,) float64: the image's mean scene-linear colour and alpha."""
        return average(self.images[index])


def _multiplies_alpha(image: bpy.types.Image) -> bool:
    """Whether Cycles gives the colour times alpha when a node's Alpha is not asked for.

    Measured: straight bytes in every version; since 5.0 by the alpha mode alone, before that bytes
    in both associated modes, and floats never.
    """
    if bpy.app.version >= (5, 0):
        return image.alpha_mode == "STRAIGHT"
    return not image.is_float and image.alpha_mode in {"STRAIGHT", "PREMUL"}


def read(image: bpy.types.Image | None, alpha_used: bool, notes: Notes) -> Image:
    """The pixels of `image`; a missing one is magenta, as in Blender. `alpha_used` if its alpha is asked for."""
    if image is None:
        notes.add("an image node", "has no image; it is magenta, as in Cycles")
        return Image("(no image)", MAGENTA, srgb=True)
    image = image.original
    was_loaded = image.has_data
    width, height = image.size  # asks Blender to load the file
    if not width or not height or not image.has_data:
        notes.add(f'image "{image.name}"', f"cannot be read from {image.filepath or 'memory'}; it is magenta")
        return Image(image.name, MAGENTA, srgb=True)
    pixels = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    associate = not alpha_used and _multiplies_alpha(image)
    space, is_float = image.colorspace_settings.name, image.is_float
    if not was_loaded and image.source == "FILE" and not image.is_dirty:
        image.buffers_free()
    pixels = _four_channels(pixels.reshape(height, width, -1))
    if is_float:
        if associate:
            pixels[..., :3] *= pixels[..., 3:]
        return Image(image.name, pixels)
    if space != "sRGB" and space not in _DATA_SPACES:
        notes.add(f'image "{image.name}"', f"colour space {space} is not supported; it is read as sRGB")
    pixels *= 255.0
    pixels += 0.5
    stored = pixels.astype(np.uint8)
    if associate:
        # In whole numbers and rounded down, as Cycles does it.
        stored[..., :3] = stored[..., :3].astype(np.uint16) * stored[..., 3:] // 255
    return Image(image.name, stored, srgb=space not in _DATA_SPACES)


def _four_channels(pixels: np.ndarray) -> np.ndarray:
    """(H, W, 4) from 1 (grey), 2 (grey, alpha), 3 or 4 channels."""
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    color = pixels[..., :3] if channels == 3 else pixels[..., :1].repeat(3, axis=2)
    alpha = pixels[..., 1:] if channels == 2 else np.ones_like(pixels[..., :1])
    return np.concatenate([color, alpha], axis=2)
