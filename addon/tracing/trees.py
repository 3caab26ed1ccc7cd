"""A bounding-volume hierarchy of a mesh's triangles: what `ray-traced` searches.

Nodes have up to four children, and a leaf is one triangle. Of a binary tree by the smallest boxes
(addon/tracing/clusters.py) each node takes up the largest of its children, twice, as Wald, Benthin and Boulos
2008 do. A node keeps its children's boxes in 16 bits a side, in units of the mesh's own box, rounded
outwards: a ray is brought into these units once for a mesh.
"""

from dataclasses import dataclass

import numpy as np

from .clusters import pair_up, surface

DEPTH = 32
"""Levels that no tree exceeds; gpu_shaders/common/trees.glsl has room for as many."""

STEPS = 65535
"""Units along each side of a mesh's box; gpu_shaders/common/trees.glsl holds the same number."""

_WIDTH = 4
_NOTHING = STEPS  # a box from STEPS to 0: no ray meets it


@dataclass(frozen=True, eq=False)
class Tree:
    """The hierarchy of a mesh in the box from `low` to `low + size`, (3,) float64 each.

    `nodes` (N, 4, 4) uint32, the root first: for x, y and z the box of each of four children, its low side in
    the lower 16 bits and its high side in the upper; then the children: a node, or as int32 -1 - a triangle.
    `depth` counts levels of nodes.
    """

    low: np.ndarray
    size: np.ndarray
    nodes: np.ndarray
    depth: int


def build(corners: np.ndarray, low: np.ndarray, size: np.ndarray) -> Tree:
    """The tree of a mesh from its corners (T, 3, 3), T ≥ 1, which lie within the box from `low`, of `size` > 0."""
    least, most = ((side - low) / size for side in (corners.min(axis=1), corners.max(axis=1)))
    shape = size / size.max()
    boxes = np.concatenate([-least * shape, most * shape], axis=1).astype(np.float32)
    for balanced in (False, True):
        children, around = pair_up(boxes, balanced)
        levels = _widen(children, surface(around.T))
        if len(levels) <= DEPTH:
            break
    slots = np.concatenate(levels)
    return Tree(low, size, _packed(slots, around / np.tile(shape, 2), len(boxes)), len(levels))


def _widen(children: np.ndarray, size: np.ndarray) -> list[np.ndarray]:
    """Levels, from the root's on, of nodes of up to four: (N, 4) nodes of the binary tree, -1 for none."""
    leaves = len(children) + 1
    if not len(children):
        return [np.array([[0, -1, -1, -1]])]
    levels, inner = [], np.array([leaves + len(children) - 1])
    while len(inner):
        slots = np.full((len(inner), _WIDTH), -1)
        slots[:, :2] = children[inner - leaves]
        for free in range(2, _WIDTH):
            score = np.where(slots >= leaves, size[slots], -1.0)
            largest = score.argmax(axis=1)
            row = np.flatnonzero(score.max(axis=1) >= 0)
            both = children[slots[row, largest[row]] - leaves]
            slots[row, largest[row]], slots[row, free] = both[:, 0], both[:, 1]
        levels.append(slots)
        inner = slots[slots >= leaves]
    return levels


def _packed(slots: np.ndarray, boxes: np.ndarray, leaves: int) -> np.ndarray:
    """Nodes as a `Tree` keeps them, for the slots of all levels in turn and boxes in shares of the mesh's."""
    # Half a unit more on either side holds what float32 rounds, here and in the shader.
    low = np.clip(np.floor(-boxes[:, :3] * STEPS - 0.5), 0, STEPS)
    high = np.clip(np.ceil(boxes[:, 3:] * STEPS + 0.5), 0, STEPS)
    sides = low.astype(np.uint32) | high.astype(np.uint32) << np.uint32(16)
    nodes = np.empty((len(slots), 4, _WIDTH), np.uint32)
    nodes[:, :3] = np.where(slots[:, None] < 0, np.uint32(_NOTHING), sides[slots].transpose(0, 2, 1))
    inner = slots >= leaves
    # Levels list children in the order of their parents, so that they stand in the order they are counted in.
    numbers = -1 - slots
    numbers[inner] = 1 + np.arange(inner.sum())
    nodes[:, 3] = numbers.astype(np.int32).view(np.uint32)
    return nodes
