"""A bounding-volume hierarchy of a mesh's triangles: what `ray-traced` searches.

Triangles become pieces (addon/tracing/splitting.py), pieces a binary tree (addon/tracing/clusters.py) and that
one of up to four children a node (addon/tracing/widening.py), whose leaves are one triangle each. A node keeps its
children's boxes in 16 bits a side, in units of the mesh's own box, rounded outwards: a ray is brought into these
units once for a mesh.
"""

from dataclasses import dataclass

import numpy as np

from .clusters import pair_up, surface
from .splitting import split
from .widening import WIDTH, widen

DEPTH = 32
"""Levels that no tree exceeds; gpu_shaders/common/trees.glsl has room for as many."""

STEPS = 65535
"""Units along each side of a mesh's box; gpu_shaders/common/trees.glsl holds the same number."""

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
    shape = size / size.max()
    pieces, source = split((corners - low) / size.max())
    boxes = np.concatenate([-pieces.min(axis=1), pieces.max(axis=1)], axis=1).astype(np.float32)
    for balanced in (False, True):
        children, around = pair_up(boxes, balanced)
        levels = widen(children, surface(around.T))
        if len(levels) <= DEPTH:
            break
    return Tree(low, size, _packed(np.concatenate(levels), around / np.tile(shape, 2), source), len(levels))


def _packed(slots: np.ndarray, boxes: np.ndarray, source: np.ndarray) -> np.ndarray:
    """Nodes as a `Tree` keeps them.

    `slots` are those of all levels in turn, `boxes` in shares of the mesh's, `source` the triangle of each leaf.
    """
    # Half a unit more on either side holds what float32 rounds, here and in the shader.
    low = np.clip(np.floor(-boxes[:, :3] * STEPS - 0.5), 0, STEPS)
    high = np.clip(np.ceil(boxes[:, 3:] * STEPS + 0.5), 0, STEPS)
    sides = low.astype(np.uint32) | high.astype(np.uint32) << np.uint32(16)
    nodes = np.empty((len(slots), 4, WIDTH), np.uint32)
    nodes[:, :3] = np.where(slots[:, None] < 0, np.uint32(_NOTHING), sides[slots].transpose(0, 2, 1))
    inner = slots >= len(source)
    # Levels list children in the order of their parents, so that they stand in the order they are counted in.
    numbers = -1 - source[np.minimum(slots, len(source) - 1)]
    numbers[inner] = 1 + np.arange(inner.sum())
    nodes[:, 3] = numbers.astype(np.int32).view(np.uint32)
    return nodes
