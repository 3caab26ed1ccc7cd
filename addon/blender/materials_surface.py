"""Shader nodes as one surface: scattering, emission and one reflection."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..scene import Fresnel
from .materials_colors import BLACK_PAINT, Paint, Texture, read_number, read_paint
from .nodes import Plug, Source, Unsupported, source

_GRAZING = 1e-5
_FACETS = {"BECKMANN": "Beckmann", "ASHIKHMIN_SHIRLEY": "Ashikhmin and Shirley"}


@dataclass(frozen=True)
class Surface:
    """A `Material` whose colours are still Blender's.

    `base` times `diffuse` is scattered, `emission` given off, `reflection` mirrored. `roughness` is the average of
    `grain`, which is roughness where it varies; `multiscatter` as of a `Material`.
    """

    base: Paint = BLACK_PAINT
    diffuse: float = 0.0
    emission: Paint = BLACK_PAINT
    reflection: Paint = BLACK_PAINT
    fresnel: Fresnel = Fresnel.CONSTANT
    ior: float = 1.5
    roughness: float = 0.0
    grain: Paint = BLACK_PAINT
    multiscatter: bool = False

    def times(self, weight: float) -> "Surface":
        """The surface with a share of its strength."""
        return replace(
            self,
            diffuse=self.diffuse * weight,
            emission=self.emission.times(weight),
            reflection=self.reflection.times(weight),
        )


class SurfaceReader:
    """Reads the shader tree of one material.

    `warn(node, message)` notes what is lost, `average` gives a texture's mean (4,) RGBA, and
    `viewport` is the material, whose viewport settings stand in for what cannot be read.
    """

    def __init__(
        self,
        viewport: bpy.types.Material,
        warn: Callable[[bpy.types.Node, str], None],
        average: Callable[[Texture], np.ndarray],
    ) -> None:
        self._viewport = viewport
        self._warn = warn
        self._average = average

    def read(self, plug: Plug) -> Surface:
        """The surface at a shader input; nothing linked is black, as in Cycles."""
        found = source(plug)
        if found.node is None:
            return Surface()
        reader = _READERS.get(found.node.bl_idname)
        if reader is None:
            self._warn(found.node, "is not supported; the viewport colour stands in")
            return Surface(base=self._viewport_paint, diffuse=1.0)
        if (normal := found.input("Normal")) is not None and source(normal).node is not None:
            self._warn(source(normal).node, "changes normals, which is not supported; the mesh's own are used")
        return reader(self, found)

    @property
    def _viewport_paint(self) -> Paint:
        return Paint(tuple(self._viewport.diffuse_color)[:3])

    def _paint(self, found: Source, name: str) -> Paint:
        try:
            return read_paint(found.input(name))
        except Unsupported as gap:
            self._warn(gap.node, f"{gap}; the viewport colour stands in")
            return self._viewport_paint

    def _number(self, found: Source, name: str, otherwise: float | None = None) -> float:
        """A constant; of a texture its average; of what cannot be read `otherwise`, or the socket's own value."""
        plug = found.input(name)
        if plug is None:
            return otherwise or 0.0
        try:
            value, averaged = read_number(plug, self._average)
        except Unsupported as gap:
            value = plug.socket.default_value if otherwise is None else otherwise
            self._warn(gap.node, f"{gap}; {name.lower()} is taken as {value:.3g}")
            return value
        if averaged is not None:
            self._warn(averaged, f"varies {name.lower()}, which is not supported; its average {value:.3g} is used")
        return value

    def _diffuse(self, found: Source) -> Surface:
        return Surface(base=self._paint(found, "Color"), diffuse=1.0)

    def _emission(self, found: Source) -> Surface:
        return Surface(emission=self._paint(found, "Color").times(self._number(found, "Strength")))

    def _glossy(self, found: Source, color_name: str = "Color") -> Surface:
        color = self._paint(found, color_name)
        return self._rough(found, Surface(base=color, reflection=color))

    def _rough(self, found: Source, surface: Surface) -> Surface:
        """`surface` as rough as a node says, by an image or everywhere alike, with the facets that it says."""
        facets = found.node.distribution
        if facets not in ("GGX", "MULTI_GGX"):
            self._warn(found.node, f"has facets by {_FACETS[facets]}, which are not supported; GGX is used")
        surface = replace(surface, multiscatter=facets == "MULTI_GGX")
        plug = found.input("Roughness")
        try:
            grain = read_paint(plug)
        except Unsupported:
            grain = BLACK_PAINT
        if grain.texture is not None and grain.attribute is None and source(plug).socket.name != "Alpha":
            return replace(surface, roughness=_unit(read_number(plug, self._average)[0]), grain=grain)
        roughness = _unit(self._number(found, "Roughness", self._viewport.roughness))
        return replace(surface, roughness=roughness, grain=Paint((roughness,) * 3))

    def _metallic(self, found: Source) -> Surface:
        if getattr(found.node, "fresnel_type", "F82") != "F82":
            self._warn(found.node, "is given by IOR and extinction, which is not supported; its base colour is used")
        return replace(self._glossy(found, "Base Color"), fresnel=Fresnel.SCHLICK)

    def _glass(self, found: Source) -> Surface:
        """The viewport colour under a reflection of the glass's index, for nothing here refracts."""
        self._warn(found.node, "lets light through, which is not supported; the viewport colour lies under its gloss")
        glass = Surface(
            base=self._viewport_paint,
            diffuse=1.0,
            reflection=self._paint(found, "Color"),
            fresnel=Fresnel.DIELECTRIC,
            ior=self._number(found, "IOR"),
        )
        return self._rough(found, glass)

    def _principled(self, found: Source) -> Surface:
        """Principled: a metal from metallic 0.5 on, else a base under a dielectric gloss."""
        self._warn_of_layers(found)
        metallic = _unit(self._number(found, "Metallic", self._viewport.metallic))
        base = self._principled_base(found)
        emission = self._paint(found, "Emission Color").times(self._number(found, "Emission Strength"))
        surface = self._rough(found, Surface(base=base, diffuse=1.0 - metallic, emission=emission))
        if surface.emission.black:
            surface = replace(surface, emission=BLACK_PAINT)
        if metallic >= 0.5:
            return replace(surface, reflection=base, fresnel=Fresnel.SCHLICK)
        ior = _principled_ior(self._number(found, "IOR"), self._number(found, "Specular IOR Level"))
        white = Paint() if ior > 1.0 else BLACK_PAINT
        return replace(surface, reflection=white, fresnel=Fresnel.DIELECTRIC, ior=ior)

    def _principled_base(self, found: Source) -> Paint:
        if self._number(found, "Transmission Weight") > 0.0:
            self._warn(found.node, "lets light through, which is not supported; the viewport colour stands in")
            return self._viewport_paint
        return self._paint(found, "Base Color")

    def _warn_of_layers(self, found: Source) -> None:
        """Name the layers of a Principled node that are in use and not drawn."""
        alpha = found.input("Alpha")
        if source(alpha).node is not None or alpha.socket.default_value < 1.0:
            self._warn(found.node, "is partly transparent (Alpha), which is not supported; it is drawn opaque")
        for name in ("Coat Weight", "Sheen Weight", "Subsurface Weight", "Anisotropic"):
            plug = found.input(name)
            if plug is not None and (source(plug).node is not None or plug.socket.default_value > 0.0):
                self._warn(found.node, f"uses {name}, which is not supported; it is left out")

    def _mix(self, found: Source) -> Surface:
        first, second = found.input("Shader"), found.input("Shader_001")
        for clear, solid in ((first, second), (second, first)):
            see_through = source(clear).node
            if see_through is not None and see_through.bl_idname == "ShaderNodeBsdfTransparent":
                self._warn(see_through, "is not supported; the surface is drawn opaque")
                return self.read(solid)
        surfaces = self.read(first), self.read(second)
        ior = self._fresnel_index(source(found.input("Fac")))
        if ior is not None and _is_coated(*surfaces):
            gloss = surfaces[1]
            return replace(
                surfaces[0],
                reflection=gloss.reflection,
                fresnel=Fresnel.DIELECTRIC,
                ior=ior,
                roughness=gloss.roughness,
                grain=gloss.grain,
                multiscatter=gloss.multiscatter,
            )
        factor = _unit(self._number(found, "Fac", 0.5))
        return self._sum(found, surfaces[0].times(1.0 - factor), surfaces[1].times(factor))

    def _fresnel_index(self, found: Source) -> float | None:
        """The index of refraction of a Fresnel or Layer Weight node, or None for another source."""
        if found.node is None:
            return None
        if found.node.bl_idname == "ShaderNodeFresnel":
            return self._number(found, "IOR")
        if found.node.bl_idname == "ShaderNodeLayerWeight" and found.socket.name == "Fresnel":
            return 1.0 / max(1.0 - self._number(found, "Blend"), _GRAZING)
        return None

    def _add(self, found: Source) -> Surface:
        return self._sum(found, self.read(found.input("Shader")), self.read(found.input("Shader_001")))

    def _sum(self, found: Source, first: Surface, second: Surface) -> Surface:
        """Both surfaces at once; of two that cannot be added, the stronger, with a warning."""
        base, diffuse = self._sum_of_bases(found, first, second)
        weights = [max(surface.reflection.color) for surface in (first, second)]
        shiny = first if weights[0] >= weights[1] else second
        reflection = shiny.reflection
        if min(weights) > 0.0:
            alike = first.fresnel == second.fresnel and abs(first.roughness - second.roughness) < 0.05
            reflection = self._total(found, first.reflection, second.reflection, "reflections", alike)
        emission = self._total(found, first.emission, second.emission, "emissions", alike=True)
        return replace(shiny, base=base, diffuse=diffuse, emission=emission, reflection=reflection)

    def _sum_of_bases(self, found: Source, first: Surface, second: Surface) -> tuple[Paint, float]:
        diffuse = first.diffuse + second.diffuse
        if diffuse == 0.0:
            shiny = max((first, second), key=lambda surface: max(surface.reflection.color))
            return shiny.base, 0.0
        if not first.diffuse or not second.diffuse:
            return (first if first.diffuse else second).base, diffuse
        weighted = [surface.base.times(surface.diffuse / diffuse) for surface in (first, second)]
        if weighted[0].varying == weighted[1].varying:
            return _added(*weighted), diffuse
        self._warn(found.node, "mixes two textured surfaces, which is not supported; the stronger is used")
        return max((first, second), key=lambda surface: surface.diffuse).base, diffuse

    def _total(self, found: Source, first: Paint, second: Paint, what: str, alike: bool) -> Paint:
        if first.black or second.black:
            return second if first.black else first
        if alike and first.varying == second.varying:
            return _added(first, second)
        self._warn(found.node, f"mixes two different {what}, which is not supported; the stronger is used")
        return max((first, second), key=lambda paint: max(paint.color))


