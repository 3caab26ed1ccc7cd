"""One stage for each scene that a viewport shows: reads it when Blender says that it has changed."""

import threading
from collections.abc import Hashable

import bpy
import gpu
import numpy as np

from ..blender.extract import extract
from ..blender.extract_camera import check_camera
from ..blender.extract_memo import Memo
from ..blender.names import object_name
from ..errors import CatoptricError, SceneError
from ..gl import give_way
from ..methods.mixed import Assignment
from ..methods.studio import Act, Studio
from ..scene import Camera, Scene
from . import lights
from .choices import method_of
from .in_place import InPlace
from .leaving import forgetting_factory
from .work import redraw_panels

ENGINE = "CATOPTRIC"
_POLL = 1.0 / 60.0


class Stage:
    """A scene and view layer as viewports see them, and the studio that draws it. Lives on the main thread."""

    def __init__(self, scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
        self.studio = Studio(_news.set)
        self.memo = Memo()
        self.found: Scene | None = None
        self.shown: Scene | None = None
        self.problem = ""
        self.act = 0
        self.reference: InPlace | None = None
        self.viewers: dict[int, Hashable] = {}
        self._scene, self._layer = scene.session_uid, layer.name
        self.stale = True

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the last reading could not carry over."""
        return self.found.warnings if self.found else ()

    def told(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Take note of what has changed; it is read soon, not in the middle of Blender's drawing."""
        self.memo.forget(depsgraph)
        self.stale = True
        wake()

    def read(self) -> None:
        """Read the scene anew, and have it drawn."""
        self.stale = False
        scene = next((scene for scene in bpy.data.scenes if scene.session_uid == self._scene), None)
        layer = scene.view_layers.get(self._layer) if scene else None
        if layer is None or layer.depsgraph is None:
            return
        try:
            found = extract(scene, layer.depsgraph, camera=_stand_in(scene), memo=self.memo)
        except CatoptricError as problem:
            self.problem = str(problem)
            return
        self.problem, self.found = "", found
        self.shown, lighting = lights.shown(scene, found)
        self.act = self.studio.show(Act(self.shown, lighting, assignment(scene, found)))

    @property
    def said(self) -> tuple:
        """What panels say of it."""
        studio = self.studio
        under_way = (studio.stage, round(studio.fraction, 2)) if studio.stage and studio.busy else None
        return self.problem, self.warnings, studio.problem, studio.choices, under_way


def assignment(bpy_scene: bpy.types.Scene, scene: Scene) -> Assignment:
    """The method of every reflector of `scene`, extracted from `bpy_scene`, as its object or the scene has it."""
    reflectors = [scene.instances[index].name for index in scene.reflectors]
    return {name: method_of(bpy_scene, bpy.data.objects.get(object_name(name))) for name in reflectors}


def _stand_in(bpy_scene: bpy.types.Scene) -> Camera | None:
    """A camera where the scene has none that will do: a viewport brings its own, but Auto looks from the scene's."""
    try:
        check_camera(bpy_scene)
    except SceneError:
        return Camera(np.eye(4))
    return None


_stages: dict[tuple[int, str], Stage] = {}
_news = threading.Event()
_in_panels: list[tuple] = []
"""What every stage said when panels were drawn last."""


def stage_of(depsgraph: bpy.types.Depsgraph) -> Stage:
    """The stage of the scene and view layer that a viewport shows."""
    scene, layer = depsgraph.scene.original, depsgraph.view_layer
    key = (scene.session_uid, layer.name)
    if key not in _stages:
        _stages[key] = Stage(scene, layer)
        wake()
    return _stages[key]


def known(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> Stage | None:
    """The stage, if a viewport has shown this scene."""
    return _stages.get((scene.session_uid, layer.name))


def touch() -> None:
    """Have every scene read again, because a setting changed."""
    for stage in _stages.values():
        stage.stale = True
    if _stages:
        wake()


def wake() -> None:
    """Read what is stale, and redraw the viewports as soon as a studio has something new to show."""
    if not bpy.app.timers.is_registered(_poll):
        bpy.app.timers.register(_poll)


def _poll() -> float | None:
    """Reads what is stale, redraws what has news; sleeps for good when all is drawn."""
    for stage in list(_stages.values()):
        if stage.stale:
            stage.read()
    if _news.is_set():
        _news.clear()
        _redraw_viewports()
    _redraw_panels_that_lag()
    at_work = any(stage.stale or stage.studio.busy for stage in _stages.values())
    return _POLL if at_work or _news.is_set() else None


def _redraw_panels_that_lag() -> None:
    """Panels are dear to draw: only when what they say has changed."""
    global _in_panels
    said = [stage.said for stage in _stages.values()]
    if said != _in_panels:
        _in_panels = said
        redraw_panels()


def redraw_in(seconds: float) -> None:
    """Redraw the viewports after some time, whatever happens until then."""
    if not bpy.app.timers.is_registered(_redraw_viewports):
        bpy.app.timers.register(_redraw_viewports, first_interval=seconds)


def _redraw_viewports() -> None:
    for window in bpy.context.window_manager.windows:
        if window.scene.render.engine != ENGINE:
            continue
        for area in window.screen.areas:
            if area.type == "VIEW_3D" and area.spaces.active.shading.type == "RENDERED":
                for region in area.regions:
                    if region.type == "WINDOW":  # not the sidebar and the headers, which show no picture
                        region.tag_redraw()


def _close_all() -> None:
    for stage in _stages.values():
        stage.studio.close()
    _stages.clear()


def _give_way() -> None:
    """Have a software OpenGL wait for Blender; it says whether it is one as soon as its window is open."""
    if gpu.platform.device_type_get() == "SOFTWARE":
        give_way()


lights.when_read = touch
_register, unregister = forgetting_factory(_close_all, _poll, _redraw_viewports, _give_way)


def register() -> None:
    """Be ready for viewports."""
    if not bpy.app.background:
        bpy.app.timers.register(_give_way, persistent=True)
    _register()
