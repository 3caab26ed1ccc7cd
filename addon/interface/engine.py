"""The render engine Catoptric: the viewport's Rendered mode, and F12."""

import bpy

from ..errors import Cancelled, CatoptricError
from ..methods.contract import Frame, View
from ..methods.registry import named
from ..scene import Camera, Lighting
from . import stages
from .viewport import Viewport


class CatoptricEngine(bpy.types.RenderEngine):
    """Real-time reflections, measured against Cycles."""

    bl_idname = stages.ENGINE
    bl_label = "Catoptric"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def __init__(self, *args, **kwargs) -> None:
        """Blender makes one for each viewport, and one for each render."""
        super().__init__(*args, **kwargs)
        self._viewport: Viewport | None = None

    def __del__(self) -> None:
        viewport = getattr(self, "_viewport", None)
        if viewport is not None:
            viewport.close()

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """The scene has changed."""
        stages.stage_of(depsgraph).told(depsgraph)

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Show the newest picture; ask for a newer one where it is not of this view."""
        if self._viewport is None:
            self._viewport = Viewport()
        self._viewport.draw(self, context, stages.stage_of(depsgraph))


_CLASSES = (CatoptricEngine,)


def _panels() -> list[type[bpy.types.Panel]]:
    """Blender's own panels that make sense with any engine."""
    unwanted = {"VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes"}
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ()) and panel.__name__ not in unwanted
    ]


def register() -> None:
    """Add the engine, and show Blender's common panels with it."""
    for kind in _CLASSES:
        bpy.utils.register_class(kind)
    for panel in _panels():
        panel.COMPAT_ENGINES.add(stages.ENGINE)


def unregister() -> None:
    """Take it away."""
    for panel in _panels():
        panel.COMPAT_ENGINES.discard(stages.ENGINE)
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
