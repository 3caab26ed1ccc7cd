"""What the buttons that start longer work have in common: progress, Esc, and one line at the end."""

import bpy

from ..errors import CatoptricError
from . import work

_TICK = 0.1


class Working:
    """Mixed into an operator, whose `task` says what is to be done. Blender stays usable meanwhile."""

    def task(self, context: bpy.types.Context) -> work.Task:
        """The work; raises a `CatoptricError` where it cannot be."""
        raise NotImplementedError

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """Why the button cannot be pressed, as a sentence; empty if it can."""
        return ""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Unless there is trouble, or other work under way."""
        current = work.current()
        trouble = f"{current.label} is still under way" if current else cls.trouble(context)
        if trouble:
            cls.poll_message_set(trouble)
        return not trouble

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Begin; without a window, stay until it is done."""
        if not self._begin(context):
            return {"CANCELLED"}
        if not bpy.app.background:
            return {"FINISHED"}
        work.wait(self._task)
        return self._report_end()

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Begin, and listen for Esc."""
        if not self._begin(context):
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0.0, 1.0)
        self._timer = manager.event_timer_add(_TICK, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show how far it is; all events but Esc go on to Blender."""
        if event.type == "ESC" and event.value == "PRESS":
            self._task.stop()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._task.over:
            self._leave(context)
            return self._report_end()
        context.window_manager.progress_update(self._task.fraction)
        context.workspace.status_text_set(f"{said_of(self._task)}  |  Esc: stop")
        return {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender takes the operator away: it opens another file, or closes the window."""
        self._task.stop()
        self._leave(context)

    def _begin(self, context: bpy.types.Context) -> bool:
        try:
            self._task = self.task(context)
            work.begin(self._task)
        except CatoptricError as problem:
            self.report({"ERROR"}, str(problem))
            return False
        return True

    def _leave(self, context: bpy.types.Context) -> None:
        manager = context.window_manager
        manager.event_timer_remove(self._timer)
        manager.progress_end()
        if context.workspace:
            context.workspace.status_text_set(None)

    def _report_end(self) -> set[str]:
        for note in self._task.notes:
            self.report({"WARNING"}, note)
        if self._task.problem:
            self.report({"ERROR"}, self._task.problem)
        elif self._task.stopped:
            self.report({"INFO"}, f"{self._task.label}: stopped")
        else:
            self.report({"INFO"}, self._task.outcome or f"{self._task.label}: done")
            return {"FINISHED"}
        return {"CANCELLED"}


def said_of(task: work.Task) -> str:
    """How far a task is, in a line."""
    stage = f", {task.stage}" if task.stage else ""
    return f"{task.label}{stage}: {task.fraction:.0%}" if not task.stopped else f"{task.label}: stopping"
