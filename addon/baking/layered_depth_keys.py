"""What a layered depth texture depends on, as a key for the cache."""

from dataclasses import replace

from ..cache import key_of
from ..scene import ColorSource, Lighting, Material, Mesh, Scene

_VERSION = 1
"""Goes up when the same input bakes to something else."""


def keys_of(scene: Scene, lighting: Lighting, resolution: int, layers: int) -> list[str | None]:
    """The key of each instance's bake, None where reflections do not see the instance.

    Unlit, a moved, rotated or scaled object keeps its key. Lightmaps and lamps become part of it under
    the light that uses them; under lamps, everything that may cast a shadow does as well.
    """
    meshes = [key_of(mesh) for mesh in scene.meshes]
    images = [key_of(image) for image in scene.images]
    materials = material_keys(scene, images)
    whole = _light_key(scene, meshes) if lighting is Lighting.DIRECT else None
    keys: list[str | None] = []
    for instance in scene.instances:
        mesh: Mesh = scene.meshes[instance.mesh]
        if not instance.in_reflections or not len(mesh.triangles):
            keys.append(None)
            continue
        parts: list[object] = [_VERSION, resolution, layers, lighting, meshes[instance.mesh], instance.reflector]
        parts += [materials[index] for index in instance.materials]
        if lighting is Lighting.CYCLES and instance.lightmap is not None:
            parts.append(images[instance.lightmap])
        if lighting is Lighting.DIRECT:
            parts += [instance.matrix, whole]
        keys.append(key_of(parts))
    return keys


def material_keys(scene: Scene, images: list[str]) -> list[str]:
    """The keys of a scene's materials, by content; `images` are the keys of its images."""
    return [_material_key(material, images) for material in scene.materials]


def _material_key(material: Material, images: list[str]) -> str:
    """By content: a name or an image's place in the scene changes nothing."""
    sources = (material.base, material.emission, material.reflection)
    shown = [None if source.image is None else images[source.image] for source in sources]
    placeless = [replace(source, image=None) for source in sources]
    bare = ColorSource()
    return key_of(replace(material, name="", base=bare, emission=bare, reflection=bare), placeless, shown)


def _light_key(scene: Scene, meshes: list[str]) -> str:
    """The lamps, the world, and all that stands in their light."""
    standing = [(meshes[instance.mesh], instance.matrix) for instance in scene.instances]
    return key_of(scene.lamps, scene.world, standing)
