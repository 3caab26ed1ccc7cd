"""Arrays that shaders read by index: GLSL 4.10 has no storage buffers, so they lie in 2D textures."""

import moderngl
import numpy as np

from ..errors import MachineError
from .context import require

WIDTH = 4096
"""Texels in a row of a data texture; gpu_shaders/common/data.glsl holds the same number."""

_DTYPES = {np.dtype(np.float32): "f4", np.dtype(np.uint32): "u4", np.dtype(np.int32): "i4", np.dtype(np.uint8): "f1"}


class DataTexture:
    """An (N, components) array of float32, uint32, int32 or uint8 (read as 0..1), one texel a row."""

    def __init__(self, array: np.ndarray) -> None:
        """Upload `array`; raises `MachineError` where it is larger than the GPU allows."""
        context = require()
        count, components = array.shape
        rows = max(1, -(-count // WIDTH))
        limit = context.info["GL_MAX_TEXTURE_SIZE"]
        if rows > limit:
            raise MachineError(
                f"the scene needs {count:,} texels in one table and this GPU holds {limit * WIDTH:,}: "
                "simplify meshes or shrink textures"
            )
        width = WIDTH if rows > 1 else max(1, count)
        padded = np.zeros((rows * width, components), array.dtype)
        padded[:count] = array
        self.texture = context.texture((width, rows), components, padded, alignment=1, dtype=_DTYPES[array.dtype])
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.size_bytes = padded.nbytes

    def use(self, unit: int) -> None:
        """Bind to a texture unit."""
        self.texture.use(unit)

    def release(self) -> None:
        """Give the memory back."""
        self.texture.release()
