"""Diffuse light, computed by Cycles once and kept in an image for each object."""

from dataclasses import replace

import bpy
import numpy as np

from ..cache import Cache, key_of
from ..errors import MachineError, UsageError
from ..progress import Progress, silent
from ..scene import Image, Scene
from .lightmap_denoise import denoised
from .lightmap_density import appearance, seen_area, split_where_seen, users_of_meshes
from .lightmap_stage import bake_stage
from .lightmap_uv import unwrap
from .reference import cycles_engine
from .render_fingerprint import LIGHTMAP_NAME, fingerprint, without_lightmaps
from .render_settings import changed, first_line, quiet

SMALLEST, LARGEST = 32, 2048
CHUNK = 16
_OUTSIDE = -2.0
"""Where triangles lie that get no light map: off the image."""

_SPREAD = 8
"""Texels that a chart's light is spread beyond its border, for bilinear lookups."""


def bake_lightmaps(
    bpy_scene: bpy.types.Scene,
    scene: Scene,
    samples: int = 32,
    texels: int = 1 << 20,
    cache: Cache | None = None,
    progress: Progress = silent,
) -> Scene:
    """`scene`, extracted from `bpy_scene`, with a lightmap on every instance that scatters light.

    A surface's diffuse radiance is `base * diffuse * lightmap`: the lightmap holds irradiance over
    pi, direct and indirect, of all lamps, the world and glowing surfaces, without caustics, on the
    side that the shading normals point to. `texels` are shared out among the instances by
    how large they appear, 32 to 2048 a side; `samples` a texel are denoised. Triangles that appear
    much larger at one end are split, without a gap, so that texels can lie where they are seen.
    The .blend stays as it was. Raises `UsageError` for settings that make no sense, `MachineError`
    where Cycles fails; passes on what `progress` raises.
    """
    if samples < 1 or texels < 1:
        raise UsageError("a lightmap needs at least one sample and one texel")
    receivers = [index for index, instance in enumerate(scene.instances) if _scatters(scene, instance.materials)]
    if not receivers:
        return without_lightmaps(scene)
    scene = without_lightmaps(split_where_seen(scene, receivers, appearance(scene)))
    with cycles_engine(bpy_scene):
        key = key_of("lightmap 3", fingerprint(bpy_scene, scene), samples, texels)
        known = cache.get("lightmap", key) if cache else None
        arrays = known.arrays if known else _bake(bpy_scene, scene, receivers, samples, texels, progress)
    if cache and not known:
        cache.put("lightmap", key, arrays)
    return _with_lightmaps(scene, receivers, arrays)


def _scatters(scene: Scene, materials: tuple[int, ...]) -> bool:
    return any(scene.materials[index].diffuse > 0.0 for index in materials)


def _bake(
    bpy_scene: bpy.types.Scene, scene: Scene, receivers: list[int], samples: int, texels: int, progress: Progress
) -> dict[str, np.ndarray]:
    """Lightmaps ("image I", (S, S, 3)) by instance, and their coordinates ("uvs M", (T, 3, 2)) by mesh."""
    seen = appearance(scene)
    shown = {index: seen_area(scene, index, seen) for index in receivers}
    sizes = lightmap_sizes([float((scale**2 * area).sum()) for scale, area in shown.values()], texels)
    size_of = dict(zip(receivers, sizes, strict=True))
    uvs = {}
    for number, (mesh, users) in enumerate(users_of_meshes(scene, receivers).items()):
        progress("unwrapping", 0.1 * number / len(receivers))
        size = min(size_of[index] for index in users)
        uvs[mesh] = unwrap(scene.meshes[mesh], size, np.max([shown[index][0] for index in users], axis=0))
    places, extent = atlas_places(sizes)
    layout = []
    tiles = dict(zip(receivers, zip(places, sizes, strict=True), strict=True))
    for index, instance in enumerate(scene.instances):
        if index in tiles:
            place, size = tiles[index]
            layout.append((uvs[instance.mesh] * size + place) / extent)
        else:
            layout.append(np.full((len(scene.meshes[instance.mesh].triangles), 3, 2), _OUTSIDE))
    light, covered = _bake_atlas(bpy_scene, scene, np.concatenate(layout).astype(np.float32), extent, samples, progress)
    progress("denoising the light", 0.95)
    light = denoised(spread(light, covered, _SPREAD, hidden=covered & ~light.any(axis=-1) & _has_sky(scene)))
    arrays = {f"uvs {mesh}": coordinates for mesh, coordinates in uvs.items()}
    for index, ((x, y), size) in tiles.items():
        arrays[f"image {index}"] = light[y : y + size, x : x + size].copy()
    progress("baking light", 1.0)
    return arrays


def lightmap_sizes(areas: list[float], texels: int) -> list[int]:
    """Texels a side, powers of two, of lightmaps that together have about `texels`, shared out by `areas`."""
    shares = np.maximum(areas, 1e-12)
    sides = np.sqrt(texels * shares / shares.sum())
    return [int(size) for size in np.clip(2 ** np.round(np.log2(sides)), SMALLEST, LARGEST)]


