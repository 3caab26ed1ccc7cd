"""Bakes for game engines: textures, catoptric.json that says what lies where, and the GLSL that samples them."""

import json
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..cache import Cache
from ..drawing import Resident, world_boxes
from ..errors import SceneError, UsageError
from ..gl import on_gl_thread
from ..parameters import Parameter, Value, resolve
from ..progress import Progress, part_of, silent
from ..scene import Lighting, Scene
from .engine_export_cubes import cross, cross_layout, cube_map
from .engine_export_ktx2 import why_no_ktx2, write_ktx2
from .environment import EnvironmentCubes
from .files import free_stem, made_folder, whole, write_exr
from .layered_depth import FACES, LAYERS, RESOLUTION, LayeredDepth, each_bake
from .layered_depth_atlas import CHANNELS, atlas
from .surroundings import surroundings

SCHEMA = 1
"""Of catoptric.json; goes up when its meaning changes."""

CUBE_SIZE = Parameter(
    "cube_size", "Cube size", 256, "Texels along a face of a reflector's cube", unit="texels", minimum=16, maximum=4094
)

PARAMETERS = (RESOLUTION, LAYERS, CUBE_SIZE)
"""What `export_for_engine` can be told."""

_ROOT = Path(__file__).resolve().parents[2]
_GLSL = _ROOT / "gpu_shaders" / "engine" / "catoptric.glsl"
_RGBA = ("R", "G", "B", "A")
_TEXTURES = {"color_depth": ("R", "G", "B", "Z"), "normal_count": ("N.X", "N.Y", "N.Z", "layers")}
_HALF = 65504.0
_MEANING = {
    "length": "metres",
    "world": "right-handed, Z up",
    "matrices": "row-major, for column vectors",
    "radiance": "scene-linear, Rec.709 primaries, not clamped in color_depth, up to 65504 in cubes",
    "depth": "linear, 0 at the face to 1 at the opposite one; 1 where a texel has no such layer",
    "normal": "in the object's space",
    "rows": "row 0 of a file is its top; left and top are texels from there",
    "faces": "u runs rightwards and v upwards, along axes of the object's space",
    "cubes": "for texture(samplerCube, direction.xzy) with a direction of the world",
}


@dataclass
class Exported:
    """The files that were written, catoptric.json last, and what a person should know, a sentence each."""

    written: list[Path] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@on_gl_thread
def export_for_engine(
    scene: Scene,
    lighting: Lighting,
    objects: Iterable[str | int] | None,
    folder: Path,
    settings: dict[str, Value] | None = None,
    cache: Cache | None = None,
    progress: Progress = silent,
) -> Exported:
    """Bake `objects` (names or indices of instances, None for all) and write them to `folder` as an engine takes them.

    An object becomes a layered depth atlas, two RGBA textures a layer (Zhang et al., 3.3 and 3.4); a reflector
    becomes a cube of what it sees from its centre, but for itself and the objects that became an atlas.
    Objects without an inside, or around a reflector, stay in the cubes. `settings` may hold PARAMETERS.
    catoptric.json comes last, so that it names no file that is not there. Raises a `CatoptricError` with one line.
    """
    chosen = resolve(PARAMETERS, settings or {})
    selected = _selected(scene, objects)
    made_folder(folder)
    resident = Resident(scene, lighting)
    try:
        export = _Export(resident, selected, Path(folder))
        export.write_objects(chosen, cache, part_of(progress, 0.0, 0.7))
        export.write_cubes(chosen[CUBE_SIZE.name], part_of(progress, 0.7, 1.0))
        return export.finish()
    finally:
        resident.release()


def _selected(scene: Scene, objects: Iterable[str | int] | None) -> frozenset[int]:
    """Instances by name or index; a name stands for every instance that bears it."""
    names = [instance.name for instance in scene.instances]
    if objects is None:
        return frozenset(range(len(names)))
    selected: set[int] = set()
    for wanted in objects:
        found = {index for index, name in enumerate(names) if wanted in (name, index)}
        if not found:
            raise UsageError(f"no object {wanted!r} to export; there are: {', '.join(dict.fromkeys(names))}")
        selected |= found
    return frozenset(selected)


