"""The part of the panel that lists what reflects and what is reflected."""

import bpy

from . import stages
from .choices import OF_SCENE
from .panel_drawing import draw_parameters, draw_text
from .texts import count_of, drawn_by, reflected_of, reflectors_of, sentence

_MOST = 24
"""Rows; a longer list is for the outliner."""


def draw_reflectors(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Every reflector with its method; more of the one that is active."""
    stage = stages.known(context.scene, context.view_layer)
    if stage is None or stage.found is None:
        layout.operator("catoptric.find", icon="VIEWZOOM")
    else:
        _draw_list(layout, context, stage)
    holder = context.object
    if holder is not None and holder.type in {"MESH", "CURVE", "SURFACE", "META", "FONT"}:
        _draw_object(layout, context, holder, stage)


def _draw_list(layout: bpy.types.UILayout, context: bpy.types.Context, stage: stages.Stage) -> None:
    groups = reflectors_of(stage.found)
    column = layout.column(align=True)
    for name in list(groups)[:_MOST]:
        holder = context.scene.objects.get(name)
        asked = context.scene.catoptric.method
        if holder is not None and holder.catoptric.method != OF_SCENE:
            asked = holder.catoptric.method
        text = drawn_by(name, asked, stage.studio.choices.get(groups[name][0]))
        row = column.row(align=True)
        row.alignment = "LEFT"
        active = holder is not None and holder == context.object
        icon = "RADIOBUT_ON" if active else "RADIOBUT_OFF"
        row.operator("catoptric.select", text=text, icon=icon, emboss=False).name = name
    if len(groups) > _MOST:
        column.label(text=f"and {len(groups) - _MOST} more")
    row = layout.row()
    reflected = reflected_of(stage.found)
    row.label(text=f"{count_of(groups, 'reflector', 'reflectors')}, {len(reflected)} reflected")
    row.operator("catoptric.find", text="", icon="FILE_REFRESH")
    header, body = layout.panel("catoptric_reflected", default_closed=True)
    header.label(text="Reflected objects")
    if body is not None:
        body = body.column(align=True)
        for name in reflected[:_MOST]:
            body.label(text=name, icon="OBJECT_DATA")
        if len(reflected) > _MOST:
            body.label(text=f"and {len(reflected) - _MOST} more")


def _draw_object(layout, context: bpy.types.Context, holder: bpy.types.Object, stage: stages.Stage | None) -> None:
    box = layout.box()
    box.label(text=holder.name, icon="OBJECT_DATA")
    box.prop(holder.catoptric, "reflects")
    names = reflectors_of(stage.found).get(holder.name) if stage and stage.found else None
    if not names:
        return
    box.prop(holder.catoptric, "method")
    if holder.catoptric.method != OF_SCENE:
        draw_parameters(box, holder.catoptric.methods, holder.catoptric.method)
    choice = stage.studio.choices.get(names[0])
    if choice is not None and choice.reason:
        draw_text(box, sentence(choice.reason), context, icon="INFO")
