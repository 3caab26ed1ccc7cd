"""The search for reflection points on its own: a path, an eye and vertices in, where they are reflected out."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import moderngl
import numpy as np
import trimesh
from catoptric.addon.baking.reflector_maps import ReflectorMap, reflector_maps
from catoptric.addon.baking.reflector_maps_tables import ResidentMaps
from catoptric.addon.drawing import world_to_clip
from catoptric.addon.gl import on_gl_thread, program, require
from catoptric.addon.scene import Camera, Mesh, Scene

from .stage import mesh_of

_ROW = 4096
_EVERYTHING = 1e30
_MAPS_UNIT = 11
_LAST_UNIT = 13


def sphere(subdivisions: int = 5) -> Mesh:
    """A ball of radius 1 whose vertices and normals are a sphere's."""
    shape = trimesh.creation.icosphere(subdivisions=subdivisions)
    mesh = mesh_of(shape, smooth=True)
    normals = shape.vertices / np.linalg.norm(shape.vertices, axis=1, keepdims=True)
    return Mesh("ball", normals.astype(np.float32), mesh.triangles, normals[mesh.triangles].astype(np.float32),
                mesh.uvs, mesh.slots)  # fmt: skip


def sheet(height=lambda x, y: 0.2 * (x**2 + y**2), count: int = 24, hole: float = 0.0) -> Mesh:
    """An open sheet over a square of 2 m, smooth, that faces up; with a round hole."""
    x, y = np.meshgrid(np.linspace(-1, 1, count + 1), np.linspace(-1, 1, count + 1))
    points = np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3)
    first = (np.arange(count)[None] + (count + 1) * np.arange(count)[:, None]).reshape(-1)
    square = first[:, None] + [0, 1, count + 2, 0, count + 2, count + 1]
    square = square.reshape(-1, 3)
    square = square[np.linalg.norm(points[square].mean(axis=1)[:, :2], axis=1) >= hole]
    return mesh_of(trimesh.Trimesh(points, square, process=False), smooth=True)


def maps_of(mesh: Mesh, size: int = 512, finer: int = 1, spread: float = 20.0) -> list[ReflectorMap]:
    """The maps of a mesh, baked anew."""
    return reflector_maps(mesh, {"map_size": size, "finer": finer, "spread": spread})


class Samples(NamedTuple):
    """16 rays that took a path: `origins` and `directions` (16, 3) as they left it, in the world, and for each part of
    the path the `starts` (16, 3): where they were reflected, as directions of its frame."""

    origins: np.ndarray
    directions: np.ndarray
    starts: Sequence[np.ndarray]


@dataclass
class Found:
    """`directions` (N, 3) of the first reflection points from the part's centre, in its frame; `lean` (N,), below 0
    where a vertex is behind the reflector; `pixels` (N, 2) from the picture's middle."""

    directions: np.ndarray
    lean: np.ndarray
    pixels: np.ndarray


