"""Change a Blender scene for one render, take the picture as linear floats, and put everything back."""

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
import OpenImageIO as oiio

from ..errors import MachineError, SceneError, UsageError
from .extract_evaluate import layer_name, no_new_images


@contextmanager
def changed(owner: bpy.types.bpy_struct, **values: object) -> Iterator[None]:
    """Set properties of `owner`, and set them back at the end, in the same order.

    The order matters where one property limits another (an image's file format, its colour depth).
    A property that this release of Blender lacks is left out.
    """
    before = {name: getattr(owner, name) for name in values if hasattr(owner, name)}
    try:
        for name in before:
            setattr(owner, name, values[name])
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)


@contextmanager
def plain_picture(bpy_scene: bpy.types.Scene, width: int, height: int) -> Iterator[None]:
    """Every pixel of one sharp picture, with nothing between the renderer and the file.

    No compositor, sequencer, border, depth of field, motion blur, stereo, stamp or Freestyle;
    saved as 32-bit linear OpenEXR.
    """
    if width < 1 or height < 1:
        raise UsageError(f"a picture of {width}x{height} pixels cannot be rendered: give at least 1x1")
    if bpy_scene.camera is None:
        raise SceneError(f"scene {bpy_scene.name!r} has no camera: add one, or make one active")
    render = bpy_scene.render
    layer = bpy_scene.view_layers[layer_name(bpy_scene)]
    with ExitStack() as stack:
        stack.enter_context(no_new_images())
        for owner, values in (
            (
                render,
                {
                    "resolution_x": width,
                    "resolution_y": height,
                    "resolution_percentage": 100,
                    "use_border": False,
                    "use_crop_to_border": False,
                    "film_transparent": False,
                    "use_motion_blur": False,
                    "use_compositing": False,
                    "use_sequencer": False,
                    "use_multiview": False,
                    "use_freestyle": False,
                    "use_persistent_data": False,
                    "use_stamp": False,
                    "use_file_extension": True,
                    "use_overwrite": True,
                    "use_placeholder": False,
                    "save_output": True,
                    "use_texture_cache": False,
                    "dither_intensity": 0.0,
                },
            ),
            (
                render.image_settings,
                {
                    "media_type": "IMAGE",
                    "file_format": "OPEN_EXR",
                    "color_mode": "RGB",
                    "color_depth": "32",
                    "exr_codec": "ZIP",
                    "color_management": "FOLLOW_SCENE",
                },
            ),
            (layer, {"use": True, "world_override": None, "samples": 0}),
        ):
            stack.enter_context(changed(owner, **values))
        if bpy_scene.camera.type == "CAMERA":
            stack.enter_context(changed(bpy_scene.camera.data.dof, use_dof=False))
        yield


def take_picture(bpy_scene: bpy.types.Scene) -> np.ndarray:
    """Render `bpy_scene` as it is set: (H, W, 3) float32 scene-linear, row 0 at the top."""
    with TemporaryDirectory(prefix="catoptric-") as folder:
        path = Path(folder) / "picture.exr"
        with changed(bpy_scene.render, filepath=str(path)), quiet():
            try:
                bpy.ops.render.render(write_still=True, scene=bpy_scene.name, layer=layer_name(bpy_scene))
            except RuntimeError as error:
                raise MachineError(f"Blender could not render {bpy_scene.name!r}: {first_line(error)}") from error
        if not path.exists():
            raise MachineError(f"Blender could not save its picture in {folder}: is the disk full?")
        return read_picture(path)


@contextmanager
def quiet() -> Iterator[None]:
    """Keep Blender's own chatter off the standard output, which without a window is the command line's."""
    if not bpy.app.background:
        yield
        return
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def first_line(error: Exception) -> str:
    """What Blender says went wrong, without its traceback."""
    return str(error).strip().split("\n")[0].removeprefix("Error: ")


def read_picture(path: Path) -> np.ndarray:
    """An image file's first three channels: (H, W, 3) float32, row 0 at the top."""
    buffer = oiio.ImageBuf(str(path))
    pixels = buffer.get_pixels(oiio.FLOAT)
    if pixels is None or buffer.has_error:
        raise MachineError(f"cannot read the picture {path}: {buffer.geterror()}")
    if pixels.shape[2] < 3:
        pixels = np.repeat(pixels[..., :1], 3, axis=2)
    return np.ascontiguousarray(pixels[..., :3])
