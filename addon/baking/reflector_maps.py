"""Reflector cube maps (Estalella et al., 4.1): where each part of a reflector lies, and which way it faces."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ..cache import Cache, key_of
from ..gl import clear, on_gl_thread, program, read_back, require
from ..parameters import Parameter, Value
from ..progress import Progress, part_of, silent
from ..scene import Mesh, Scene
from ..tracing import Curvature, StarPart, star_parts
from .finer import finer, met_by
from .grow import grown

_SECTION = "Estalella et al., 4.1"

SIZE = Parameter(
    "map_size",
    "Map size",
    256,
    "Texels along a face of a reflector's cube maps; a patch of a reflector has a quarter of them, or fewer",
    unit="texels",
    minimum=16,
    maximum=2048,
    section=_SECTION,
)
FINER = Parameter(
    "finer",
    "Finer by",
    1,
    "How often each triangle of a reflector is quartered for its maps, onto the surface that its normals stand for",
    minimum=0,
    maximum=4,
    section=_SECTION,
)
SPREAD = Parameter(
    "spread",
    "Spread",
    20.0,
    "How far the normals of a patch may turn; a closed convex reflector is a single part whatever it is",
    unit="degrees",
    minimum=5.0,
    maximum=60.0,
    section="Estalella et al., 6.2",
)

KIND = "reflector-maps"
"""Of the entries in the cache."""

BORDER = 1
"""Texels around each face, so that what lies between its outer texels and the next face's is on both."""

_LEAST_LIKE_A_BALL = 1e-4
"""Of an ellipsoid: the inverse square of its longest half axis, in mean radii."""

_LEAST_PATCH = 8
"""Texels along the face of a patch, however few triangles it has."""

_LEAST_NEAR = 0.25
"""How near what is made up is at least, of how near the farthest texel is that the reflector covers."""

_AT_ONCE = 1 << 18
"""Texels whose rays meet the reflector at once: so much memory is needed."""

_PATCH_FACE = 4
"""A patch lies before its frame's third axis: on the face +Z."""

_KEPT: "WeakKeyDictionary[Mesh, tuple[tuple[Value, ...], list[ReflectorMap]]]" = WeakKeyDictionary()
"""The maps that a mesh had last, and the settings they were made with."""


