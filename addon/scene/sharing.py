"""A scene at another time, with what has not changed."""

from dataclasses import fields, is_dataclass, replace

import numpy as np

from .scene import Scene

_MANY = "meshes", "instances", "materials", "images", "lamps"


def sharing(scene: Scene, before: Scene) -> Scene:
    """`scene` with the very objects of `before` in the place of their equals.

    What is the same object in memory is taken to be unchanged by those who draw scenes one after another.
    """
    shared = {name: _shared(getattr(scene, name), getattr(before, name)) for name in _MANY}
    return replace(scene, **shared, world=_either(scene.world, before.world))


def only_seen_from_elsewhere(scene: Scene, before: Scene) -> bool:
    """Whether the two, of which one shares with the other, are the same but for the camera."""
    pairs = [zip(getattr(scene, name), getattr(before, name), strict=False) for name in _MANY]
    same_counts = all(len(getattr(scene, name)) == len(getattr(before, name)) for name in _MANY)
    return same_counts and scene.world is before.world and all(one is other for pair in pairs for one, other in pair)


def _shared(things: tuple, before: tuple) -> tuple:
    return (*map(_either, things, before), *things[len(before) :])


def _either(thing: object, before: object) -> object:
    return before if alike(thing, before) else thing


def alike(one: object, other: object) -> bool:
    """Whether two things hold the same, arrays by their values, dataclasses by their fields."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other)
    if is_dataclass(one):
        return all(alike(getattr(one, entry.name), getattr(other, entry.name)) for entry in fields(one))
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(alike, one, other))
    return one == other
