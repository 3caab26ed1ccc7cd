"""Triangles cut where they are large for what they are near to."""

import numpy as np


def cut_near(
    corners: np.ndarray, boxes: np.ndarray, share: float, least: np.ndarray, most: int = 4_000_000
) -> tuple[np.ndarray, np.ndarray]:
    """Halve triangles `corners` (T, 3, 3) until no edge is longer than `share` of its distance from the `boxes`.

    `boxes` (B, 2, 3) low and high corners, and `least` (B,) what is short enough however near each is; no more than
    `most` triangles come out. Returns (N, 3, 3) pieces, and (N,) int64 the triangle each is a piece of. A piece's
    corner may lie within a neighbour's edge.
    """
    source = np.arange(len(corners))
    done: list[tuple[np.ndarray, np.ndarray]] = []
    count = 0
    while len(corners):
        edges = np.roll(corners, -1, axis=1) - corners
        lengths = np.linalg.norm(edges, axis=2)
        longest = lengths.argmax(axis=1)
        length = lengths[np.arange(len(corners)), longest]
        small = length <= least.min(initial=np.inf)
        small[~small] = length[~small] <= _allowed(corners[~small], boxes, share, least)
        if count + 2 * len(corners) > most:
            small[:] = True
        done.append((corners[small], source[small]))
        count += int(small.sum())
        corners, source = _halved(corners[~small], longest[~small]), np.tile(source[~small], 2)
    pieces, sources = zip(*done, strict=True) if done else ((corners,), (source,))
    return np.concatenate(pieces), np.concatenate(sources)


def _halved(corners: np.ndarray, longest: np.ndarray) -> np.ndarray:
    """(2 T, 3, 3) the halves of triangles on either side of the middle of their longest edges."""
    order = (longest[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(corners, order[..., None], axis=1).transpose(1, 0, 2)
    middle = 0.5 * (a + b)
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def _allowed(corners: np.ndarray, boxes: np.ndarray, share: float, least: np.ndarray) -> np.ndarray:
    """(T,) the longest edge that each triangle may have, by the distance of the box around it to the others."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    allowed = np.full(len(corners), np.inf)
    for box, enough in zip(boxes, least, strict=True):
        gap = np.maximum(np.maximum(box[0] - high, low - box[1]), 0.0)
        allowed = np.minimum(allowed, np.maximum(share * np.linalg.norm(gap, axis=1), enough))
    return allowed
