"""From crossings to layers: where a line enters an object and where it leaves it again."""

from typing import NamedTuple

import numpy as np

from .layered_depth_peel import Crossings


class Layers(NamedTuple):
    """L layers in the order of texel, then depth, none overlapping another in its texel.

    `texel` (L,) int32, `depth` (L, 2) float32 and `triangle` (L, 2) int32 of entry and exit; `hidden`
    counts crossings inside a solid, which no line from outside can see.
    """

    texel: np.ndarray
    depth: np.ndarray
    triangle: np.ndarray
    hidden: int


class _Steps(NamedTuple):
    """Crossings taken apart, so that each has one triangle; in order."""

    texel: np.ndarray
    depth: np.ndarray
    triangle: np.ndarray
    turn: np.ndarray


def pair(crossings: Crossings) -> Layers:
    """The layers of `crossings`.

    In a texel that a closed surface leaves as often as it enters, a layer lasts from where the line
    enters the union of all solids to where it leaves it; a surface turned inside out counts the same.
    Where the count does not come out (a hole, a cap that cut), a front face pairs with the back face
    behind it. Everything else is a surface without thickness: its exit is its entry.
    """
    steps = _apart(crossings)
    before, after, sound = _windings(steps)
    enters = sound & (before == 0) & (after != 0)
    leaves = sound & (before != 0) & (after == 0)
    paired = _front_to_back(steps, ~sound)
    thin = ~paired & ~np.roll(paired, 1) & ~sound
    thin |= sound & (steps.turn == 0) & (before == 0)
    first = np.concatenate([np.flatnonzero(enters), np.flatnonzero(paired), np.flatnonzero(thin)])
    last = np.concatenate([np.flatnonzero(leaves), np.flatnonzero(paired) + 1, np.flatnonzero(thin)])
    order = np.argsort(first, kind="stable")
    both = np.stack([first[order], last[order]], axis=1)
    hidden = len(steps.texel) - 2 * len(both) + int(thin.sum())
    return Layers(steps.texel[both[:, 0]], steps.depth[both], steps.triangle[both], hidden)


def _apart(crossings: Crossings) -> _Steps:
    """Where two solids touch, a crossing leaves one and enters the other: make it two."""
    within = np.sign(_running(crossings.texel, crossings.turn))
    double = (crossings.front >= 0) & (crossings.back >= 0) & (crossings.turn == 0)
    index = np.repeat(np.arange(len(double)), 1 + double)
    second = np.concatenate([[False], index[1:] == index[:-1]])[: len(index)]
    # Leave before entering; outside of everything, enter and leave at once.
    turn_first = np.where(within != 0, -within, 1)[index]
    turn = np.where(double[index], np.where(second, -turn_first, turn_first), crossings.turn[index])
    away = (turn < 0) & (crossings.back[index] >= 0)
    triangle = np.where(away, crossings.back[index], crossings.front[index])
    return _Steps(crossings.texel[index], crossings.depth[index], triangle, turn)


def _running(texel: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The sum of `turn` in each texel up to and with each entry."""
    total = np.cumsum(turn)
    start = np.flatnonzero(_starts(texel))
    return total - np.repeat((total - turn)[start], np.diff(np.append(start, len(texel))))


def _starts(texel: np.ndarray) -> np.ndarray:
    """Which entries are the first of their texel."""
    return np.concatenate([[True], texel[1:] != texel[:-1]])[: len(texel)]


def _windings(steps: _Steps) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How many solids a line is in before and after each step, and whether its texel's count comes out."""
    after = _running(steps.texel, steps.turn)
    start = np.flatnonzero(_starts(steps.texel))
    if not len(start):
        return after, after, after == 0
    total = after[np.append(start[1:], len(after)) - 1]
    one_sided = (np.minimum.reduceat(after, start) >= 0) | (np.maximum.reduceat(after, start) <= 0)
    sound = np.repeat((total == 0) & one_sided, np.diff(np.append(start, len(after))))
    return after - steps.turn, after, sound


def _front_to_back(steps: _Steps, among: np.ndarray) -> np.ndarray:
    """Steps that enter and are followed by one that leaves, in the same texel."""
    follows = np.append(steps.texel[1:] == steps.texel[:-1], False)[: len(steps.texel)]
    return among & follows & (steps.turn > 0) & (np.roll(steps.turn, -1) < 0)
