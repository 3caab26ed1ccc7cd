"""Which method the artist has chosen, for the scene or for one object."""

from collections.abc import Mapping

import bpy

from ..parameters import Value

OF_SCENE = "scene"
"""The object's choice that leaves the method to its scene."""


def method_of(scene: bpy.types.Scene, holder: bpy.types.Object | None) -> tuple[str, Mapping[str, Value]]:
    """The method that draws an object's reflections, and its parameters' values."""
    own = holder is not None and holder.catoptric.method != OF_SCENE
    chosen = holder.catoptric if own else scene.catoptric
    return chosen.method, chosen.methods.values(chosen.method)
