"""What lies under the cursor, and what the mirror there truly shows: two rays, traced in NumPy."""

from dataclasses import dataclass

import numpy as np

from ...addon.scene import Camera, Scene

_OFF_THE_SURFACE = 1e-5


@dataclass(frozen=True)
class Sight:
    """What a pixel shows. None as a name stands for the world.

    `name` is the object, `distance` metres to it; `mirrored` what it shows if it is a reflector, `path` metres
    from the one to the other.
    """

    name: str | None
    distance: float = np.inf
    reflects: bool = False
    mirrored: str | None = None
    path: float = np.inf


@dataclass(frozen=True, eq=False)
class _Met:
    instance: int
    distance: float
    position: np.ndarray
    normal: np.ndarray  # interpolated, towards the ray
    flat: np.ndarray


class Looker:
    """A scene that single rays are sent into; a few milliseconds a ray and 100,000 triangles near it."""

    def __init__(self, scene: Scene) -> None:
        """Gather the boxes of the instances, each in its own space."""
        self._scene = scene
        matrices = np.array([instance.matrix for instance in scene.instances]).reshape(-1, 4, 4)
        self._flat = np.abs(np.linalg.det(matrices)) < 1e-30
        matrices = np.where(self._flat[:, None, None], np.eye(4), matrices)
        self._inward = np.linalg.inv(matrices)
        self._boxes = np.array([scene.meshes[instance.mesh].bounds for instance in scene.instances]).reshape(-1, 2, 3)

    def look(self, camera: Camera, size: tuple[int, int], place: tuple[float, float]) -> Sight:
        """What is seen at `place` (pixels from the upper left corner) of a picture of that `size`."""
        origin, direction = _ray(camera, size, place)
        seen = np.array([instance.in_camera for instance in self._scene.instances], bool)
        met = self._meet(origin, direction, seen)
        if met is None:
            return Sight(None)
        instance = self._scene.instances[met.instance]
        if not instance.reflector:
            return Sight(instance.name, met.distance)
        out = direction - 2.0 * (direction @ met.normal) * met.normal
        start = met.position + _OFF_THE_SURFACE * (1.0 + met.distance) * met.flat
        seen = np.array([instance.in_reflections for instance in self._scene.instances], bool)
        mirrored = self._meet(start, out, seen)
        if mirrored is None:
            return Sight(instance.name, met.distance, True)
        name = self._scene.instances[mirrored.instance].name
        return Sight(instance.name, met.distance, True, name, mirrored.distance)

    def _meet(self, origin: np.ndarray, direction: np.ndarray, seen: np.ndarray) -> _Met | None:
        origins = self._inward[:, :3, :3] @ origin + self._inward[:, :3, 3]
        directions = self._inward[:, :3, :3] @ direction
        entries = _entries(self._boxes, origins, directions)
        entries[~seen | self._flat] = np.inf
        nearest = None
        for index in np.argsort(entries):
            if not entries[index] < (nearest.distance if nearest else np.inf):
                break
            found = self._meet_mesh(index, origins[index], directions[index])
            if found and (nearest is None or found[0] < nearest.distance):
                nearest = self._met(index, *found, origin, direction)
        return nearest

    def _meet_mesh(self, index: int, origin: np.ndarray, direction: np.ndarray) -> tuple[float, int, np.ndarray] | None:
        """Distance, triangle and weights (3,) of its corners (Möller and Trumbore 1997)."""
        mesh = self._scene.meshes[self._scene.instances[index].mesh]
        a, b, c = np.moveaxis(mesh.corners.astype(np.float64), 1, 0)
        across = np.cross(direction, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = 1.0 / ((b - a) * across).sum(-1)
            v = ((origin - a) * across).sum(-1) * scale
            along = np.cross(origin - a, b - a)
            w = (along @ direction) * scale
            distance = (along * (c - a)).sum(-1) * scale
            inside = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0) & (distance > 0.0)
        if not inside.any():
            return None
        triangle = int(np.argmin(np.where(inside, distance, np.inf)))
        return float(distance[triangle]), triangle, np.array([1 - v[triangle] - w[triangle], v[triangle], w[triangle]])

    def _met(self, index: int, distance: float, triangle: int, weights: np.ndarray, origin, direction) -> _Met:
        instance = self._scene.instances[index]
        mesh = self._scene.meshes[instance.mesh]
        outward = self._inward[index, :3, :3].T
        corners = mesh.corners[triangle].astype(np.float64)
        flat = outward @ np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal = outward @ (weights @ mesh.normals[triangle].astype(np.float64))
        flat, normal = (_towards(vector, -direction) for vector in (flat, normal))
        return _Met(int(index), distance, origin + distance * direction, normal, flat)


def _ray(camera: Camera, size: tuple[int, int], place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Origin and unit direction (3,) in the world."""
    left, right, bottom, top = camera.window(*size)
    x = left + place[0] / size[0] * (right - left)
    y = top - place[1] / size[1] * (top - bottom)
    turn = camera.matrix[:3, :3]
    if camera.ortho_scale is not None:
        return camera.position + turn @ (x, y, 0.0), -turn[:, 2]
    direction = turn @ (x, y, -1.0)
    return camera.position, direction / np.linalg.norm(direction)


def _entries(boxes: np.ndarray, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(N,) where each ray enters its box (at least 0), infinite where it misses."""
    with np.errstate(divide="ignore", invalid="ignore"):
        crossings = (boxes - origins[:, None]) / directions[:, None]
    # A ray in the plane of a side is 0 / 0 away from it: then the other axes decide.
    near = np.fmin(*np.moveaxis(crossings, 1, 0)).max(axis=-1, initial=0.0, where=~np.isnan(crossings).any(axis=1))
    far = np.fmax(*np.moveaxis(crossings, 1, 0)).min(axis=-1, initial=np.inf, where=~np.isnan(crossings).any(axis=1))
    return np.where(near <= far * (1.0 + 1e-9) + 1e-9, near, np.inf)


def _towards(vector: np.ndarray, side: np.ndarray) -> np.ndarray:
    """`vector` at unit length, turned to that side."""
    return vector * np.sign(vector @ side) / max(float(np.linalg.norm(vector)), 1e-300)
