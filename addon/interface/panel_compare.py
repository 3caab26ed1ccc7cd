"""The parts of the panel that hold the picture against Cycles, and write what others read."""

import bpy

from . import preflight
from .operators_compare import methods_in_use, report_folder
from .panel_drawing import draw_text


def draw_compare(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What is compared, what to know before, and the buttons."""
    scene = context.scene
    layout.prop(scene.catoptric, "compared")
    layout.prop(scene.catoptric, "reference_samples")
    if scene.catoptric.compared == "USED":
        layout.label(text=", ".join(methods_in_use(scene)))
    trouble = preflight.no_camera(scene) or preflight.no_cycles(scene)
    said = [*preflight.unsaved(report_folder(scene)), *preflight.for_cycles(scene, context.view_layer)]
    for sentence in [trouble] if trouble else said:
        draw_text(layout, sentence, context, icon="ERROR" if trouble else "INFO")
    layout.operator("catoptric.compare_in_place", icon="ARROW_LEFTRIGHT")
    layout.operator("catoptric.compare", icon="IMAGE_REFERENCE")
    layout.operator("catoptric.open_report", icon="URL")


def draw_export(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """For engines, and for machines without Blender."""
    count = len(context.selected_objects)
    layout.operator("catoptric.export_engine", text=f"Selected for Engines ({count})", icon="EXPORT")
    layout.operator("catoptric.export_scene", icon="FILE_3D")
