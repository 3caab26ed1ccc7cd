"""Following a shader's links: through reroutes, groups in groups, and muted nodes."""

from dataclasses import dataclass

import bpy


class Unsupported(Exception):
    """A node that has no counterpart here; `node` says which, the message what follows from it."""

    def __init__(self, node: bpy.types.Node, message: str) -> None:
        super().__init__(message)
        self.node = node


@dataclass(frozen=True)
class Plug:
    """An input socket, with the group nodes that lead to its tree, outermost first."""

    socket: bpy.types.NodeSocket
    groups: tuple[bpy.types.Node, ...] = ()


@dataclass(frozen=True)
class Source:
    """What feeds a plug: the output `socket` of a node, or, where nothing is linked, the input that holds the value."""

    socket: bpy.types.NodeSocket
    groups: tuple[bpy.types.Node, ...] = ()

    @property
    def node(self) -> bpy.types.Node | None:
        """The feeding node, or None where nothing is linked."""
        return self.socket.node if self.socket.is_output else None

    def input(self, name: str) -> Plug | None:
        """An input of the feeding node by name or, where names repeat or vary by version, identifier."""
        sockets = self.socket.node.inputs
        found = next((socket for socket in sockets if name in (socket.identifier, socket.name)), None)
        return found and Plug(found, self.groups)


def tree_in_use(owner: bpy.types.ID) -> bpy.types.NodeTree | None:
    """The node tree of a material, world or light, or None where it does without; since 5.0 all have one in use."""
    in_use = bpy.app.version >= (5, 0) or owner.use_nodes
    return owner.node_tree if in_use else None


def surface_plug(tree: bpy.types.NodeTree) -> Plug | None:
    """The Surface input that Cycles renders, or None without an output node."""
    end = tree.get_output_node("CYCLES")
    return end and Plug(end.inputs["Surface"])


def source(plug: Plug) -> Source:
    """What feeds `plug`, with everything skipped that only passes a value on."""
    socket, groups = plug.socket, plug.groups
    while True:
        link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
        following = link and _behind(link, groups)
        if following is None:
            return Source(socket, groups)
        socket, groups = following
        if socket.is_output:
            return Source(socket, groups)


def _behind(link: bpy.types.NodeLink, groups: tuple) -> tuple[bpy.types.NodeSocket, tuple] | None:
    """The next socket to look at, seen against the flow: an input to follow further or a real output; None at an end.

    A muted node shows what its bypass shows; one without a bypass, or a group without a tree, counts
    as not linked, as Cycles has it.
    """
    node, output = link.from_node, link.from_socket
    if node.mute:
        passed = next((inner.from_socket for inner in node.internal_links if inner.to_socket == output), None)
        return passed and (passed, groups)
    if node.type == "REROUTE":
        return node.inputs[0], groups
    if node.type == "GROUP":
        end = node.node_tree and _group_output(node.node_tree)
        return end and (_by_identifier(end.inputs, output.identifier), (*groups, node))
    if node.type == "GROUP_INPUT" and groups:
        return _by_identifier(groups[-1].inputs, output.identifier), groups[:-1]
    return output, groups


def _group_output(tree: bpy.types.NodeTree) -> bpy.types.Node | None:
    ends = [node for node in tree.nodes if node.type == "GROUP_OUTPUT"]
    return next((node for node in ends if node.is_active_output), ends[0] if ends else None)


def _by_identifier(sockets: bpy.types.NodeInputs, identifier: str) -> bpy.types.NodeSocket:
    return next(socket for socket in sockets if socket.identifier == identifier)


def all_nodes(tree: bpy.types.NodeTree) -> list[bpy.types.Node]:
    """Every node of a tree and of the groups in it."""
    nodes = list(tree.nodes)
    for node in tree.nodes:
        if node.type == "GROUP" and node.node_tree:
            nodes += all_nodes(node.node_tree)
    return nodes
