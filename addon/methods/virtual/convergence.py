"""How fast the searches of reflection points come near to them: ours, and the published one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import moderngl
import numpy as np

from ...baking.reflector_maps import reflector_maps
from ...baking.reflector_maps_tables import ResidentMaps
from ...cache import Cache
from ...drawing import world_boxes, world_to_clip
from ...gl import feedback, on_gl_thread, read_back, require
from ...parameters import Value
from ...scene import Scene
from .bundles import SAMPLES
from .rays import MAPS_UNIT, eye_of

STEPS = 12
"""That convergence is followed for."""

_ENDED = 48
"""Steps after which a search has long ended."""

_RIGHT = 1e-3
"""Radians that bisector and normal may be apart at a reflection point."""

_REACHED = 1e-2
"""And where our search goes on in the next frame; gpu_shaders/virtual/search.vert has the same."""

_TURN = np.radians(90.0) / 60
"""That the eye goes around the reflector in a frame: a quarter of the way in 60."""

_MOST_VERTICES, _MOST_PARTS = 4000, 24
"""That are looked at in a scene."""


@dataclass(frozen=True, eq=False)
class Convergence:
    """How near a search has come after 1 to STEPS steps.

    `within` (STEPS,) is the share of vertices whose reflection point is shown within a pixel of where it belongs, and
    `farthest` (STEPS,) the largest error, in pixels.
    """

    within: np.ndarray
    farthest: np.ndarray

    @property
    def exact_after(self) -> int | None:
        """Steps until 99 of 100 vertices are within a pixel; None where that takes more than STEPS."""
        exact = np.flatnonzero(self.within >= 0.99)
        return int(exact[0]) + 1 if len(exact) else None


@on_gl_thread
def convergence(
    scene: Scene, size: tuple[int, int], settings: Mapping[str, Value], cache: Cache | None = None
) -> dict[str, Convergence] | None:
    """The searches `published`, `ours` and `moving`, in the reflector that is largest in a picture of `size` pixels.

    `ours` begins as in a first picture; `moving` is ours while the camera goes around the reflector, a quarter of the
    way in 60 frames: it begins where it ended in the frame before. `settings` are those of the maps; of some thousand
    vertices those count that the reflector shows in the picture. None if there are none.
    """
    index = _largest(scene, size)
    points = _vertices(scene, index)
    if index is None or not len(points):
        return None
    maps = reflector_maps(scene.meshes[scene.instances[index].mesh], dict(settings), cache)
    tables = ResidentMaps(scene, {index: maps})
    try:
        return _followed(scene, size, tables, index, points)
    finally:
        tables.release()


def frame_before(eye: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """(4,) the eye a frame before `eye`, where it goes around what is upright through `centre` (3,)."""
    cosine, sine = np.cos(_TURN), np.sin(_TURN)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return np.append(turn @ (eye[:3] - eye[3] * centre) + eye[3] * centre, eye[3])


def _largest(scene: Scene, size: tuple[int, int]) -> int | None:
    """The reflector whose box covers most of the picture."""
    clip, areas = world_to_clip(scene.camera, *size), {}
    for index, box in zip(scene.reflectors, world_boxes(scene, scene.reflectors), strict=True):
        corners = np.array([[*np.where(bits, box[1], box[0]), 1.0] for bits in np.ndindex(2, 2, 2)]) @ clip.T
        if (corners[:, 3] > 0.0).all():
            shown = np.clip(corners[:, :2] / corners[:, 3:], -1.0, 1.0)
            areas[index] = float(np.ptp(shown, axis=0).prod())
    return max(areas, key=areas.get, default=None)


def _vertices(scene: Scene, reflector: int | None) -> np.ndarray:
    """(N, 3) of what is around a reflector, evenly from all."""
    parts = [np.zeros((0, 3))]
    for index, instance in enumerate(scene.instances):
        if index != reflector and instance.in_reflections:
            positions = scene.meshes[instance.mesh].positions.astype(np.float64)
            parts.append(positions @ instance.matrix[:3, :3].T + instance.matrix[:3, 3])
    points = np.concatenate(parts)
    points = points[np.isfinite(points).all(axis=1)]
    return points[:: -(-len(points) // _MOST_VERTICES) or 1]


def _followed(scene: Scene, size: tuple[int, int], tables: ResidentMaps, index: int, points: np.ndarray) -> dict | None:
    """The errors of the searches in all parts of a reflector, put together."""
    clip, eye = world_to_clip(scene.camera, *size), np.array(eye_of(scene.camera))
    before = frame_before(eye, world_boxes(scene, [index])[0].mean(axis=0))
    errors: dict[str, list[np.ndarray]] = {"published": [], "ours": [], "moving": []}
    for number, rays in _most_seen(tables, eye, lambda at: _pixels(clip, size, at)):
        search = partial(reflection_points, tables, number, eye, rays=rays)
        starts = _starts(tables, number, before, points, rays)
        places, right = _right(tables, number, search(points, _ENDED, False), clip, size)
        if not right.any():
            continue
        # Hollow mirrors have several points for a vertex: which one is found is all one.
        others, right_as_well = _right(tables, number, search(points, _ENDED, False, starts=starts), clip, size)
        others = np.where(right_as_well[:, None], others, places)[right]
        for name, each in errors.items():
            begun = starts[right] if name == "moving" else None
            for steps in range(1, STEPS + 1):
                now, _ = _pixels(clip, size, search(points[right], steps, name == "published", starts=begun)[:, :3])
                each.append(np.minimum(*(np.linalg.norm(now - end, axis=1) for end in (places[right], others))))
    if not errors["ours"]:
        return None
    return {name: _summed(each) for name, each in errors.items()}


def _summed(errors: list[np.ndarray]) -> Convergence:
    """Of errors by step, part after part."""
    by_step = np.array([np.concatenate(errors[step::STEPS]) for step in range(STEPS)])
    return Convergence((by_step <= 1.0).mean(axis=1), by_step.max(axis=1))


def _pixels(clip: np.ndarray, size: tuple[int, int], points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N, 2) where points are in the picture, from its middle, and (N,) whether that is within."""
    at = np.c_[points, np.ones(len(points))] @ clip.T
    places = at[:, :2] / np.where(at[:, 3:] == 0.0, 1e-30, at[:, 3:]) * np.array(size) / 2.0
    return places, (at[:, 3] > 0.0) & (np.abs(places) <= np.array(size) / 2.0).all(axis=1)


