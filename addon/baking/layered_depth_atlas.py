"""Layered depth textures as pictures: the packed atlas of Zhang et al., figure 3, one EXR file a layer."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from ..cache import Cache
from ..drawing import Resident
from ..errors import SceneError
from ..gl import on_gl_thread
from ..parameters import Value, resolve
from ..progress import Progress, silent
from ..scene import Lighting, Scene
from .files import free_stem, made_folder, write_exr
from .layered_depth import FACES, LAYERS, RESOLUTION, FaceLayers, LayeredDepth, each_bake

CHANNELS = ("R", "G", "B", "Z", "ZBack", "N.X", "N.Y", "N.Z", "layers")
"""Radiance, entry and exit depth (0 at the face to 1 across the box), normal in the mesh's space, layer count."""

_PREFIX = "catoptric:"
_LAYOUT = "+X +Y +Z above -X -Y -Z; in each, u rightwards and v upwards along the two axes after the face's own"


def atlas(bake: LayeredDepth, layer: int) -> np.ndarray:
    """(2 × cell rows, 3 × cell columns, 9) float32: layer `layer` (0 is the nearest) of all six faces.

    Row 0 is the top. The faces +X +Y +Z stand above -X -Y -Z, each at the lower left of a cell as large
    as the largest face. Where a texel has no such layer, both depths are 1 and the rest is 0, but for
    the last channel, which counts the texel's layers.
    """
    shapes = [axis.counts.shape for axis in bake.axes]
    rows, columns = (max(side) for side in zip(*shapes, strict=True))
    packed = np.zeros((2, rows, 3, columns, len(CHANNELS)), np.float32)
    packed[..., 3:5] = 1.0
    for index, name in enumerate(FACES):
        height, width = shapes[index // 2]
        packed[1 - index % 2, :height, index // 2, :width] = _picture(bake.face(name), layer)
    return packed.reshape(2 * rows, 3 * columns, -1)[::-1].copy()


def _picture(face: FaceLayers, layer: int) -> np.ndarray:
    picture = np.zeros((*face.counts.shape, len(CHANNELS)), np.float32)
    picture[..., 3:5] = 1.0
    picture[..., 8] = face.counts
    rows, texels = face.layer(layer)
    flat = picture.reshape(-1, len(CHANNELS))
    flat[texels, :3] = face.colors[rows, 0]
    flat[texels, 3:5] = face.depths[rows]
    flat[texels, 5:8] = face.normals[rows, 0]
    return picture


def write_atlas(path: Path, pixels: np.ndarray, metadata: dict[str, object]) -> None:
    """Write an atlas as 32-bit EXR; it appears whole or not at all.

    `metadata` is kept as JSON, one attribute a key. Raises `MachineError` where it cannot be written.
    """
    write_exr(path, pixels, CHANNELS, {_PREFIX + key: json.dumps(value) for key, value in metadata.items()})


def read_atlas(path: Path) -> tuple[np.ndarray, dict[str, object]]:
    """What `write_atlas` wrote: pixels (H, W, 9) float32 in the order of CHANNELS, and the metadata.

    Raises `SceneError` for a file that is none of ours or damaged.
    """
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise SceneError(f"cannot read {path}: {oiio.geterror()}")
    spec = source.spec()
    pixels = source.read_image(oiio.FLOAT)
    source.close()
    if pixels is None or not set(CHANNELS) <= set(spec.channelnames):
        raise SceneError(f"{path} is no layered depth texture, or damaged: bake it again")
    order = [spec.channelnames.index(name) for name in CHANNELS]
    mine = [entry for entry in spec.extra_attribs if entry.name.startswith(_PREFIX)]
    return pixels[..., order], {entry.name.removeprefix(_PREFIX): json.loads(entry.value) for entry in mine}


def _export_each(
    bakes: Iterable[tuple[Sequence[int], LayeredDepth]], scene: Scene, directory: Path, progress: Progress
) -> list[Path]:
    """Write bakes as they come, each with its instances, so that no more than one need be held."""
    written: list[Path] = []
    stems: set[str] = set()
    for instances, bake in bakes:
        stem = free_stem(scene.instances[instances[0]].name, stems)
        for layer in range(max(1, bake.layers)):
            progress(f"writing {stem}", (instances[0] + layer / max(1, bake.layers)) / len(scene.instances))
            written.append(directory / f"{stem}_layer-{layer + 1}.exr")
            write_atlas(written[-1], atlas(bake, layer), _metadata(bake, layer, scene, instances))
    return written


def _metadata(bake: LayeredDepth, layer: int, scene: Scene, instances: Sequence[int]) -> dict[str, object]:
    shapes = {name: list(bake.axes[index // 2].counts.shape) for index, name in enumerate(FACES)}
    return {
        "object": scene.instances[instances[0]].name,
        "mesh": bake.name,
        "layer": layer + 1,
        "layers": bake.layers,
        "layout": _LAYOUT,
        "face_rows_and_columns": shapes,
        "depth_range": [0.0, 1.0],
        "depth_meaning": "linear, 0 at the face to 1 at the opposite one",
        "box_low": bake.low.tolist(),
        "box_size": bake.size.tolist(),
        "transforms": {scene.instances[index].name: scene.instances[index].matrix.tolist() for index in instances},
        "units": "metres; radiance scene-linear",
        "cut_fragments_and_texels": list(bake.cut),
    }


@on_gl_thread
def bake_scene(
    scene: Scene,
    lighting: Lighting,
    directory: Path,
    settings: dict[str, Value] | None = None,
    cache: Cache | None = None,
    progress: Progress = silent,
) -> list[Path]:
    """Bake every reflected object of `scene` and write the atlases to `directory`; returns the files.

    `settings` may hold RESOLUTION and LAYERS. Raises a `CatoptricError` with one line that says what to do.
    """
    chosen = resolve((RESOLUTION, LAYERS), settings or {})
    directory = made_folder(directory)
    resident = Resident(scene, lighting)
    try:
        return _export_each(each_bake(resident, chosen, cache, progress), scene, directory, progress)
    finally:
        resident.release()
