"""What all parts of the panel draw with."""

import bpy

from ..methods.registry import METHODS
from .properties import identifier
from .texts import wrapped


def draw_parameters(layout: bpy.types.UILayout, methods: bpy.types.PropertyGroup, name: str) -> None:
    """A method's parameters, from its declaration."""
    group = getattr(methods, identifier(name))
    for parameter in METHODS[name].parameters:
        layout.prop(group, parameter.name)


def draw_text(layout: bpy.types.UILayout, text: str, context: bpy.types.Context, icon: str = "NONE") -> None:
    """Text of any length, in lines that fit the region."""
    column = layout.column(align=True)
    scale = context.preferences.system.ui_scale
    room = context.region.width - (45 if icon == "NONE" else 70) * scale
    for number, line in enumerate(wrapped(text, room, scale)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1" if icon != "NONE" else "NONE")
