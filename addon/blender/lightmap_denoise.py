"""Blender's denoiser (Open Image Denoise) on a picture in memory, by way of its compositor."""

from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np

from ..errors import MachineError
from .extract_evaluate import no_new_images
from .render_settings import first_line, quiet, read_picture


def denoised(pixels: np.ndarray) -> np.ndarray:
    """`pixels` (H, W, 3) float32 linear, without their noise. Raises `MachineError` if the compositor fails."""
    with no_new_images():  # the compositor leaves its viewer's picture
        return _denoised(pixels)


def _denoised(pixels: np.ndarray) -> np.ndarray:
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("Catoptric noisy", width, height, float_buffer=True)
    scene = bpy.data.scenes.new("Catoptric denoise")
    tree = None
    try:
        image.colorspace_settings.name = "Non-Color"
        image.pixels.foreach_set(np.dstack([pixels, np.ones((height, width), np.float32)]).ravel())
        image.update()
        scene.camera = bpy.data.objects.new("Catoptric denoise", bpy.data.cameras.new("Catoptric denoise"))
        tree = _compositor(scene, image)
        # The file's first row is the top, the image's the bottom.
        return read_composite(scene, width, height)[::-1].copy()
    finally:
        camera = scene.camera
        bpy.data.scenes.remove(scene)
        if camera:
            bpy.data.cameras.remove(camera.data)
        bpy.data.images.remove(image)
        if tree is not None and tree.name in bpy.data.node_groups:
            bpy.data.node_groups.remove(tree)


def read_composite(scene: bpy.types.Scene, width: int, height: int) -> np.ndarray:
    """What `scene`'s compositor gives: (H, W, 3) float32, row 0 at the top."""
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_compositing, render.use_sequencer = True, False
    render.dither_intensity = 0.0
    if hasattr(render, "compositor_device"):
        render.compositor_device = "CPU"  # with no window, a GPU context of Blender's is only trouble
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    with TemporaryDirectory(prefix="catoptric-") as folder, quiet():
        path = Path(folder) / "denoised.exr"
        render.filepath = str(path)
        try:
            bpy.ops.render.render(write_still=True, scene=scene.name)
        except RuntimeError as error:
            raise MachineError(f"Blender could not denoise a lightmap: {first_line(error)}") from error
        return read_picture(path)


def _compositor(scene: bpy.types.Scene, image: bpy.types.Image) -> bpy.types.NodeTree | None:
    """Image, Denoise, output; the node group that Blender 5 keeps beside the scene, for removal."""
    group = None
    if hasattr(scene, "compositing_node_group"):
        tree = group = bpy.data.node_groups.new("Catoptric denoise", "CompositorNodeTree")
        scene.compositing_node_group = group
        group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    source, denoise = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("CompositorNodeDenoise")
    source.image = image
    denoise.inputs["HDR"].default_value = True
    tree.links.new(source.outputs["Image"], denoise.inputs["Image"])
    tree.links.new(denoise.outputs["Image"], output.inputs["Image"])
    return group