class Search:
    """The search on a `path` of parts, numbered from 1 on."""

    @on_gl_thread
    def __init__(self, scene: Scene, maps: dict[int, Sequence[ReflectorMap]], path: Sequence[int]) -> None:
        """Compile, and upload the maps of each instance that mirrors."""
        self._scene, self._path = scene, path
        self._shader = program("virtual/search.vert", "virtual/search.frag", {"ORDER": len(path)})
        self._maps = ResidentMaps(scene, maps)

    @on_gl_thread
    def find(
        self,
        eye: Sequence[float],
        vertices: np.ndarray,
        steps: int,
        camera: Camera | None = None,
        samples: Samples | None = None,
        size: tuple[int, int] = (512, 512),
        before: Found | None = None,
    ) -> Found:
        """Where the GPU finds that `vertices` (N, 3) are reflected.

        `eye` is a point and 1, or a direction and 0. Searches that are not on one whole body begin from `samples`, or,
        as others may, where those `before` have ended.
        """
        context, shader, rows = require(), self._shader, -(-len(vertices) // _ROW)
        buffer = context.buffer(np.ascontiguousarray(vertices, np.float32))
        array = context.vertex_array(shader, [(buffer, "3f", "position")])
        results = [context.texture((_ROW, rows), 4, dtype="f4") for _ in range(3)]
        target = context.framebuffer(results)
        values = {
            "eye": eye,
            "steps": steps,
            "results_height": rows,
            "result_shift": 0,
            "bundle": (0.0, 0.0, 0.0, _EVERYTHING),
            "bundle_axis": (0.0, 0.0, 1.0, np.pi),
            "concave": False,
            "known": before is not None,
            "last_shift": 0,
            "results": _LAST_UNIT,
            "results_again": _LAST_UNIT,
            "screen": size,
            "world_to_clip": tuple(world_to_clip(camera or self._scene.camera, *size).T.ravel()),
        }
        try:
            self._maps.bind(shader, _MAPS_UNIT)
            self._maps.choose(shader, self._path)
            for name, value in values.items():
                if name in shader:
                    shader[name] = value
            if samples:
                shader["sample_origins"].write(np.float32(samples.origins).tobytes())
                shader["sample_directions"].write(np.float32(samples.directions).tobytes())
                shader["sample_starts"].write(np.concatenate(samples.starts).astype(np.float32).tobytes())
            if before:
                results.append(_texture(before, rows))
                results[-1].use(_LAST_UNIT)
            target.use()
            target.clear()
            context.enable_only(moderngl.NOTHING)
            array.render(moderngl.POINTS)
            found, shown, _ = (
                np.frombuffer(one.read(), np.float32).reshape(-1, 4)[: len(vertices)] for one in results[:3]
            )
            return Found(found[:, :3].astype(float), found[:, 3], shown[:, :2].astype(float))
        finally:
            for part in (target, *results, array, buffer):
                part.release()


def _texture(found: Found, rows: int) -> moderngl.Texture:
    """As a frame leaves its results to the next."""
    texels = np.zeros((rows * _ROW, 4), np.float32)
    texels[: len(found.lean)] = np.c_[found.directions, found.lean]
    return require().texture((_ROW, rows), 4, texels, dtype="f4")


def alhazen(eye: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """(N, 3) unit: where the unit sphere around 0 reflects `vertices` (N, 3) towards `eye` (4,), a point and 1 or a
    direction and 0.

    In the plane of eye, centre and vertex: halved between the eye's side and the horizon, where the bisector leans
    from one side of the normal to the other. A vertex inside is met where its way is mirrored outwards, as 6.1 has it.
    """
    towards = eye[:3] / np.linalg.norm(eye[:3])
    away = vertices @ towards
    aside = vertices - away[:, None] * towards
    off = np.linalg.norm(aside, axis=1)
    aside = aside / np.maximum(off, 1e-300)[:, None]
    place = np.stack([away, off], axis=1)
    far = eye[3] == 0.0
    seen_from = np.array([1.0 if far else np.linalg.norm(eye[:3]), 0.0])
    low = np.zeros(len(vertices))
    high = np.minimum(np.arctan2(off, away), np.pi / 2 if far else np.arccos(min(1.0, 1.0 / seen_from[0])))
    for _ in range(80):
        middle = 0.5 * (low + high)
        normal = np.stack([np.cos(middle), np.sin(middle)], axis=1)
        along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        to_eye = np.broadcast_to(seen_from, normal.shape) if far else unit(seen_from - normal)
        leans = ((to_eye + unit(place - normal)) * along).sum(axis=1) > 0.0
        low, high = np.where(leans, middle, low), np.where(leans, high, middle)
    angle = 0.5 * (low + high)[:, None]
    return np.cos(angle) * towards + np.sin(angle) * aside


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors made 1 long."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


# What a ball of radius 1 around 0 mirrors. All is what 32-bit floats hold, so that the search is given the same.


def rounded(values: np.ndarray) -> np.ndarray:
    """As the GPU has it."""
    return np.asarray(values, np.float32).astype(float)


def eye_at(distance: float, rng: np.random.Generator) -> np.ndarray:
    """A point and 1, or at infinity a direction and 0."""
    towards = unit(rng.normal(size=3))
    return rounded(np.append(towards, 0.0) if np.isinf(distance) else np.append(towards * distance, 1.0))


def around(count: int, rng: np.random.Generator) -> np.ndarray:
    """Points on all sides, from 0.001 to 100 radii above the ball."""
    return rounded(unit(rng.normal(size=(count, 3))) * (1 + 10 ** rng.uniform(-3, 2, size=(count, 1))))


def beyond(eye: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Those of them on the far side."""
    points = around(count, rng)
    return np.where(points @ eye[:3, None] > 0.0, -points, points)


def near_tangent(
    eye: np.ndarray, count: int, rng: np.random.Generator, nearest: float = 0.01, farthest: float = 100.0
) -> np.ndarray:
    """Points so far from where a ball reflects them by its horizon: 0.0003 to 0.3 is the sine of their height there."""
    towards = unit(eye[:3])
    sine = 10 ** rng.uniform(-3.5, -0.5, size=count)
    aside = unit(np.cross(towards, rng.normal(size=(count, 3))))
    # The angle from the eye at which it stands this high: the law of sines.
    below = 0.0 if eye[3] == 0 else np.arcsin(np.sqrt(1 - sine**2) / np.linalg.norm(eye[:3]))
    angle = (np.arccos(sine) - below)[:, None]
    points = np.cos(angle) * towards + np.sin(angle) * aside
    away = 10 ** rng.uniform(np.log10(nearest), np.log10(farthest), size=(count, 1))
    return rounded(points + reflected(eye, points, points) * away)


def reflected(eye: np.ndarray, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(N, 3) unit: where light from the eye goes on."""
    way = unit(points * eye[3] - eye[:3])
    return way - 2 * (way * normals).sum(axis=1, keepdims=True) * normals


def heights(eye: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Sine of the eye's height above the ball at its `points`."""
    return (unit(eye[:3] - eye[3] * points) * points).sum(axis=1)


def is_hidden(eye: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Whether the straight line to the eye meets the ball."""
    way = eye[:3] - eye[3] * vertices
    along = np.clip(-(vertices * way).sum(axis=1) / (way * way).sum(axis=1), 0.0, 1.0 if eye[3] else np.inf)
    return np.linalg.norm(vertices + along[:, None] * way, axis=1) < 1.0


PLACES: dict[str, Callable[[np.ndarray, int, np.random.Generator], np.ndarray]] = {
    "anywhere": lambda eye, count, rng: around(count, rng),
    "on the far side": beyond,
    "near-tangent, 0.1 to 100 radii away": partial(near_tangent, nearest=0.1),
    "near-tangent, 0.01 to 0.1 radii away": partial(near_tangent, farthest=0.1),
    "near-tangent, 0.001 to 0.01 radii away": partial(near_tangent, nearest=0.001, farthest=0.01),
}
"""Where vertices are, each with what makes some of them up for an eye."""


def pairs(place: str, count: int, seed: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Eyes (4,), from 0.01 radii above the ball to infinity, and vertices (N, 3) that it does not hide: `count` pairs
    or more."""
    rng = np.random.default_rng(seed)
    while count > 0:
        eye = eye_at(np.inf if rng.random() < 0.1 else 1 + 10 ** rng.uniform(-2, 2), rng)
        vertices = PLACES[place](eye, 250, rng)
        vertices = vertices[~is_hidden(eye, vertices)]
        count -= len(vertices)
        yield eye, vertices
