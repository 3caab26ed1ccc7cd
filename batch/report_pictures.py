"""Pictures packed into the report: lossless 16-bit floats for exposure and differences, small JPEGs to choose by."""

import tempfile
import zlib
from base64 import b64encode
from pathlib import Path

import numpy as np

from ..addon.metrics import MAGMA, to_bytes
from .pictures import save_bytes

_THUMBNAIL_HEIGHT = 96
_NOTABLE = 24


def half_codes(linear: np.ndarray) -> np.ndarray:
    """int32 (H, W, 3): the bits of `linear` as 16-bit floats. They grow with the value; below zero counts as black."""
    halves = np.clip(linear, 0.0, 65504.0).astype(np.float16)
    return halves.view(np.uint16).astype(np.int32)


def pack_picture(linear: np.ndarray, reference: np.ndarray | None = None) -> str:
    """`linear` (H, W, 3) for the page: its difference from the reference, which is nothing beside the reflectors.

    Without a reference each pixel is stored as its difference from its left neighbour.
    """
    codes = half_codes(linear)
    return _pack(np.diff(codes, axis=1, prepend=0) if reference is None else codes - half_codes(reference))


def pack_flip(colors: np.ndarray) -> str:
    """A FLIP picture (H, W, 3) in the colours of `magma` for the page: the index of each pixel's colour."""
    keys = colors.astype(np.int32) @ (1 << 16, 1 << 8, 1)
    known = MAGMA.astype(np.int32) @ (1 << 16, 1 << 8, 1)
    order = np.argsort(known)
    found = np.searchsorted(known, keys, sorter=order).clip(max=255)
    return _deflated(order[found].astype(np.uint8))


def window_of_interest(pictures: list[np.ndarray]) -> tuple[slice, slice]:
    """Rows and columns, in the pictures' own proportions, around what differs between `pictures` (H, W, 3) as shown.

    Of a ball in a wide floor, small pictures of the whole would all look alike.
    """
    shown = [to_bytes(picture).astype(np.int16) for picture in pictures]
    differences = np.max([np.abs(other - shown[0]).max(axis=-1) for other in shown], axis=0)
    ys, xs = np.nonzero(differences > _NOTABLE)
    sides = differences.shape
    if ys.size == 0:
        return slice(0, sides[0]), slice(0, sides[1])
    # Stray pixels at other objects' edges must not widen the window.
    ranges = [np.percentile(along, (3, 97)) for along in (ys, xs)]
    share = min(1.0, max((high - low + 1) / side for (low, high), side in zip(ranges, sides, strict=True)) * 1.25)
    return tuple(_window((low + high) / 2, share * side, side) for (low, high), side in zip(ranges, sides, strict=True))


def _window(middle: float, length: float, side: int) -> slice:
    length = max(1, round(length))
    start = min(max(0, round(middle - length / 2)), side - length)
    return slice(start, start + length)


def thumbnail(linear: np.ndarray) -> str:
    """A small JPEG of `linear` (H, W, 3) as a data URL."""
    height, width = linear.shape[:2]
    step = max(1, min(height // _THUMBNAIL_HEIGHT, width))
    kept = linear[: height // step * step, : width // step * step]
    # Clamped before the mean, else one bright pixel makes a white block.
    small = np.clip(kept, 0.0, 1.0).reshape(height // step, step, -1, step, 3).mean(axis=(1, 3))
    return jpeg(to_bytes(small))


def jpeg(shown: np.ndarray) -> str:
    """A picture (H, W, 3) uint8 as a JPEG in a data URL."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.jpg"
        save_bytes(path, shown)
        return "data:image/jpeg;base64," + b64encode(path.read_bytes()).decode()


def _pack(differences: np.ndarray) -> str:
    """Base64 of deflated bytes that `decodePicture` in pictures.js undoes.

    Green, red less green, blue less green, one plane after the other; signs folded into the lowest
    bit; then all low bytes, and all high bytes, most of which are zero.
    """
    red, green, blue = np.moveaxis(differences, -1, 0)
    planes = np.stack([green, red - green, blue - green])
    folded = np.where(planes < 0, -2 * planes - 1, 2 * planes)
    return _deflated(np.stack([folded & 255, folded >> 8 & 255, folded >> 16]).astype(np.uint8))


def _deflated(values: np.ndarray) -> str:
    return b64encode(zlib.compress(values.tobytes(), 6)).decode()
