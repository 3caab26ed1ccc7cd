"""Have Cycles draw what the viewport shows."""

from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio

from ..errors import MachineError
from ..methods.contract import View
from . import preflight, stages
from .background import ProcessTask
from .in_place import InPlace
from .viewport import scale_at_rest, view_of
from .working import Working


class _Reference(ProcessTask):
    """Cycles' picture of one view."""

    def __init__(self, stage: stages.Stage, view: View, **arguments: object) -> None:
        super().__init__("Cycles draws this view", "reference", **arguments)
        self._stage, self._view = stage, view

    def arguments(self, folder: Path) -> dict[str, object]:
        """The view, as JSON takes it, and a file for the picture."""
        camera = self._view.camera
        seen = {name: getattr(camera, name) for name in ("lens", "sensor", "shift", "ortho_scale", "near", "far")}
        seen |= {"matrix": camera.matrix.tolist(), "pixel_aspect": camera.pixel_aspect}
        size = {"width": self._view.width, "height": self._view.height}
        return {**super().arguments(folder), **size, "camera": seen, "out": str(folder / "reference.exr")}

    def finish(self) -> None:
        """Show it beside ours."""
        buffer = oiio.ImageBuf(str(self.folder / "reference.exr"))
        pixels = buffer.get_pixels(oiio.FLOAT)
        if buffer.has_error or pixels is None:
            raise MachineError("Cycles' picture of this view cannot be read: is the disk full?")
        self._stage.reference = InPlace(self._view, np.ascontiguousarray(pixels[::-1, :, :3]))
        self.outcome = "Cycles to the right, ours to the left"
        stages.touch()


class CATOPTRIC_OT_compare_in_place(Working, bpy.types.Operator):
    """Draw what this viewport shows by Cycles, in the background, and show it half and half with ours"""

    bl_idname = "catoptric.compare_in_place"
    bl_label = "Compare This View"

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """It takes a viewport that shows our picture, and Cycles."""
        if context.region_data is None or stages.known(context.scene, context.view_layer) is None:
            return "Show the scene in Rendered mode by the engine Catoptric first"
        return preflight.no_cycles(context.scene)

    def task(self, context: bpy.types.Context) -> ProcessTask:
        """At the viewport's own camera and size."""
        scene = context.scene
        settings = scene.catoptric
        region = next(region for region in context.area.regions if region.type == "WINDOW")
        view = view_of(region, context.region_data, scale_at_rest(settings))
        settings.overlay = "SPLIT"
        stage = stages.known(scene, context.view_layer)
        return _Reference(stage, view, lighting=settings.lighting, samples=settings.reference_samples)


CLASSES = (CATOPTRIC_OT_compare_in_place,)
