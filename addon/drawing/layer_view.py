"""How many layers the columns under what a camera sees have."""

import numpy as np

from ..gl import read_back, require
from ..scene import Camera
from .passes import ScreenPass
from .resident import Resident
from .visibility import Part, Visibility


def layer_view(resident: Resident, camera: Camera, seen: Visibility) -> np.ndarray:
    """(H, W) int, row 0 at the bottom, 0 for the world; on the GL thread.

    `seen` is what the camera sees. A column is a texel of the object's layered depth texture
    (`addon/tracing/layers.py`); layers that lie within a slice of each other count as one.
    """
    context = require()
    texture = context.texture(seen.size, 4, dtype="f4")
    target = context.framebuffer([texture])
    try:
        target.clear()
        ScreenPass("overlays/layers.frag", resident, Part.SURFACES).draw(camera, seen, target)
        pixels = np.frombuffer(read_back(texture), np.float32).reshape(seen.size[1], seen.size[0], 4)
        return pixels[..., 0].round().astype(int)
    finally:
        target.release()
        texture.release()
