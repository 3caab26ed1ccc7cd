"""A bounding-volume hierarchy of the instances' boxes, walked without a stack."""

import numpy as np


def build(boxes: np.ndarray) -> np.ndarray:
    """Nodes (N, 2, 4) float32, depth first, for world boxes (B, 2, 3).

    A node is (low corner, index of the node to go on with when its box is missed) and (high corner,
    box index, or -1 for an inner node). A walk visits node + 1 on a hit, the first number on a
    miss, and ends at N. Boxes split at the median of the axis along which their centres spread most.
    """
    centres = boxes.mean(axis=1)
    nodes: list[tuple[np.ndarray, int]] = []
    ends: dict[int, int] = {}
    pending = [(np.arange(len(boxes)), None)] if len(boxes) else []
    while pending:
        members, finished = pending.pop()
        if members is None:
            ends[finished] = len(nodes)
            continue
        node = len(nodes)
        nodes.append((members, int(members[0]) if len(members) == 1 else -1))
        pending.append((None, node))
        if len(members) > 1:
            axis = np.ptp(centres[members], axis=0).argmax()
            ordered = members[np.argsort(centres[members, axis], kind="stable")]
            half = len(ordered) // 2
            pending += [(ordered[half:], None), (ordered[:half], None)]
    packed = np.zeros((len(nodes), 2, 4), np.float32)
    for index, (members, leaf) in enumerate(nodes):
        packed[index, 0] = (*boxes[members, 0].min(axis=0), ends[index])
        packed[index, 1] = (*boxes[members, 1].max(axis=0), leaf)
    return packed
