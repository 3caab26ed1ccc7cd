"""A Blender scene of its own for a bake: a Scene's triangles under the artist's lamps, world and materials."""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager

import bpy
import numpy as np

from ..scene import Instance, Mesh, Scene
from .materials import DEFAULT_GREY
from .names import object_name
from .nodes import all_nodes

LIGHTMAP_LAYER = "Catoptric lightmap"
_MOST_LAYERS = 7
"""UV layers beside the lightmap's; Blender holds eight."""


@contextmanager
def bake_stage(bpy_scene: bpy.types.Scene, scene: Scene, uvs: np.ndarray, target: bpy.types.Image) -> Iterator[tuple]:
    """A temporary scene and the one object in it that holds all of `scene`'s triangles, in order.

    `uvs` (T, 3, 2) float32 is where each triangle lies in `target`, over all instances. Yields the
    Blender scene and the object; removes both, and all that was made for them, at the end.
    """
    with ExitStack() as stack:
        stage = bpy_scene.copy()
        stack.callback(bpy.data.scenes.remove, stage)
        for child in list(stage.collection.children):
            stage.collection.children.unlink(child)
        for holder in list(stage.collection.objects):
            stage.collection.objects.unlink(holder)
        for layer in stage.view_layers:
            layer.material_override = None
        materials = [_baked_material(stack, material.name, target) for material in scene.materials]
        mesh = world_mesh(scene, uvs, materials)
        stack.callback(bpy.data.meshes.remove, mesh)
        solid = _add(stack, stage, mesh.name, mesh)
        for lamp in scene.lamps:
            original = bpy.data.objects[object_name(lamp.name)]
            placed = _add(stack, stage, lamp.name, original.data)
            placed.matrix_world = lamp.matrix.T.tolist()
            placed.visible_diffuse = original.visible_diffuse
        yield stage, solid


def _add(stack: ExitStack, stage: bpy.types.Scene, name: str, data: bpy.types.ID) -> bpy.types.Object:
    holder = bpy.data.objects.new(name, data)
    stage.collection.objects.link(holder)
    stack.callback(bpy.data.objects.remove, holder)
    return holder


def _baked_material(stack: ExitStack, name: str, target: bpy.types.Image) -> bpy.types.Material:
    """A copy of the artist's material with `target` as the image that is baked into."""
    original = bpy.data.materials.get(name)
    material = original.copy() if original else bpy.data.materials.new(name)
    stack.callback(bpy.data.materials.remove, material)
    if not original or not material.use_nodes or not material.node_tree:
        color = tuple(material.diffuse_color)[:3] if original else DEFAULT_GREY
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
        diffuse.inputs["Color"].default_value = (*color, 1.0)
        tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = target
    material.node_tree.nodes.active = node
    return material


def world_mesh(scene: Scene, lightmap_uvs: np.ndarray, materials: list[bpy.types.Material]) -> bpy.types.Mesh:
    """One Blender mesh of all instances' triangles in the world, in the order of instances and triangles."""
    parts = [_placed(scene.meshes[instance.mesh], instance) for instance in scene.instances]
    counts = np.cumsum([0] + [len(part["positions"]) for part in parts])
    positions = np.concatenate([part["positions"] for part in parts])
    triangles = np.concatenate([part["triangles"] + start for part, start in zip(parts, counts[:-1], strict=True)])
    joined = {name: np.concatenate([part[name] for part in parts]) for name in ("normals", "uvs", "colors", "slots")}
    turned = np.concatenate([np.full(len(part["triangles"]), part["turned"]) for part in parts])
    lightmap_uvs = np.where(turned[:, None, None], lightmap_uvs[:, [0, 2, 1]], lightmap_uvs)

    mesh = triangle_mesh("Catoptric solid", positions, triangles)
    for material in materials:
        mesh.materials.append(material)
    mesh.attributes.new("material_index", "INT", "FACE").data.foreach_set("value", joined["slots"])
    uv_names, color_names = _lookups(materials)
    for name in uv_names:
        _set_uvs(mesh, name, joined["uvs"])
    for name in color_names:
        layer = mesh.color_attributes.new(name, "FLOAT_COLOR", "CORNER")
        layer.data.foreach_set("color", joined["colors"].ravel())
    _set_uvs(mesh, LIGHTMAP_LAYER, lightmap_uvs)
    mesh.uv_layers.active = mesh.uv_layers[LIGHTMAP_LAYER]
    mesh.uv_layers[uv_names[0]].active_render = True
    mesh.normals_split_custom_set(joined["normals"].reshape(-1, 3))
    return mesh


def triangle_mesh(name: str, positions: np.ndarray, triangles: np.ndarray) -> bpy.types.Mesh:
    """A Blender mesh of the given triangles, in order."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(triangles, np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    return mesh


def _set_uvs(mesh: bpy.types.Mesh, name: str, uvs: np.ndarray) -> None:
    layer = mesh.uv_layers.new(name=name, do_init=False)
    layer.data.foreach_set("uv", np.ascontiguousarray(uvs, np.float32).ravel())


def _placed(mesh: Mesh, instance: Instance) -> dict:
    """The instance's arrays in the world. A mirrored one is turned round, so that its front stays in front."""
    linear = instance.matrix[:3, :3]
    turned = np.linalg.det(linear) < 0
    order = [0, 2, 1] if turned else [0, 1, 2]
    normals = mesh.normals @ np.linalg.inv(linear)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    count = len(mesh.triangles)
    return {
        "positions": mesh.positions @ linear.T + instance.matrix[:3, 3],
        "triangles": mesh.triangles[:, order],
        "normals": (normals / np.where(lengths > 0, lengths, 1.0))[:, order],
        "uvs": mesh.uvs[:, order],
        "colors": np.ones((count, 3, 4), np.float32) if mesh.colors is None else mesh.colors[:, order],
        "slots": np.asarray(instance.materials, np.int32)[mesh.slots],
        "turned": turned,
    }


def _lookups(materials: Iterable[bpy.types.Material]) -> tuple[list[str], list[str]]:
    """The names by which the materials ask for texture coordinates and for vertex colours."""
    nodes = [node for material in materials for node in all_nodes(material.node_tree)]
    uvs = {node.uv_map for node in nodes if hasattr(node, "uv_map")} - {""}
    colors = {node.layer_name for node in nodes if node.bl_idname == "ShaderNodeVertexColor"} - {""}
    colors |= {node.attribute_name for node in nodes if node.bl_idname == "ShaderNodeAttribute"} - uvs - {""}
    return sorted(uvs | {"UVMap"})[:_MOST_LAYERS], sorted(colors or {"Color"})
