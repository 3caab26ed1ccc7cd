"""Triangles cut where they are large for what they are near to."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_AT_ONCE = 1 << 16
"""Pairs of triangles and boxes that are held against each other in one go."""


@dataclass(frozen=True, eq=False)
class Near:
    """Something that triangles may be near to: `boxes` (B, 2, 3) of its parts, low and high corners, and `least` (B,)
    the length of an edge that is short enough however near to each."""

    boxes: np.ndarray
    least: np.ndarray


def cut_near(
    corners: np.ndarray, things: Sequence[Near], share: float, most: int = 1_000_000
) -> tuple[np.ndarray, np.ndarray]:
    """Halve triangles `corners` (T, 3, 3) until no edge is longer than `share` of its distance from anything near.

    No more than `most` triangles come out, but for those that went in. Returns (N, 3, 3) pieces, and (N,) int64 the
    triangle each is a piece of. A piece's corner may lie within a neighbour's edge.
    """
    source = np.arange(len(corners))
    done: list[tuple[np.ndarray, np.ndarray]] = []
    count = 0
    while len(corners):
        edges = np.roll(corners, -1, axis=1) - corners
        lengths = np.linalg.norm(edges, axis=2)
        longest = lengths.argmax(axis=1)
        small = ~_too_long(corners, lengths[np.arange(len(corners)), longest], things, share)
        if count + 2 * len(corners) > most:
            small[:] = True
        done.append((corners[small], source[small]))
        count += int(small.sum())
        corners, source = halved(corners[~small], longest[~small]), np.tile(source[~small], 2)
    pieces, sources = zip(*done, strict=True) if done else ((corners,), (source,))
    return np.concatenate(pieces), np.concatenate(sources)


def halved(corners: np.ndarray, longest: np.ndarray) -> np.ndarray:
    """(2 T, 3, 3) the halves of triangles on either side of the middle of an edge, `longest` (T,)."""
    order = (longest[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(corners, order[..., None], axis=1).transpose(1, 0, 2)
    middle = 0.5 * (a + b)
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def _too_long(corners: np.ndarray, length: np.ndarray, things: Sequence[Near], share: float) -> np.ndarray:
    """(T,) bool: whether triangles' longest edges, `length` (T,), are too long for their distance from anything."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    too_long = np.zeros(len(corners), bool)
    for thing in things:
        around = np.stack([thing.boxes[:, 0].min(axis=0), thing.boxes[:, 1].max(axis=0)])[None]
        asked = np.flatnonzero(~too_long)
        asked = asked[_beyond(low[asked], high[asked], length[asked], around, thing.least.min()[None], share)]
        begin = 0
        while begin < len(thing.boxes) and len(asked):
            part = slice(begin, begin + max(1, _AT_ONCE // len(asked)))
            beyond = _beyond(low[asked], high[asked], length[asked], thing.boxes[part], thing.least[part], share)
            too_long[asked[beyond]] = True
            asked, begin = asked[~beyond], part.stop
    return too_long


def _beyond(
    low: np.ndarray, high: np.ndarray, length: np.ndarray, boxes: np.ndarray, least: np.ndarray, share: float
) -> np.ndarray:
    """(T,) bool: whether edges `length` (T,) are too long for any of `boxes` (B, 2, 3), and longer than its `least`."""
    gaps = np.maximum(np.maximum(boxes[:, 0] - high[:, None], low[:, None] - boxes[:, 1]), 0.0)
    longest = np.maximum(least, share * np.sqrt(np.einsum("tbi,tbi->tb", gaps, gaps)))
    return (length[:, None] > longest).any(axis=1)
