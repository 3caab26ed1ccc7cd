"""The naive warp of reflections, which reprojection is compared with."""

import moderngl

from .deferred import Clock
from .reuse.buffers import Sample
from .reuse.packed_buffers import PackedBuffers
from .reuse.warping import WARPING, WarpingMethod


class ImageWarp(WarpingMethod):
    """Reflections stay on the mirrors as if they were painted there, and are warped with them by depth.

    What the key frame saw in a point of a mirror is taken for what every camera sees there. It is what temporal
    coherence does to diffuse surfaces, and what Xie, Wang and Dutré hold their reprojection against.

    Source: Xie, Wang and Dutré, *Reflection reprojection using temporal coherence*, 2017: depth-based warping (3.2),
    key frames (4.3); the *naive approach* of figures 1 and 6.

    Outputs: as every method; `Frame.reuse` says what was traced.

    Limitations: wrong as soon as the camera moves: a reflection does not shift on its mirror, and jumps with the next
    key frame and at the borders of what is traced; what has moved begins a key frame; mirror-like materials only
    (roughness counts as 0).
    """

    name = "image-warp"
    source = "Xie et al., 3.2 and figures 1 and 6: depth-based warping of a key frame's reflections, as colours"
    parameters = WARPING

    def image(self, clock: Clock, key: PackedBuffers, sample: Sample) -> moderngl.Texture:
        """What the key frame saw."""
        return key.light
