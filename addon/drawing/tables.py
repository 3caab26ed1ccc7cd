"""A Scene as the tables that gpu_shaders/common reads: plain arrays, one row a texel."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count
from weakref import WeakKeyDictionary

import numpy as np

from ..scene import ColorSource, Fresnel, Image, Instance, Material, Mesh, Scene
from ..tracing import OCTANTS, build_hierarchy, depth_axis, is_convex, padded_box, placed_box
from .lamps import lamp_rows

_BYTES, _SRGB = 1, 2
_HOLDS_BYTES, _HOLDS_FLOATS = 1, 2
_NONE = _MIRRORS_NOTHING = -1
_SHAPES: "WeakKeyDictionary[Mesh, tuple[np.ndarray, np.ndarray, bool]]" = WeakKeyDictionary()
_MOST_PLACES = 1 << 14
"""Of a mesh, whose boxes are remembered."""


def geometry_tables(scene: Scene) -> dict[str, np.ndarray]:
    """What meshes and images hold, by sampler name. Every table has at least one row, so that its texture exists."""
    return {
        "positions": _rows([_positions(mesh) for mesh in scene.meshes]),
        "corners": _rows([_corners(mesh) for mesh in scene.meshes]),
        "vertex_colors": _vertex_colors(scene.meshes),
        **_images(_all_images(scene)),
    }


def record_table(scene: Scene, groups: Mapping[int, int] | None = None) -> tuple[np.ndarray, dict[str, int]]:
    """All that there is little of, in one table, since a shader may read only 16; and integer uniforms.

    These tell where sections of the table begin and how long they are, and which image is the
    panorama (-1: none). `groups` maps instances that mirror to the number of their group, 0 unless given.
    """
    instances, materials = _instances_and_materials(scene, groups or {})
    hierarchy, lamps = _hierarchy(scene), lamp_rows(scene.lamps)
    numbers = {
        "first_material": len(instances),
        "first_node": len(instances) + len(materials),
        "hierarchy_nodes": len(hierarchy) // (2 * OCTANTS),
        "first_lamp": len(instances) + len(materials) + len(hierarchy),
        "lamp_count": len(scene.lamps),
        "world_panorama": _NONE if scene.world.panorama is None else len(scene.images),
    }
    return np.concatenate([instances, materials, hierarchy, lamps]).astype(np.float32), numbers


def first_triangles(scene: Scene) -> np.ndarray:
    """Where the triangles of each mesh begin among all, and in the end how many there are."""
    return np.concatenate([[0], np.cumsum([len(mesh.triangles) for mesh in scene.meshes])]).astype(np.int64)


def box_of(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Low corner and size, (3,) float64, of the box that rays are held against before a mesh is searched."""
    return _shape_of(mesh)[:2]


def _shape_of(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, bool]:
    """The box of a mesh, and whether it is convex; found once, as long as the mesh lives."""
    if mesh not in _SHAPES:
        _SHAPES[mesh] = *padded_box(mesh.corners), is_convex(mesh.positions, mesh.triangles)
    return _SHAPES[mesh]


def material_defines(scene: Scene) -> dict[str, int]:
    """What gpu_shaders/common/surface.glsl must handle for these materials, and may leave out."""
    sources = {
        "BASE_IMAGES": [material.base for material in scene.materials],
        "EMISSION_IMAGES": [material.emission for material in scene.materials],
        "REFLECTION_IMAGES": [material.reflection for material in scene.materials],
        "ROUGHNESS_IMAGES": [material.roughness for material in scene.materials],
    }
    defines = dict.fromkeys(sources, 0)
    for name, colors in sources.items():
        for color in colors:
            if color.image is not None:
                is_bytes = scene.images[color.image].pixels.dtype == np.uint8
                defines[name] |= _HOLDS_BYTES if is_bytes else _HOLDS_FLOATS
    tinted = any(color.vertex_colors for colors in sources.values() for color in colors)
    return {
        **defines,
        "VERTEX_COLORS": int(tinted),
        "EMISSION": int(any(material.emits for material in scene.materials)),
        "DIELECTRICS": int(any(m.mirrors and m.fresnel is Fresnel.DIELECTRIC for m in scene.materials)),
    }


def world_boxes(scene: Scene, indices: Iterable[int]) -> np.ndarray:
    """(N, 2, 3) float64: least and greatest world corner of each of some instances; found once for a place."""
    instances = [scene.instances[index] for index in indices]
    return np.array([_world_box(one, scene.meshes[one.mesh]) for one in instances]).reshape(-1, 2, 3)


def _world_box(instance: Instance, mesh: Mesh) -> np.ndarray:
    return placed_box(mesh, lambda: mesh.positions, instance.matrix, _MOST_PLACES)


