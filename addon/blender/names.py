"""How instances are named after the Blender objects that they came from."""

import re

import bpy


class Names:
    """Hands out names: an object's own at first, numbered (`Ball [2]`) for every further instance of it."""

    def __init__(self) -> None:
        self._taken: set[str] = set()
        self._counts: dict[str, int] = {}

    def unique(self, name: str) -> str:
        """`name`, numbered if it is taken."""
        count = self._counts.get(name, 0) + 1
        while (candidate := name if count == 1 else f"{name} [{count}]") in self._taken:
            count += 1
        self._counts[name] = count
        self._taken.add(candidate)
        return candidate


def object_name(instance_name: str) -> str:
    """The name of the Blender object, in the open file, that the instance of that name came from."""
    if instance_name in bpy.data.objects:
        return instance_name
    return re.sub(r" \[\d+\]$", "", instance_name)
