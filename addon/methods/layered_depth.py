"""Our layered depth textures: the hit itself, not a sample near it."""

from .traced import Traced
from .tracers import LAYERED_DEPTH


class LayeredDepth(Traced):
    """Layered depth textures whose texels hold the triangles that pass through them.

    A ray walks the columns of each object it may meet, skips empty slices of depth by a pyramid, and
    meets the triangles of a slice exactly. It takes the nearest hit over all objects, the reflector
    itself included, and follows mirrors as often as the scene's glossy bounces allow. A rough mirror sends
    rays of its GGX lobe, which neighbouring pixels share in a picture of one sample a pixel.

    Source: Zhang, Hsieh and Shen, 3.3 and 3.4, whose texels sample depth; the walk down and up a
    pyramid is hierarchical screen-space tracing's.

    Limitations: few `rays` are noisy where a mirror is rough; no refraction; objects that deform are baked
    again; a very dense mesh costs more (1,000,000 triangles about twice 1,500).
    """

    name = LAYERED_DEPTH
    source = "after Zhang et al., 3.3 and 3.4: columns of triangles, walked exactly"
    tracer = LAYERED_DEPTH
