"""The colour plates of the paper on glossy planar reflections, drawn from any scene that has a flat mirror."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..addon.errors import SceneError
from ..addon.methods.contract import Method, View
from ..addon.methods.registry import METHODS
from ..addon.parameters import Value
from ..addon.progress import Progress, part_of, silent
from ..addon.scene import ColorSource, Lighting, Material, Scene, mean_color
from .pictures import save_png
from .plates_page import Row, Shown, write_page

PUBLISHED, OURS = "glossy-planes", "glossy-planar"

_SLABS = 8


@dataclass(frozen=True)
class Plate:
    """One figure of the paper: how it is drawn, and whether its floor has its texture. No settings: no reflection."""

    name: str
    caption: str
    settings: Mapping[str, Value] | None
    textured: bool = False


PLATES = (
    Plate("figure-10", "Figure 10: without reflections", None),
    Plate(
        "figure-11",
        "Figure 11: a perfect mirror, without a Fresnel term",
        {"attenuation": "none", "blur": "none"},
    ),
    Plate(
        "figure-13",
        "Figure 13: attenuation planes parallel to the floor, without a Fresnel term",
        {"attenuation": "parallel"},
    ),
    Plate("figure-14", "Figure 14: tilted attenuation planes", {"attenuation": "tilted"}),
    Plate(
        "figure-12",
        "Figure 12: a textured floor masks approximations, under tilted planes",
        {"attenuation": "tilted"},
        textured=True,
    ),
)
"""The colour plates; for better visibility the paper leaves the texture out in all but figure 12."""

PAIR = (
    Plate("figure-8-left", "Figure 8, left: blurred slabs", {"attenuation": "parallel", "blur": "slabs"}),
    Plate(
        "figure-8-right",
        "Figure 8, right: one blur, and a plane where slabs meet",
        {"attenuation": "parallel", "planes": _SLABS},
    ),
)


@dataclass(frozen=True)
class Sitting:
    """What all plates share: a scene and its name for people, the pictures' `size`, `side` squared samples a pixel."""

    name: str
    scene: Scene
    lighting: Lighting
    size: tuple[int, int]
    side: int


def without_texture(scene: Scene) -> Scene:
    """The scene whose mirrors have the mean of their base image for a colour."""
    mirrors = {index for number in scene.reflectors for index in scene.instances[number].materials}
    plain = [_plain(scene, one) if index in mirrors else one for index, one in enumerate(scene.materials)]
    return replace(scene, materials=tuple(plain))


def _plain(scene: Scene, material: Material) -> Material:
    return replace(material, base=ColorSource(tuple(map(float, mean_color(scene, material.base)))))


def check(scene: Scene) -> None:
    """Raise `SceneError` where there is nothing to draw plates of."""
    reasons = [METHODS[PUBLISHED].applies_to(scene, scene.instances[index]) for index in scene.reflectors]
    if all(reasons):
        raise SceneError(f"{scene.name}: no mirror here is flat. {reasons[0]}")


def draw(
    sitting: Sitting, out: Path, truths: Mapping[bool, np.ndarray] | None = None, progress: Progress = silent
) -> Path:
    """Write every plate, ours beside them, and plates.html into the folder `out`; gives the page's path.

    `truths` are Cycles' pictures (H, W, 3) of the floor with its texture (True) and without, as far as there are
    any. The light is not unlit, and the scene passes `check`.
    """
    atelier = _Atelier(sitting, out, progress)
    ours = {textured: atelier.ours(textured) for textured in (False, True)}
    cycles = {
        textured: atelier.show(f"cycles{_mark(textured)}", "Cycles", picture)
        for textured, picture in (truths or {}).items()
    }
    rows = []
    for plate in PLATES:
        beside = (atelier.plate(plate), ours[plate.textured], cycles.get(plate.textured))
        rows.append(Row(plate.caption.partition(":")[0], tuple(filter(None, beside))))
    pair = Row("Figure 8", tuple(map(atelier.plate, PAIR)))
    return write_page(out, sitting.name, str(sitting.lighting), sitting.size, rows, pair)


def _mark(textured: bool) -> str:
    return "-textured" if textured else ""


class _Atelier:
    """Draws one picture after another."""

    def __init__(self, sitting: Sitting, out: Path, progress: Progress) -> None:
        self._sitting, self._out, self._progress = sitting, out, progress
        self._floors = {True: sitting.scene, False: without_texture(sitting.scene)}
        self._drawn, self._count = 0, len(PLATES) + len(PAIR) + len(self._floors)

    def plate(self, plate: Plate) -> Shown:
        """A figure of the paper."""
        scene = self._floors[plate.textured]
        if plate.settings is None:
            dull = tuple(replace(instance, reflector=False) for instance in scene.instances)
            scene = replace(scene, instances=dull)
        return self._photograph(plate.name, plate.caption, METHODS[PUBLISHED](plate.settings or {}), scene)

    def ours(self, textured: bool) -> Shown:
        """What we draw instead."""
        name = f"{OURS}{_mark(textured)}"
        return self._photograph(name, f"{OURS}, ours", METHODS[OURS](), self._floors[textured])

    def _photograph(self, name: str, caption: str, method: Method, scene: Scene) -> Shown:
        sitting = self._sitting
        share = part_of(self._progress, self._drawn / self._count, (self._drawn + 1) / self._count)
        self._drawn += 1
        method.prepare(scene, sitting.lighting, part_of(share, 0.0, 0.5))
        try:
            frame = method.render(View(scene.camera, *sitting.size, sitting.side), part_of(share, 0.5, 1.0))
        finally:
            method.release()
        return self.show(name, caption, frame.color)

    def show(self, name: str, caption: str, color: np.ndarray) -> Shown:
        """Write a picture with its caption."""
        save_png(self._out / f"{name}.png", color, caption)
        return Shown(f"{name}.png", caption, color)
