"""A reflector among what it shows, in figures: what decides which method suits it."""

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from ..scene import Instance, Mesh, Scene, mean_roughness
from ..tracing import is_convex
from .glossy.gloss import lobe_angle_of_roughness

_MOST_TRIANGLES = 50_000
"""Of what stands around; more take longer to look through than a choice may."""

_CLOSED = 0.99
"""Share of a box's side that walls must cover."""


@dataclass(frozen=True)
class Shape:
    """A mesh as a mirror, in its own space.

    `radius` reaches from the middle of its box to the farthest corner; `curvature` is that of the flattest
    place (1 / radius, 0 for a plane); `alone` says that no part of it shows in another.
    """

    radius: float
    curvature: float
    alone: bool


@dataclass(frozen=True, eq=False)
class Placed:
    """Where the instances of a scene are, one a row.

    `low` and `high` (I, 3) corners of a box in world space, `middle` (I, 3), `axes` (I, 3, 3) with the
    sides' directions in rows and `half` (I, 3) lengths of the box in its own space, metres; `radius` (I,) of
    a ball around the middle; `shown` (I,) whether reflections may see it, `known` (I,) whether a capture sees
    it as reflections do.
    """

    low: np.ndarray
    high: np.ndarray
    middle: np.ndarray
    axes: np.ndarray
    half: np.ndarray
    radius: np.ndarray
    shown: np.ndarray
    known: np.ndarray


_SHAPES: "WeakKeyDictionary[Mesh, Shape]" = WeakKeyDictionary()
_RADII: "WeakKeyDictionary[Mesh, float]" = WeakKeyDictionary()
_PLACED: "WeakKeyDictionary[Scene, Placed]" = WeakKeyDictionary()


