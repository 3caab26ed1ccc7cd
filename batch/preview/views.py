"""Blender's view transforms, by OpenColorIO, as tables that a shader looks up."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

STANDARD = "Standard"
"""The plain sRGB curve, which needs no table."""

STOPS = -12.5, 8.0
"""Radiance from two to the one to two to the other is told apart; AgX itself begins at the first."""

_SIDE = 81
"""A quarter of a stop from entry to entry: a picture is right to a step of a screen nearly everywhere."""

_DISPLAY, _LIGHT = "sRGB", "scene_linear"
_UNFIT = {"Raw", "False Color"}
"""No curve at all, and colours in bands, which a table would blur."""


@cache
def names() -> tuple[str, ...]:
    """What there is: what the installed Blender has, but for its looks; STANDARD alone without Blender."""
    config = _config()
    found = oiio.ColorConfig(str(config)).getViewNames(_DISPLAY) if config else []
    return (STANDARD, *(name for name in found if name not in _UNFIT | {STANDARD}))


def table(name: str) -> np.ndarray:
    """(B, G, R, 3) float32 in 0..1, encoded for an sRGB screen; each axis has its channel's radiance at even stops."""
    steps = np.exp2(np.linspace(*STOPS, _SIDE, dtype=np.float32))
    blue, green, red = np.meshgrid(steps, steps, steps, indexing="ij")
    shown = _shown(np.stack([red, green, blue], axis=-1).reshape(_SIDE, -1, 3), name)
    return np.clip(shown, 0.0, 1.0).reshape(_SIDE, _SIDE, _SIDE, 3)


def _shown(linear: np.ndarray, name: str) -> np.ndarray:
    """What a screen shows of a picture (H, W, 3) float32, by OpenColorIO itself."""
    picture = oiio.ImageBuf(np.ascontiguousarray(linear, np.float32))
    shown = oiio.ImageBufAlgo.ociodisplay(picture, _DISPLAY, name, _LIGHT, colorconfig=str(_config()))
    return shown.get_pixels(oiio.FLOAT)


@cache
def _config() -> Path | None:
    """The configuration that the installed Blender brings; Blender itself is not loaded."""
    spec = find_spec("bpy")
    found = Path(spec.origin).parent.glob("*/datafiles/colormanagement/config.ocio") if spec and spec.origin else ()
    return next(iter(found), None)
