"""What Cycles shows of a plane, and what an extracted Scene says that it shows: two ways to one small picture."""

from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
from catoptric.addon.scene import Extension, Interpolation, Scene, linear
from catoptric.tests import blender_stage as stage

SIDE = 12

FILTER_WIDTH = 0.01
"""Of a pixel: how far across it Cycles strews its samples; it goes no lower."""


def plane_scene() -> tuple[bpy.types.Scene, bpy.types.Object]:
    """A plane from -1 to 1 with UVs 0 to 1, right under an orthographic camera that shows just it."""
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 2), (0, 0, 0), type="ORTHO", ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.render.resolution_percentage = 100
    shaped = stage.add_plane(scene, "Plane", 2.0)
    shaped.data.uv_layers[0].uv.foreach_set("vector", np.array([0, 0, 1, 0, 1, 1, 0, 1], np.float32))
    return scene, shaped


def emissive(name: str = "Emissive") -> tuple[bpy.types.Material, bpy.types.Node]:
    """A material of one Emission node."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material, emission


def textured(name: str = "Textured", image: bpy.types.Image | None = None) -> tuple[bpy.types.Material, bpy.types.Node]:
    """An emissive material that shows an image, texel by texel."""
    material, emission = emissive(name)
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation = image, "Closest"
    material.node_tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    return material, node


def noise_image(name="Noise", width=5, height=7, alpha=False, is_float=False, seed=0) -> bpy.types.Image:
    """A generated image of random pixels."""
    pixels = np.random.default_rng(seed).random((height, width, 4), dtype=np.float32)
    if not alpha:
        pixels[..., 3] = 1.0
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


def cycles_picture(scene: bpy.types.Scene, folder: Path) -> np.ndarray:
    """(SIDE, SIDE, 3) what Cycles renders, one sample in every pixel's middle, row 0 at the bottom."""
    cycles, settings = scene.cycles, scene.render.image_settings
    scene.render.engine = "CYCLES"
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", FILTER_WIDTH
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.render.filepath = str(folder / "picture.exr")
    bpy.ops.render.render(scene=scene.name, write_still=True)
    return oiio.ImageBuf(scene.render.filepath).get_pixels(oiio.FLOAT)[::-1, :, :3]


def scene_picture(scene: Scene) -> np.ndarray:
    """(SIDE, SIDE, 3) the emission of what lies under each pixel's middle, read from the arrays of `scene`."""
    picture = np.zeros((SIDE * SIDE, 3))
    for inside, weights, instance, mesh, number in under_pixels(scene):
        source = scene.materials[instance.materials[mesh.slots[number]]].emission
        color = np.tile(source.color, (inside.sum(), 1))
        if source.image is not None:
            color = color * look_up(scene.images[source.image], source, weights @ mesh.uvs[number])
        if source.vertex_colors:
            color = color * (weights @ mesh.colors[number])[:, :3]
        picture[inside] = color
    return picture.reshape(SIDE, SIDE, 3)


def uv_picture(scene: Scene) -> np.ndarray:
    """(SIDE, SIDE, 2) the texture coordinates under each pixel's middle."""
    picture = np.zeros((SIDE * SIDE, 2))
    for inside, weights, _, mesh, number in under_pixels(scene):
        picture[inside] = weights @ mesh.uvs[number]
    return picture.reshape(SIDE, SIDE, 2)


def under_pixels(scene: Scene, margin: float = -1e-9):
    """For every triangle: which pixels' middles (SIDE²,) it covers from above, and their barycentric weights (N, 3)."""
    middles = (np.arange(SIDE) + 0.5) / SIDE * 2.0 - 1.0
    points = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    for instance in scene.instances:
        mesh = scene.meshes[instance.mesh]
        world = mesh.corners @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
        for number, corners in enumerate(world[..., :2]):
            edges = (corners[1:] - corners[0]).T
            if abs(np.linalg.det(edges)) < 1e-12:
                continue
            weights = np.linalg.solve(edges, (points - corners[0]).T).T
            weights = np.column_stack([1.0 - weights.sum(axis=1), weights])
            inside = (weights >= margin).all(axis=1)
            yield inside, weights[inside], instance, mesh, number


def look_up(image, source, uvs: np.ndarray) -> np.ndarray:
    """(N, 3) scene-linear colours of the nearest texels."""
    assert source.interpolation is Interpolation.CLOSEST
    height, width = image.pixels.shape[:2]
    texels = np.floor(uvs * (width, height)).astype(int)
    beyond = ((uvs < 0) | (uvs >= 1)).any(axis=1)
    if source.extension is Extension.REPEAT:
        texels %= (width, height)
    elif source.extension is Extension.MIRROR:
        folded = np.abs((uvs + 1) % 2 - 1)
        texels = np.minimum(np.floor(folded * (width, height)).astype(int), (width - 1, height - 1))
    texels = np.clip(texels, 0, (width - 1, height - 1))
    colors = linear(image)[texels[:, 1], texels[:, 0], :3].astype(np.float64)
    if source.extension is Extension.CLIP:
        colors[beyond] = 0.0
    return colors
