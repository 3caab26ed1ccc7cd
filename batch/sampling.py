"""How many samples a pixel Cycles takes for a reference, and the methods beside it."""

from ..addon.drawing import reflectors_seen
from ..addon.metrics import Enough
from ..addon.scene import Scene

NOISE = 0.006
"""FLIP over the reflectors that a reference which chooses its samples itself may have of its own."""

LEAST = 64
"""The samples at which it stops first: half of fewer would be too few for the methods' own edges."""

MOST = 512
"""The samples at which it stops in any case."""

LIGHT = 512
"""What baked light follows as long as the reference's samples are not known."""

WITHOUT_REFERENCE = 32
"""What the methods' samples follow where there is no reference."""

_LEAST_SIDE, _MOST_SIDE = 2, 16


def enough(scene: Scene, size: tuple[int, int]) -> Enough:
    """Samples for a reference whose own noise is not laid at the methods' door."""
    return Enough(reflectors_seen(scene, *size), NOISE, LEAST, MOST)


def supersampling(samples: int, against: str | None = None) -> int:
    """Samples along a side of a pixel, in a box, beside a reference of `samples` a pixel: half as many in all.

    More of one side and more of the other: a bright speck in a curved mirror that few samples miss
    would otherwise be laid at the method's door. A regular grid needs fewer than Cycles' scattered samples for as
    little noise. Where a method is the reference, `against`, all draw alike.
    """
    if against:
        return min(max(1, round(samples**0.5)), _MOST_SIDE)
    return min(max(_LEAST_SIDE, round((samples / 2) ** 0.5)), _MOST_SIDE)
