"""Whether baked light is still that of a scene, and how it is put onto one."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..cache import key_of
from ..scene import Instance, Mesh, Scene
from .layered_depth_keys import material_keys


class Keys:
    """Keys of meshes and images, which are hashed once for as long as they are the same object in memory."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[object, str]] = {}

    def of(self, things: tuple) -> list[str]:
        """The key of each; what is not asked for any more is forgotten by `sweep`."""
        for thing in things:
            if id(thing) not in self._known:
                self._known[id(thing)] = thing, key_of(thing)
        return [self._known[id(thing)][1] for thing in things]

    def sweep(self, scene: Scene) -> None:
        """Forget all that `scene` does not hold."""
        held = {id(thing) for thing in (*scene.meshes, *scene.images)}
        self._known = {place: known for place, known in self._known.items() if place in held}


@dataclass(frozen=True)
class Standing:
    """What light depends on, as keys: by an instance's name its mesh, place and materials; the lamps; the world."""

    meshes: Mapping[str, str]
    places: Mapping[str, str]
    materials: Mapping[str, str]
    lamps: str
    world: str


def standing(scene: Scene, keys: Keys) -> Standing:
    """How things stand in `scene`."""
    meshes, materials = keys.of(scene.meshes), material_keys(scene, keys.of(scene.images))
    return Standing(
        meshes={one.name: meshes[one.mesh] for one in scene.instances},
        places={one.name: key_of(one.matrix) for one in scene.instances},
        materials={one.name: key_of([materials[index] for index in one.materials]) for one in scene.instances},
        lamps=key_of(scene.lamps),
        world=key_of(scene.world),
    )


def changes(before: Standing, now: Standing) -> list[str]:
    """What has changed, a phrase each; nothing if the light is as it was."""
    return list(_changes(before, now))


def _changes(before: Standing, now: Standing) -> Iterator[str]:
    for name in now.places.keys() - before.places.keys():
        yield f'"{name}" is new'
    for name in before.places.keys() - now.places.keys():
        yield f'"{name}" is gone'
    for what, old, new in (
        ("has another shape", before.meshes, now.meshes),
        ("has moved", before.places, now.places),
        ("has another material", before.materials, now.materials),
    ):
        yield from (f'"{name}" {what}' for name in new if old.get(name, new[name]) != new[name])
    if before.lamps != now.lamps:
        yield "the lamps have changed"
    if before.world != now.world:
        yield "the world has changed"


def dressed(scene: Scene, lit: Scene, fitting: set[str]) -> Scene:
    """`scene` with the lightmaps of `lit` on the instances whose names are `fitting`.

    These take over the mesh of `lit`, which holds the lightmap's coordinates and may be cut finer. What `scene`
    and `lit` hold stays the same objects in memory.
    """
    meshes, images = list(scene.meshes), list(scene.images)
    added: dict[int, int] = {}
    known = {instance.name: instance for instance in lit.instances}

    def own(store: list, thing: "Mesh | np.ndarray") -> int:
        if id(thing) not in added:
            added[id(thing)] = len(store)
            store.append(thing)
        return added[id(thing)]

    def wearing(instance: Instance) -> Instance:
        source = known.get(instance.name) if instance.name in fitting else None
        if source is None or source.lightmap is None:
            return instance
        mesh = lit.meshes[source.mesh]
        if mesh.slots.max(initial=0) >= len(instance.materials):
            return instance
        return replace(instance, mesh=own(meshes, mesh), lightmap=own(images, lit.images[source.lightmap]))

    instances = tuple(wearing(instance) for instance in scene.instances)
    return replace(scene, instances=instances, meshes=tuple(meshes), images=tuple(images))
