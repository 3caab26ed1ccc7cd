"""Every reflected ray, traced."""

from .traced import Traced
from .tracers import RAY_TRACED


class RayTraced(Traced):
    """Every reflected ray goes down a hierarchy of boxes to the triangle that it meets first.

    Two levels: each mesh has a tree of its own, built once however often it is placed, and the objects' boxes
    stand in one above them, the only one built anew when something moves. A ray takes the nearest hit over all
    objects, the reflector itself included, looks up textures and light there, and follows mirrors as often as the
    scene's glossy bounces allow. It is exact, and so what other methods are held against.

    Source: Meister and Bittner, *Parallel locally-ordered clustering for bounding volume hierarchy construction*,
    2018, over triangles split as by Ernst and Greiner, *Early split clipping for bounding volume hierarchies*, 2007;
    four children a node as Ylitie, Karras and Laine choose theirs, *Efficient incoherent ray traversal on GPUs
    through compressed wide BVHs*, 2017; loops for lanes in step as Aila and Laine, *Understanding the efficiency of
    ray traversal on GPUs*, 2009.

    Outputs: as every method.

    Limitations: few `rays` are noisy where a mirror is rough; no refraction; the tree of a mesh that deforms is
    built anew, some seconds for 1,000,000 triangles.
    """

    name = RAY_TRACED
    source = "Meister and Bittner 2018, Ylitie et al. 2017: a hierarchy of boxes for each mesh, and one above"
    tracer = RAY_TRACED