def _right(
    tables: ResidentMaps, number: int, ends: np.ndarray, clip: np.ndarray, size: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """(N, 2) where searches have ended in the picture, and (N,) whether those are reflection points within it."""
    places, inside = _pixels(clip, size, ends[:, :3])
    return places, (ends[:, 3] >= 0.0) & (ends[:, 3] < _RIGHT) & _is_on(tables, number, ends[:, :3]) & inside


def _starts(tables: ResidentMaps, number: int, eye: np.ndarray, points: np.ndarray, rays: Mapping) -> np.ndarray:
    """(N, 3) where our search ended for an eye, as directions of the part's frame; 0 where it has found nothing."""
    ends = reflection_points(tables, number, eye, points, _ENDED, False, rays)
    reached = (ends[:, 3] >= 0.0) & (ends[:, 3] <= _REACHED)
    return tables.directions_of(number, ends[:, :3]) * reached[:, None]


def _is_on(tables: ResidentMaps, number: int, points: np.ndarray) -> np.ndarray:
    """(N,) whether points of the reflector lie on the part's own side of its map."""
    one = tables.maps[number - 1]
    if one.is_whole:
        return np.ones(len(points), bool)
    inward = np.linalg.inv(tables.to_world(number))
    x, y, z = (points @ inward[:3, :3].T + inward[:3, 3]).T
    return np.maximum(np.abs(x), np.abs(y)) <= one.reach * z


def _most_seen(tables: ResidentMaps, eye: np.ndarray, pixels_of: Callable) -> list[tuple[int, dict[str, np.ndarray]]]:
    """Numbers of the parts that have most pixels of the picture, and their rays."""
    seen = [(number, *_rays(tables, number, eye, pixels_of)) for number in range(1, len(tables.maps) + 1)]
    seen.sort(key=lambda part: -part[1])
    return [(number, rays) for number, pixels, rays in seen[:_MOST_PARTS] if pixels]


def _rays(tables: ResidentMaps, number: int, eye: np.ndarray, pixels_of: Callable) -> tuple[int, dict[str, np.ndarray]]:
    """How many pixels of the picture a part has, and the rays by which our search in it finds its start.

    No picture is drawn for them: they are mirrored in the map's texels.
    """
    one, matrix = tables.maps[number - 1], tables.to_world(number)
    points = one.positions[one.covered] @ matrix[:3, :3].T + matrix[:3, 3]
    normals = one.normals[one.covered] @ np.linalg.inv(matrix[:3, :3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    ways = eye[:3] - eye[3] * points
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    cosines = (ways * normals).sum(axis=1)
    places, inside = pixels_of(points)
    seen = np.flatnonzero((cosines > 0.0) & inside)
    if not len(seen):
        return 0, {}
    chosen = seen[((np.arange(SAMPLES) + 0.5) / SAMPLES * len(seen)).astype(int)]
    return len(np.unique(np.floor(places[seen]), axis=0)), {
        "sample_origins": points[chosen],
        "sample_directions": (2.0 * cosines[:, None] * normals - ways)[chosen],
        "sample_starts": tables.directions_of(number, points[chosen]),
    }


def reflection_points(
    maps: ResidentMaps,
    number: int,
    eye: np.ndarray,
    points: np.ndarray,
    steps: int,
    published: bool,
    rays: Mapping[str, np.ndarray] | None = None,
    starts: np.ndarray | None = None,
) -> np.ndarray:
    """(N, 4) float32: where the search for each of the world's `points` (N, 3) is after so many steps; GL thread.

    xyz the point of the reflector, w the angle in radians between normal and bisector there, below 0 where the part
    hides the vertex or faces away. `eye` (4,), w 0 for one that is infinitely far away; `number` that of the part,
    from 1; `rays` are uniforms by which ours starts in patches, `starts` (N, 3) directions in the part's frame from
    which it starts instead, where they are not 0.
    """
    stages = {"vertex_shader": "virtual_published/points.vert"}
    shader = feedback(stages, ("reached",), {"ORDER": 1, "PUBLISHED": int(published)})
    maps.bind(shader, MAPS_UNIT)
    maps.choose(shader, (number,))
    given = {"eye": tuple(eye), "steps": steps, "threshold": 0.0}
    for name, value in given.items():
        if name in shader:
            shader[name] = value
    for name, value in (rays or {}).items():
        if name in shader:
            shader[name].write(np.ascontiguousarray(value, np.float32).tobytes())
    context = require()
    vertices, reached = context.buffer(np.asarray(points, np.float32)), context.buffer(reserve=16 * len(points))
    begun = context.buffer(np.zeros((len(points), 3), np.float32) if starts is None else starts.astype(np.float32))
    inputs = [(vertices, "3f", "position")] + ([] if published else [(begun, "3f", "start")])
    array = context.vertex_array(shader, inputs)
    nothing = context.simple_framebuffer((1, 1))  # OpenGL draws, even to nowhere, only where there is one
    try:
        nothing.use()
        array.transform(reached, moderngl.POINTS, vertices=len(points))
        return np.frombuffer(read_back(reached), np.float32).reshape(-1, 4)
    finally:
        for part in (array, vertices, begun, reached, nothing):
            part.release()
