"""Pictures on disk: linear EXR for measuring, PNG for looking at."""

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from ..addon.errors import MachineError
from ..addon.metrics import PictureError, magma, to_bytes
from .results import Images, atomically


def save_exr(path: Path, linear: np.ndarray, metadata: Mapping[str, str] | None = None, half: bool = False) -> None:
    """Write `linear` (H, W, 3) float32 as OpenEXR, losslessly, or in 16 bits a channel if `half` (up to 65504)."""
    pixels = np.clip(linear, -65504.0, 65504.0) if half else linear
    attributes = {"compression": "zip", "oiio:ColorSpace": "lin_rec709", **(metadata or {})}
    _write(path, np.ascontiguousarray(pixels, np.float32), "half" if half else "float", attributes)


def save_png(path: Path, linear: np.ndarray, caption: str = "") -> None:
    """Write `linear` (H, W, 3) as a screen shows it: clamped to 0..1, sRGB-encoded, 8 bits a channel."""
    save_bytes(path, to_bytes(linear), caption)


def save_bytes(path: Path, colors: np.ndarray, caption: str = "") -> None:
    """Write `colors` (H, W, 3) uint8, sRGB-encoded, as PNG or JPEG by the ending of `path`, with a caption in it."""
    # Compressing a PNG more takes twice the time and saves a tenth of it.
    attributes = {"oiio:ColorSpace": "sRGB", "Compression": "jpeg:82", "png:compressionLevel": 3}
    if caption:
        attributes["ImageDescription"] = caption
    _write(path, np.ascontiguousarray(colors), "uint8", attributes)


def load_picture(path: Path) -> np.ndarray:
    """(H, W, 3): float32 as stored in an EXR, uint8 of an 8-bit picture. Raises `PictureError` if it cannot be read."""
    if not Path(path).exists():
        raise PictureError(f"the picture {path} is missing: run compare again without --resume")
    source = oiio.ImageInput.open(str(path))
    pixels = None
    if source is not None:
        bytewise = source.spec().format == oiio.TypeUInt8
        pixels = source.read_image(oiio.UINT8 if bytewise else oiio.FLOAT)
        source.close()
    oiio.geterror()
    if pixels is None or pixels.ndim != 3 or pixels.shape[-1] < 3:
        raise PictureError(f"the picture {path} is damaged: run compare again without --resume")
    return pixels[..., :3]


def image_paths(scene: str, frame: int, lighting: str, method: str, against: str | None = None) -> Images:
    """Where a result's pictures lie, relative to the folder of the report. The reference is shared by all methods.

    It is the picture of the method `against`, or one of its own.
    """
    stem = f"images/{_slug(scene)}/{_slug(lighting)}-{frame:04d}"
    return Images(
        method=f"{stem}-{_slug(method)}.exr",
        reference=f"{stem}-{_slug(against) if against else 'reference'}.exr",
        flip=f"{stem}-{_slug(method)}-flip.png",
    )


def retraced_path(images: Images) -> str:
    """Where the pixels lie that a method traced anew, relative to the folder of the report."""
    return images.method.removesuffix(".exr") + "-retraced.png"


def film_stem(scene: str, lighting: str, method: str) -> str:
    """Where the film of a method over many frames lies, without its ending, relative to the folder of the report."""
    return f"films/{_slug(scene)}/{_slug(lighting)}-{_slug(method)}"


def plates_folder(scene: str, frame: int, lighting: str) -> str:
    """Where the paper's plates of a scene lie, relative to the folder of the report."""
    return f"plates/{_slug(scene)}/{_slug(lighting)}-{frame:04d}"


def searches_path(scene: str, frame: int, lighting: str) -> str:
    """Where the figures of a scene's searches lie (batch/searches.py), relative to the folder of the report."""
    return f"images/{_slug(scene)}/{_slug(lighting)}-{frame:04d}-searches.json"


def save_images(
    directory: Path,
    images: Images,
    color: np.ndarray,
    reference: np.ndarray,
    flip: np.ndarray,
    metadata: Mapping,
    half: bool = False,
) -> None:
    """Write a result's three pictures below `directory`; a reference that is there already is kept.

    `half` as of `save_exr`, for the method's own.
    """
    save_exr(directory / images.method, color, metadata, half)
    if not (directory / images.reference).exists():
        save_exr(directory / images.reference, reference, metadata)
    save_bytes(directory / images.flip, magma(flip))


def save_mask(path: Path, mask: np.ndarray) -> None:
    """Write `mask` (H, W) bool, white where it holds."""
    save_bytes(path, np.repeat(mask[..., None] * np.uint8(255), 3, axis=-1))


def load_mask(path: Path) -> np.ndarray:
    """(H, W) bool, as `save_mask` wrote it. Raises `PictureError` if it cannot be read."""
    return load_picture(path)[..., 0] > 127


_RED, _VEIL = (215, 25, 30), 0.65


def reddened(shown: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """`shown` (H, W, 3) uint8 under a red veil where `mask` (H, W) holds: the view of Xie et al., figure 7."""
    picture = shown.astype(np.float32)
    picture[mask] += _VEIL * (np.float32(_RED) - picture[mask])
    return np.round(picture).astype(np.uint8)


def _write(path: Path, pixels: np.ndarray, kind: str, attributes: Mapping[str, str | int]) -> None:
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, kind)
    for name, value in attributes.items():
        spec.attribute(name, value)
    with atomically(path) as temporary:
        target = oiio.ImageOutput.create(str(temporary))
        done = target.open(str(temporary), spec) and target.write_image(pixels)
        if not (target.close() and done):
            raise MachineError(f"cannot write {path}: {target.geterror() or 'is the disk full?'}")


def _slug(name: str) -> str:
    """`name` as a file name that every system takes; names that would meet get a mark of their own."""
    plain = re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip("-.")[:60]
    return plain if plain == name else f"{plain}-{hashlib.blake2b(name.encode(), digest_size=3).hexdigest()}"
