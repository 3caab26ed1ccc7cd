"""Compare with Cycles, and look at the report."""

import shutil
import webbrowser
from pathlib import Path

import bpy

from ..errors import MachineError, SceneError
from ..methods.registry import METHODS
from . import preflight
from .background import ProcessTask
from .choices import OF_SCENE
from .places import output_folder
from .working import Working

REPORT = "report.html"

_written: dict[int, Path] = {}
"""By scene, the last report of this session."""


class _Comparison(ProcessTask):
    """The batch comparator, on a copy of the open file."""

    def __init__(self, uid: int, folder: Path, **arguments: object) -> None:
        super().__init__("Comparing with Cycles", "compare", out=str(folder), **arguments)
        self._uid, self._report = uid, folder / REPORT
        self._was_there = folder.exists()

    def finish(self) -> None:
        """Open the report."""
        if not self._report.is_file():
            raise MachineError(f"no report was written; {self.notes[-1] if self.notes else 'Blender ended too early'}")
        _written[self._uid] = self._report
        self.outcome = f"Report: {self._report}"
        if not bpy.app.background:
            show(self._report)

    def drop(self) -> None:
        """A folder without a single finished row is of no use."""
        super().drop()
        if not self._was_there and not self._report.exists():
            shutil.rmtree(self._report.parent, ignore_errors=True)


class CATOPTRIC_OT_compare(Working, bpy.types.Operator):
    """Render the scene by Cycles and by the methods, in the background, and write a report of how they differ"""

    bl_idname = "catoptric.compare"
    bl_label = "Compare with Cycles"

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """There must be a camera, Cycles, and something that mirrors."""
        return preflight.no_camera(context.scene) or preflight.no_cycles(context.scene)

    def task(self, context: bpy.types.Context) -> ProcessTask:
        """As the settings of the scene say."""
        scene = context.scene
        settings = scene.catoptric
        chosen = list(METHODS) if settings.compared == "ALL" else methods_in_use(scene)
        return _Comparison(
            scene.session_uid,
            report_folder(scene),
            lighting=settings.lighting,
            settings={name: dict(settings.methods.values(name)) for name in chosen},
            samples=settings.reference_samples,
        )


class CATOPTRIC_OT_open_report(bpy.types.Operator):
    """Show the last report of this scene in a web browser"""

    bl_idname = "catoptric.open_report"
    bl_label = "Open Report"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Once there is one."""
        if not last_report(context.scene).is_file():
            cls.poll_message_set("There is no report of this scene yet; compare it with Cycles first")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Open the browser."""
        show(last_report(context.scene))
        return {"FINISHED"}


def methods_in_use(scene: bpy.types.Scene) -> list[str]:
    """The method of the scene, and those that objects of it have of their own."""
    own = {holder.catoptric.method for holder in scene.objects} - {OF_SCENE}
    return [name for name in METHODS if name in own | {scene.catoptric.method}]


def report_folder(scene: bpy.types.Scene) -> Path:
    """Where the report of a scene goes."""
    return output_folder() / bpy.path.clean_name(scene.name)


def last_report(scene: bpy.types.Scene) -> Path:
    """The report that was written last; the file may have got a name since."""
    newest = _written.get(scene.session_uid)
    return newest if newest is not None and newest.is_file() else report_folder(scene) / REPORT


def show(report: Path) -> None:
    """Open a report in the web browser."""
    if not report.is_file():
        raise SceneError(f"{report}: there is no such report any more")
    if not bpy.app.background:
        webbrowser.open(report.as_uri())


CLASSES = (CATOPTRIC_OT_compare, CATOPTRIC_OT_open_report)
