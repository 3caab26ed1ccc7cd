"""Blender's materials as `Material`s, and which of them make a reflector."""

from dataclasses import dataclass

import bpy

from ..scene import BLACK, ColorSource, Fresnel, Material
from .images import ImageReader
from .materials_colors import Paint, Texture
from .materials_lookup import Lookup
from .materials_surface import Surface, SurfaceReader
from .nodes import surface_plug, tree_in_use
from .notes import Notes

ROUGHEST_METAL = 0.2 + 1e-6  # Blender's sliders are 32-bit floats: its 0.2 is a little more
ROUGHEST_DIELECTRIC = 0.1 + 1e-6
LEAST_HEAD_ON = 0.01
LEAST_GLOSS = 0.05

DEFAULT_GREY = (0.8, 0.8, 0.8)
"""The colour that Cycles gives a surface without a material."""


@dataclass(frozen=True)
class Slot:
    """A material as a mesh needs it: its index, where its textures are looked up, its mesh attribute.

    `mirrors_clearly` says that an artist would call it a mirror (see `is_clear_mirror`), `mirrors` that it reflects.
    """

    index: int
    lookup: Lookup
    attribute: str | None
    mirrors_clearly: bool
    mirrors: bool


class MaterialReader:
    """Reads each material once. `materials` are the results, in the order of their indices."""

    def __init__(self, images: ImageReader, notes: Notes) -> None:
        self.materials: list[Material] = []
        self._images = images
        self._notes = notes
        self._slots: dict[tuple[str, bool], Slot] = {}

    def slot(self, material: bpy.types.Material | None, object_name: str, forced: bool = False) -> Slot:
        """What `material` (None: Cycles' default grey) is; `object_name` is for warnings.

        A dielectric too rough for a clear mirror image loses its gloss, unless the artist asked for
        it on this object (`forced`), so that `Material.mirrors` says where to draw one.
        """
        key = (material.name_full if material else "", forced)
        if key not in self._slots:
            self._slots[key] = self._read(material, object_name, forced)
        return self._slots[key]

    def _read(self, material: bpy.types.Material | None, object_name: str, forced: bool) -> Slot:
        where = f'object "{object_name}"' + (f', material "{material.name}"' if material else "")
        surface = self._surface(material, where)
        clear = is_clear_mirror(surface)
        glossy = clear or forced or surface.fresnel is not Fresnel.DIELECTRIC
        paints = (surface.base, surface.emission, surface.reflection, surface.grain)
        lookup = self._agreed(where, "texture coordinates", [p.texture.lookup for p in paints if p.texture], Lookup())
        attribute = self._agreed(where, "attributes", [p.attribute for p in paints if p.attribute is not None], None)
        result = Material(
            name=material.name if material else "(no material)",
            base=self._color(surface.base),
            diffuse=surface.diffuse,
            emission=self._color(surface.emission),
            reflection=self._color(surface.reflection) if glossy else BLACK,
            fresnel=surface.fresnel,
            ior=surface.ior,
            roughness=self._color(surface.grain),
            multiscatter=surface.multiscatter,
        )
        self.materials.append(result)
        return Slot(len(self.materials) - 1, lookup, attribute, clear, not surface.reflection.black)

    def _surface(self, material: bpy.types.Material | None, where: str) -> Surface:
        if material is None:
            return Surface(base=Paint(DEFAULT_GREY), diffuse=1.0)
        tree = tree_in_use(material)
        if tree is None:
            return Surface(base=Paint(tuple(material.diffuse_color)[:3]), diffuse=1.0)

        def warn(node: bpy.types.Node, message: str) -> None:
            self._notes.add(f'{where}, node "{node.name}"', message)

        plug = surface_plug(tree)
        if plug is None:
            return Surface()
        end = plug.socket.node
        for name in ("Volume", "Displacement"):
            if end.inputs[name].is_linked:
                warn(end, f"has a {name.lower()}, which is not supported; it is left out")
        return SurfaceReader(material, warn, self._average).read(plug)

    def _average(self, texture: Texture):
        return self._images.average(self._images.index(texture.image, texture.alpha_used))

    def _agreed(self, where: str, what: str, found: list, otherwise):
        if any(one != found[0] for one in found[1:]):
            self._notes.add(where, f"uses several {what}, which is not supported; the base colour's are used for all")
        return found[0] if found else otherwise

    def _color(self, paint: Paint) -> ColorSource:
        texture, has_attribute = paint.texture, paint.attribute is not None
        if texture is None:
            return ColorSource(paint.color, vertex_colors=has_attribute)
        index = self._images.index(texture.image, texture.alpha_used)
        return ColorSource(paint.color, index, texture.interpolation, texture.extension, has_attribute)


def is_clear_mirror(surface: Surface) -> bool:
    """Whether an artist who looks at the surface expects to see a mirror image in it.

    Metals and glossy surfaces up to roughness 0.2: brushed steel still shows what is beside it;
    rougher metal only has highlights. Dielectrics up to 0.1, as they reflect some 4 % head on, which is
    lost in the base colour once it is blurred: varnish, still water and glass count, a new Principled
    (roughness 0.5) or a satin floor does not. Below 1 % head on (an index of 1.22) nothing is seen at all.
    """
    strength = max(surface.reflection.color)
    if surface.fresnel is Fresnel.DIELECTRIC:
        return surface.roughness <= ROUGHEST_DIELECTRIC and strength * head_on(surface.ior) >= LEAST_HEAD_ON
    return surface.roughness <= ROUGHEST_METAL and strength >= LEAST_GLOSS


def head_on(ior: float) -> float:
    """The share of light that a dielectric reflects at normal incidence."""
    return ((ior - 1.0) / (ior + 1.0)) ** 2
