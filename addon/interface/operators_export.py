"""Export for game engines, and for machines without Blender."""

from pathlib import Path

import bpy

from ..baking.engine_export import CUBE_SIZE, PARAMETERS
from ..scene.archive import EXTENSION
from . import bakes, preflight
from .background import ProcessTask
from .places import output_folder
from .working import Working


class _Asking(Working):
    """Asks for a place first, unless it is told one; then works."""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Open the file browser where no place is given."""
        if self.filepath:
            return super().invoke(context, event)
        self.filepath = str(self.proposal(context))
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """From the file browser, begin anew with the place that was chosen."""
        if bpy.app.background:
            return super().execute(context)
        getattr(bpy.ops.catoptric, self.bl_idname.rpartition(".")[2])("INVOKE_DEFAULT", filepath=self.filepath)
        return {"FINISHED"}

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """There must be a camera: a scene is exported with it."""
        return preflight.no_camera(context.scene)


class CATOPTRIC_OT_export_engine(_Asking, bpy.types.Operator):
    """Write the bakes of the selected objects as textures for a game engine, with the GLSL that samples them"""

    bl_idname = "catoptric.export_engine"
    bl_label = "Export for Engines"

    filepath: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", options={"SKIP_SAVE"})

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """Something must be selected."""
        if not any(holder.type != "CAMERA" and holder.type != "LIGHT" for holder in context.selected_objects):
            return "Select the objects to export"
        return super().trouble(context)

    def proposal(self, context: bpy.types.Context) -> Path:
        """A folder beside the file."""
        return output_folder() / "engine"

    def task(self, context: bpy.types.Context) -> ProcessTask:
        """As bakes are set."""
        asked = bakes.asked_by(context.scene)
        values = {"resolution": asked.resolution, "layers": asked.layers, CUBE_SIZE.name: CUBE_SIZE.default}
        names = [holder.name for holder in context.selected_objects if holder.type not in {"CAMERA", "LIGHT"}]
        return _Export(
            "Exporting for engines",
            "export_engine",
            Path(bpy.path.abspath(self.filepath)),
            lighting=context.scene.catoptric.lighting,
            objects=names,
            settings={parameter.name: values[parameter.name] for parameter in PARAMETERS},
        )


class CATOPTRIC_OT_export_scene(_Asking, bpy.types.Operator):
    """Write the scene, with its light, as one file for machines without Blender and for `catoptric preview`"""

    bl_idname = "catoptric.export_scene"
    bl_label = "Export Scene"

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH", options={"SKIP_SAVE"})
    filter_glob: bpy.props.StringProperty(default=f"*{EXTENSION}", options={"HIDDEN"})

    def proposal(self, context: bpy.types.Context) -> Path:
        """A file beside the .blend."""
        if bpy.data.filepath:
            return Path(bpy.data.filepath).with_suffix(EXTENSION)
        return output_folder() / f"scene{EXTENSION}"

    def task(self, context: bpy.types.Context) -> ProcessTask:
        """With the light that the settings ask for."""
        place = Path(bpy.path.abspath(self.filepath)).with_suffix(EXTENSION)
        return _Export("Exporting the scene", "export", place, lighting=context.scene.catoptric.lighting)


class _Export(ProcessTask):
    def __init__(self, label: str, name: str, place: Path, **arguments: object) -> None:
        super().__init__(label, name, out=str(place), **arguments)
        self._place = place

    def finish(self) -> None:
        """Say where it is."""
        self.outcome = f"Written: {self._place}"


CLASSES = (CATOPTRIC_OT_export_engine, CATOPTRIC_OT_export_scene)
