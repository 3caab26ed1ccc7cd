"""Bake, bake all, clear."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import bpy

from ..baking.layered_depth import KIND, LAYERS, RESOLUTION, each_bake
from ..cache import Cache
from ..drawing import Resident
from ..errors import CatoptricError, SceneError
from ..progress import Progress, part_of
from ..scene import Lighting, Scene
from ..scene.archive import EXTENSION
from . import bakes, lights, preflight, stages, work
from .background import ProcessTask
from .working import Working

_LIGHT_S_SHARE = 0.7
"""Of the way, where layers follow."""


class LightTask(ProcessTask):
    """Diffuse light, baked by Cycles on a copy of the open file."""

    def __init__(self, scene: bpy.types.Scene, read: Scene) -> None:
        """`read` is the scene as it stands now."""
        super().__init__("Baking light", "export", lighting=Lighting.CYCLES.value)
        self._uid, self._stood = scene.session_uid, read

    def arguments(self, folder: Path) -> dict[str, object]:
        """The archive goes to the temporary folder."""
        return super().arguments(folder) | {"out": str(folder / f"light{EXTENSION}")}

    def finish(self) -> None:
        """Keep the archive, and show it."""
        lights.keep(self._uid, self.folder / f"light{EXTENSION}", self._stood)
        bakes.forget_account(self._uid)
        self.outcome = "The light is baked"


class LayersTask(work.GlTask):
    """Layered depth textures of some objects, into the cache."""

    def __init__(self, uid: int, account: bakes.Account, wanted: frozenset[int]) -> None:
        """`wanted` are instances of the account's scene."""
        super().__init__("Baking layers", self._bake)
        self._uid, self._account, self._wanted = uid, account, wanted

    def finish(self) -> None:
        """Have the panel look again."""
        bakes.forget_account(self._uid)

    def _bake(self, progress: Progress) -> Iterator[None]:
        scene, settings = self._account.scene, self._account.settings
        others = frozenset(range(len(scene.instances))) - self._wanted
        resident = Resident(scene, settings.lighting)
        try:
            for number, asked in enumerate(baked := self._account.baked):
                chosen = {RESOLUTION.name: asked.resolution, LAYERS.name: asked.layers}
                share = part_of(progress, number / len(baked), (number + 1) / len(baked))
                for _ in each_bake(resident, chosen, Cache(), share, others):
                    yield
        finally:
            resident.release()


class CATOPTRIC_OT_bake(Working, bpy.types.Operator):
    """Bake what is missing or stale, and keep it on disk"""

    bl_idname = "catoptric.bake"
    bl_label = "Bake"

    name: bpy.props.StringProperty(
        name="Object", description="All objects, and the light, if it is empty", options={"SKIP_SAVE"}
    )

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """The scene must have been read."""
        return "" if read_stage(context) else "Show the scene in the viewport, or press Find Reflectors, first"

    def task(self, context: bpy.types.Context) -> work.Task:
        """One object, or all that is not fresh."""
        scene, stage = context.scene, read_stage(context)
        account = bakes.wait_for(scene, stage)
        if self.name:
            return _one(account, scene.session_uid, self.name)
        if account.light is None or account.light.kind == bakes.FRESH:
            return _all(account, scene.session_uid)
        trouble = preflight.no_camera(scene) or preflight.no_cycles(scene)
        if trouble:
            raise SceneError(f"the light is {account.light.kind}, and cannot be baked: {trouble}")
        return work.Chain("Baking", partial(_light_and_layers, scene, stage))


def _one(account: bakes.Account, uid: int, name: str) -> LayersTask:
    if account.light is not None and account.light.kind == bakes.MISSING:
        raise SceneError("the light is missing, and would be in what is baked: press Bake All, or Bake Light first")
    if name not in account.instances:
        raise SceneError(f'"{name}" needs no layered depth textures: no reflector searches it')
    return LayersTask(uid, account, account.instances[name])


def _all(account: bakes.Account, uid: int) -> LayersTask:
    wanted = unbaked(account)
    if not wanted:
        raise SceneError("there is nothing to bake: all is fresh")
    return LayersTask(uid, account, wanted)


def unbaked(account: bakes.Account) -> frozenset[int]:
    """The instances whose bakes are not fresh."""
    names = [state.name for state in account.objects if state.kind != bakes.FRESH]
    return frozenset().union(*(account.instances[name] for name in names))


def _light_and_layers(scene: bpy.types.Scene, stage: stages.Stage, chain: work.Task) -> work.Parts:
    """The light first: it is part of what the layers show."""
    uid = scene.session_uid
    yield LightTask(scene, stage.found), _LIGHT_S_SHARE
    chain.stage = "reading the light"
    while lights.busy():
        lights.poll()
        yield None, _LIGHT_S_SHARE
    stage.read()
    while (account := bakes.current(_scene_of(uid), stage)) is None:
        yield None, _LIGHT_S_SHARE
    if wanted := unbaked(account):
        yield LayersTask(uid, account, wanted), 1.0
    chain.outcome = "All is baked"


def _scene_of(uid: int) -> bpy.types.Scene:
    """The scene, which undo may have put elsewhere in memory."""
    scene = next((scene for scene in bpy.data.scenes if scene.session_uid == uid), None)
    if scene is None:
        raise SceneError("the scene that was being baked is gone")
    return scene


class CATOPTRIC_OT_bake_light(Working, bpy.types.Operator):
    """Have Cycles bake the diffuse light of the whole scene, in the background"""

    bl_idname = "catoptric.bake_light"
    bl_label = "Bake Light"

    @classmethod
    def trouble(cls, context: bpy.types.Context) -> str:
        """Light is shared out as the camera sees it."""
        if not read_stage(context):
            return "Show the scene in the viewport, or press Find Reflectors, first"
        return preflight.no_camera(context.scene) or preflight.no_cycles(context.scene)

    def task(self, context: bpy.types.Context) -> work.Task:
        """In a process of its own."""
        return LightTask(context.scene, read_stage(context).found)


class CATOPTRIC_OT_clear(bpy.types.Operator):
    """Remove bakes from the disk; what is on the screen stays"""

    bl_idname = "catoptric.clear"
    bl_label = "Clear"

    name: bpy.props.StringProperty(name="Object", description="All bakes if it is empty", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Where there is something."""
        stage = read_stage(context)
        account = bakes.account_of(context.scene, stage) if stage else None
        if work.current() or account is None or not account.size:
            cls.poll_message_set("Work is under way" if work.current() else "There are no bakes of this scene")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove the files."""
        account = bakes.wait_for(context.scene, read_stage(context))
        try:
            for state in account.objects:
                if self.name in ("", state.name):
                    for key in account.kept[state.name]:
                        Cache().remove(KIND, key)
            if not self.name:
                lights.forget(context.scene)
        except CatoptricError as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        bakes.forget_account(context.scene.session_uid)
        stages.touch()
        return {"FINISHED"}


def read_stage(context: bpy.types.Context) -> stages.Stage | None:
    """The scene's stage, once it has been read."""
    stage = stages.known(context.scene, context.view_layer)
    return stage if stage is not None and stage.shown is not None else None


CLASSES = (CATOPTRIC_OT_bake, CATOPTRIC_OT_bake_light, CATOPTRIC_OT_clear)
