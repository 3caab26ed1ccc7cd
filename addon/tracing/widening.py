"""A binary tree as one whose nodes have up to four children.

Wald, Benthin and Boulos 2008, Getting rid of packets, take up children greedily; here the best of all ways is
found from the leaves up, as Ylitie, Karras and Laine 2017 do, Efficient incoherent ray traversal on GPUs through
compressed wide BVHs, 3.1: the one whose nodes have the least surface together, since a ray visits a node as
often as it meets its box.
"""

import numpy as np

WIDTH = 4


def widen(children: np.ndarray, size: np.ndarray) -> list[np.ndarray]:
    """Levels, from the root's on, of (N, 4) children of each node, -1 for none.

    `children` (B - 1, 2) are those of the binary tree's nodes from B on, the last of them the root, and `size`
    (2 B - 1,) is what any node's box costs. Nodes keep their numbers, of which fewer are left; each level
    lists the nodes that the one before names, in its order.
    """
    leaves = len(children) + 1
    if leaves == 1:
        return [np.array([[0, -1, -1, -1]])]
    shares = _shares(children, size, leaves)
    levels, inner = [], np.array([leaves + len(children) - 1])
    while len(inner):
        levels.append(_slots(inner, children, shares, leaves))
        inner = levels[-1][levels[-1] >= leaves]
    return levels


def _shares(children: np.ndarray, size: np.ndarray, leaves: int) -> np.ndarray:
    """(B - 1, WIDTH + 1) int8: of so many places for what is below a node, how many go to its first child.

    0 where it is best that it takes one place, as a node of its own.
    """
    cost = np.zeros((len(size), WIDTH + 1), np.float32)  # of what is below a node, in so many places at most
    shares = np.zeros((len(children), WIDTH + 1), np.int8)
    for inner in reversed(_generations(children, leaves)):
        first, second = cost[children[inner - leaves]].transpose(1, 0, 2)
        split = np.full((len(inner), WIDTH + 1), np.inf, np.float32)
        share = np.zeros((len(inner), WIDTH + 1), np.int8)
        for places in range(2, WIDTH + 1):
            for part in range(1, places):
                total = first[:, part] + second[:, places - part]
                better = total < split[:, places]
                split[better, places], share[better, places] = total[better], part
        alone = size[inner] + split[:, WIDTH]
        cost[inner, 1:] = np.minimum(split[:, 1:], alone[:, None])
        shares[inner - leaves] = np.where(split <= alone[:, None], share, 0)
        shares[inner - leaves, WIDTH] = share[:, WIDTH]
    return shares


def _generations(children: np.ndarray, leaves: int) -> list[np.ndarray]:
    """The nodes that have children, from the root on, by how far they are below it."""
    generations, inner = [], np.array([leaves + len(children) - 1])
    while len(inner):
        generations.append(inner)
        below = children[inner - leaves].reshape(-1)
        inner = below[below >= leaves]
    return generations


def _slots(inner: np.ndarray, children: np.ndarray, shares: np.ndarray, leaves: int) -> np.ndarray:
    """(N, WIDTH) children that nodes take up."""
    slots, places = np.full((len(inner), WIDTH), -1), np.zeros((len(inner), WIDTH), np.int8)
    slots[:, 0], places[:, 0] = inner, WIDTH
    for column in range(WIDTH - 1):
        # What has several places, and is better apart, gives the last of them to its second child.
        row = np.arange(len(inner))
        while len(row):
            node = slots[row, column]
            part = np.where(node >= leaves, shares[np.maximum(node - leaves, 0), places[row, column]], 0)
            row, node, part = row[part > 0], node[part > 0], part[part > 0]
            both, there = children[node - leaves], column + part
            slots[row, column], slots[row, there] = both[:, 0], both[:, 1]
            places[row, there] = places[row, column] - part
            places[row, column] = part
    return slots
