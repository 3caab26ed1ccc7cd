"""Every way to draw one reflector, by its name. A new one is a line here."""

from .deferred import DeferredMethod
from .environment_map import EnvironmentMap, EnvironmentMapDynamic, EnvironmentMapParallax
from .glossy_planar import GlossyPlanar
from .glossy_planes import GlossyPlanes
from .image_warp import ImageWarp
from .layered_depth import LayeredDepth
from .layered_depth_published import LayeredDepthPublished
from .planar import Planar
from .ray_traced import RayTraced
from .reprojection import Reprojection
from .reprojection_published import ReprojectionPublished
from .virtual_objects import VirtualObjects
from .virtual_objects_published import VirtualObjectsPublished

TECHNIQUES: dict[str, type[DeferredMethod]] = {
    technique.name: technique
    for technique in (
        EnvironmentMap,
        EnvironmentMapDynamic,
        EnvironmentMapParallax,
        LayeredDepthPublished,
        LayeredDepth,
        RayTraced,
        Planar,
        GlossyPlanes,
        GlossyPlanar,
        VirtualObjectsPublished,
        VirtualObjects,
        ImageWarp,
        ReprojectionPublished,
        Reprojection,
    )
}
