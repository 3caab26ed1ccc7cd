"""A material that shows itself without light: emission, or a perfect mirror."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import bpy
import numpy as np

from ..scene import ColorSource, Fresnel, Material
from .materials_colors import read_paint
from .nodes import Plug, Source, source

_METAL = {"ShaderNodeBsdfPrincipled": "Base Color", "ShaderNodeBsdfMetallic": "Base Color"}
_GLOSS = {"ShaderNodeBsdfAnisotropic": "Color", "ShaderNodeBsdfGlossy": "Color", "ShaderNodeBsdfGlass": "Color"}
_BASE = {**_METAL, "ShaderNodeBsdfDiffuse": "Color"}
_GLOW = {
    "ShaderNodeEmission": "Color",
    "ShaderNodeBackground": "Color",
    "ShaderNodeBsdfPrincipled": "Emission Color",
}
_SAME = 1e-6


@contextmanager
def unlit_material(
    original: bpy.types.Material | None, described: Material, mirror: bool
) -> Iterator[bpy.types.Material]:
    """A Blender material for a while: `described`'s emission if it emits, else its base colour as emission.

    With `mirror`, that base colour is weighted by `diffuse`, and over it lies a mirror without
    roughness, as strong as `described.fresnel` says. What `original` links to its colours stays
    linked, so that the renderer looks its textures up by itself. Bump, alpha, subsurface,
    transmission and displacement are left out.
    """
    material = original.copy() if original else bpy.data.materials.new(described.name)
    groups: list[bpy.types.NodeTree] = []
    try:
        if not material.node_tree:
            material.use_nodes = True
        material.use_fake_user = False
        material.use_backface_culling = False
        material.cycles.emission_sampling = "NONE"  # it lights nothing, so sampling it as a lamp wastes time
        groups += _own_groups(material.node_tree)
        shader = _Shader(material.node_tree)
        own = shader.own(described, mirror)
        shader.show(shader.mirror(described, own) if mirror else own)
        yield material
    finally:
        bpy.data.materials.remove(material)
        for group in groups:
            bpy.data.node_groups.remove(group)


def _own_groups(tree: bpy.types.NodeTree) -> list[bpy.types.NodeTree]:
    """Give every group node in `tree` a copy of its group, so that outputs can be added to it."""
    copies = []
    for node in tree.nodes:
        if node.type == "GROUP" and node.node_tree:
            node.node_tree = node.node_tree.copy()
            copies += [node.node_tree, *_own_groups(node.node_tree)]
    return copies


class _Shader:
    """Nodes added to a material's copy."""

    def __init__(self, tree: bpy.types.ShaderNodeTree) -> None:
        self.tree = tree
        output = tree.get_output_node("CYCLES")
        self.surface = output and Plug(output.inputs["Surface"])

    def own(self, described: Material, mirror: bool) -> bpy.types.NodeSocket | None:
        """What the surface gives off by itself; None where that is nothing."""
        if described.emits:
            return self._emission(self._color(described.emission, _GLOW))
        weight = described.diffuse if mirror else 1.0
        if weight <= 0.0:
            return None
        return self._emission(self._color(described.base, _BASE, _GLOSS), weight)

    def mirror(self, described: Material, own: bpy.types.NodeSocket | None) -> bpy.types.NodeSocket:
        """A mirror over (dielectric) or beside (otherwise) what the surface gives off."""
        if described.fresnel is Fresnel.SCHLICK:
            color = self._color(described.reflection, _METAL)
            metal = {"Base Color": color, "Metallic": 1.0, "Roughness": 0.0}
            mirror = self._node("ShaderNodeBsdfPrincipled", **metal).outputs[0]
        else:
            color = self._color(described.reflection, _GLOSS)
            mirror = self._node("ShaderNodeBsdfAnisotropic", Color=color, Roughness=0.0).outputs[0]
        if described.fresnel is Fresnel.DIELECTRIC:
            return self._mixed(described.ior, own, mirror)
        if own is None:
            return mirror
        both = self._node("ShaderNodeAddShader")
        self._link(own, both.inputs[0])
        self._link(mirror, both.inputs[1])
        return both.outputs[0]

    def show(self, surface: bpy.types.NodeSocket | None) -> None:
        """Make `surface` the only output."""
        for node in [node for node in self.tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"]:
            self.tree.nodes.remove(node)
        output = self._node("ShaderNodeOutputMaterial")
        if surface is not None:
            self._link(surface, output.inputs["Surface"])

    def _input(self, names: Mapping[str, str]) -> Plug | None:
        """The first input of one of the named kinds of node, walking up from the surface through mixes."""
        waiting = [self.surface] if self.surface else []
        while waiting:
            found = source(waiting.pop(0))
            if found.node is None:
                continue
            if found.node.bl_idname in names:
                return found.input(names[found.node.bl_idname])
            waiting += [Plug(socket, found.groups) for socket in found.node.inputs if socket.type == "SHADER"]
        return None

    def _color(self, described: ColorSource, *kinds: Mapping[str, str]) -> "tuple | bpy.types.NodeSocket":
        """The colour that `described` means: linked to what feeds it in the artist's nodes, if that is a texture."""
        constant = (*described.color, 1.0)
        if described.image is None and not described.vertex_colors:
            return constant
        plug = next((plug for names in kinds if (plug := self._input(names))), None)
        if plug is None or source(plug).node is None:
            return constant
        linked = _lifted(source(plug))
        own_factor = np.asarray(read_paint(plug).color)
        weight = np.divide(described.color, own_factor, out=np.zeros(3), where=own_factor != 0.0)
        if np.allclose(weight, 1.0, atol=_SAME):
            return linked
        scale = self.tree.nodes.new("ShaderNodeVectorMath")
        scale.operation = "MULTIPLY"
        scale.inputs[1].default_value = weight
        self._link(linked, scale.inputs[0])
        return scale.outputs[0]

    def _emission(self, color: "tuple | bpy.types.NodeSocket", strength: float = 1.0) -> bpy.types.NodeSocket:
        return self._node("ShaderNodeEmission", Color=color, Strength=strength).outputs[0]

    def _mixed(
        self, ior: float, under: bpy.types.NodeSocket | None, gloss: bpy.types.NodeSocket
    ) -> bpy.types.NodeSocket:
        mix = self._node("ShaderNodeMixShader")
        self._link(self._node("ShaderNodeFresnel", IOR=ior).outputs[0], mix.inputs[0])
        if under is not None:
            self._link(under, mix.inputs[1])
        self._link(gloss, mix.inputs[2])
        return mix.outputs[0]

    def _link(self, given: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
        self.tree.links.new(given, target)

    def _node(self, kind: str, **inputs: object) -> bpy.types.Node:
        """A new node; every input is a value or a socket to link."""
        node = self.tree.nodes.new(kind)
        for name, value in inputs.items():
            if isinstance(value, bpy.types.NodeSocket):
                self._link(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node


def _lifted(found: Source) -> bpy.types.NodeSocket:
    """A socket outside of all groups that passes on what `found` gives."""
    socket = found.socket
    for group in reversed(found.groups):
        tree = group.node_tree
        passed = tree.interface.new_socket("Lifted", in_out="OUTPUT", socket_type="NodeSocketColor")
        end = next(node for node in tree.nodes if node.type == "GROUP_OUTPUT" and node.is_active_output)
        tree.links.new(socket, next(entry for entry in end.inputs if entry.identifier == passed.identifier))
        socket = next(entry for entry in group.outputs if entry.identifier == passed.identifier)
    return socket
