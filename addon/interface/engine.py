"""The render engine Catoptric: the viewport's Rendered mode, and F12."""

import bpy
import numpy as np

from ..errors import Cancelled, CatoptricError
from . import stages
from .final import PASSES, final_passes
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

    def update_render_passes(self, scene: bpy.types.Scene, renderlayer: bpy.types.ViewLayer) -> None:
        """What the compositor may ask for."""
        for name, channels, kind in PASSES:
            self.register_pass(scene, renderlayer, name, len(channels), channels, kind)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        """F12: the scene's camera, at the samples of the settings."""
        try:
            passes = final_passes(depsgraph, self._report, lambda line: self.report({"WARNING"}, line))
        except Cancelled:
            return
        except CatoptricError as problem:
            self.error_set(str(problem))
            return
        height, width = passes["Combined"].shape[:2]
        result = self.begin_result(0, 0, width, height)
        written = result.layers[0].passes
        for name, values in passes.items():
            if name in written:
                # Blender's row 0 is at the bottom.
                written[name].rect.foreach_set(np.ascontiguousarray(values[::-1], np.float32).ravel())
        self.end_result(result)

    def _report(self, stage: str, fraction: float) -> None:
        if self.test_break():
            raise Cancelled
        self.update_stats("Catoptric", stage)
        self.update_progress(fraction)


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