class _Export:
    """The files of one export as they come; on the GL thread."""

    def __init__(self, resident: Resident, selected: frozenset[int], folder: Path) -> None:
        self._resident, self._scene, self._folder = resident, resident.scene, folder
        self._selected = selected
        self._stems: set[str] = set()
        self._searched: set[int] = set()
        self._objects: list[dict] = []
        self._cubes: list[dict] = []
        self._left_out: list[dict] = []
        self._exported = Exported()
        self._no_ktx2 = why_no_ktx2()
        if self._no_ktx2:
            self._exported.notes.append(self._no_ktx2)

    def write_objects(self, settings: dict[str, Value], cache: Cache | None, progress: Progress) -> None:
        """Write the atlases of what is selected and can be searched."""
        scene = self._scene
        around = self._selected & surroundings(scene)
        self._leave_out(around, "a reflector stands in its box")
        unseen = {index for index in self._selected if not scene.instances[index].in_reflections}
        self._leave_out(unseen - around, "reflections do not see it")
        alone = set(scene.reflectors) if len(scene.reflectors) == 1 else set()
        without = frozenset(range(len(scene.instances))) - (self._selected - around - unseen - alone)
        bake_settings = {name: settings[name] for name in (RESOLUTION.name, LAYERS.name)}
        for instances, bake in each_bake(self._resident, bake_settings, cache, progress, without):
            if bake.has_inside:
                self._objects.append(self._write_object(instances, bake))
                self._searched |= set(instances)
            else:
                self._leave_out(instances, "it is open and has no inside to search")

    def write_cubes(self, size: int, progress: Progress) -> None:
        """Write the cubes of the reflectors that are selected."""
        reflectors = self._scene.reflectors
        if not self._selected & set(reflectors):
            return
        cubes = EnvironmentCubes(self._resident, size + 2, frozenset(self._searched), progress=progress)
        try:
            captured = cubes.read()
        finally:
            cubes.release()
        for done, (reflector, cube) in enumerate(zip(reflectors, captured, strict=True)):
            if reflector in self._selected:
                progress("writing environment cubes", done / len(reflectors))
                self._cubes.append(self._write_cube(reflector, cube_map(cube).clip(-_HALF, _HALF)))

    def finish(self) -> Exported:
        """Write the GLSL and catoptric.json."""
        if not self._objects and not self._cubes:
            reasons = "; ".join(f"{entry['object']}: {entry['reason']}" for entry in self._left_out)
            raise SceneError(f"nothing to export; select a reflector or a closed object ({reasons or 'none is there'})")
        self._write_text("catoptric.glsl", _GLSL.read_text(encoding="utf-8"))
        self._write_text("catoptric.json", json.dumps(self._description(), indent=1, ensure_ascii=False) + "\n")
        left_out = (f"{entry['object']} stays in the cubes: {entry['reason']}" for entry in self._left_out)
        self._exported.notes += left_out
        return self._exported

    def _leave_out(self, instances: Iterable[int], reason: str) -> None:
        names = (self._scene.instances[index].name for index in sorted(instances))
        self._left_out += [{"object": name, "reason": reason} for name in names]

    def _write_object(self, instances: Sequence[int], bake: LayeredDepth) -> dict:
        stem = free_stem(self._scene.instances[instances[0]].name, self._stems)
        files: dict[str, list[str]] = {name: [] for name in _TEXTURES}
        for layer in range(bake.layers):
            pixels = atlas(bake, layer)
            for name, channels in _TEXTURES.items():
                path = self._path(f"{stem}_{name}_layer-{layer + 1}.exr")
                write_exr(path, pixels[..., [CHANNELS.index(channel) for channel in channels]], _RGBA)
                files[name].append(path.name)
        if bake.cut[1]:
            self._exported.notes.append(f"{bake.name}: {bake.cut[1]} texels have more layers than were asked for")
        placed = [self._scene.instances[index] for index in instances]
        return {
            "mesh": bake.name,
            "instances": [{"name": one.name, "object_to_world": one.matrix.tolist()} for one in placed],
            "box": {"low": bake.low.tolist(), "size": bake.size.tolist()},
            "texels": _texels(bake),
            "layers": bake.layers,
            "cut": {"fragments": bake.cut[0], "texels": bake.cut[1]},
            "textures": {name: self._texture(f"{stem}_{name}", files[name], pixels.shape) for name in _TEXTURES},
            "faces": _atlas_layout(bake),
        }

    def _texture(self, stem: str, files: list[str], shape: tuple[int, ...]) -> dict:
        """The entry of one array of atlases, which is written as KTX2 as well where that can be."""
        entry = {"format": "RGBA 32-bit float", "width": shape[1], "height": shape[0], "files": files, "ktx2": None}
        if not self._no_ktx2:
            import OpenImageIO as oiio

            layers = [oiio.ImageBuf(str(self._folder / file)).get_pixels(oiio.FLOAT) for file in files]
            path = self._path(f"{stem}.ktx2")
            write_ktx2(path, np.stack(layers)[:, None], array=True)
            entry["ktx2"] = path.name
        return entry

    def _write_cube(self, reflector: int, faces: np.ndarray) -> dict:
        """`faces` (6, N, N, 3) as `cube_map` orders them."""
        instance, size = self._scene.instances[reflector], faces.shape[1]
        stem = f"{free_stem(instance.name, self._stems)}_cube"
        path = self._path(f"{stem}.exr")
        write_exr(path, cross(faces), _RGBA[:3], half=True)
        entry = {
            "reflector": instance.name,
            "object_to_world": instance.matrix.tolist(),
            "centre": world_boxes(self._scene, [reflector])[0].mean(axis=0).tolist(),
            "size": size,
            "file": path.name,
            "format": "RGB 16-bit float",
            "ktx2": None,
            "without": [self._scene.instances[index].name for index in sorted(self._searched | {reflector})],
            "faces": cross_layout(size),
        }
        if not self._no_ktx2:
            opaque = np.ones((*faces.shape[:3], 4), np.float16)
            opaque[..., :3] = faces
            path = self._path(f"{stem}.ktx2")
            write_ktx2(path, opaque[None])
            entry["ktx2"] = path.name
        return entry

    def _description(self) -> dict:
        manifest = tomllib.loads((_ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
        return {
            "schema": SCHEMA,
            "generator": f"{manifest['id']} {manifest['version']}",
            "scene": self._scene.name,
            "frame": self._scene.frame,
            "lighting": self._resident.lighting.value,
            "meaning": _MEANING,
            "glsl": "catoptric.glsl",
            "objects": self._objects,
            "cubes": self._cubes,
            "left_out": self._left_out,
        }

    def _path(self, name: str) -> Path:
        self._exported.written.append(self._folder / name)
        return self._exported.written[-1]

    def _write_text(self, name: str, text: str) -> None:
        with whole(self._path(name)) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _texels(bake: LayeredDepth) -> list[int]:
    """Texels along x, y and z of the box: what the faces along Y (columns along z) and Z (along x and y) have."""
    rows, columns = bake.axes[2].counts.shape
    return [columns, rows, bake.axes[1].counts.shape[1]]


def _atlas_layout(bake: LayeredDepth) -> dict[str, dict[str, object]]:
    """Of each face: its upper left texel in the atlas, its size, and the axes of the object that u and v follow."""
    cell = max(_texels(bake))
    layout = {}
    for index, name in enumerate(FACES):
        axis = index // 2
        rows, columns = bake.axes[axis].counts.shape
        layout[name] = {
            "left": axis * cell,
            "top": (1 + index % 2) * cell - rows,
            "columns": columns,
            "rows": rows,
            "u": "+" + "XYZ"[(axis + 1) % 3],
            "v": "+" + "XYZ"[(axis + 2) % 3],
        }
    return layout
