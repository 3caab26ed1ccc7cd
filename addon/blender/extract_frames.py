"""One frame of a scene after another: read whole, unless nothing but the camera has moved."""

from dataclasses import replace

import bpy

from ..progress import Progress, silent
from ..scene import Scene, sharing
from .extract import extract
from .extract_camera import check_camera, read_camera
from .notes import Notes


def extract_at(
    bpy_scene: bpy.types.Scene, frame: int, before: Scene | None = None, progress: Progress = silent
) -> Scene:
    """`bpy_scene` at `frame`, where it stays.

    What is as in `before`, the scene at the frame that Blender showed until now, is the same object in memory; nobody
    may have changed the file meanwhile. Where Blender says that the camera alone moves from that frame to this one,
    nothing else is read again: some modifiers take seconds.
    """
    moved = _set_frame(bpy_scene, frame)
    if before is not None and moved is not None and moved <= _camera_and_its_action(bpy_scene):
        check_camera(bpy_scene)
        camera = read_camera(bpy_scene, bpy.context.evaluated_depsgraph_get(), Notes())
        return replace(before, camera=camera, frame=frame)
    scene = extract(bpy_scene, progress=progress)
    return scene if before is None else sharing(scene, before)


def _set_frame(bpy_scene: bpy.types.Scene, frame: int) -> set[bpy.types.ID] | None:
    """Go to `frame`; what Blender says has changed on the way, None where it cannot know of everything that renders."""
    changed: list[set[bpy.types.ID]] = []

    def told(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        changed.append({update.id.original for update in depsgraph.updates})

    # A render marks everything as changed, though it leaves all as it was; that is not this frame's doing.
    bpy.context.view_layer.update()
    bpy.app.handlers.frame_change_post.append(told)
    try:
        bpy_scene.frame_set(frame)
    finally:
        bpy.app.handlers.frame_change_post.remove(told)
    return changed[0] if len(changed) == 1 and _shows_all(bpy_scene) else None


def _shows_all(bpy_scene: bpy.types.Scene) -> bool:
    """Whether all that renders is in the viewport as well, of whose changes alone Blender tells."""
    layer = bpy.context.view_layer
    if bpy.context.scene != bpy_scene or any(_differs(child) for child in _below(layer.layer_collection)):
        return False
    return all(thing.hide_render or thing.visible_get(view_layer=layer) for thing in layer.objects)


def _below(collection: bpy.types.LayerCollection) -> list[bpy.types.LayerCollection]:
    return [found for child in collection.children for found in (child, *_below(child))]


def _differs(collection: bpy.types.LayerCollection) -> bool:
    """Whether a collection renders and yet is hidden; what is excluded is gone from both."""
    hidden = collection.hide_viewport or collection.collection.hide_viewport
    return hidden and not collection.exclude and not collection.collection.hide_render


def _camera_and_its_action(bpy_scene: bpy.types.Scene) -> set[bpy.types.ID]:
    holder = bpy_scene.camera
    moving = holder and holder.animation_data and holder.animation_data.action
    return {thing for thing in (holder, moving) if thing is not None}