@dataclass(frozen=True, eq=False)
class ReflectorMap:
    """The maps of one part. F faces (all six of a whole body, the one of a patch) of N × N texels.

    `positions` (F, N, N, 3) float32 metres from the part's centre, along the axes of its frame, row 0 at the
    bottom; `normals` (F, N, N, 3) float32, of unit length, along the same axes; `covered` (F, N, N) bool, whether
    the reflector itself is there: the rest goes on as its neighbours do, which closes what is open.
    """

    part: StarPart
    positions: np.ndarray
    normals: np.ndarray
    covered: np.ndarray

    @property
    def size(self) -> int:
        """Texels along a face, border included."""
        return self.positions.shape[1]

    @property
    def reach(self) -> float:
        """Tangent of the angle between a face's middle and its side, border apart."""
        return self.part.reach if np.isfinite(self.part.reach) else 1.0

    @property
    def is_whole(self) -> bool:
        """Whether all six faces are there."""
        return len(self.positions) == 6

    def shown(self) -> np.ndarray:
        """(N, 3) positions where the reflector itself is, N ≥ 1."""
        return self.positions[self.covered]

    @cached_property
    def radius(self) -> float:
        """Metres from the centre to the reflector, in the mean."""
        return float(np.linalg.norm(self.shown(), axis=1).mean())

    @cached_property
    def ball(self) -> np.ndarray:
        """(3, 3) float64: takes the unit sphere to the ellipsoid around the centre that is nearest to the reflector."""
        x, y, z = self.shown().T.astype(np.float64) / self.radius
        squares = np.stack([x * x, y * y, z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z])
        xx, yy, zz, xy, xz, yz = np.linalg.solve(squares @ squares.T, squares.sum(axis=1))
        values, vectors = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        # What is no more like an ellipsoid than this is taken for a sphere.
        values = values if values.min() > _LEAST_LIKE_A_BALL else np.ones(3)
        return self.radius * (vectors / np.sqrt(values)) @ vectors.T

    @cached_property
    def turn(self) -> float:
        """Sine of how far the normals turn from their mean; 1 for a whole body."""
        normals = self.normals[self.covered]
        mean = normals.mean(axis=0)
        mean /= max(np.linalg.norm(mean), 1e-12)
        cosine = float((normals @ mean).min())
        return 1.0 if self.is_whole or cosine < 0.0 else float(np.sqrt(max(0.0, 1.0 - cosine * cosine)))

    @cached_property
    def to_mesh(self) -> np.ndarray:
        """(4, 4) float64 from the part's frame to the mesh's space."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.part.frame.T
        matrix[:3, 3] = self.part.centre
        return matrix


def reflector_maps(
    mesh: Mesh, settings: dict, cache: Cache | None = None, progress: Progress = silent
) -> list[ReflectorMap]:
    """The maps of every part of a mesh.

    `settings` holds the values of SIZE, FINER and SPREAD; what `cache` holds is not baked again.
    """
    size, levels, spread = settings[SIZE.name], settings[FINER.name], settings[SPREAD.name]
    key = key_of(KIND, 6, mesh.positions, mesh.triangles, mesh.normals, size, levels, spread)
    if cache and (kept := cache.get(KIND, key)):
        return _unpacked(kept.arrays)
    progress("splitting reflectors", 0.0)
    parts = star_parts(mesh.positions, mesh.triangles, mesh.normals, spread)
    maps = []
    for number, part in enumerate(parts):
        progress("baking reflector maps", number / len(parts))
        maps.append(bake_part(mesh, part, _size(part, size), levels))
    if cache:
        cache.put(KIND, key, _packed(maps))
    return maps


def _size(part: StarPart, size: int) -> int:
    """Texels along the faces of a part: a patch of few triangles needs no more than about two for each."""
    if np.isinf(part.reach):
        return size
    enough = 2 * BORDER + int(np.ceil(2.0 * np.sqrt(len(part.triangles) + len(part.margin))))
    return max(_LEAST_PATCH, min(size // 4, enough))


def maps_of(
    scene: Scene, reflectors: Iterable[int], settings: dict, cache: Cache | None = None, progress: Progress = silent
) -> dict[int, list[ReflectorMap]]:
    """The maps of each of some instances; those of the same mesh share theirs, and keep them as long as it lives."""
    meshes = {index: scene.meshes[scene.instances[index].mesh] for index in reflectors}
    wanted, distinct = tuple(settings[one.name] for one in (SIZE, FINER, SPREAD)), dict.fromkeys(meshes.values())
    for done, mesh in enumerate(distinct):
        if mesh not in _KEPT or _KEPT[mesh][0] != wanted:
            share = part_of(progress, done / len(distinct), (done + 1) / len(distinct))
            _KEPT[mesh] = wanted, reflector_maps(mesh, settings, cache, share)
    return {index: _KEPT[mesh][1] for index, mesh in meshes.items()}


@on_gl_thread
def bake_part(mesh: Mesh, part: StarPart, size: int, levels: int) -> ReflectorMap:
    """The maps of one part, `size` texels a face; its triangles are quartered `levels` times before."""
    drawn = np.concatenate([part.margin, part.triangles])
    corners = (mesh.corners[drawn].astype(np.float64) - part.centre) @ part.frame.T
    normals = mesh.normals[drawn].astype(np.float64) @ part.frame.T
    corners, normals = finer(corners, normals, levels)
    faces = range(6) if np.isinf(part.reach) else (_PATCH_FACE,)
    reach = 1.0 if np.isinf(part.reach) else part.reach
    ways = _ways(faces, size, reach)
    shown = _shown(corners, faces, size, reach)
    positions, turned = _met(ways, shown, corners, normals)
    covered = shown > 0
    if not covered.any():
        _pin(positions, turned, covered, ways, corners, normals)
    # What goes on is how near the reflector is and how it faces: a plane's nearness is linear, and every texel stays
    # in its direction.
    ahead = np.stack([np.abs(place[..., face // 2]) for place, face in zip(positions, faces, strict=True)])
    nearness = 1.0 / np.where(covered, ahead, 1.0)
    values = np.concatenate([nearness[..., None], turned], axis=3)
    values = np.stack([grown(face, inside) for face, inside in zip(values, covered, strict=True)])
    least = _LEAST_NEAR * nearness.min(initial=np.inf, where=covered)
    made_up = ways / np.maximum(values[..., :1], least)
    normals = values[..., 1:] / np.maximum(np.linalg.norm(values[..., 1:], axis=3, keepdims=True), 1e-20)
    filled = np.where(covered[..., None], positions, made_up)
    return ReflectorMap(part, filled.astype(np.float32), normals.astype(np.float32), covered)


def _met(ways: np.ndarray, shown: np.ndarray, corners: np.ndarray, normals: np.ndarray):
    """Positions and normals (F, N, N, 3) float64 of the surface in texels that show a triangle, else 0."""
    positions, turned = np.zeros_like(ways), np.zeros_like(ways)
    texels = np.flatnonzero(shown)
    for some in np.array_split(texels, len(texels) // _AT_ONCE + 1):
        triangles = shown.ravel()[some] - 1
        found = met_by(ways.reshape(-1, 3)[some], corners[triangles], normals[triangles])
        positions.reshape(-1, 3)[some], turned.reshape(-1, 3)[some] = found
    return positions, turned


def _pin(positions: np.ndarray, turned: np.ndarray, covered: np.ndarray, ways: np.ndarray, corners, normals) -> None:
    """Have the texel that is nearest to the middle of a patch show it, where the patch passes between all texels."""
    middle = corners.reshape(-1, 3).mean(axis=0)
    cosines = ways[0] @ middle / np.linalg.norm(ways[0], axis=2)
    texel = 0, *np.unravel_index(cosines.argmax(), cosines.shape)
    positions[texel], covered[texel] = middle[2] * ways[texel], True
    turned[texel] = normals.reshape(-1, 3).mean(axis=0)


def _ways(faces: Sequence[int], size: int, reach: float) -> np.ndarray:
    """(F, N, N, 3) from the centre through the texels, 1 along their face's axis."""
    at = reach * ((2.0 * np.arange(size) + 1.0 - size) / (size - 2 * BORDER))
    ways = np.empty((len(faces), size, size, 3))
    for way, face in zip(ways, faces, strict=True):
        axis, side = face // 2, 1.0 - 2.0 * (face % 2)
        way[..., axis] = side
        way[..., (axis + 1) % 3], way[..., (axis + 2) % 3] = -side * at, at[:, None]
    return ways


