"""A Blender scene whose materials have one colour where they have images, for as long as it takes to render it."""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager

import bpy

from .nodes import all_nodes, tree_in_use

_BASE = "Base Color"


@contextmanager
def plain_base(colors: Mapping[str, tuple[float, float, float]]) -> Iterator[None]:
    """Within, the materials of these names have these linear base colours; afterwards they are as they were.

    Of a material, every Principled BSDF has it; other shaders, and what a library brings, stay as they are.
    """
    with ExitStack() as stack:
        for name, color in colors.items():
            material = bpy.data.materials.get(name)
            tree = tree_in_use(material) if material is not None and material.library is None else None
            for node in all_nodes(tree) if tree is not None else ():
                if node.bl_idname == "ShaderNodeBsdfPrincipled":
                    _paint(stack, node, color)
        yield


def _paint(stack: ExitStack, node: bpy.types.Node, color: tuple[float, float, float]) -> None:
    socket, links = node.inputs[_BASE], node.id_data.links
    for link in list(socket.links):
        stack.callback(links.new, link.from_socket, socket)
        links.remove(link)
    stack.callback(setattr, socket, "default_value", tuple(socket.default_value))
    socket.default_value = (*color, 1.0)
