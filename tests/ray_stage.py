"""Rays of a test's own, sent through the shaders that every method traces with."""

from typing import NamedTuple

import moderngl
import numpy as np
from catoptric.addon.drawing import Resident
from catoptric.addon.gl import on_gl_thread, require
from catoptric.addon.gl.programs import source
from catoptric.addon.methods.tracers import tracer_defines
from catoptric.addon.scene import Lighting, Scene

from .stage import Judge, camera_rays, mirrored

FAR = 1e30

_MAIN = """
in vec3 origin;
in vec3 direction;
in ivec2 start;
out ivec2 met;
out float distance_to_hit;
void main() {
    Hit hit = nearest_hit(Ray(origin, direction), Hit(start.x, start.y, vec2(0.0), 0.0), 1e30);
    met = ivec2(hit.instance, hit.triangle);
    distance_to_hit = hit.distance;
    gl_Position = vec4(0.0);
}
"""


class Hits(NamedTuple):
    """What rays meet first: `instance` and `triangle` (of its mesh) (N,), -1 for nothing, `distance` (N,) or FAR."""

    instance: np.ndarray
    triangle: np.ndarray
    distance: np.ndarray


class Tracer:
    """A scene on the GPU that rays are sent through."""

    def __init__(self, scene: Scene, name: str = "ray-traced") -> None:
        """Upload the scene."""
        self._name = name
        self._make(scene)

    @on_gl_thread
    def _make(self, scene: Scene) -> None:
        self._resident = Resident(scene, Lighting.UNLIT)
        text, _ = source("common/tracer.glsl", tracer_defines(self._name))
        self._program = require().program(vertex_shader=text + _MAIN, varyings=["met", "distance_to_hit"])

    @on_gl_thread
    def update(self, scene: Scene) -> None:
        """Go on with another scene."""
        self._resident.update(scene)

    @on_gl_thread
    def hits(self, origins: np.ndarray, directions: np.ndarray, starts: np.ndarray | None = None) -> Hits:
        """What rays (N, 3), (N, 3) meet; `starts` (N, 2) are the instance and triangle (of all) that they leave."""
        context, count = require(), len(origins)
        starts = np.full((count, 2), -1) if starts is None else starts
        parts = [
            np.ascontiguousarray(part, kind) for part, kind in ((origins, "f4"), (directions, "f4"), (starts, "i4"))
        ]
        buffers = [context.buffer(part) for part in parts]
        names = [("3f", "origin"), ("3f", "direction"), ("2i", "start")]
        contents = [(b, *n) for b, n in zip(buffers, names, strict=True) if n[1] in self._program]
        array = context.vertex_array(self._program, contents)
        found = context.buffer(reserve=12 * count)
        self._resident.bind(self._program)
        context.simple_framebuffer((1, 1)).use()  # nothing is drawn, yet there must be one
        array.transform(found, moderngl.POINTS, count)
        raw = np.frombuffer(found.read(), np.int32).reshape(-1, 3)
        scene = self._resident.scene
        firsts = np.concatenate([[0], np.cumsum([len(mesh.triangles) for mesh in scene.meshes])])
        mesh = np.array([instance.mesh for instance in scene.instances])[raw[:, 0]]
        triangle = np.where(raw[:, 0] < 0, -1, raw[:, 1] - firsts[mesh])
        return Hits(raw[:, 0], triangle, raw[:, 2].view(np.float32))

    @on_gl_thread
    def release(self) -> None:
        """Give the GPU memory back."""
        self._resident.release()


def brute_force(scene: Scene, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Distances (R, T) along rays to every triangle of every instance in turn, in float64; inf where it is missed.

    As the shader counts it, a hair beside an edge is a hit.
    """
    parts = []
    for instance in scene.instances:
        inward = np.linalg.inv(instance.matrix)
        o, d = origins @ inward[:3, :3].T + inward[:3, 3], directions @ inward[:3, :3].T
        a, b, c = (scene.meshes[instance.mesh].corners.astype(float)[:, i] for i in range(3))
        p = np.cross(d[:, None], (c - a)[None])
        with np.errstate(all="ignore"):
            scale = 1.0 / ((b - a) * p).sum(-1)
            to = o[:, None] - a
            q = np.cross(to, (b - a)[None])
            v, w = (to * p).sum(-1) * scale, (d[:, None] * q).sum(-1) * scale
            t = ((c - a) * q).sum(-1) * scale
            inside = (v >= -1e-6) & (w >= -1e-6) & (v + w <= 1 + 1e-6) & (t > 1e-4)
        parts.append(np.where(inside, t, np.inf))
    return np.concatenate(parts, axis=1)


class Agreement(NamedTuple):
    """Of `rays` reflected rays: the share whose triangle is Embree's, and with it that of those which tie.

    Rays tie where two triangles are met within 1e-5 of the same distance, as at the edge that they share.
    """

    rays: int
    same: float
    same_or_tied: float


def agreement(scene: Scene, name: str, width: int, height: int) -> Agreement:
    """Hold what the pixels' reflected rays meet, by the tracer of this name, against Embree."""
    judge = Judge(scene)
    origins, directions = camera_rays(scene.camera, width, height)
    first = judge.meet(origins, directions)
    mirrors = np.array([instance.reflector for instance in scene.instances])
    start, reflected = mirrored(first, directions)
    chosen = (first.instance >= 0) & mirrors[first.instance] & ((reflected * first.flat).sum(-1) > 0.01)
    # Embree knows of no triangle that a ray leaves, so that both begin where rounding cannot meet it.
    scale = 1.0 + np.abs(start[chosen]).max(axis=1, keepdims=True)
    origins = (start[chosen] + 2e-5 * scale * first.flat[chosen]).astype(np.float32)
    directions = reflected[chosen].astype(np.float32)
    expected = judge.meet(origins.astype(float), directions.astype(float))
    tracer = Tracer(scene, name)
    try:
        found = tracer.hits(origins, directions)
    finally:
        tracer.release()
    firsts = np.cumsum([0, *(len(scene.meshes[instance.mesh].triangles) for instance in scene.instances)])
    triangle = np.where(found.instance < 0, -1, firsts[found.instance] + found.triangle)
    same = triangle == expected.triangle
    both = (triangle >= 0) & (expected.triangle >= 0)
    apart = np.full(len(same), np.inf)
    apart[both] = np.abs(found.distance[both] - expected.distance[both]) / (1.0 + expected.distance[both])
    return Agreement(len(same), same.mean(), (same | (apart <= 1e-5)).mean())
