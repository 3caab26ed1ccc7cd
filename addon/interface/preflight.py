"""What a person should know before a button is pressed, a sentence each."""

from pathlib import Path

import bpy

from .texts import listed


def no_camera(scene: bpy.types.Scene) -> str:
    """Why there is no picture to compare; empty if there is one."""
    if scene.camera is None:
        return "The scene has no camera to compare from; add one"
    if scene.camera.type != "CAMERA":
        return f'"{scene.camera.name}" is no camera; make one the active camera of the scene'
    return ""


def no_cycles(scene: bpy.types.Scene) -> str:
    """Why Cycles cannot work; empty if it can."""
    return "" if hasattr(scene, "cycles") else "Cycles is switched off; enable it under Add-ons"


def unsaved(folder: Path) -> list[str]:
    """Where a report goes as long as the file has no place of its own."""
    if bpy.data.filepath:
        return []
    return [f"The file is not saved yet: the report goes to {folder}, and stays there"]


def for_cycles(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> list[str]:
    """Where what Cycles renders differs from what the viewport shows."""
    said = []
    painted = [image.name for image in bpy.data.images if image.is_dirty and image.source == "FILE"]
    if painted:
        said.append(f"Images with changes that are not saved count as they are on disk: {listed(painted)}")
    hidden = [
        holder.name
        for holder in layer.objects
        if not holder.hide_render and holder.type == "MESH" and not holder.visible_get(view_layer=layer)
    ]
    if hidden:
        said.append(f"Hidden in the viewport, yet rendered: {listed(hidden)}")
    unrendered = [holder.name for holder in layer.objects if holder.hide_render and holder.type == "MESH"]
    if unrendered:
        said.append(f"Not rendered, and so in no reflection: {listed(unrendered)}")
    return said
