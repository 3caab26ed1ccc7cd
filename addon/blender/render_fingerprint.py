"""What determines a picture by Cycles: a key for the cache."""

from collections.abc import Iterator
from dataclasses import replace

import bpy

from ..cache import key_of
from ..scene import Scene

LIGHTMAP_NAME = "lightmap of "
"""What the names of lightmap images begin with; they stand behind all others in `Scene.images`."""

_LOOKS = {"location", "location_absolute", "width", "height", "select", "hide", "label", "use_custom_color"}
_LOOKS |= {"show_options", "show_preview", "show_texture", "warning_propagation", "dimensions", "pixels"}
_SIMPLE = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}


def fingerprint(bpy_scene: bpy.types.Scene, scene: Scene) -> str:
    """A key of everything a picture of `scene` depends on, its size and samples apart.

    Beside the extracted scene, whose lightmaps do not matter, these are the artist's shader nodes,
    which may hold more than extraction carries over, Cycles' settings and Blender's version.
    """
    extracted = replace(without_lightmaps(scene), name="", resolution=(0, 0), warnings=(), view="", exposure=0.0)
    names = {material.name for material in scene.materials}
    trees = [_tree(material.node_tree) for material in bpy.data.materials if material.name in names]
    lamps = [_tree(lamp.node_tree) for lamp in bpy.data.lights]
    world = _tree(bpy_scene.world.node_tree) if bpy_scene.world else None
    return key_of(extracted, trees, lamps, world, _simple(bpy_scene.cycles), bpy.app.version)


def without_lightmaps(scene: Scene) -> Scene:
    """`scene` as it was extracted."""
    meshes = tuple(replace(mesh, lightmap_uvs=None) for mesh in scene.meshes)
    instances = tuple(replace(instance, lightmap=None) for instance in scene.instances)
    images = tuple(image for image in scene.images if not image.name.startswith(LIGHTMAP_NAME))
    return replace(scene, meshes=meshes, instances=instances, images=images)


def _tree(tree: bpy.types.NodeTree | None, depth: int = 0) -> list:
    """A node tree's values and links, and those of the groups in it."""
    if tree is None or depth > 8:
        return []
    nodes = [_node(node, depth) for node in tree.nodes]
    links = [(x.from_node.name, x.from_socket.identifier, x.to_node.name, x.to_socket.identifier) for x in tree.links]
    return [nodes, links]


def _node(node: bpy.types.Node, depth: int) -> list:
    group = getattr(node, "node_tree", None)
    ramp = getattr(node, "color_ramp", None)
    image = getattr(node, "image", None)
    return [
        _simple(node),
        [_simple(socket) for socket in node.inputs],
        _tree(group, depth + 1),
        [_simple(element) for element in ramp.elements] if ramp else [],
        _simple(image) if image else [],
    ]


def _simple(struct: bpy.types.bpy_struct) -> list:
    """Names and values of a struct's plain properties, looks in the node editor apart."""
    return list(_simple_properties(struct))


def _simple_properties(struct: bpy.types.bpy_struct) -> Iterator[tuple]:
    for item in struct.bl_rna.properties:
        frame_color = item.identifier == "color" and isinstance(struct, bpy.types.Node)
        if item.type not in _SIMPLE or item.identifier in _LOOKS or frame_color:
            continue
        yield item.identifier, _plain(getattr(struct, item.identifier))


def _plain(value: object) -> object:
    if isinstance(value, set):
        return sorted(value)
    if hasattr(value, "__len__") and not isinstance(value, str):
        return [_plain(inner) for inner in value]
    return value
