"""A bounding-volume hierarchy of the instances' boxes, walked front to back without a stack."""

import numpy as np

OCTANTS = 8
"""Orders that the nodes stand in, one for each set of signs of a ray's direction."""


def build(boxes: np.ndarray) -> np.ndarray:
    """Nodes (8, N, 2, 4) float32, depth first, for world boxes (B, 2, 3).

    Octant o holds the order for rays that go down along x, y and z where bits 1, 2 and 4 of o are
    set: of two children the one that such a ray meets first stands first. A node is (low corner,
    index of the node to go on with when its box is missed) and (high corner, box index, or -1 for
    an inner node). A walk visits node + 1 on a hit and ends at N.
    """
    if not len(boxes):
        return np.zeros((OCTANTS, 0, 2, 4), np.float32)
    children, axes, leaves = _split(boxes)
    levels = _levels(children)
    low, high, sizes = boxes[leaves, 0].copy(), boxes[leaves, 1].copy(), np.ones(len(axes), int)
    for level in levels[::-1]:
        below = children[level]
        low[level], high[level] = low[below].min(axis=1), high[below].max(axis=1)
        sizes[level] += sizes[below].sum(axis=1)
    places = _places(children, axes, levels, sizes)
    octant = np.arange(OCTANTS)[:, None]
    nodes = np.empty((OCTANTS, len(axes), 2, 4), np.float32)
    nodes[octant, places, 0, :3], nodes[octant, places, 1, :3] = low, high
    nodes[octant, places, 0, 3] = places + sizes
    nodes[octant, places, 1, 3] = np.where(children[:, 0] < 0, leaves, -1)
    return nodes


def _split(boxes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Children of each node (N, 2), -1 of a leaf, the axis they part along, and a box below it.

    Boxes part at the median of the axis along which their centres spread most. Children stand behind their parents.
    """
    centres = boxes.mean(axis=1)
    children: list[tuple[int, int]] = []
    axes: list[int] = []
    members = [np.arange(len(boxes))]
    for inside in members:  # grows while it is walked
        axis = int(np.ptp(centres[inside], axis=0).argmax()) if len(inside) > 1 else 0
        axes.append(axis)
        if len(inside) == 1:
            children.append((-1, -1))
            continue
        ordered = inside[np.argsort(centres[inside, axis], kind="stable")]
        children.append((len(members), len(members) + 1))
        members += [ordered[: len(ordered) // 2], ordered[len(ordered) // 2 :]]
    return np.array(children), np.array(axes), np.array([inside[0] for inside in members])


def _levels(children: np.ndarray) -> list[np.ndarray]:
    """The inner nodes as far from the root as each other, from it on."""
    levels, level = [], np.zeros(1, int)
    while len(inner := level[children[level, 0] >= 0]):
        levels.append(inner)
        level = children[inner].ravel()
    return levels


def _places(children: np.ndarray, axes: np.ndarray, levels: list[np.ndarray], sizes: np.ndarray) -> np.ndarray:
    """(8, N): where each node stands; below a node stands its near child with all of its own, then the far one."""
    octant = np.arange(OCTANTS)[:, None]
    places = np.zeros((OCTANTS, len(axes)), int)
    for level in levels:
        downwards = octant >> axes[level] & 1
        near, far = children[level, downwards], children[level, 1 - downwards]
        places[octant, near] = places[:, level] + 1
        places[octant, far] = places[:, level] + 1 + sizes[near]
    return places
