"""Every method by its name. A new one is a line here."""

from ..errors import UsageError
from .contract import Method
from .environment_map import EnvironmentMap, EnvironmentMapDynamic, EnvironmentMapParallax
from .layered_depth import LayeredDepth
from .layered_depth_published import LayeredDepthPublished

METHODS: dict[str, type[Method]] = {
    method.name: method
    for method in (
        EnvironmentMap,
        EnvironmentMapDynamic,
        EnvironmentMapParallax,
        LayeredDepthPublished,
        LayeredDepth,
    )
}


def named(name: str) -> type[Method]:
    """The method of that name; raises `UsageError`, which lists the names, where there is none."""
    if name not in METHODS:
        raise UsageError(f"no method {name!r}; there are: {', '.join(METHODS)}")
    return METHODS[name]
