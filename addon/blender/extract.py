"""From a Blender scene to a `Scene`: whatever a final render would show."""

from collections.abc import Iterator

import bpy
import numpy as np

from ..progress import Progress, silent
from ..scene import Camera, Instance, Lamp, Mesh, Scene
from ..scene.soundness import NOWHERE, Empty, is_placed
from .extract_camera import check_camera, read_camera, read_lamp
from .extract_evaluate import with_render_depsgraph
from .extract_memo import Memo
from .extract_mesh import Surfacing, read_mesh
from .images import ImageReader
from .materials import MaterialReader, Slot
from .materials_lookup import object_space
from .names import Names
from .notes import Notes
from .world import read_world

REFLECTOR_PROPERTY = "catoptric_reflector"
"""The custom property of an object that says whether it is a reflector, whatever its materials."""

_LEFT_OUT = {"CURVES": "hair curves", "POINTCLOUD": "a point cloud", "VOLUME": "a volume"} | dict.fromkeys(
    ("GREASEPENCIL", "GPENCIL"), "grease pencil"
)


def extract(
    context_scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph | None = None,
    frame: int | None = None,
    progress: Progress = silent,
    camera: Camera | None = None,
    memo: Memo | None = None,
) -> Scene:
    """Everything that a method needs of `context_scene`, at `frame` (default: its current one).

    Without `depsgraph` the scene is evaluated as for a final render; a viewport passes its own, and gets
    what it shows; its own `camera`, which stands for the scene's; and the `memo` of the reading before.
    What cannot be carried over is named in `Scene.warnings`. Raises `SceneError` without a usable camera.
    The .blend is left as it was.
    """
    if camera is None:
        check_camera(context_scene)
    frame_before = context_scene.frame_current, context_scene.frame_subframe
    try:
        if frame is not None and frame != frame_before[0]:
            context_scene.frame_set(frame)
        reading = _Reading(context_scene, progress, camera, memo or Memo())
        if depsgraph is not None:
            reading.read(depsgraph)
        else:
            with_render_depsgraph(context_scene, reading.read)
        return reading.finish()
    finally:
        if context_scene.frame_current != frame_before[0]:
            context_scene.frame_set(frame_before[0], subframe=frame_before[1])