def _added(first: Paint, second: Paint) -> Paint:
    return replace(first, color=tuple(a + b for a, b in zip(first.color, second.color, strict=True)))


def _is_coated(under: Surface, gloss: Surface) -> bool:
    """Whether a Fresnel mix of the two is a dielectric: something that scatters under something that only mirrors."""
    bare = under.reflection.black and under.emission.black
    return bare and gloss.diffuse == 0.0 and gloss.emission.black and gloss.fresnel is Fresnel.CONSTANT


def _principled_ior(ior: float, level: float) -> float:
    """The index that Principled's IOR and Specular IOR Level (0.5 leaves it as it is) amount to together."""
    if level == 0.5:
        return ior
    head_on = ((ior - 1.0) / (ior + 1.0)) ** 2 * 2.0 * max(level, 0.0)
    root = min(head_on, 0.99) ** 0.5
    return (1.0 + root) / (1.0 - root)


def _unit(value: float) -> float:
    return min(max(value, 0.0), 1.0)


_READERS: dict[str, Callable[[SurfaceReader, Source], Surface]] = {
    "ShaderNodeBsdfDiffuse": SurfaceReader._diffuse,
    "ShaderNodeEmission": SurfaceReader._emission,
    "ShaderNodeBackground": SurfaceReader._emission,
    "ShaderNodeBsdfGlossy": SurfaceReader._glossy,
    "ShaderNodeBsdfAnisotropic": SurfaceReader._glossy,
    "ShaderNodeBsdfMetallic": SurfaceReader._metallic,
    "ShaderNodeBsdfGlass": SurfaceReader._glass,
    "ShaderNodeBsdfPrincipled": SurfaceReader._principled,
    "ShaderNodeMixShader": SurfaceReader._mix,
    "ShaderNodeAddShader": SurfaceReader._add,
}