def atlas_places(sizes: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Where squares of these sizes (powers of two) lie, (N, 2) int, and width and height of all together.

    Largest first along a Z-order curve, on which each ends where the next may begin.
    """
    order = np.argsort(sizes, kind="stable")[::-1]
    ordered = np.asarray(sizes, np.int64)[order]
    unit = ordered[-1]
    ends = np.cumsum((ordered // unit) ** 2)
    starts = ends - (ordered // unit) ** 2
    places = np.zeros((len(sizes), 2), np.int64)
    for bit in range(24):
        places[order, 0] |= (starts >> (2 * bit) & 1) << bit
        places[order, 1] |= (starts >> (2 * bit + 1) & 1) << bit
    places *= unit
    return places, (places + np.asarray(sizes)[:, None]).max(axis=0)


def _bake_atlas(
    bpy_scene: bpy.types.Scene, scene: Scene, uvs: np.ndarray, extent: np.ndarray, samples: int, progress: Progress
) -> tuple[np.ndarray, np.ndarray]:
    """All lightmaps in one image, `extent` wide and high: light (H, W, 3), row 0 at the bottom, and where it is."""
    width, height = extent.tolist()
    target = bpy.data.images.new("Catoptric lightmaps", width, height, alpha=True, float_buffer=True)
    total, covered = np.zeros((height, width, 3), np.float32), np.zeros((height, width), bool)
    pixels = np.empty(width * height * 4, np.float32)
    try:
        target.colorspace_settings.name = "Non-Color"
        target.generated_color = (0.0, 0.0, 0.0, 0.0)
        with bake_stage(bpy_scene, scene, uvs, target) as (stage, solid):
            for offset in range(0, samples, CHUNK):
                progress("baking light", 0.1 + 0.85 * offset / samples)
                length = min(CHUNK, samples - offset)
                # Pieces of one sequence: as even as if it were one, where each of its own would be so by itself.
                piece = {"use_sample_subset": True, "sample_offset": offset, "sample_subset_length": length}
                with changed(stage.cycles, samples=samples, **piece):
                    _bake_once(stage, solid)
                target.pixels.foreach_get(pixels)
                shown = pixels.reshape(height, width, 4)
                total += shown[..., :3] * (length / samples)
                covered |= shown[..., 3] > 0.5
    finally:
        bpy.data.images.remove(target)
    return total, covered


def _bake_once(stage: bpy.types.Scene, solid: bpy.types.Object) -> None:
    layer = stage.view_layers[0]
    layer.objects.active = solid
    solid.select_set(True, view_layer=layer)
    stage.render.bake.view_from = "ABOVE_SURFACE"
    chosen = {"object": solid, "active_object": solid, "selected_objects": [solid]}
    chosen |= {"scene": stage, "view_layer": layer, "selected_editable_objects": [solid]}
    with bpy.context.temp_override(**chosen), quiet():
        try:
            bpy.ops.object.bake(
                type="DIFFUSE",
                pass_filter={"DIRECT", "INDIRECT"},
                target="IMAGE_TEXTURES",
                save_mode="INTERNAL",
                use_selected_to_active=False,
                use_clear=True,
                margin=0,
            )
        except RuntimeError as error:
            raise MachineError(f"Cycles could not bake the light: {first_line(error)}") from error


def spread(light: np.ndarray, covered: np.ndarray, texels: int, hidden: "np.ndarray | bool" = False) -> np.ndarray:
    """`light` (H, W, 3) with every uncovered texel (H, W) within reach filled by the mean of its neighbours.

    What lies further off gets the mean of all, so that nothing near is darkened by a filter.
    `hidden` texels (H, W) lie inside something solid: the first two are filled as well, else the
    line where it meets the surface is dark; the others stay black.
    """
    hidden = covered & hidden
    known = (covered & ~hidden).astype(np.float32)
    filled = np.where(known[..., None] > 0, light, 0.0).astype(np.float32)
    mean = filled.sum(axis=(0, 1)) / max(known.sum(), 1.0)
    for step in range(texels):
        weight, total = _neighbours(known), _neighbours(filled)
        fresh = (known == 0) & (weight > 0)
        filled[fresh] = total[fresh] / weight[fresh, None]
        known[fresh] = 1.0
        if step == 1:
            known[hidden] = 1.0
    filled[known == 0] = mean
    return filled


def _has_sky(scene: Scene) -> bool:
    """Whether the world shines: then a texel that no light reaches at all is not in shadow but walled in."""
    return scene.world.panorama is not None or any(scene.world.color)


def _neighbours(values: np.ndarray) -> np.ndarray:
    """The sum of each texel and the eight around it."""
    padded = np.pad(values, [(1, 1), (1, 1)] + [(0, 0)] * (values.ndim - 2))
    rows = padded[:-2] + padded[1:-1] + padded[2:]
    return rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:]


def _with_lightmaps(scene: Scene, receivers: list[int], arrays: dict[str, np.ndarray]) -> Scene:
    meshes = [replace(mesh, lightmap_uvs=arrays.get(f"uvs {number}")) for number, mesh in enumerate(scene.meshes)]
    instances, images = list(scene.instances), list(scene.images)
    for index in receivers:
        light = arrays[f"image {index}"]
        pixels = np.dstack([light, np.ones(light.shape[:2], np.float32)])
        images.append(Image(f"{LIGHTMAP_NAME}{instances[index].name}", pixels))
        instances[index] = replace(instances[index], lightmap=len(images) - 1)
    return replace(scene, meshes=tuple(meshes), instances=tuple(instances), images=tuple(images))
