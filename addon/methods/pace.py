"""How coarse pictures are while something moves, so that one follows the other fluently."""

_SLOW, _QUICK = 1 / 15, 1 / 65
"""Seconds for a picture: beyond the one they become coarser, below the other finer again."""


class Pace:
    """Learns from pictures of one sample a pixel by how much to divide the sides of those that must not take long.

    `scale` is that divisor, a power of two.
    """

    def __init__(self, coarsest: int) -> None:
        """Begin with whole pictures; the sides are never divided by more than `coarsest`."""
        self.scale, self._coarsest = 1, coarsest

    def took(self, scale: int, seconds: float) -> None:
        """A picture whose sides were divided by `scale` has taken so long."""
        if seconds > _SLOW:
            self.scale = max(self.scale, min(2 * scale, self._coarsest))
        elif seconds < _QUICK and scale <= self.scale:
            self.scale = max(1, scale // 2)
