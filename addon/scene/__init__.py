"""What is rendered, as plain NumPy dataclasses, and reading and writing it as one file."""

from .camera import Camera, SensorFit
from .image_values import average, linear, mean_color, mean_roughness
from .light import Lamp, LampKind, Lighting, World
from .material import BLACK, LUMINANCE, ColorSource, Extension, Fresnel, Image, Interpolation, Material, grey
from .mesh import Instance, Mesh
from .scene import Scene
from .sharing import alike, only_seen_from_elsewhere, sharing

__all__ = [
    "BLACK",
    "LUMINANCE",
    "Camera",
    "ColorSource",
    "Extension",
    "Fresnel",
    "Image",
    "Instance",
    "Interpolation",
    "Lamp",
    "LampKind",
    "Lighting",
    "Material",
    "Mesh",
    "Scene",
    "SensorFit",
    "World",
    "alike",
    "average",
    "grey",
    "linear",
    "mean_color",
    "mean_roughness",
    "only_seen_from_elsewhere",
    "sharing",
]
