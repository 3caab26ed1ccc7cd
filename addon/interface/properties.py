"""Settings that the .blend keeps, those of methods made from the methods' own declarations."""

from collections.abc import Mapping

import bpy

from ..blender.extract import REFLECTOR_PROPERTY
from ..methods.contract import Method
from ..methods.mixed import AUTO
from ..methods.registry import METHODS
from ..parameters import Parameter, Value
from ..scene import Lighting
from . import stages
from .choices import OF_SCENE
from .viewport import AUTOMATIC

LIGHTINGS = (
    (Lighting.UNLIT.value, "Unlit", "Colours alone: tests the geometry of the reflection", 0),
    (Lighting.DIRECT.value, "Direct", "Lamps with shadows, in the shader: a preview at once", 1),
    (Lighting.CYCLES.value, "Lightmaps", "Diffuse light baked by Cycles, as games do", 2),
)
OVERLAYS = (
    ("PICTURE", "Picture", "The picture itself", 0),
    ("REFLECTORS", "Reflectors", "Where a reflector shows, in green", 1),
    ("DISTANCE", "Hit distance", "How far away is what a mirror shows: near is bright, the world is blue", 2),
    ("LAYERS", "Layers", "Layers of the layered depth textures: blue is one, red five and more", 3),
    ("RETRACED", "Traced anew", "In red what reprojection could not take over from earlier pictures, as you move", 7),
    ("SPLIT", "Ours and Cycles", "Half and half, once Cycles has drawn this view", 5),
    ("ERROR", "Error", "FLIP against Cycles, once it has drawn this view: black is equal", 6),
    ("REGIONS", "Reflection regions", "Green where a reflector may show an object, red where it cannot", 4),
)
RESOLUTIONS = (
    (AUTOMATIC, "Automatic", "Full; coarser while anything moves, if full pictures take long", 0),
    ("1", "Full", "A sample for every pixel of the screen", 1),
    ("2", "Half", "Four times as fast", 2),
)
QUALITIES = ((1, "1"), (2, "4"), (4, "16"), (6, "36"))


def identifier(method: str) -> str:
    """A method's name as that of a property."""
    return method.replace("-", "_")