def _shown(corners: np.ndarray, faces: Sequence[int], size: int, reach: float) -> np.ndarray:
    """(F, N, N) uint32: which triangle the middles of texels show, counted from 1, or 0."""
    context = require()
    shader = program("reflector_maps/faces.vert", "reflector_maps/faces.frag")
    buffer = context.buffer(corners.reshape(-1, 3).astype(np.float32))
    array = context.vertex_array(shader, [(buffer, "3f", "position")])
    texture = context.texture((size, size), 1, dtype="u4")
    target = context.framebuffer([texture])
    try:
        context.enable_only(moderngl.NOTHING)
        shader["scale"] = (size - 2 * BORDER) / size / reach
        pictures = []
        for face in faces:
            clear(target)
            shader["axis"], shader["side"] = face // 2, 1.0 - 2.0 * (face % 2)
            array.render(moderngl.TRIANGLES)
            pictures.append(np.frombuffer(read_back(texture), np.uint32).reshape(size, size))
        return np.stack(pictures)
    finally:
        for part in (target, texture, array, buffer):
            part.release()


def _packed(maps: Sequence[ReflectorMap]) -> dict[str, np.ndarray]:
    arrays = {"curvature": np.array([part.part.curvature.value for part in maps], np.int32)}
    for number, part in enumerate(maps):
        own = {name: getattr(part.part, name) for name in ("triangles", "margin", "centre", "frame", "reach")}
        own |= {name: getattr(part, name) for name in ("positions", "normals", "covered")}
        arrays |= {f"{number}_{name}": np.asarray(value) for name, value in own.items()}
    return arrays


def _unpacked(arrays: dict[str, np.ndarray]) -> list[ReflectorMap]:
    maps = []
    for number, curvature in enumerate(arrays["curvature"]):
        own = {name: arrays[f"{number}_{name}"] for name in ("triangles", "margin", "centre", "frame")}
        part = StarPart(**own, reach=float(arrays[f"{number}_reach"]), curvature=Curvature(int(curvature)))
        maps.append(ReflectorMap(part, *(arrays[f"{number}_{name}"] for name in ("positions", "normals", "covered"))))
    return maps