class Situation:
    """A reflector of a scene and what stands around it; measured when asked. Lengths in metres.

    Errors are the most that is to be expected, in pixels at the middle of a picture of the scene's resolution
    from the scene's camera.
    """

    def __init__(self, scene: Scene, reflector: Instance, tolerance: float) -> None:
        """Nothing is measured yet, and nothing will be that `tolerance`, in pixels, leaves no need for."""
        self.scene, self.reflector, self.tolerance = scene, reflector, tolerance
        self._index = scene.instances.index(reflector)
        self._placed = placed(scene)
        self._scales = np.linalg.svd(reflector.matrix[:3, :3], compute_uv=False)

    @cached_property
    def _shape(self) -> Shape:
        return shape_of(self.scene.meshes[self.reflector.mesh])

    @property
    def alone(self) -> bool:
        """Whether no part of the reflector shows in another."""
        return self._shape.alone

    @cached_property
    def radius(self) -> float:
        """From the middle of the reflector to its farthest point."""
        return float(self._placed.radius[self._index])

    @cached_property
    def curvature(self) -> float:
        """Of its flattest place, 1/m; an ellipsoid's c / a² bounds what a stretched mesh keeps."""
        return float(self._shape.curvature * self._scales[-1] / max(self._scales[0], 1e-30) ** 2)

    @cached_property
    def _viewer(self) -> float:
        """How near the camera comes to the reflector's box."""
        low, high = self._placed.low[self._index], self._placed.high[self._index]
        eye = self.scene.camera.position
        return float(np.linalg.norm(np.maximum(np.maximum(low - eye, eye - high), 0.0)))

    @cached_property
    def _pixel(self) -> float:
        """Width of a pixel at distance 1; in metres, for an orthographic camera."""
        width, height = self.scene.resolution
        left, right, _, _ = self.scene.camera.window(width, height)
        return (right - left) / width

    def on_screen(self, offset: np.ndarray | float, distance: np.ndarray | float) -> np.ndarray | float:
        """Pixels that `offset` metres, at `distance` from the reflector, take where it is flattest.

        By the thin-mirror equation 1 / image = 1 / distance + 2 curvature, image / distance is the scale.
        """
        scale = 1.0 / (1.0 + 2.0 * self.curvature * distance)
        if self.scene.camera.ortho_scale is not None:
            return offset * scale / self._pixel
        return offset * scale / np.maximum(self._viewer + distance * scale, 1e-9) / self._pixel

    def texel_on_screen(self, cube_size: int) -> float:
        """Pixels that a texel of a cube takes, where it shows what is far away."""
        far = 1e6 * (1.0 + self.radius + self._viewer)
        return float(self.on_screen(2.0 / cube_size * far, far))

    @cached_property
    def extent(self) -> float:
        """The reflector's own radius in pixels."""
        if self.scene.camera.ortho_scale is not None:
            return self.radius / self._pixel
        return self.radius / max(self._viewer, 1e-9) / self._pixel

    @cached_property
    def others(self) -> np.ndarray:
        """Indices of the other instances that may show in the reflector."""
        shown = self._placed.shown.copy()
        shown[self._index] = False
        return np.flatnonzero(shown)

    @cached_property
    def _rounds(self) -> np.ndarray:
        """(others,) whether the reflector's middle lies within each one's box."""
        at, centre = self._placed, self._placed.middle[self._index]
        return (at.low[self.others] <= centre).all(axis=1) & (at.high[self.others] >= centre).all(axis=1)

    @cached_property
    def distances(self) -> np.ndarray:
        """(others,) at least so far away from the reflector is each.

        By boxes and balls; what is around the reflector by its triangles, if what is beside it tolerates an
        environment map, else 0.
        """
        at, around = self._placed, self.others
        offset = at.middle[self._index] - at.middle[around]
        own = np.abs(np.einsum("nij,nj->ni", at.axes[around], offset))
        to_box = np.linalg.norm(np.maximum(own - at.half[around], 0.0), axis=1) - self.radius
        to_ball = np.linalg.norm(offset, axis=1) - at.radius[around] - self.radius
        gaps = np.maximum(at.low[around] - at.high[self._index], at.low[self._index] - at.high[around])
        between_boxes = np.linalg.norm(np.maximum(gaps, 0.0), axis=1)
        least = np.maximum(np.maximum(to_box, to_ball), between_boxes)
        if self._misplaced(least)[~self._rounds].max(initial=0.0) <= self.tolerance:
            for row in np.flatnonzero(self._rounds):
                least[row] = self._nearest_triangle([around[row]])[0].min(initial=np.inf)
        return least

    def _nearest_triangle(self, instances: list[int] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(T,) at least so far away is each triangle, and (T, 3, 3) their corners; a 0 if there are too many."""
        meshes = [self.scene.meshes[self.scene.instances[index].mesh] for index in instances]
        if sum(len(mesh.triangles) for mesh in meshes) > _MOST_TRIANGLES:
            return np.zeros(1), np.zeros((1, 3, 3))
        corners = np.concatenate(
            [
                mesh.corners @ matrix[:3, :3].T + matrix[:3, 3]
                for mesh, matrix in zip(meshes, (self.scene.instances[i].matrix for i in instances), strict=True)
            ]
        )
        centre = self._placed.middle[self._index]
        gaps = np.maximum(corners.min(axis=1) - centre, centre - corners.max(axis=1))
        to_box = np.linalg.norm(np.maximum(gaps, 0.0), axis=1)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-30)
        to_plane = np.abs(((corners[:, 0] - centre) * normals).sum(axis=1)) / lengths
        return np.maximum(np.maximum(to_box, to_plane) - self.radius, 0.0), corners

    def _sizes(self, distances: np.ndarray) -> np.ndarray:
        return self.on_screen(2.0 * self._placed.radius[self.others], distances)

    def _misplaced(self, distances: np.ndarray) -> np.ndarray:
        sizes = self._sizes(distances)
        misplaced = np.minimum(self.on_screen(self.radius, distances), sizes)
        return np.where(self._placed.known[self.others], misplaced, sizes)

    @cached_property
    def parallax(self) -> np.ndarray:
        """(others,) pixels by which a map that is looked up by direction alone misplaces each.

        The map is captured at the middle, so that a ray from elsewhere is off by the radius at most; what a
        capture does not know as reflections show it, a mirror for one, is wrong as a whole.
        """
        return self._misplaced(self.distances)

    @cached_property
    def blur(self) -> float:
        """Pixels by which the roughest of its mirrors blurs what is far away: the width of its lobe."""
        mesh = self.scene.meshes[self.reflector.mesh]
        materials = [self.scene.materials[self.reflector.materials[slot]] for slot in np.unique(mesh.slots)]
        roughness = [mean_roughness(self.scene, material) for material in materials if material.mirrors]
        lobe = float(lobe_angle_of_roughness(max(roughness, default=0.0)))
        return 0.0 if self.scene.camera.ortho_scale is not None else 2.0 * np.tan(lobe) / self._pixel

    @property
    def worst(self) -> int:
        """Which of `others` decides against an environment map: one beside the reflector rather than around it."""
        beside = np.where(self._rounds, 0.0, self.parallax)
        return int(np.argmax(beside if beside.max() > self.tolerance else self.parallax))

    @cached_property
    def room_error(self) -> float:
        """Pixels by which a map projected onto the box around everything misplaces what lies along its sides.

        Objects smaller than the tolerance are left out. Infinite where the box has holes, or holds what a capture
        does not know. A wall `t` before the box's side, at distance d, is off by radius · t / (d + t): the lookup
        goes to where the ray meets the side, and the capture saw the wall in front of that place.
        """
        large = self._sizes(self.distances) > self.tolerance
        walls, beside = self.others[large], large & ~self._rounds
        if not len(walls) or not self._placed.known[walls].all():
            return np.inf
        low, high = self._placed.low.min(axis=0), self._placed.high.max(axis=0)
        middle = self._placed.middle[self.others[beside]]
        depth = np.minimum(middle - low, high - middle).min(axis=1)
        if self._projected(depth, self.distances[beside]) > self.tolerance:  # spares a look at all triangles
            return np.inf
        distance, corners = self._nearest_triangle(walls)
        depths = np.concatenate([corners - low, high - corners], axis=2).max(axis=1)
        depth, side = depths.min(axis=1), depths.argmin(axis=1)
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        size = high - low
        if (np.bincount(side, areas, 6) < _CLOSED * np.tile(size[[1, 2, 0]] * size[[2, 0, 1]], 2)).any():
            return np.inf
        return self._projected(depth, distance)

    def _projected(self, depth: np.ndarray, distance: np.ndarray) -> float:
        offset = self.radius * depth / np.maximum(distance + depth, 1e-30)
        return float(self.on_screen(offset, distance).max(initial=0.0))


def shape_of(mesh: Mesh) -> Shape:
    """Measured once, as long as the mesh lives."""
    if mesh not in _SHAPES:
        corners = mesh.corners.astype(np.float64)
        radius = _radius_of(mesh)
        alone = _is_flat(corners, radius) or _is_convex(mesh)
        _SHAPES[mesh] = Shape(radius, _least_curvature(corners, mesh.normals, radius), alone)
    return _SHAPES[mesh]


def _radius_of(mesh: Mesh) -> float:
    if mesh not in _RADII:
        _RADII[mesh] = float(np.linalg.norm(mesh.corners - mesh.bounds.mean(axis=0), axis=2).max(initial=0.0))
    return _RADII[mesh]


def _is_convex(mesh: Mesh) -> bool:
    """Whether the mesh bounds a convex body, be its corners split for the sake of normals or not."""
    positions, joined = np.unique(mesh.positions, axis=0, return_inverse=True)
    return is_convex(positions, joined.reshape(-1)[mesh.triangles])


def _is_flat(corners: np.ndarray, radius: float) -> bool:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    largest = int(lengths.argmax())
    heights = (corners - corners[largest, 0]) @ normals[largest]
    return bool(np.abs(heights).max() <= 1e-4 * radius * lengths[largest])


def _least_curvature(corners: np.ndarray, normals: np.ndarray, radius: float) -> float:
    """How little the shading normal turns along any edge, in radians a metre."""
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    turns = np.linalg.norm(np.roll(normals, -1, axis=1) - normals, axis=2)
    long = lengths > 1e-5 * radius
    return float((turns[long] / lengths[long]).min(initial=1.0 / max(radius, 1e-30)))


def placed(scene: Scene) -> Placed:
    """Measured once, as long as the scene lives."""
    if scene not in _PLACED:
        bounds = np.array([scene.meshes[instance.mesh].bounds for instance in scene.instances], np.float64)
        matrices = np.array([instance.matrix for instance in scene.instances], np.float64)
        linear = matrices[:, :3, :3]
        middle = np.einsum("nij,nj->ni", linear, bounds.mean(axis=1)) + matrices[:, :3, 3]
        half = 0.5 * (bounds[:, 1] - bounds[:, 0])
        reach = np.einsum("nij,nj->ni", np.abs(linear), half)
        scales = np.maximum(np.linalg.norm(linear, axis=1), 1e-30)
        axes = (linear / scales[:, None]).transpose(0, 2, 1)
        half = half * scales
        radii = np.array([_radius_of(scene.meshes[instance.mesh]) for instance in scene.instances])
        radii *= np.linalg.norm(linear, ord=2, axis=(1, 2))
        sheared = np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2)) > 1e-3
        axes[sheared], half[sheared] = np.eye(3), reach[sheared]
        seen = np.array([(one.in_reflections, one.in_camera, one.reflector) for one in scene.instances])
        known = (seen[:, 0] == seen[:, 1]) & ~seen[:, 2]
        shown = seen[:, :2].any(axis=1)
        _PLACED[scene] = Placed(middle - reach, middle + reach, middle, axes, half, radii, shown, known)
    return _PLACED[scene]
