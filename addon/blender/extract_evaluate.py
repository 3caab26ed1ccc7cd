"""The scene evaluated for rendering, which Blender shows only to render engines."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import bpy

from ..errors import SceneError

Result = TypeVar("Result")


def with_render_depsgraph(scene: bpy.types.Scene, read: Callable[[bpy.types.Depsgraph], Result]) -> Result:
    """Call `read` with `scene` evaluated as a final render has it, and return what it returns.

    Modifiers and particles are then at their render levels, and render visibility holds; a viewport's
    depsgraph has neither. What `read` raises is raised here, and `SceneError` if Blender refuses to render.
    """
    results: list[Result] = []
    failures: list[BaseException] = []

    class Reader(bpy.types.RenderEngine):
        """A render engine that renders nothing."""

        bl_idname = "CATOPTRIC_READER"
        bl_label = "Catoptric (reading the scene)"

        def render(self, depsgraph: bpy.types.Depsgraph) -> None:
            """Read once, though a stereo render asks twice; Blender prints what is raised here and goes on."""
            if results or failures:
                return
            try:
                results.append(read(depsgraph))
            except BaseException as failure:
                failures.append(failure)

    render = scene.render
    bpy.utils.register_class(Reader)
    try:
        with (
            kept(render, "engine", "use_compositing", "use_sequencer", "use_motion_blur", "film_transparent"),
            no_new_images(),
        ):
            render.engine = Reader.bl_idname
            render.use_compositing = render.use_sequencer = False
            bpy.ops.render.render(scene=scene.name, layer=layer_name(scene))
    except RuntimeError as refusal:
        reason = str(refusal).strip().splitlines()[-1]
        raise SceneError(f'scene "{scene.name}": Blender does not render it just now ({reason})') from None
    finally:
        # Left registered, it hangs Blender 4.5 as a module at exit.
        bpy.utils.unregister_class(Reader)
    if failures:
        raise failures[0]
    if not results:
        raise SceneError(
            f'scene "{scene.name}": Blender does not render it; try Render Image (F12) and mend what it says'
        )
    return results[0]


def layer_name(scene: bpy.types.Scene) -> str:
    """The view layer to render: the one in the window, else the first that is rendered."""
    if bpy.context.scene == scene and bpy.context.view_layer is not None:
        return bpy.context.view_layer.name
    return next((layer for layer in scene.view_layers if layer.use), scene.view_layers[0]).name


@contextmanager
def kept(owner: object, *names: str) -> Iterator[None]:
    """Give the named attributes of `owner` back their values at the end."""
    values = {name: getattr(owner, name) for name in names}
    try:
        yield
    finally:
        for name, value in values.items():
            setattr(owner, name, value)


@contextmanager
def no_new_images() -> Iterator[None]:
    """Remove the image blocks ("Render Result") that appear meanwhile."""
    before = {image.name_full for image in bpy.data.images}
    try:
        yield
    finally:
        for image in [image for image in bpy.data.images if image.name_full not in before]:
            bpy.data.images.remove(image)
