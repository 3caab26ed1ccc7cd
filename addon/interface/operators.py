"""The buttons that act at once; those that start longer work have files of their own."""

from typing import ClassVar

import bpy

from ..blender.extract_memo import Memo
from . import operators_bake, operators_compare, operators_export, operators_in_place, stages, work

_MIRROR = "Catoptric mirror"


class CATOPTRIC_OT_show(bpy.types.Operator):
    """Switch to the render engine Catoptric, and the 3D view to Rendered"""

    bl_idname = "catoptric.show"
    bl_label = "Show in Viewport"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Choose the engine; of several 3D views, the one with the button in it is enough."""
        context.scene.render.engine = stages.ENGINE
        own = context.area if context.area and context.area.type == "VIEW_3D" else None
        for area in [own] if own else views_of(context):
            area.spaces.active.shading.type = "RENDERED"
        return {"FINISHED"}


class CATOPTRIC_OT_find(bpy.types.Operator):
    """Look through the scene for objects that mirror"""

    bl_idname = "catoptric.find"
    bl_label = "Find Reflectors"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Read the scene anew."""
        stage = stages.stage_of(context.evaluated_depsgraph_get())
        stage.memo = Memo()  # outside a viewport, nobody has told it what changed
        stage.read()
        if stage.problem:
            self.report({"ERROR"}, stage.problem)
            return {"CANCELLED"}
        return {"FINISHED"}


class CATOPTRIC_OT_select(bpy.types.Operator):
    """Select this object alone"""

    bl_idname = "catoptric.select"
    bl_label = "Select"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(name="Object", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """In object mode alone, as all selecting of objects."""
        return _in_object_mode(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Select the object and make it the active one."""
        holder = context.view_layer.objects.get(self.name)
        if holder is None:
            self.report({"ERROR"}, f'"{self.name}" is not in this view layer any more; press Find Reflectors')
            return {"CANCELLED"}
        for other in context.view_layer.objects.selected:
            other.select_set(False)
        context.view_layer.objects.active = holder
        holder.select_set(True)
        if not holder.visible_get():
            self.report({"INFO"}, f'"{self.name}" is active, though hidden in this view')
        return {"FINISHED"}


class CATOPTRIC_OT_make_mirror(bpy.types.Operator):
    """Give the active object a material that mirrors"""

    bl_idname = "catoptric.make_mirror"
    bl_label = "Make It a Mirror"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Where there is a surface to give a material to."""
        holder = context.object
        if holder is None or holder.type not in {"MESH", "CURVE", "SURFACE", "META", "FONT"}:
            cls.poll_message_set("Select an object with a surface")
            return False
        return _in_object_mode(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Put a mirror in the place of the active material."""
        context.object.active_material = bpy.data.materials.get(_MIRROR) or _mirror()
        return {"FINISHED"}


class CATOPTRIC_OT_stop(bpy.types.Operator):
    """Stop what is under way, as Esc does"""

    bl_idname = "catoptric.stop"
    bl_label = "Stop"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """While there is something to stop."""
        return work.current() is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Ask it to end."""
        work.cancel()
        return {"FINISHED"}


def views_of(context: bpy.types.Context) -> list[bpy.types.Area]:
    """The 3D views of the window."""
    return [area for area in context.screen.areas if area.type == "VIEW_3D"] if context.screen else []


def _in_object_mode(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    if context.mode != "OBJECT":
        operator.poll_message_set("Leave edit mode first")
        return False
    return True


def _mirror() -> bpy.types.Material:
    material = bpy.data.materials.new(_MIRROR)
    if material.node_tree is None:  # Blender 4.5; later ones always have it
        material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"].inputs
    surface["Base Color"].default_value = (0.9, 0.9, 0.9, 1.0)
    surface["Metallic"].default_value, surface["Roughness"].default_value = 1.0, 0.0
    return material


_CLASSES = (
    CATOPTRIC_OT_show,
    CATOPTRIC_OT_find,
    CATOPTRIC_OT_select,
    CATOPTRIC_OT_make_mirror,
    CATOPTRIC_OT_stop,
    *operators_bake.CLASSES,
    *operators_compare.CLASSES,
    *operators_in_place.CLASSES,
    *operators_export.CLASSES,
)


register, unregister = bpy.utils.register_classes_factory(_CLASSES)
