"""Colour sockets: constants, images, colour attributes, and products of these."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..scene import LUMINANCE, Extension, Interpolation
from .materials_lookup import Lookup, read_lookup
from .nodes import Plug, Source, Unsupported, source

Color = tuple[float, float, float]


@dataclass(frozen=True)
class Texture:
    """An Image Texture node: `image`, whether its Alpha is in use, how it is read and where (`lookup`)."""

    image: bpy.types.Image | None
    alpha_used: bool
    interpolation: Interpolation
    extension: Extension
    lookup: Lookup


@dataclass(frozen=True)
class Paint:
    """A colour: `color` (linear RGB) times a texture, times a mesh attribute (`""`: the one active for renders)."""

    color: Color = (1.0, 1.0, 1.0)
    texture: Texture | None = None
    attribute: str | None = None

    @property
    def constant(self) -> bool:
        """Whether the colour is the same everywhere."""
        return self.texture is None and self.attribute is None

    @property
    def black(self) -> bool:
        """Whether it is black everywhere."""
        return not any(self.color)

    @property
    def varying(self) -> tuple:
        """What makes it vary; paints that agree in it can be added by their colours."""
        return self.texture, self.attribute

    def times(self, factor: float | Color) -> "Paint":
        """The paint with its colour multiplied."""
        factors = factor if isinstance(factor, tuple) else (factor,) * 3
        return replace(self, color=tuple(a * b for a, b in zip(self.color, factors, strict=True)))


BLACK_PAINT = Paint((0.0, 0.0, 0.0))


def read_paint(plug: Plug) -> Paint:
    """The colour at an input socket. Raises `Unsupported` for nodes that vary in ways a Paint cannot."""
    found = source(plug)
    if found.node is None:
        return Paint(_value(found.socket))
    reader = _READERS.get(found.node.bl_idname)
    if reader is None:
        raise Unsupported(found.node, "is not supported")
    return reader(found)


def _value(socket: bpy.types.NodeSocket) -> Color:
    value = getattr(socket, "default_value", 0.0)
    return tuple(value)[:3] if hasattr(value, "__len__") else (float(value),) * 3


def read_number(plug: Plug, average: Callable[[Texture], np.ndarray]) -> tuple[float, bpy.types.Node | None]:
    """The number at an input socket, and the node that was averaged to get it, if one was.

    `average` gives a texture's mean (4,) RGBA. A colour becomes its luminance, as Cycles converts.
    Raises `Unsupported` where there is no average to take.
    """
    found = source(plug)
    paint = read_paint(plug)
    if paint.attribute is not None:
        raise Unsupported(found.node, "varies over the surface, which is not supported")
    if paint.texture is None:
        return _grey(found.socket, paint.color), None
    mean = average(paint.texture)
    if found.socket.name == "Alpha":
        return float(mean[3]), found.node
    return _luminance(tuple(mean[:3] * paint.color)), found.node


def _grey(socket: bpy.types.NodeSocket, color: Color) -> float:
    return _luminance(color) if socket.type == "RGBA" else color[0]


def _luminance(color: Color) -> float:
    return float(np.dot(color, LUMINANCE))


def read_constant(plug: Plug) -> float:
    """The number at an input socket; raises `Unsupported` if it varies."""
    found, paint = source(plug), read_paint(plug)
    if not paint.constant:
        raise Unsupported(found.node, "varies over the surface, which is not supported here")
    return _grey(found.socket, paint.color)


def _output_value(found: Source) -> Paint:
    return Paint(_value(found.socket))


def _image(found: Source) -> Paint:
    node = found.node
    if node.projection != "FLAT":
        raise Unsupported(node, f"has {node.projection.lower()} projection, which is not supported")
    if node.image is not None and node.image.source in {"TILED", "SEQUENCE", "MOVIE"}:
        raise Unsupported(node, f"shows a {node.image.source.lower()} image, which is not supported")
    alpha = node.outputs["Alpha"].is_linked
    closest = node.interpolation == "Closest"
    reading = Interpolation.CLOSEST if closest else Interpolation.LINEAR
    lookup = read_lookup(found.input("Vector"), read_constant_vector)
    return Paint(texture=Texture(node.image, alpha, reading, Extension[node.extension], lookup))


def read_constant_vector(plug: Plug) -> Color:
    """Three numbers at an input socket; raises `Unsupported` if they vary."""
    paint = read_paint(plug)
    if not paint.constant:
        raise Unsupported(source(plug).node, "varies over the surface, which is not supported here")
    return paint.color


def _color_attribute(found: Source) -> Paint:
    if found.socket.name == "Alpha":
        raise Unsupported(found.node, "is asked for its alpha, which is not supported")
    return Paint(attribute=found.node.layer_name)


def _attribute(found: Source) -> Paint:
    node = found.node
    if node.attribute_type != "GEOMETRY" or found.socket.name != "Color":
        raise Unsupported(node, "reads something else than a mesh attribute's colour, which is not supported")
    return Paint(attribute=node.attribute_name)


def _mix(found: Source) -> Paint:
    node = found.node
    suffix = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}.get(node.data_type)
    if suffix is None or (suffix == "Vector" and node.factor_mode == "NON_UNIFORM"):
        raise Unsupported(node, "mixes something else than colours, which is not supported")
    blend = node.blend_type if suffix == "Color" else "MIX"
    factor = read_constant(found.input("Factor_Float"))
    if node.clamp_factor:
        factor = min(max(factor, 0.0), 1.0)
    first, second = (read_paint(found.input(f"{side}_{suffix}")) for side in "AB")
    return _blended(node, blend, factor, first, second, suffix == "Color" and node.clamp_result)


def _mix_legacy(found: Source) -> Paint:
    node = found.node
    factor = min(max(read_constant(found.input("Fac")), 0.0), 1.0)
    first, second = (read_paint(found.input(name)) for name in ("Color1", "Color2"))
    return _blended(node, node.blend_type, factor, first, second, node.use_clamp)


def _blended(node: bpy.types.Node, blend: str, factor: float, first: Paint, second: Paint, clamp: bool) -> Paint:
    """Two paints blended: constants by any of the plain modes, images where the result is a product or one of them."""
    if blend not in _BLENDS:
        raise Unsupported(node, f"blends by {blend.lower()}, which is not supported")
    if factor == 0.0:
        result = first
    elif blend == "MIX" and factor == 1.0:
        result = second
    elif first.constant and second.constant:
        a, b = np.array(first.color), np.array(second.color)
        result = Paint(tuple(float(x) for x in a + (_BLENDS[blend](a, b) - a) * factor))
    elif blend == "MULTIPLY":
        result = _product(node, factor, first, second)
    elif blend == "MIX" and first.varying == second.varying:
        sides = zip(first.color, second.color, strict=True)
        result = replace(first, color=tuple(a + (b - a) * factor for a, b in sides))
    else:
        raise Unsupported(node, f"blends images by {blend.lower()}, which is not supported")
    if clamp and result.constant:
        result = Paint(tuple(min(max(channel, 0.0), 1.0) for channel in result.color))
    return result


_BLENDS = {
    "MIX": lambda a, b: b,
    "MULTIPLY": lambda a, b: a * b,
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "SCREEN": lambda a, b: 1 - (1 - a) * (1 - b),
    "LIGHTEN": np.maximum,
    "DARKEN": np.minimum,
}


def _product(node: bpy.types.Node, factor: float, first: Paint, second: Paint) -> Paint:
    """First × (1 - factor + factor × second), where at most one of them has an image and one an attribute."""
    if second.constant:
        return first.times(tuple(1.0 - factor + factor * channel for channel in second.color))
    both_images = first.texture and second.texture
    both_attributes = first.attribute is not None and second.attribute is not None
    if factor != 1.0 or both_images or both_attributes:
        raise Unsupported(node, "multiplies two images, or one by a part, which is not supported")
    attribute = first.attribute if first.attribute is not None else second.attribute
    return Paint(first.times(second.color).color, first.texture or second.texture, attribute)


def _constant_inputs(found: Source, names: tuple[str, ...]) -> list[np.ndarray]:
    return [np.array(read_constant_vector(found.input(name))) for name in names]


def _invert(found: Source) -> Paint:
    factor, color = _constant_inputs(found, ("Fac", "Color"))
    return Paint(tuple(float(x) for x in color + (1.0 - 2.0 * color) * factor))


def _gamma(found: Source) -> Paint:
    color, gamma = _constant_inputs(found, ("Color", "Gamma"))
    return Paint(tuple(float(x) for x in np.where(color > 0, np.abs(color) ** gamma, color)))


def _combine(found: Source) -> Paint:
    if getattr(found.node, "mode", "RGB") != "RGB":
        raise Unsupported(found.node, "combines something else than red, green and blue, which is not supported")
    return Paint(tuple(read_constant(plug) for plug in map(found.input, ("Red", "Green", "Blue"))))


def _math(found: Source) -> Paint:
    node = found.node
    if node.operation not in _OPERATIONS:
        raise Unsupported(node, f"computes {node.operation.lower()}, which is not supported")
    a, b = (read_constant(found.input(name)) for name in ("Value", "Value_001"))
    result = _OPERATIONS[node.operation](a, b)
    return Paint((min(max(result, 0.0), 1.0) if node.use_clamp else result,) * 3)


_OPERATIONS: dict[str, Callable[[float, float], float]] = {
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "MULTIPLY": lambda a, b: a * b,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "MINIMUM": min,
    "MAXIMUM": max,
}

_READERS: dict[str, Callable[[Source], Paint]] = {
    "ShaderNodeRGB": _output_value,
    "ShaderNodeValue": _output_value,
    "ShaderNodeTexImage": _image,
    "ShaderNodeVertexColor": _color_attribute,
    "ShaderNodeAttribute": _attribute,
    "ShaderNodeMix": _mix,
    "ShaderNodeMixRGB": _mix_legacy,
    "ShaderNodeInvert": _invert,
    "ShaderNodeGamma": _gamma,
    "ShaderNodeCombineColor": _combine,
    "ShaderNodeMath": _math,
}
