"""Flat mirrors: where they are, what a camera sees behind them, and through which part of the screen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from ..drawing import MOST_CUTS, Clipping, world_to_clip
from ..scene import Camera, Instance, Mesh, Scene
from ..tracing import FlatParts, flat_parts
from .situation import placed

MOST_PARTS = 8
"""Planes that a reflector may have: a box has six. Each that is seen costs a picture of the scene."""

Bounds = tuple[int, int, int, int]
"""x, y, width and height in pixels; row 0 is at the bottom."""

_LEAST_FLAT = 0.5
_EDGE_ON = 1e-6
_TOUCH = 1e-6
"""Of the scene's extent: what a shader's floats leave of a plane."""

_FINE = 1e-6
"""Of a mirror's extent: what is nearer to its outline lies on it; corners, being floats, are rounded as well."""
_ROUNDING = 2.0 * float(np.finfo(np.float32).eps)

_FOUND: "WeakKeyDictionary[Instance, tuple[tuple, FlatParts]]" = WeakKeyDictionary()
"""What was asked of an instance last, and the answer."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """A flat part of a reflector.

    `instance` is its index, `part` the number of the part from 1 on, `material` the index of the one that most of
    it has; `plane` (4,) float64 unit normal and offset in the world; `points` (N, 3) float64, whose convex hull holds
    it; `outline` (M, 3) the corners of its own hull in the plane, in order, or `MOST_CUTS` and more of them.
    """

    instance: int
    part: int
    material: int
    plane: np.ndarray
    points: np.ndarray
    outline: np.ndarray


@dataclass(frozen=True)
class Registration:
    """How a mirrored picture lies on a screen of `screen` pixels: around the same middle.

    It is smaller by `scale`, and has `margin` texels more on each side, left and right, bottom and top.
    """

    screen: tuple[int, int]
    scale: int = 1
    margin: tuple[int, int] = (0, 0)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture in texels."""
        (width, height), (x, y) = self.screen, self.margin
        return -(-width // self.scale) + 2 * x, -(-height // self.scale) + 2 * y

    @property
    def extent(self) -> tuple[float, float]:
        """The part of the picture's width and height that the screen covers."""
        (width, height), (wide, high) = self.screen, self.size
        return width / self.scale / wide, height / self.scale / high

    def camera(self, camera: Camera) -> Camera:
        """What sees the whole picture as `camera` sees the screen."""
        if self.size == self.screen:
            return camera
        projection = np.diag([*self.extent, 1.0, 1.0]) @ camera.projection(*self.screen)
        return Camera.of_matrices(np.linalg.inv(camera.matrix), projection, *self.size)

    def bounds(self, bounds: Bounds) -> Bounds:
        """A part of the screen as a part of the picture, with the margin and a texel for the filter around it."""
        if self.size == self.screen:
            return bounds
        low, size = np.array(bounds[:2], float), np.array(self.size)
        high = low + bounds[2:]
        middle = np.array(self.screen) / 2.0
        spare = np.add(self.margin, 1)
        first = np.clip(np.floor((low - middle) / self.scale + size / 2.0) - spare, 0, size).astype(int)
        last = np.clip(np.ceil((high - middle) / self.scale + size / 2.0) + spare, 0, size).astype(int)
        return (*map(int, first), *map(int, last - first))


def parts_of(scene: Scene, reflector: Instance, degrees: float, metres: float) -> FlatParts:
    """The flat parts of what mirrors of a reflector, in world space; found once, as long as the instance lives."""
    mesh = scene.meshes[reflector.mesh]
    mirrors = [scene.materials[index].mirrors for index in reflector.materials]
    asked = mesh, mirrors, degrees, metres
    if _FOUND.get(reflector, (None,))[0] != asked:
        _FOUND[reflector] = asked, _parts_of(mesh, reflector, np.array(mirrors)[mesh.slots], degrees, metres)
    return _FOUND[reflector][1]


def _parts_of(mesh: Mesh, reflector: Instance, among: np.ndarray, degrees: float, metres: float) -> FlatParts:
    corners = mesh.corners.astype(np.float64) @ reflector.matrix[:3, :3].T + reflector.matrix[:3, 3]
    normals = mesh.normals.astype(np.float64) @ np.linalg.inv(reflector.matrix[:3, :3])
    return flat_parts(corners, normals, among, degrees, metres, MOST_PARTS)


def why_not_flat(scene: Scene, reflector: Instance, degrees: float, metres: float) -> str | None:
    """None if at least half of what mirrors of a reflector is flat, else the reason, as `applies_to` gives it."""
    if not np.isfinite(scene.meshes[reflector.mesh].normals).all():
        return "it has normals that are not numbers: have its mesh's normals recalculated"
    share = parts_of(scene, reflector, degrees, metres).share
    if np.isnan(share):
        return "it has no mirror-like face with an area: give it one, or a material that mirrors"
    if share < _LEAST_FLAT:
        return (
            f"it is curved: {share:.0%} of it lies in few planes, within {degrees:g} degrees and "
            f"{metres:g} m; layered-depth draws any shape"
        )
    return None


def mirrors_of(scene: Scene, index: int, parts: FlatParts) -> list[Mirror]:
    """The flat mirrors of the instance `index`, whose parts these are."""
    mesh, matrix = scene.meshes[scene.instances[index].mesh], scene.instances[index].matrix
    positions = mesh.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    mirrors = []
    for number, plane in enumerate(parts.planes):
        members = np.flatnonzero(parts.part == number)
        material = scene.instances[index].materials[np.bincount(mesh.slots[members]).argmax()]
        belongs = np.zeros(len(positions), bool)
        belongs[mesh.triangles[members]] = True
        points = positions[belongs]
        height = points @ plane[:3] + plane[3]
        outline, beyond = _outline(points - height[:, None] * plane[:3], plane)
        base = np.concatenate([outline, beyond])
        prism = np.concatenate([base + height.min() * plane[:3], base + height.max() * plane[:3]])
        mirrors.append(Mirror(index, number + 1, material, plane, prism, outline))
    return mirrors


def _outline(points: np.ndarray, plane: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the convex hull of points in the plane, in order; and the points that they do not hold.

    From two corners on, the farthest point beyond each edge is one more, until none is left or `MOST_CUTS` are
    found: an outline of so many edges is not cut by them.
    """
    flat = points @ np.linalg.svd(plane[None, :3])[2][1:].T
    order = np.lexsort(flat.T[::-1])
    corners = order[[0, -1]]
    limit = _FINE * float(np.ptp(flat, axis=0).max()) + _ROUNDING * float(np.abs(points).max())
    while True:
        start, end = flat[corners], flat[np.roll(corners, -1)]
        (x, y), length = (end - start).T, np.linalg.norm(end - start, axis=1)
        outward = np.stack([y, -x], axis=1) / np.maximum(length, 1e-30)[:, None]
        beyond = flat @ outward.T - (outward * start).sum(axis=1)
        further = np.flatnonzero(beyond.max(axis=0) > limit)
        if not len(further) or len(corners) >= MOST_CUTS:
            return points[corners], points[(beyond > limit).any(axis=1)]
        corners = np.insert(corners, further + 1, beyond[:, further].argmax(axis=0))


def reflection_matrix(plane: np.ndarray) -> np.ndarray:
    """(4, 4) that mirrors points in a plane with a unit normal (Goldman 1990, as 17.1.2 gives it)."""
    matrix = np.eye(4)
    matrix[:3, :3] -= 2.0 * np.outer(plane[:3], plane[:3])
    matrix[:3, 3] = -2.0 * plane[3] * plane[:3]
    return matrix


def towards(plane: np.ndarray, camera: Camera) -> np.ndarray | None:
    """The plane with its normal on the camera's side; None where the camera sees it edge-on."""
    if camera.ortho_scale is None:
        height = float(plane[:3] @ camera.position + plane[3])
        limit = _EDGE_ON * (1.0 + float(np.abs(camera.position).max()))
    else:
        height, limit = float(plane[:3] @ camera.matrix[:3, 2]), _EDGE_ON
    return None if abs(height) < limit else np.sign(height) * plane


def mirrored(camera: Camera, mirror: Mirror, scene: Scene) -> Camera:
    """The camera behind the mirror, which sees the scene as the mirror shows it.

    It sees as far as there is anything, since a camera's own far end is for what it sees directly; and from the
    mirror on, so that depth is precise.
    """
    matrix = reflection_matrix(mirror.plane) @ camera.matrix
    at = placed(scene)
    corners = np.maximum(np.abs(at.low - matrix[:3, 3]), np.abs(at.high - matrix[:3, 3]))
    depths = -((mirror.points - camera.position) @ camera.matrix[:3, 2])
    nearest = float(depths.min())
    near = max(camera.near, nearest - 0.01 * abs(nearest))
    return replace(
        camera, matrix=matrix, near=near, far=max(2.0 * near, 1.01 * float(np.linalg.norm(corners, axis=1).max()))
    )


def seen_within(camera: Camera, mirror: Mirror, size: tuple[int, int], bounds: Bounds) -> Bounds | None:
    """The part of `bounds` that holds the mirror, with a pixel to spare; None where it is not in there."""
    width, height = size
    at = np.c_[mirror.points, np.ones(len(mirror.points))] @ world_to_clip(camera, width, height).T
    if (at[:, 3] <= 0.0).all():
        return None
    if (at[:, 3] <= camera.near * 1e-3).any():
        return bounds
    corner = (at[:, :2] / at[:, 3:] + 1.0) / 2.0 * (width, height)
    x, y, wide, high = bounds
    low = np.maximum(np.floor(corner.min(axis=0)) - 1.0, (x, y)).astype(int)
    high_end = np.minimum(np.ceil(corner.max(axis=0)) + 1.0, (x + wide, y + high)).astype(int)
    return None if (high_end <= low).any() else (*map(int, low), *map(int, high_end - low))


def cut_at(mirror: Mirror, scene: Scene) -> np.ndarray:
    """A mirror's plane, moved towards the viewer by so little that the mirror itself, even if uneven, is behind it."""
    at = placed(scene)
    reach = max(float(np.abs(at.low).max()), float(np.abs(at.high).max()))
    height = max(0.0, float((mirror.points @ mirror.plane[:3] + mirror.plane[3]).max()))
    return mirror.plane - np.array([0.0, 0.0, 0.0, height + _TOUCH * (1.0 + reach)])


def before(plane: np.ndarray, mirror: Mirror) -> bool:
    """Whether any of a mirror is on the plane's positive side."""
    return bool((mirror.points @ plane[:3] + plane[3]).max() > 0.0)


def edge_planes(outline: np.ndarray, camera: Camera) -> np.ndarray:
    """(N, 4) planes through the camera and the edges of an outline, positive inside; none if there are too many.

    The camera may be the mirrored one: an outline is its own mirror image. What has more edges than OpenGL cuts
    by, besides the mirror's own plane, is left to other means.
    """
    if len(outline) >= MOST_CUTS:
        return np.zeros((0, 4))
    along = np.roll(outline, -1, axis=0) - outline
    sight = (
        outline - camera.position if camera.ortho_scale is None else np.broadcast_to(camera.matrix[:3, 2], along.shape)
    )
    normals = np.cross(sight, along)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    planes = np.c_[normals, -(normals * outline).sum(axis=1)]
    inside = planes @ np.append(outline.mean(axis=0), 1.0)
    return np.sign(inside)[:, None] * planes


def reached(camera: Camera, cut: np.ndarray, size: tuple[int, int], bounds: Bounds, scene: Scene) -> Sequence[int]:
    """The instances whose boxes are in front of a mirror and in the pyramid from the camera through `bounds`."""
    (x, y, wide, high), (width, height) = bounds, size
    left, right = 2.0 * x / width - 1.0, 2.0 * (x + wide) / width - 1.0
    bottom, top = 2.0 * y / height - 1.0, 2.0 * (y + high) / height - 1.0
    clip = world_to_clip(camera, width, height)
    sides = [clip[0] - left * clip[3], right * clip[3] - clip[0], clip[1] - bottom * clip[3], top * clip[3] - clip[1]]
    planes = np.array([*sides, cut])
    at = placed(scene)
    middle, half = (at.low + at.high) / 2.0, (at.high - at.low) / 2.0
    furthest = middle @ planes[:, :3].T + planes[:, 3] + half @ np.abs(planes[:, :3]).T
    shows = np.array([instance.in_reflections for instance in scene.instances])
    return [int(index) for index in np.flatnonzero((furthest >= 0.0).all(axis=1) & shows)]


def clipped_by(clipping: Clipping, mirror: Mirror, camera: Camera, cut: np.ndarray) -> np.ndarray:
    """(N, 4) the planes that cut a mirrored picture: the mirror's own, and its edges' where that is the way."""
    edges = edge_planes(mirror.outline, camera) if clipping is Clipping.CLIP_PLANES else np.zeros((0, 4))
    return np.concatenate([cut[None], edges])
