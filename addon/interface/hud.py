"""Words in a viewport's corner: what each stage of a frame costs, how far a bake is, what went wrong."""

from collections.abc import Mapping

import blf
import bpy

from ..methods.techniques import TECHNIQUES
from . import stages
from .texts import sentence, wrapped

_SIZE = 12
_LEFT = _BOTTOM = 12
_OUTLINE = 6
"""Of the shadows that blf offers, the one that can be read on any ground."""
_handle = None


def lines(stage: stages.Stage, viewer: object, show_times: bool) -> list[str]:
    """What there is to tell, from the bottom up."""
    studio = stage.studio
    told = [sentence(text) for text in (stage.problem, studio.problem) if text]
    if studio.stage and studio.busy:
        told.append(f"{studio.stage}: {studio.fraction:.0%}")
    picture = studio.picture(viewer) if viewer else None
    held = stage.reference
    if picture and held and held.flip is not None and held.fits(picture.view):
        told.append(f"FLIP over the mirrors {held.flip:.4f}")
    if picture and show_times:
        told += [f"at 1/{viewer.scale} of the resolution"] if viewer.scale > 1 else []
        told += [f"{name} {time:.1f} ms" for name, time in reversed(_stages(picture.time_ms, viewer.copy_ms).items())]
    return told


def _stages(time_ms: Mapping[str, float], copy_ms: float) -> dict[str, float]:
    """Milliseconds by stage, from the top down: a method's share below the sum, the way to the screen at the end."""
    indented = {f"    {name}" if name in TECHNIQUES else name: time for name, time in time_ms.items()}
    return {**indented, "copy": copy_ms}


def _draw() -> None:
    context = bpy.context
    scene, shading = context.scene, context.space_data.shading
    if scene.render.engine != stages.ENGINE or shading.type != "RENDERED":
        return
    stage = stages.known(scene, context.view_layer)
    if stage is None:
        return
    viewer = stage.viewers.get(context.region.as_pointer())
    scale = context.preferences.system.ui_scale
    blf.size(0, _SIZE * scale)
    blf.color(0, 1.0, 1.0, 1.0, 0.9)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, _OUTLINE, 0.0, 0.0, 0.0, 0.8)
    told = [wrapped(line, _room(context), scale) for line in lines(stage, viewer, scene.catoptric.show_times)]
    for number, line in enumerate(row for rows in told for row in reversed(rows)):
        blf.position(0, _LEFT, _BOTTOM + number * 1.5 * _SIZE * scale, 0)
        blf.draw(0, line)
    blf.disable(0, blf.SHADOW)


def _room(context: bpy.types.Context) -> float:
    """Pixels between the corner and the sidebar, which may lie over the region."""
    sidebar = next((region.width for region in context.area.regions if region.type == "UI"), 0)
    return context.region.width - sidebar - 2 * _LEFT


def register() -> None:
    """Draw over every 3D viewport."""
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    """Draw no more."""
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
