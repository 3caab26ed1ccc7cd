"""What a surface does with light, reduced to what the real-time methods draw."""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np


class Interpolation(IntEnum):
    """How an image is read between texels, as Cycles does it: before sRGB is decoded."""

    LINEAR = 0
    CLOSEST = 1


class Extension(IntEnum):
    """What an image shows outside 0..1. CLIP is transparent black."""

    REPEAT = 0
    EXTEND = 1
    CLIP = 2
    MIRROR = 3


class Fresnel(IntEnum):
    """How a reflection's strength depends on the angle.

    CONSTANT: the colour itself (Glossy BSDF). SCHLICK: from the colour, head on, to white at
    grazing (Principled, metallic). DIELECTRIC: exact Fresnel of `ior`, times the colour; what is
    not reflected reaches the base colour.
    """

    CONSTANT = 0
    SCHLICK = 1
    DIELECTRIC = 2


@dataclass(frozen=True, eq=False)
class Image:
    """An image in memory. `pixels` (H, W, 4), row 0 at the bottom.

    uint8 where Blender keeps bytes (`srgb` says that they are sRGB-encoded, to be decoded *after*
    interpolation, as Cycles does), else float32 scene-linear.
    """

    name: str
    pixels: np.ndarray
    srgb: bool = False


@dataclass(frozen=True)
class ColorSource:
    """A colour: `color` (linear RGB factors) times an image, times the vertex colours.

    `image` is an index into `Scene.images`, or None.
    """

    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    image: int | None = None
    interpolation: Interpolation = Interpolation.LINEAR
    extension: Extension = Extension.REPEAT
    vertex_colors: bool = False


LUMINANCE = (0.2126, 0.7152, 0.0722)
"""What a colour becomes as a number, as Cycles converts it."""


def grey(value: float) -> ColorSource:
    """The same number in all channels."""
    return ColorSource((value, value, value))


BLACK = grey(0.0)


@dataclass(frozen=True)
class Material:
    """A surface: `base * diffuse` is scattered, `emission` is given off, `reflection` is mirrored.

    `diffuse` is the weight of scattering (0 for a metal). `emission` holds its strength in its
    colour. `reflection` BLACK means that nothing is mirrored, `fresnel` how it varies with the
    angle, `ior` its index. The luminance of `roughness`, as of a colour that becomes a number in Cycles, is
    Blender's roughness; GGX alpha is its square. `multiscatter` says that light which goes from facet to facet of a
    rough surface counts too (Blender's Multiscatter GGX, its default), so that a white one stays white.
    """

    name: str
    base: ColorSource = field(default_factory=ColorSource)
    diffuse: float = 1.0
    emission: ColorSource = BLACK
    reflection: ColorSource = BLACK
    fresnel: Fresnel = Fresnel.CONSTANT
    ior: float = 1.5
    roughness: ColorSource = field(default_factory=lambda: grey(0.5))
    multiscatter: bool = False

    @property
    def emits(self) -> bool:
        """Whether the surface gives off light of its own."""
        return any(channel > 0.0 for channel in self.emission.color)

    @property
    def mirrors(self) -> bool:
        """Whether the surface reflects at all."""
        return any(channel > 0.0 for channel in self.reflection.color)