def _redraw(owner: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Custom properties tell no depsgraph that they have changed."""
    stages.touch()


def property_of(parameter: Parameter):
    """The Blender property of one declared parameter."""
    common = {"name": parameter.label, "description": parameter.help, "update": _redraw}
    if isinstance(parameter.default, bool):
        return bpy.props.BoolProperty(default=parameter.default, **common)
    if parameter.choices:
        items = [(choice, choice, "", number) for number, choice in enumerate(parameter.choices)]
        return bpy.props.EnumProperty(items=items, default=parameter.default, **common)
    if isinstance(parameter.default, str):
        return bpy.props.StringProperty(default=parameter.default, **common)
    bounds = {"min": parameter.minimum, "max": parameter.maximum}
    bounds = {name: type(parameter.default)(bound) for name, bound in bounds.items() if bound is not None}
    make = bpy.props.IntProperty if isinstance(parameter.default, int) else bpy.props.FloatProperty
    return make(default=parameter.default, **bounds, **common)


def _settings_class(method: type[Method]) -> type[bpy.types.PropertyGroup]:
    name = "CATOPTRIC_PG_" + identifier(method.name)
    annotations = {parameter.name: property_of(parameter) for parameter in method.parameters}
    return type(name, (bpy.types.PropertyGroup,), {"__annotations__": annotations, "__doc__": method.__doc__})


_SETTINGS = {name: _settings_class(method) for name, method in METHODS.items()}


def _method_items() -> list[tuple[str, str, str, int]]:
    return [
        (name, name.replace("-", " ").title(), method.source, number)
        for number, (name, method) in enumerate(METHODS.items())
    ]


class MethodSettings(bpy.types.PropertyGroup):
    """Values of every method's parameters."""

    __annotations__ = {identifier(name): bpy.props.PointerProperty(type=kind) for name, kind in _SETTINGS.items()}

    def values(self, method: str) -> Mapping[str, Value]:
        """The parameters of one method, by name."""
        group = getattr(self, identifier(method))
        return {parameter.name: getattr(group, parameter.name) for parameter in METHODS[method].parameters}


REFLECTS = (
    ("AUTO", "By material", "A reflector if its material is a clear mirror: metallic or glossy, and smooth", 0),
    ("YES", "Always", "A reflector, if its material reflects at all", 1),
    ("NO", "Never", "No reflector, whatever its material", 2),
)


def _get_reflects(settings: bpy.types.PropertyGroup) -> int:
    value = settings.id_data.get(REFLECTOR_PROPERTY)
    return 0 if value is None else 1 if value else 2


def _set_reflects(settings: bpy.types.PropertyGroup, number: int) -> None:
    """The choice lies in the custom property, which counts without the add-on as well."""
    if number == 0:
        settings.id_data.pop(REFLECTOR_PROPERTY, None)
    else:
        settings.id_data[REFLECTOR_PROPERTY] = number == 1


class SceneSettings(bpy.types.PropertyGroup):
    """How a scene's reflections are drawn."""

    method: bpy.props.EnumProperty(
        name="Method",
        items=_method_items(),
        default=AUTO,
        update=_redraw,
        description="How reflections are drawn, on objects that have no method of their own",
    )
    methods: bpy.props.PointerProperty(type=MethodSettings)
    lighting: bpy.props.EnumProperty(
        name="Light",
        items=LIGHTINGS,
        default=Lighting.DIRECT.value,
        update=_redraw,
        description="Where the light of a surface comes from",
    )
    light: bpy.props.StringProperty(options={"HIDDEN"}, description="The key of the light that was baked last")
    overlay: bpy.props.EnumProperty(
        name="Overlay", items=OVERLAYS, default="PICTURE", update=_redraw, description="What the viewport shows instead"
    )
    samples: bpy.props.EnumProperty(
        name="Samples",
        items=[(str(side), words, f"{words} samples a pixel once nothing moves", side) for side, words in QUALITIES],
        default="4",
        update=_redraw,
        description="Samples a pixel of a picture at rest",
    )
    scale: bpy.props.EnumProperty(
        name="Resolution",
        items=RESOLUTIONS,
        default=AUTOMATIC,
        update=_redraw,
        description="Resolution of the viewport's picture",
    )
    show_times: bpy.props.BoolProperty(
        name="Times", default=True, update=_redraw, description="Show what each stage costs in the viewport's corner"
    )
    compared: bpy.props.EnumProperty(
        name="Methods",
        items=(
            ("USED", "In use", "The methods that this scene and its objects have chosen", 0),
            ("ALL", "All", "Every method there is, one row each", 1),
        ),
        default="USED",
        description="Which methods are compared with Cycles",
    )
    reference_samples: bpy.props.IntProperty(
        name="Cycles samples",
        default=0,
        min=0,
        max=65536,
        description="Samples a pixel of the picture that Cycles renders; 0: as many as make its noise low",
    )


class ObjectSettings(bpy.types.PropertyGroup):
    """How an object reflects."""

    reflects: bpy.props.EnumProperty(
        name="Reflector",
        items=REFLECTS,
        get=_get_reflects,
        set=_set_reflects,
        update=_redraw,
        description="Whether the object shows a mirror image",
    )
    method: bpy.props.EnumProperty(
        name="Method",
        items=[(OF_SCENE, "As the scene", "The method chosen for the whole scene", 100), *_method_items()],
        default=OF_SCENE,
        update=_redraw,
        description="How this object's reflections are drawn",
    )
    methods: bpy.props.PointerProperty(type=MethodSettings)


_CLASSES = (*_SETTINGS.values(), MethodSettings, SceneSettings, ObjectSettings)


def register() -> None:
    """Add the settings to every scene and object."""
    for kind in _CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.catoptric = bpy.props.PointerProperty(type=SceneSettings)
    bpy.types.Object.catoptric = bpy.props.PointerProperty(type=ObjectSettings)


def unregister() -> None:
    """Take them away again; what a file holds of them stays in it."""
    del bpy.types.Scene.catoptric, bpy.types.Object.catoptric
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
