"""The curves of the searches for reflection points, kept beside a comparison's pictures and drawn in its report."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from math import log10
from pathlib import Path

from ..addon.cache import Cache
from ..addon.methods.virtual.convergence import STEPS, Convergence, convergence
from ..addon.methods.virtual_objects import VirtualObjects
from ..addon.methods.virtual_objects_published import VirtualObjectsPublished
from ..addon.parameters import Value
from .judging import Shot
from .pictures import searches_path
from .results import atomically

METHODS = VirtualObjectsPublished.name, VirtualObjects.name
"""What searches."""

LEAST, MOST = 0.01, 100.0
"""Pixels, at the ends of the axis of errors."""


@dataclass(frozen=True)
class Curve:
    """One search: the share of vertices `within` a pixel, and the `farthest` one's error in pixels, by step."""

    name: str
    within: list[float]
    farthest: list[float]

    def points(self, what: str, width: float, height: float) -> str:
        """A curve as an SVG's points, in a box of that size; row 0 is at the top."""
        heights = self.within if what == "within" else [_height(error) for error in self.farthest]
        across = width / (STEPS - 1)
        return " ".join(f"{across * step:.1f},{height * (1.0 - up):.1f}" for step, up in enumerate(heights))


def _height(error: float) -> float:
    """0 to 1 where an error stands on its axis."""
    return log10(min(max(error, LEAST), MOST) / LEAST) / log10(MOST / LEAST)


def follow(shot: Shot, settings: Mapping[str, Value], cache: Cache) -> Path | None:
    """Write how near the searches come in the shot's largest reflector; None where it mirrors no vertex.

    `settings` of one of METHODS, whose maps are searched.
    """
    curves = convergence(shot.scene, shot.size, settings, cache)
    if curves is None:
        return None
    path = shot.out / searches_path(shot.name, shot.scene.frame, str(shot.lighting))
    with atomically(path) as temporary:
        temporary.write_text(json.dumps({name: _plain(curve) for name, curve in curves.items()}), encoding="utf-8")
    return path


def _plain(curve: Convergence) -> dict[str, list[float]]:
    return {"within": curve.within.tolist(), "farthest": curve.farthest.tolist()}


def load(path: Path) -> list[Curve]:
    """The curves that `follow` wrote; none where it did not, or somebody else has written there since."""
    try:
        curves = [Curve(name, **values) for name, values in json.loads(path.read_text(encoding="utf-8")).items()]
        for curve in curves:
            curve.points("within", 1.0, 1.0), curve.points("farthest", 1.0, 1.0)
    except (OSError, ValueError, TypeError, AttributeError):
        return []
    return curves
