"""The part of the panel that says what is baked."""

import time

import bpy

from ..methods.layered_depth_published import LayeredDepthPublished
from . import bakes
from .operators_bake import read_stage
from .panel_drawing import draw_text
from .preflight import for_cycles
from .texts import ago, size_of

_ICONS = {bakes.FRESH: "CHECKMARK", bakes.STALE: "FILE_REFRESH", bakes.MISSING: "REMOVE"}
_MOST = 24


def draw_bakes(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How each bake stands, with the buttons that mend it."""
    stage = read_stage(context)
    if stage is None:
        draw_text(layout, "Show the scene in the viewport to see what is baked.", context)
        return
    account = bakes.account_of(context.scene, stage)
    if account is None:
        layout.label(text="Looking at the cache …")
        return
    if account.light is not None:
        _draw_light(layout, context, account.light)
    texels = " and ".join(str(asked.resolution) for asked in account.baked)
    said = f"Layered depth textures of {texels} texels, for {LayeredDepthPublished.name} and for export"
    draw_text(layout, said, context)
    column = layout.column(align=True)
    for state in account.objects[:_MOST]:
        row = column.row(align=True)
        row.label(text=line_of(state), icon=_ICONS[state.kind])
        if state.kind != bakes.FRESH:
            row.operator("catoptric.bake", text="", icon="RENDER_STILL").name = state.name
        if state.size:
            row.operator("catoptric.clear", text="", icon="TRASH").name = state.name
        if state.why:
            draw_text(column, state.why, context, icon="BLANK1")
    if len(account.objects) > _MOST:
        column.label(text=f"and {len(account.objects) - _MOST} more")
    row = layout.row(align=True)
    todo = row.row(align=True)
    todo.enabled = any(state.kind != bakes.FRESH for state in account.states)
    todo.operator("catoptric.bake", text="Bake All", icon="RENDER_STILL")
    row.operator("catoptric.clear", text="Clear All", icon="TRASH")
    said = f"{size_of(account.size)} on disk; baking takes about {size_of(account.memory)} of memory"
    draw_text(layout, said, context)


def line_of(state: bakes.State) -> str:
    """A bake in one line."""
    kept = f", {size_of(state.size)}, {ago(time.time() - state.written)}" if state.size else ""
    return f"{state.name}: {state.kind}{kept}"


def _draw_light(layout: bpy.types.UILayout, context: bpy.types.Context, state: bakes.State) -> None:
    box = layout.box()
    box.label(text=line_of(state), icon=_ICONS[state.kind])
    if state.why:
        draw_text(box, state.why, context, icon="BLANK1")
    if state.kind != bakes.FRESH:
        for sentence in for_cycles(context.scene, context.view_layer):
            draw_text(box, sentence, context, icon="INFO")
    box.operator("catoptric.bake_light", icon="LIGHT")
