"""Pictures of the manual as files: side by side with labels, and small."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

FOLDER = Path(__file__).with_name("pictures")
WIDTH = 1200
LARGEST_BYTES = 200_000

_GAP, _LABEL = 6, 26
_QUALITIES = (92, 88, 84, 80, 75, 70)


def strip(pictures: Mapping[str, np.ndarray], columns: int, width: int = WIDTH) -> Image.Image:
    """Pictures (H, W, 3) uint8 of one size in a grid, each with its label below it."""
    across = (width - _GAP * (columns - 1)) // columns
    shape = next(iter(pictures.values())).shape
    height = round(across * shape[0] / shape[1])
    rows = -(-len(pictures) // columns)
    sheet = Image.new("RGB", (width, rows * (height + _LABEL) + (rows - 1) * _GAP), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for number, (label, pixels) in enumerate(pictures.items()):
        row, column = divmod(number, columns)
        x, y = column * (across + _GAP), row * (height + _LABEL + _GAP)
        sheet.paste(Image.fromarray(pixels).resize((across, height), Image.Resampling.LANCZOS), (x, y))
        pen.text((x + across / 2, y + height + _LABEL / 2), label, "black", font, anchor="mm")
    return sheet


def save(picture: Image.Image | np.ndarray, name: str) -> None:
    """Write a picture into the manual, no wider than WIDTH; a JPEG as good as LARGEST_BYTES allow."""
    image = picture if isinstance(picture, Image.Image) else Image.fromarray(picture)
    if image.width > WIDTH:
        image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)
    path = FOLDER / name
    path.parent.mkdir(exist_ok=True)
    for quality in _QUALITIES if path.suffix == ".jpg" else (100,):
        image.save(path, optimize=True, quality=quality)
        if path.stat().st_size <= LARGEST_BYTES:
            print(path.relative_to(FOLDER.parent), f"{path.stat().st_size / 1000:.0f} KB")
            return
    raise ValueError(f"{name} has {path.stat().st_size} bytes: make it smaller, or a JPEG")