class _Reading:
    """One extraction under way."""

    def __init__(self, scene: bpy.types.Scene, progress: Progress, camera: Camera | None, memo: Memo) -> None:
        self.scene, self.progress, self.camera, self.memo = scene, progress, camera, memo
        self.notes = Notes()
        self.images = ImageReader(self.notes, memo.images)
        self.materials = MaterialReader(self.images, self.notes)
        self.meshes: list[Mesh] = []
        self.instances: list[Instance] = []
        self.lamps: list[Lamp] = []
        self._known: dict[tuple, int | Empty] = {}
        self._used_slots: list[list[int]] = []  # of each mesh
        self._names = Names()
        self._override: bpy.types.Material | None = None

    def read(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Take in the camera, and every visible mesh and lamp."""
        if self.camera is None:
            self.camera = read_camera(self.scene, depsgraph, self.notes)
        self._override = depsgraph.view_layer_eval.material_override
        total = max(len(depsgraph.object_instances), 1)
        for number, placed in enumerate(depsgraph.object_instances):
            self.progress("reading the scene", 0.9 * number / total)
            holder = placed.object
            # For a final render the depsgraph has settled this; a particle's object is often hidden itself.
            hidden = depsgraph.mode == "VIEWPORT" and holder.hide_render and not placed.is_instance
            if not placed.show_self or hidden:
                continue
            # The matrix is copied: Blender's is only valid within this step of the loop.
            matrix = np.array(placed.matrix_world, dtype=np.float64)
            parent = placed.parent if placed.is_instance else None
            if holder.type == "MESH":
                self._add_mesh(depsgraph, holder, parent, matrix)
            elif holder.type == "LIGHT":
                self.lamps.append(read_lamp(holder, matrix, self._names.unique(holder.name), self.notes))
            elif holder.type in _LEFT_OUT:
                self.notes.add(_object(holder), f"{_LEFT_OUT[holder.type]} cannot be drawn; it is left out")
            self._warn_of_hair(holder)
        self.memo.keep_used()

    def finish(self) -> Scene:
        """The Scene; the world is read now, since Blender renders one thing at a time."""
        self.progress("reading the world", 0.9)
        scene, render = self.scene, self.scene.render
        self._warn_of_color_space()
        if self.memo.world is None:
            self.memo.world = read_world(scene.world, scene.frame_current, self.notes, self.memo.may_render)
        percentage = render.resolution_percentage / 100.0
        self.progress("reading the scene", 1.0)
        return Scene(
            name=scene.name,
            camera=self.camera,
            meshes=tuple(self.meshes),
            instances=tuple(self.instances),
            materials=tuple(self.materials.materials),
            images=tuple(self.images.images),
            lamps=tuple(self.lamps),
            world=self.memo.world,
            frame=scene.frame_current,
            resolution=(
                max(int(render.resolution_x * percentage), 1),
                max(int(render.resolution_y * percentage), 1),
            ),
            glossy_bounces=_bounces(scene),
            warnings=self.notes.lines,
            view=scene.view_settings.view_transform,
            exposure=scene.view_settings.exposure,
        )

    def _add_mesh(self, depsgraph, holder, parent, matrix: np.ndarray) -> None:
        if len(holder.data.polygons) == 0 and parent is None and _only_instances(holder):
            return
        if not is_placed(matrix):
            self.notes.add(_object(holder), f"{NOWHERE}; it is left out")
            return
        wanted = _wanted(holder, parent, self.notes)
        slots = self._slots(holder, forced=wanted is True)
        mesh = self._mesh(depsgraph, holder, slots, matrix)
        if isinstance(mesh, Empty):
            self.notes.add(_object(holder), f"{mesh}; it is left out")
            return
        # A negative determinant (a mirrored object) stays in the matrix: it turns the winding round, so a
        # rasteriser must swap front and back there, while normals go by the inverse transpose and still
        # point outwards.
        self.instances.append(
            Instance(
                name=self._names.unique(holder.name),
                mesh=mesh,
                matrix=matrix,
                materials=tuple(slot.index for slot in slots),
                reflector=self._reflects(holder, wanted, [slots[used] for used in self._used_slots[mesh]]),
                in_reflections=_seen(holder, parent, "visible_glossy"),
                in_camera=_seen(holder, parent, "visible_camera"),
            )
        )

    def _slots(self, holder: bpy.types.Object, forced: bool) -> list[Slot]:
        """What each material slot holds, be it linked to the object or to its mesh."""
        materials = [self._override or slot.material for slot in holder.material_slots] or [self._override]
        return [self.materials.slot(material, holder.name, forced) for material in materials]

    def _mesh(self, depsgraph, holder: bpy.types.Object, slots: list[Slot], matrix: np.ndarray) -> int | Empty:
        """The index of the instance's mesh; instances of one evaluated mesh share it if they look textures up alike."""

        def evaluated(name: str) -> bpy.types.Object | None:
            other = bpy.data.objects.get(name)
            return other and other.evaluated_get(depsgraph)

        surfacings = tuple(Surfacing(object_space(slot.lookup, matrix, evaluated), slot.attribute) for slot in slots)
        key = (holder.data.as_pointer(), surfacings)
        if key not in self._known:
            mesh = self.memo.mesh(key, holder) or self._read_mesh(key, holder, surfacings)
            self._known[key] = mesh
            if isinstance(mesh, Mesh):
                self._known[key] = len(self.meshes)
                self.meshes.append(mesh)
                self._used_slots.append(np.unique(mesh.slots).tolist())
        return self._known[key]

    def _read_mesh(self, key: tuple, holder: bpy.types.Object, surfacings: tuple[Surfacing, ...]) -> Mesh | Empty:
        try:
            self.memo.meshes[key] = read_mesh(holder.data, surfacings)
        except Empty as reason:
            self.memo.meshes[key] = reason
        return self.memo.meshes[key]

    def _reflects(self, holder: bpy.types.Object, wanted: bool | None, used: list[Slot]) -> bool:
        """Whether a mirror image is to be drawn: as the artist says, else if a material in use is a clear mirror."""
        if wanted is None:
            return any(slot.mirrors_clearly for slot in used)
        if wanted and not any(slot.mirrors for slot in used):
            self.notes.add(
                _object(holder), f"is to be a reflector ({REFLECTOR_PROPERTY}), but no material of it reflects"
            )
            return False
        return wanted

    def _warn_of_hair(self, holder: bpy.types.Object) -> None:
        for system in holder.particle_systems:
            if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                self.notes.add(_object(holder), f'hair "{system.name}" is not supported; it is left out')

    def _warn_of_color_space(self) -> None:
        space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "Linear Rec.709")
        if space != "Linear Rec.709":
            self.notes.add("the file", f"working space {space} is not supported; colours are taken as linear Rec.709")


def _object(holder: bpy.types.Object) -> str:
    return f'object "{holder.name}"'


def _only_instances(holder: bpy.types.Object) -> bool:
    """Whether an object without faces is there for what it instances (geometry nodes, particles, vertices)."""
    return holder.is_instancer or any(modifier.type == "NODES" for modifier in holder.modifiers)


def _family(holder: bpy.types.Object, parent: bpy.types.Object | None) -> Iterator[bpy.types.Object]:
    """The object, and the one that instances it."""
    yield holder
    if parent is not None:
        yield parent


def _seen(holder: bpy.types.Object, parent: bpy.types.Object | None, by: str) -> bool:
    """Ray visibility: an instance is hidden with its instancer, as in Cycles."""
    return all(getattr(one, by) for one in _family(holder, parent))


def _wanted(holder: bpy.types.Object, parent: bpy.types.Object | None, notes: Notes) -> bool | None:
    """What the custom property says, on the object or else on its instancer; None if it says nothing."""
    for one in _family(holder, parent):
        value = one.get(REFLECTOR_PROPERTY)
        if isinstance(value, bool | int) and value in (0, 1):
            return bool(value)
        if value is not None:
            notes.add(_object(one), f"{REFLECTOR_PROPERTY} is {value!r}, neither true nor false; it is ignored")
    return None


def _bounces(scene: bpy.types.Scene) -> int:
    """Cycles' glossy bounces; as many as in a new file if Cycles is off."""
    cycles = getattr(scene, "cycles", None)
    return min(cycles.glossy_bounces, cycles.max_bounces) if cycles else 4
