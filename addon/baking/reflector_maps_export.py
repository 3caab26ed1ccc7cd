"""Reflector cube maps as pictures: one EXR file a reflector, one part of it for each part of the reflector."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..cache import Cache
from ..errors import SceneError
from ..parameters import Value, resolve
from ..progress import Progress, part_of, silent
from ..scene import Scene
from .files import free_stem, made_folder, write_exr_parts
from .reflector_maps import BORDER, FINER, SIZE, SPREAD, ReflectorMap, reflector_maps

PARAMETERS = (SIZE, FINER, SPREAD)
"""What `export_maps` can be told."""

CHANNELS = ("P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "covered")
"""Position from the part's centre and normal, along the axes of its frame; 1 where the reflector itself is, else 0."""

_PREFIX = "catoptric:"
_LAYOUT = "+X -X +Y -Y +Z -Z side by side, a patch +Z alone; u and v along the two axes after the face's own, u the \
other way on + faces"


class StoredMap(NamedTuple):
    """One part as `read_maps` finds it: arrays as of a `ReflectorMap`, and what the file says beside them."""

    positions: np.ndarray
    normals: np.ndarray
    covered: np.ndarray
    metadata: dict[str, object]


def export_maps(
    scene: Scene,
    directory: Path,
    settings: dict[str, Value] | None = None,
    cache: Cache | None = None,
    progress: Progress = silent,
) -> list[Path]:
    """Bake the maps of every reflector of `scene` and write them to `directory`; returns the files.

    Instances of one mesh share a file. `settings` may hold PARAMETERS. Raises a `CatoptricError` with one line.
    """
    chosen, directory = resolve(PARAMETERS, settings or {}), made_folder(directory)
    users: dict[int, list[int]] = {}
    for index in scene.reflectors:
        users.setdefault(scene.instances[index].mesh, []).append(index)
    written: list[Path] = []
    stems: set[str] = set()
    for done, (mesh, instances) in enumerate(users.items()):
        share = part_of(progress, done / len(users), (done + 1) / len(users))
        maps = reflector_maps(scene.meshes[mesh], chosen, cache, share)
        if maps:
            stem = free_stem(scene.instances[instances[0]].name, stems)
            written.append(directory / f"{stem}_reflector-maps.exr")
            parts = [(strip(one), _metadata(one, number, scene, instances)) for number, one in enumerate(maps)]
            write_exr_parts(written[-1], parts, CHANNELS)
    return written


def strip(one: ReflectorMap) -> np.ndarray:
    """(N, F × N, 7) float32: the faces of a map side by side, row 0 the top."""
    texels = np.concatenate([one.positions, one.normals, one.covered[..., None]], axis=3, dtype=np.float32)
    return texels[:, ::-1].transpose(1, 0, 2, 3).reshape(one.size, -1, len(CHANNELS))


def read_maps(path: Path) -> list[StoredMap]:
    """What `export_maps` wrote, bit by bit. Raises `SceneError` for a file that is none of ours or damaged."""
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise SceneError(f"cannot read {path}: {oiio.geterror()}")
    maps: list[StoredMap] = []
    while source.seek_subimage(len(maps), 0):
        spec = source.spec()
        pixels = source.read_image(len(maps), 0, 0, spec.nchannels, oiio.FLOAT)
        if pixels is None or not set(CHANNELS) <= set(spec.channelnames):
            raise SceneError(f"{path} holds no reflector maps, or is damaged: bake them again")
        texels = pixels[..., [spec.channelnames.index(name) for name in CHANNELS]]
        faces = texels.reshape(spec.height, -1, spec.height, len(CHANNELS)).transpose(1, 0, 2, 3)[:, ::-1]
        mine = [entry for entry in spec.extra_attribs if entry.name.startswith(_PREFIX)]
        metadata = {entry.name.removeprefix(_PREFIX): json.loads(entry.value) for entry in mine}
        maps.append(StoredMap(faces[..., :3], faces[..., 3:6], faces[..., 6] > 0.0, metadata))
    source.close()
    return maps


def _metadata(one: ReflectorMap, number: int, scene: Scene, instances: Sequence[int]) -> dict[str, str]:
    """What a part's picture says, as JSON by attribute."""
    said = {
        "object": scene.instances[instances[0]].name,
        "mesh": scene.meshes[scene.instances[instances[0]].mesh].name,
        "part": number + 1,
        "layout": _LAYOUT,
        "border_texels": BORDER,
        "reach": one.reach,
        "reach_meaning": "tangent of the angle between a face's middle and its side, border apart",
        "centre": one.part.centre.tolist(),
        "frame": one.part.frame.tolist(),
        "frame_meaning": "rows are the part's right, up and axis in the mesh's space",
        "curvature": one.part.curvature.name.lower(),
        "triangles": len(one.part.triangles),
        "transforms": {scene.instances[index].name: scene.instances[index].matrix.tolist() for index in instances},
        "units": "metres",
    }
    return {_PREFIX + key: json.dumps(value) for key, value in said.items()}
