"""The panel: in the sidebar of the 3D view, and where Blender users look for a render engine's settings."""

from collections.abc import Callable
from typing import NamedTuple

import bpy

from ..scene import Lighting
from . import lights, stages, work
from .operators import views_of
from .panel_bakes import draw_bakes
from .panel_compare import draw_compare, draw_export
from .panel_drawing import draw_parameters, draw_text
from .panel_reflectors import draw_reflectors
from .texts import sentence


class _Part(NamedTuple):
    """A panel, drawn in both places. One without a `parent` holds the others."""

    name: str
    label: str
    draw: Callable[[bpy.types.UILayout, bpy.types.Context], None]
    parent: str = ""
    closed: bool = False
    applies: Callable[[bpy.types.Context], bool] = lambda context: True


def draw_main(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What comes first: the one button of a beginner, what is under way, what went wrong."""
    stage = stages.known(context.scene, context.view_layer)
    if not is_shown(context):
        row = layout.row()
        row.scale_y = 2.0
        row.operator("catoptric.show", icon="SHADING_RENDERED")
    elif stage is not None and stage.found is not None and not stage.found.reflectors:
        draw_text(layout, "Nothing reflects here yet. Metallic or glossy materials of low roughness do.", context)
        row = layout.row()
        row.scale_y = 1.5
        holder = context.object
        text = f'Make "{holder.name}" a Mirror' if holder else "Make It a Mirror"
        row.operator("catoptric.make_mirror", text=text, icon="MATERIAL")
    _draw_work(layout, context)
    problem = stage and (stage.problem or stage.studio.problem)
    if problem:
        draw_text(layout, sentence(problem), context, icon="ERROR")


def draw_settings(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How the scene is drawn."""
    settings = context.scene.catoptric
    layout.prop(settings, "method")
    draw_parameters(layout, settings.methods, settings.method)
    layout.prop(settings, "lighting")
    if settings.lighting == Lighting.CYCLES and lights.missing(context.scene) and not lights.busy():
        draw_text(layout, "No light is baked yet; lamps stand in for it", context, icon="INFO")
        layout.operator("catoptric.bake_light", icon="LIGHT")


def draw_view(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the viewport shows of it."""
    settings = context.scene.catoptric
    for name in ("overlay", "samples", "scale", "show_times"):
        layout.prop(settings, name)


def draw_warnings(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What of the scene cannot be shown."""
    warnings = _warnings(context)
    for warning in warnings[:_MOST_WARNINGS]:
        draw_text(layout, warning, context, icon="ERROR")
    if len(warnings) > _MOST_WARNINGS:
        layout.label(text=f"and {len(warnings) - _MOST_WARNINGS} more")


def is_shown(context: bpy.types.Context) -> bool:
    """Whether Catoptric draws a viewport of this window."""
    shown = any(area.spaces.active.shading.type == "RENDERED" for area in views_of(context))
    return shown and context.scene.render.engine == stages.ENGINE


def _draw_work(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    task = work.current()
    stage = stages.known(context.scene, context.view_layer)
    if task is not None:
        row = layout.row(align=True)
        row.progress(factor=task.fraction, text=f"{task.label}: {task.fraction:.0%}")
        row.operator("catoptric.stop", text="", icon="CANCEL")
        draw_text(layout, sentence(task.stage) or "Beginning", context)
    elif work.last():
        draw_text(layout, work.last(), context, icon="INFO")
    if stage is not None and stage.studio.stage and stage.studio.busy:
        layout.progress(factor=stage.studio.fraction, text=sentence(stage.studio.stage))


def _warnings(context: bpy.types.Context) -> tuple[str, ...]:
    stage = stages.known(context.scene, context.view_layer)
    return stage.warnings if stage else ()


_MOST_WARNINGS = 8
_PARTS = (
    _Part("main", "Catoptric", draw_main),
    _Part("settings", "Method", draw_settings, "main"),
    _Part("reflectors", "Reflectors", draw_reflectors, "main"),
    _Part("view", "Viewport", draw_view, "main", closed=True),
    _Part("bakes", "Bakes", draw_bakes, "main", closed=True),
    _Part("compare", "Compare with Cycles", draw_compare, "main", closed=True),
    _Part("export", "Export", draw_export, "main", closed=True),
    _Part("warnings", "Warnings", draw_warnings, "main", applies=lambda context: bool(_warnings(context))),
)


def _panel(part: _Part, place: str, **where: object) -> type[bpy.types.Panel]:
    """The class of one part in one place; `where` are Blender's own attributes of panels."""

    def draw(self: bpy.types.Panel, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        part.draw(self.layout, context)

    def poll(cls: type[bpy.types.Panel], context: bpy.types.Context) -> bool:
        engines = getattr(cls, "COMPAT_ENGINES", {context.scene.render.engine})
        return context.scene.render.engine in engines and part.applies(context)

    members = {"bl_label": part.label, "draw": draw, "poll": classmethod(poll), "__doc__": part.draw.__doc__, **where}
    if part.closed:
        members["bl_options"] = {"DEFAULT_CLOSED"}
    if part.parent:
        members["bl_parent_id"] = f"{place}_PT_{part.parent}"
    return type(f"{place}_PT_{part.name}", (bpy.types.Panel,), members)


_SIDEBAR = {"bl_space_type": "VIEW_3D", "bl_region_type": "UI", "bl_category": "Catoptric"}
_RENDER_TAB = {
    "bl_space_type": "PROPERTIES",
    "bl_region_type": "WINDOW",
    "bl_context": "render",
    "COMPAT_ENGINES": {stages.ENGINE},
}
_CLASSES = (
    *(_panel(part, "CATOPTRIC", **_SIDEBAR) for part in _PARTS),
    *(_panel(part, "CATOPTRIC_RENDER", **_RENDER_TAB) for part in _PARTS),
)


register, unregister = bpy.utils.register_classes_factory(_CLASSES)
