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
    children, axes, members = _split(boxes)
    return np.stack([_ordered(boxes, children, axes, members, octant) for octant in range(OCTANTS)])


def _split(boxes: np.ndarray):
    """Children of each node (none of a leaf), the axis they part along, and the boxes below it.

    Boxes part at the median of the axis along which their centres spread most.
    """
    centres = boxes.mean(axis=1)
    children: list[tuple[int, ...]] = []
    axes: list[int] = []
    members = [np.arange(len(boxes))]
    for inside in members:  # grows while it is walked
        axis = int(np.ptp(centres[inside], axis=0).argmax())
        axes.append(axis)
        if len(inside) == 1:
            children.append(())
            continue
        ordered = inside[np.argsort(centres[inside, axis], kind="stable")]
        children.append((len(members), len(members) + 1))
        members += [ordered[: len(ordered) // 2], ordered[len(ordered) // 2 :]]
    return children, axes, members


def _ordered(boxes, children, axes, members, octant: int) -> np.ndarray:
    packed = np.zeros((len(children), 2, 4), np.float32)
    place, pending = 0, [0]
    while pending:
        node = pending.pop()
        inside = members[node]
        # A subtree of n leaves has 2 n - 1 nodes, all of them in a row.
        packed[place, 0] = (*boxes[inside, 0].min(axis=0), place + 2 * len(inside) - 1)
        packed[place, 1] = (*boxes[inside, 1].max(axis=0), inside[0] if len(inside) == 1 else -1)
        downwards = octant >> axes[node] & 1
        pending += children[node] if downwards else children[node][::-1]
        place += 1
    return packed
