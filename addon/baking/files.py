"""Files that bakes are written to: whole or not at all, under names that every system takes."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..errors import MachineError


def made_folder(path: Path) -> Path:
    """The folder `path`, made if need be; raises `MachineError` where that cannot be."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MachineError(f"cannot make the folder {path}: {error.strerror}; choose another one") from error
    return Path(path)


def free_stem(name: str, taken: set[str]) -> str:
    """A file name for an object: only what every file system takes, and none twice."""
    plain = re.sub(r"[^\w.-]+", "-", name).strip("-.") or "object"
    stem, number = plain, 1
    while stem.lower() in taken:
        number += 1
        stem = f"{plain}-{number}"
    taken.add(stem.lower())
    return stem


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A file beside `path` to write to, of the same ending; it becomes `path` once it is finished.

    Raises `MachineError` where the folder does not allow it.
    """
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise MachineError(f"cannot write {path}: {error.strerror}; choose another folder") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_exr(
    path: Path,
    pixels: np.ndarray,
    channels: Sequence[str],
    attributes: Mapping[str, str] | None = None,
    half: bool = False,
) -> None:
    """Write `pixels` (H, W, channels) float32, row 0 the top, as EXR of 32 bits a channel, or 16 if `half`.

    It appears whole or not at all. Raises `MachineError` where it cannot be written.
    """
    write_exr_parts(path, [(pixels, attributes or {})], channels, half)


def write_exr_parts(
    path: Path, parts: Sequence[tuple[np.ndarray, Mapping[str, str]]], channels: Sequence[str], half: bool = False
) -> None:
    """Write pictures of any sizes, each with its attributes, as the parts of one EXR; else as `write_exr`."""
    import OpenImageIO as oiio  # Blender brings it; the rest of the bake does without

    specs = []
    height, width = np.max([pixels.shape[:2] for pixels, _ in parts], axis=0).tolist()
    for number, (pixels, attributes) in enumerate(parts, 1):
        specs.append(
            oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], oiio.HALF if half else oiio.FLOAT)
        )
        specs[-1].full_width, specs[-1].full_height = width, height  # which an EXR's parts must share
        specs[-1].channelnames = tuple(channels)
        specs[-1].attribute("compression", "zip")
        if len(parts) > 1:
            specs[-1].attribute("oiio:subimagename", f"part-{number}")
        for key, value in attributes.items():
            specs[-1].attribute(key, value)
    with whole(path) as temporary:
        output = oiio.ImageOutput.create(str(temporary))
        done = output.open(str(temporary), tuple(specs))
        for number, (pixels, _) in enumerate(parts):
            done = done and (number == 0 or output.open(str(temporary), specs[number], "AppendSubimage"))
            done = done and output.write_image(np.ascontiguousarray(pixels, np.float32))
        if not (done and output.close()):
            raise MachineError(f"cannot write {path}: {output.geterror()}; free some space or choose another folder")
