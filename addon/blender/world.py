"""What lies behind everything: a colour, or a panorama of whatever the world's nodes make."""

import math
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio

from ..errors import SceneError
from ..scene import World, linear
from .extract_evaluate import no_new_images
from .images import MAGENTA, read
from .materials_colors import read_constant, read_constant_vector
from .nodes import Source, Unsupported, all_nodes, source, surface_plug, tree_in_use
from .notes import Notes

DEFAULT_WIDTH = 2048
WIDEST = 8192


def read_world(world: bpy.types.World | None, frame: int, notes: Notes, may_render: bool = True) -> World:
    """The world as a constant colour or an equirectangular panorama.

    An environment texture without mapping is read as it is; other nodes are rendered by Cycles, alone,
    or replaced by the world's viewport colour where that must not be (`may_render` False).
    `world` may be evaluated; `frame` is the scene's frame.
    """
    if world is None:
        return World()
    tree = tree_in_use(world)
    if tree is None:
        return World(tuple(world.color))
    plug = surface_plug(tree)
    found = plug and source(plug)
    if plug is not None and plug.socket.node.inputs["Volume"].is_linked:
        notes.add(f'world "{world.name}"', "a volume is not supported; it is left out")
    if not found or found.node is None:
        return World()
    if any(node.bl_idname == "ShaderNodeLightPath" for node in all_nodes(tree)):
        notes.add(f'world "{world.name}"', "a Light Path node is not supported; the world is what the camera sees")
    plain = _plain(found, notes) if found.node.bl_idname == "ShaderNodeBackground" else None
    if plain is None and not may_render:
        notes.add(
            f'world "{world.name}"',
            "only Cycles can draw its nodes: show the scene in Rendered mode first; its viewport colour is used",
        )
        return World(tuple(world.color))
    return plain or World(panorama=render_panorama(world.original, frame, _width(tree)))


def _plain(background: Source, notes: Notes) -> World | None:
    """A Background node of constants, or of an environment texture as it is stored; None for anything more."""
    try:
        strength = read_constant(background.input("Strength"))
    except Unsupported:
        return None
    found = source(background.input("Color"))
    if found.node is not None and found.node.bl_idname == "ShaderNodeTexEnvironment":
        return _environment(found, strength, notes)
    try:
        color = read_constant_vector(background.input("Color"))
    except Unsupported:
        return None
    return World(tuple(channel * strength for channel in color))


def _environment(found: Source, strength: float, notes: Notes) -> World | None:
    node = found.node
    mapped = source(found.input("Vector")).node is not None
    if node.image is not None and (
        mapped or node.projection != "EQUIRECTANGULAR" or node.image.source not in {"FILE", "GENERATED"}
    ):
        return None
    image = read(node.image, alpha_used=False, notes=notes)
    if image.pixels.shape == MAGENTA.shape and (image.pixels == MAGENTA).all():
        return World((strength, 0.0, strength))
    if image.pixels.shape[1] > WIDEST:
        return None
    return World(panorama=np.ascontiguousarray(linear(image)[..., :3] * np.float32(strength)))


def _width(tree: bpy.types.NodeTree) -> int:
    """How wide to render: as its widest environment image, within bounds."""
    images = [node.image for node in all_nodes(tree) if getattr(node, "image", None)]
    return min(max([image.size[0] for image in images], default=0) or DEFAULT_WIDTH, WIDEST)


def render_panorama(world: bpy.types.World, frame: int, width: int) -> np.ndarray:
    """(width // 2, width, 3) float32: `world` rendered by Cycles as `World.panorama` lies, one sample at every texel's
    centre. Raises `SceneError` if Cycles gives no picture.
    """
    with tempfile.TemporaryDirectory() as folder, _panorama_scene(world, frame, width) as scene, no_new_images():
        path = Path(folder) / "world.exr"
        scene.render.filepath = str(path)
        bpy.ops.render.render(scene=scene.name, write_still=True)
        picture = oiio.ImageBuf(str(path))
        if picture.has_error or not path.exists():
            raise SceneError(f'world "{world.name}" could not be rendered by Cycles; try it in Blender')
        pixels = picture.get_pixels(oiio.FLOAT)
    return np.ascontiguousarray(pixels[::-1, :, :3])


@contextmanager
def _panorama_scene(world: bpy.types.World, frame: int, width: int) -> Iterator[bpy.types.Scene]:
    """A scene with `world` and a panoramic camera alone, which is removed at the end."""
    scene = bpy.data.scenes.new("Catoptric world")
    data = bpy.data.cameras.new("Catoptric world")
    holder = bpy.data.objects.new("Catoptric world", data)
    copy = world.copy()
    try:
        scene.world = copy
        copy.cycles_visibility.camera = True
        scene.collection.objects.link(holder)
        scene.camera = holder
        data.type = "PANO"
        data.panorama_type = "EQUIRECTANGULAR"
        # Turned so that the picture's centre is +X, as the mapping in `World` has it.
        holder.rotation_euler = (math.pi / 2.0, 0.0, -math.pi / 2.0)
        scene.frame_set(frame)
        _settle(scene, width)
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(holder)
        bpy.data.cameras.remove(data)
        bpy.data.worlds.remove(copy)


def _settle(scene: bpy.types.Scene, width: int) -> None:
    """Cycles, one sample in the middle of every pixel, 32-bit EXR."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    cycles.samples = 1
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 0.01
    cycles.max_bounces = 0
