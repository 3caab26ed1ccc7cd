"""Arrays that shaders read by index: GLSL 4.10 has no storage buffers, so they lie in 2D textures."""

import moderngl
import numpy as np

from ..errors import MachineError
from .context import require

WIDTH = 4096
"""Texels in a row of a data texture; gpu_shaders/common/data.glsl holds the same number."""

_ROWS = 64
"""Rows that are uploaded in one call, during which no other Python thread runs."""

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
        self.texture = context.texture((width, rows), components, alignment=1, dtype=_DTYPES[array.dtype])
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.size_bytes = rows * width * components * array.itemsize
        for row in range(0, rows, _ROWS):
            self._upload(array[row * width : (row + _ROWS) * width], row)

    def _upload(self, texels: np.ndarray, row: int) -> None:
        """Write `texels` (N, components) from a row on; what is left of the last row is zeros."""
        width, components = self.texture.width, self.texture.components
        height = max(1, -(-len(texels) // width))
        padded = np.zeros((height * width, components), texels.dtype)
        padded[: len(texels)] = texels
        self.texture.write(padded, viewport=(0, row, width, height), alignment=1)

    def use(self, unit: int) -> None:
        """Bind to a texture unit."""
        self.texture.use(unit)

    def release(self) -> None:
        """Give the memory back."""
        self.texture.release()
