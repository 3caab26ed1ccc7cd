"""Layered depth textures of an object (Zhang et al., 3.3, 3.4): what its box's six faces see, all layers deep."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..cache import Cache
from ..drawing import Resident
from ..errors import UsageError
from ..gl import on_gl_thread
from ..parameters import Parameter
from ..progress import Progress, part_of, silent
from ..scene import Mesh
from .layered_depth_keys import keys_of
from .layered_depth_pairs import pair
from .layered_depth_peel import Peeler
from .layered_depth_shade import Shader
from .layered_depth_solids import solid_triangles

RESOLUTION = Parameter(
    "resolution",
    "Resolution",
    512,
    "Texels along the longest side of an object's box",
    unit="texels",
    minimum=16,
    maximum=2048,
    section="Zhang et al., 3.3",
)
LAYERS = Parameter(
    "layers",
    "Most layers",
    64,
    "Layers that each face peels before the rest is cut; what is cut is reported",
    minimum=1,
    maximum=1024,
    section="Zhang et al., 3.4",
)

FACES = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")
"""The faces of a box, in the house's order."""

KIND = "layered-depth"
"""Of the entries in the cache."""

_PADDING = 1e-3


@dataclass(frozen=True, eq=False)
class FaceLayers:
    """What one face of the box sees. N columns along u, M rows along v, L layers.

    u lies along the axis after the face's own, v along the one after that, in the direction of the
    axes on both faces of a pair. `counts` (M, N) int32 layers of each texel. The rest holds the layers
    of all texels, texel by texel (u fastest), nearest first: `depths` (L, 2) float32 entry and exit, 0
    at this face to 1 at the opposite one, equal where the surface has no thickness; `triangles` (L, 2)
    int32 that are crossed there; `colors` (L, 2, 3) float32 radiance and `normals` (L, 2, 3) float32
    unit shading normals in the mesh's space, of the entry as this face sees it and of the exit as the
    opposite face does.
    """

    counts: np.ndarray
    depths: np.ndarray
    triangles: np.ndarray
    colors: np.ndarray
    normals: np.ndarray

    @cached_property
    def first(self) -> np.ndarray:
        """(M, N) int64 row of each texel's first layer."""
        return (np.cumsum(self.counts) - self.counts.ravel()).reshape(self.counts.shape)

    def layer(self, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Rows (K,) of layer `index` (0 is the nearest) and the texels (K,) they belong to."""
        texels = np.flatnonzero(self.counts.ravel() > index)
        return self.first.ravel()[texels] + index, texels

    def opposite(self) -> "FaceLayers":
        """What the face across the box sees: the same crossings, last first. Exact but for 1 - depth."""
        total = len(self.depths)
        start, count = self.first.ravel(), self.counts.ravel()
        ends = np.repeat(2 * start + count - 1, count)
        order = ends - np.arange(total)
        return FaceLayers(
            self.counts,
            np.float32(1.0) - self.depths[order, ::-1],
            self.triangles[order, ::-1],
            self.colors[order, ::-1],
            self.normals[order, ::-1],
        )


@dataclass(frozen=True, eq=False)
class LayeredDepth:
    """The layered depth textures of one mesh, in its own space.

    `name` of the mesh; `low` and `size` (3,) float64 metres of the box, a little larger than the mesh;
    `axes`: what the faces -X, -Y and -Z see, of which the opposite ones follow; `hidden` crossings
    inside a solid, which are in no layer; `cut` fragments that the cap on layers left out between
    opposite faces, and the texels that miss some.
    """

    name: str
    low: np.ndarray
    size: np.ndarray
    axes: tuple[FaceLayers, FaceLayers, FaceLayers]
    hidden: int
    cut: tuple[int, int]

    @property
    def layers(self) -> int:
        """Most layers that any texel has."""
        return max(int(axis.counts.max()) for axis in self.axes)

    @property
    def has_inside(self) -> bool:
        """Whether any layer has thickness; a mesh that is open everywhere has none."""
        return any((axis.depths[:, 0] < axis.depths[:, 1]).any() for axis in self.axes)

    @property
    def size_bytes(self) -> int:
        """Memory of the arrays."""
        return sum(array.nbytes for axis in self.axes for array in vars(axis).values() if array is not None)

    def face(self, name: str) -> FaceLayers:
        """The face of that name, one of FACES; raises `UsageError` for another."""
        if name not in FACES:
            raise UsageError(f"no face {name!r}; there are: {', '.join(FACES)}")
        low = self.axes["XYZ".index(name[1])]
        return low if name[0] == "-" else low.opposite()


@on_gl_thread
def bake_layers(
    resident: Resident,
    settings: dict,
    cache: Cache | None = None,
    progress: Progress = silent,
    without: frozenset[int] = frozenset(),
) -> list[LayeredDepth | None]:
    """One bake for each instance of the scene, None for those that reflections do not see and those `without`.

    `settings` holds the values of RESOLUTION and LAYERS. Instances with the same mesh, materials and
    light share theirs; what `cache` holds is not baked again. Raises `MachineError` where a table is
    larger than the GPU's textures.
    """
    bakes: list[LayeredDepth | None] = [None] * len(resident.scene.instances)
    for instances, bake in each_bake(resident, settings, cache, progress, without):
        for index in instances:
            bakes[index] = bake
    return bakes


def each_bake(
    resident: Resident,
    settings: dict,
    cache: Cache | None = None,
    progress: Progress = silent,
    without: frozenset[int] = frozenset(),
) -> Iterator[tuple[tuple[int, ...], LayeredDepth]]:
    """The bakes of `bake_layers` one by one, each with its instances; on the GL thread."""
    sharing: dict[str, list[int]] = {}
    keys = keys_of(resident.scene, resident.lighting, settings["resolution"], settings["layers"])
    for index, key in enumerate(keys):
        if key is not None and index not in without:
            sharing.setdefault(key, []).append(index)
    for done, (key, instances) in enumerate(sharing.items()):
        share = part_of(progress, done / len(sharing), (done + 1) / len(sharing))
        share("baking layered depth textures", 0.0)
        kept = cache.get(KIND, key) if cache else None
        bake = _unpacked(*kept) if kept else bake_instance(resident, instances[0], **settings, progress=share)
        if cache and not kept:
            cache.put(KIND, key, *_packed(bake))
        yield tuple(instances), bake
    progress("baking layered depth textures", 1.0)


@on_gl_thread
def bake_instance(
    resident: Resident,
    instance: int,
    resolution: int = RESOLUTION.default,
    layers: int = LAYERS.default,
    progress: Progress = silent,
) -> LayeredDepth:
    """The layered depth textures of one instance's mesh, lit as the instance is."""
    mesh = resident.scene.meshes[resident.scene.instances[instance].mesh]
    low, size, shapes = face_shapes(mesh, resolution)
    places = ((mesh.positions.astype(np.float64) - low) / size).astype(np.float32)
    peeler = Peeler(places, mesh.triangles, solid_triangles(mesh.positions, mesh.triangles))
    shader = Shader(resident, instance, low, size)
    axes, hidden, cut = [], 0, np.zeros(2, np.int64)
    try:
        for axis, shape in enumerate(shapes):
            crossings = peeler.peel(axis, shape, 2 * layers, part_of(progress, axis / 3, (axis + 1) / 3))
            found = pair(crossings)
            colors, normals = shader.shade(axis, shape, found.texel, found.triangle)
            counts = np.bincount(found.texel, minlength=shape[0] * shape[1]).astype(np.int32)
            axes.append(FaceLayers(counts.reshape(shape[::-1]), found.depth, found.triangle, colors, normals))
            hidden += found.hidden
            cut += crossings.cut
    finally:
        peeler.release()
    return LayeredDepth(mesh.name, low, size, tuple(axes), hidden, (int(cut[0]), int(cut[1])))


def face_shapes(mesh: Mesh, resolution: int) -> tuple[np.ndarray, np.ndarray, list[tuple[int, int]]]:
    """The box's low corner and size (3,) float64, and the texels along u and v of each axis' faces.

    Texels are as near to square as whole numbers of them allow; the longest side has `resolution`.
    """
    low, high = mesh.bounds.astype(np.float64)
    padding = _PADDING * (high - low).max() + 1e-6 * np.abs(mesh.bounds).max() + 1e-9
    low, size = low - padding, high - low + 2.0 * padding
    texels = np.clip(np.round(resolution * size / size.max()), 1, resolution).astype(int)
    return low, size, [(int(texels[(axis + 1) % 3]), int(texels[(axis + 2) % 3])) for axis in range(3)]


def _packed(bake: LayeredDepth) -> tuple[dict[str, np.ndarray], dict]:
    arrays = {f"{axis}_{name}": getattr(bake.axes[axis], name) for axis in range(3) for name in _fields()}
    meta = {"name": bake.name, "hidden": bake.hidden, "cut": bake.cut}
    return {**arrays, "low": bake.low, "size": bake.size}, meta


def _unpacked(arrays: dict[str, np.ndarray], meta: dict) -> LayeredDepth:
    axes = tuple(FaceLayers(*(arrays[f"{axis}_{name}"] for name in _fields())) for axis in range(3))
    return LayeredDepth(meta["name"], arrays["low"], arrays["size"], axes, meta["hidden"], tuple(meta["cut"]))


def _fields() -> tuple[str, ...]:
    return tuple(FaceLayers.__dataclass_fields__)
