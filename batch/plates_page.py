"""The page of the plates: pictures beside each other, and the paper's curves."""

import tempfile
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..addon.methods.glossy.gloss import figure_curves
from ..addon.metrics import to_bytes
from .page import templates, texts
from .pictures import save_bytes
from .results import atomically

FILE_NAME = "plates.html"

HEIGHTS = (0.5, 1.0, 1.5, 2.0, 2.5)
"""Metres above the floor, of the curves of figures 5 and 6."""

FARTHEST = 20.0
_DISTANCES = np.linspace(0.05, FARTHEST, 400)


@dataclass(frozen=True, eq=False)
class Shown:
    """A picture (H, W, 3), linear, the file it lies in beside the page, and what stands below it."""

    file: str
    caption: str
    color: np.ndarray

    @property
    def data(self) -> str:
        """A JPEG as a data URL."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "shown.jpg"
            save_bytes(path, to_bytes(self.color))
            return "data:image/jpeg;base64," + b64encode(path.read_bytes()).decode()


@dataclass(frozen=True)
class Row:
    """Pictures beside each other."""

    title: str
    pictures: tuple[Shown, ...]


@dataclass(frozen=True)
class Chart:
    """Curves over the distance, one for each of `HEIGHTS`: `curves` (H, D), shown from 0 to `highest`."""

    title: str
    label: str
    highest: float
    curves: np.ndarray

    def points(self, curve: int, width: float, height: float) -> str:
        """The curve as an SVG's points, in a box of that size; row 0 is at the top."""
        x = _DISTANCES / FARTHEST * width
        y = height * (1.0 - self.curves[curve] / self.highest)
        inside = y >= 0.0
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x[inside], y[inside], strict=True))


def charts() -> list[Chart]:
    """Figures 5 and 6 of the paper."""
    radius, fresnel = figure_curves(_DISTANCES, HEIGHTS)
    return [
        Chart("Figure 5: filter radius over distance", "r/d", 0.012, radius),
        Chart("Figure 6: Fresnel factor", "F", 0.8, fresnel),
    ]


def write_page(out: Path, scene: str, lighting: str, size: tuple[int, int], rows: Sequence[Row], pair: Row) -> Path:
    """Write plates.html, which needs nothing else, into the folder `out`, and give its path.

    Raises `MachineError` if it cannot be written.
    """
    page = (
        templates()
        .get_template("plates.html.j2")
        .render(
            scene=scene,
            lighting=lighting,
            size=size,
            rows=rows,
            pair=pair,
            charts=charts(),
            heights=HEIGHTS,
            farthest=FARTHEST,
            style=texts("report.css"),
        )
    )
    path = out / FILE_NAME
    with atomically(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path
