"""The trees of a scene's meshes as one table: what gpu_shaders/common/trees.glsl reads."""

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from ..progress import Progress, silent
from ..scene import Mesh, Scene
from ..tracing import Tree, build_tree
from .tables import box_of

_TREES: "WeakKeyDictionary[Mesh, Tree]" = WeakKeyDictionary()


def grow_trees(meshes: Sequence[Mesh], progress: Progress = silent) -> list[Tree]:
    """The tree of each mesh; grown once, and kept as long as the mesh lives."""
    missing = [mesh for mesh in meshes if mesh not in _TREES]
    for number, mesh in enumerate(missing):
        progress("growing trees", number / len(missing))
        _TREES[mesh] = build_tree(mesh.corners, *box_of(mesh))
    return [_TREES[mesh] for mesh in meshes]


def tree_table(scene: Scene) -> dict[str, np.ndarray]:
    """By sampler name: the root of each mesh's tree, one texel a mesh, then four texels a node."""
    trees = grow_trees(scene.meshes)
    # Roots fill whole nodes, so that the index of a node is a quarter of its texel's.
    head = -(-max(1, len(trees)) // 4)
    firsts = head + np.cumsum([0, *(len(tree.nodes) for tree in trees)])
    table = np.zeros((firsts[-1], 4, 4), np.uint32)
    table.reshape(-1, 4)[: len(trees), 0] = firsts[:-1]
    begins = np.cumsum([0, *(len(mesh.triangles) for mesh in scene.meshes)])
    for tree, first, begin in zip(trees, firsts, begins, strict=False):
        part = table[first : first + len(tree.nodes)]
        part[:] = tree.nodes
        children = part[:, 3].view(np.int32)
        children += np.where(children < 0, np.int32(-begin), np.int32(first))
    return {"tree_nodes": table.reshape(-1, 4)}