def _rows(parts: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([*parts, np.zeros((0 if parts else 1, 4), np.float32)])


def _positions(mesh: Mesh) -> np.ndarray:
    rows = np.zeros((len(mesh.triangles), 3, 4), np.float32)
    rows[..., :3] = mesh.corners
    rows[:, 0, 3] = mesh.slots
    return rows.reshape(-1, 4)


def _corners(mesh: Mesh) -> np.ndarray:
    count = len(mesh.triangles)
    normals = np.zeros((count, 3, 4), np.float32)
    normals[..., :3] = mesh.normals
    uvs = np.zeros((count, 12), np.float32)
    uvs[:, :6] = mesh.uvs.reshape(count, 6)
    if mesh.lightmap_uvs is not None:
        uvs[:, 6:] = mesh.lightmap_uvs.reshape(count, 6)
    return np.concatenate([normals.reshape(count, 12), uvs], axis=1).reshape(-1, 4)


def _vertex_colors(meshes: Sequence[Mesh]) -> np.ndarray:
    if all(mesh.colors is None for mesh in meshes):
        return np.ones((1, 4), np.float32)
    white = [np.ones((3 * len(mesh.triangles), 4), np.float32) for mesh in meshes]
    colors = [rows if mesh.colors is None else mesh.colors for rows, mesh in zip(white, meshes, strict=True)]
    return np.concatenate([np.asarray(rows, np.float32).reshape(-1, 4) for rows in colors])


def _instances_and_materials(scene: Scene, groups: Mapping[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """An instance's materials stand in a row of their own, so that a slot is an offset."""
    first: dict[tuple[int, ...], int] = {}
    order: list[int] = []
    for instance in scene.instances:
        if instance.materials not in first:
            first[instance.materials] = len(order)
            order.extend(instance.materials)
    rows = np.zeros((len(scene.instances), 10, 4), np.float32)
    shapes = [_shape_of(mesh) for mesh in scene.meshes]
    reflectors: defaultdict[int, Iterator[int]] = defaultdict(count)
    if scene.instances:
        matrices = np.stack([instance.matrix for instance in scene.instances])
        rows[:, 0:3], rows[:, 3:6] = matrices[:, :3], np.linalg.inv(matrices)[:, :3]
    for index, (row, instance) in enumerate(zip(rows, scene.instances, strict=True)):
        lightmap = _NONE if instance.lightmap is None else instance.lightmap
        group = groups.get(index, 0) if instance.reflector else _NONE
        row[6] = first[instance.materials], group + 1, lightmap, next(reflectors[group])
        low, size, convex = shapes[instance.mesh]
        row[7] = *low, depth_axis(size)
        row[8] = *size, convex
        row[9, 0] = instance.mesh
    materials = [_material(scene.materials[index]) for index in order] or [np.zeros((6, 4), np.float32)]
    return rows.reshape(-1, 4), np.concatenate(materials)


def _material(material: Material) -> np.ndarray:
    base, reflection, emission, roughness = material.base, material.reflection, material.emission, material.roughness
    fresnel = material.fresnel if material.mirrors else _MIRRORS_NOTHING
    return np.array(
        [
            [*base.color, material.diffuse],
            [_image(base), _flags(base), fresnel, material.ior],
            [*reflection.color, _image(reflection)],
            [*emission.color, _image(emission)],
            [_flags(reflection), _flags(emission), _flags(roughness), material.multiscatter],
            [*roughness.color, _image(roughness)],
        ],
        np.float32,
    )


def _image(source: ColorSource) -> int:
    return _NONE if source.image is None else source.image


def _flags(source: ColorSource) -> int:
    return source.interpolation | source.extension << 1 | source.vertex_colors << 3


def _all_images(scene: Scene) -> list[Image]:
    """The scene's images, and the panorama last."""
    return [*scene.images, *([] if scene.world.panorama is None else [_opaque(scene.world.panorama)])]


def _opaque(panorama: np.ndarray) -> Image:
    pixels = np.ones((*panorama.shape[:2], 4), np.float32)
    pixels[..., :3] = panorama[..., :3]
    return Image("world", pixels)


def _images(images: Sequence[Image]) -> dict[str, np.ndarray]:
    table = np.zeros((max(1, len(images)), 4), np.uint32)
    texels: dict[bool, list[np.ndarray]] = {True: [], False: []}
    offsets = {True: 0, False: 0}
    for row, image in zip(table, images, strict=False):
        height, width = image.pixels.shape[:2]
        is_bytes = image.pixels.dtype == np.uint8
        row[:] = offsets[is_bytes], width, height, _BYTES * is_bytes | _SRGB * image.srgb
        texels[is_bytes].append(image.pixels.reshape(-1, 4))
        offsets[is_bytes] += width * height
    return {
        "images": table,
        "byte_texels": np.concatenate([*texels[True], np.zeros((1, 4), np.uint8)]),
        "float_texels": np.concatenate([*texels[False], np.zeros((1, 4), np.float32)]).astype(np.float32),
    }


def _hierarchy(scene: Scene) -> np.ndarray:
    shown = np.array([index for index, instance in enumerate(scene.instances) if instance.in_reflections], int)
    nodes = build_hierarchy(world_boxes(scene, shown)).reshape(-1, 2, 4)
    leaves = nodes[:, 1, 3] >= 0
    nodes[leaves, 1, 3] = shown[nodes[leaves, 1, 3].astype(int)]
    margin = 1e-5 * (1.0 + np.abs(nodes[:, :, :3]))
    nodes[:, 0, :3] -= margin[:, 0]
    nodes[:, 1, :3] += margin[:, 1]
    return nodes.reshape(-1, 4)
