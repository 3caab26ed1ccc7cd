"""The panel: where the settings are seen."""

import bpy

from ..methods.registry import METHODS
from . import stages
from .properties import identifier


class CATOPTRIC_PT_main(bpy.types.Panel):
    """Catoptric's settings in the sidebar of the 3D view."""

    bl_label = "Catoptric"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Catoptric"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the settings from their declarations."""
        layout, settings = self.layout, context.scene.catoptric
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "method")
        layout.prop(settings, "lighting")
        group = getattr(settings.methods, identifier(settings.method))
        for parameter in METHODS[settings.method].parameters:
            layout.prop(group, parameter.name)
        layout.separator()
        layout.prop(settings, "overlay")
        layout.prop(settings, "samples")
        layout.prop(settings, "scale")
        layout.prop(settings, "show_times")
        stage = stages.known(context.scene, context.view_layer)
        for warning in stage.warnings[:5] if stage else ():
            layout.label(text=warning, icon="ERROR")


def register() -> None:
    """Add the panel."""
    bpy.utils.register_class(CATOPTRIC_PT_main)


def unregister() -> None:
    """Take it away."""
    bpy.utils.unregister_class(CATOPTRIC_PT_main)
