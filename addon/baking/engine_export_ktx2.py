"""KTX2 through Khronos' own library, where it is installed."""

from pathlib import Path

import numpy as np

from .files import whole

_FORMATS = {2: "VK_FORMAT_R16G16B16A16_SFLOAT", 4: "VK_FORMAT_R32G32B32A32_SFLOAT"}
"""By bytes a channel."""


def why_no_ktx2() -> str | None:
    """None where KTX2 can be written, else the reason as a sentence."""
    try:
        import pyktx  # noqa: F401
    except (ImportError, OSError) as error:
        return f"no KTX2 is written, for pyktx and libktx are not installed ({error})"
    return None


def write_ktx2(path: Path, images: np.ndarray, array: bool = False) -> None:
    """Write `images` (layers, faces, H, W, 4), float16 or float32, row 0 the top, without compression or mipmaps.

    Six faces make a cube map; `array` makes an array texture. Raises `MachineError` where it cannot be written.
    """
    from pyktx import KtxTexture2, KtxTextureCreateInfo, KtxTextureCreateStorage, VkFormat

    layers, faces, height, width, _ = images.shape
    info = KtxTextureCreateInfo(
        gl_internal_format=None,
        base_width=width,
        base_height=height,
        base_depth=1,
        vk_format=VkFormat[_FORMATS[images.itemsize]],
        num_layers=layers,
        num_faces=faces,
        is_array=array,
    )
    texture = KtxTexture2.create(info, KtxTextureCreateStorage.ALLOC)
    for layer in range(layers):
        for face in range(faces):
            texture.set_image_from_memory(0, layer, face, np.ascontiguousarray(images[layer, face]).tobytes())
    with whole(path) as temporary:
        temporary.write_bytes(texture.write_to_memory())
