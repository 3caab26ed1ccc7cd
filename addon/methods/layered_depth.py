"""Our layered depth textures: the hit itself, not a sample near it."""

import moderngl

from ..scene import Scene
from .contract import View
from .deferred import DeferredMethod


class LayeredDepth(DeferredMethod):
    """Layered depth textures whose texels hold the triangles that pass through them.

    A ray walks the columns of each object it may meet, skips empty slices of depth by a pyramid, and
    meets the triangles of a slice exactly. It takes the nearest hit over all objects, the reflector
    itself included, and follows mirrors as often as the scene's glossy bounces allow.

    Source: Zhang, Hsieh and Shen, 3.3 and 3.4, whose texels sample depth; the walk down and up a
    pyramid is hierarchical screen-space tracing's.

    Limitations: mirror-like materials only (roughness counts as 0); no refraction; objects that
    deform are baked again; a very dense mesh costs more (1,000,000 triangles about twice 1,500).
    """

    name = "layered-depth"
    source = "after Zhang et al., 3.3 and 3.4: columns of triangles, walked exactly"
    shader = "traced/traced.frag"

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """How often a path reflects."""
        shader["reflections"] = reflections_left(self.scene, view)


def reflections_left(scene: Scene, view: View) -> int:
    """How often a path may reflect that a view begins: in all once more than Cycles' glossy bounces."""
    return scene.glossy_bounces + 1 - view.mirrored
