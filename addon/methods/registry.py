"""Every method that draws a whole scene, by its name."""

from ..errors import UsageError
from .contract import Method
from .mixed import Auto
from .techniques import TECHNIQUES

METHODS: dict[str, type[Method]] = {**TECHNIQUES, Auto.name: Auto}


def named(name: str) -> type[Method]:
    """The method of that name; raises `UsageError`, which lists the names, where there is none."""
    if name not in METHODS:
        raise UsageError(f"no method {name!r}; there are: {', '.join(METHODS)}")
    return METHODS[name]
