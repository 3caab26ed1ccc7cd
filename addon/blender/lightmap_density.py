"""How large things appear, so that a lightmap's texels lie where they are seen."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..scene import Instance, Mesh, Scene

_OUTSIDE = 0.25
"""The least weight of what lies out of the picture: a mirror that is far away may still show it."""

_STEEPEST = 1.4
"""How many times as large one end of an edge may appear as the other."""

_SHORTEST = 0.03
"""The length of edges that stay whole, as a share of the distance that they appear from."""

_ROUNDS = 8
"""How often an edge is halved at most: a part is never shorter than its 256th."""

# Parts of a triangle with its first one, two or all edges halved; corners 0 1 2, then the middles of 01 12 20.
_PARTS = {
    1: np.array([[0, 3, 2], [3, 1, 2]]),
    2: np.array([[3, 1, 4], [0, 3, 4], [0, 4, 2]]),
    3: np.array([[3, 1, 4], [0, 3, 5], [5, 4, 2], [3, 4, 5]]),
}

Appearance = Callable[[np.ndarray], np.ndarray]
"""World points (..., 3) to how large a metre appears there, as one over a distance in metres (...)."""


def appearance(scene: Scene) -> Appearance:
    """How large things appear to the camera, directly or in the reflector that shows them largest.

    A reflector counts as its bounding sphere, flattened by as much as its normals agree: a ball of
    radius R at distance D shows what lies d away as if it lay D + d (1 + 2 D / R) away, a flat mirror
    as if D + d. Nothing is hidden by anything.
    """
    spheres = [_sphere(scene, scene.instances[index]) for index in scene.reflectors]

    def seen(points: np.ndarray) -> np.ndarray:
        largest = _directly(scene, points)
        for centre, radius, roundness in spheres:
            nearest = max(np.linalg.norm(centre - scene.camera.position) - radius, radius, scene.camera.near)
            away = np.maximum(np.linalg.norm(points - centre, axis=-1) - radius, 0.0)
            largest = np.maximum(largest, 1.0 / (nearest + away * (1.0 + 2.0 * roundness * nearest / radius)))
        return largest

    return seen


def _directly(scene: Scene, points: np.ndarray) -> np.ndarray:
    camera = scene.camera
    local = (points - camera.position) @ camera.matrix[:3, :3]
    left, right, bottom, top = camera.window(*scene.resolution)
    centre, half = np.array([left + right, bottom + top]) / 2, np.array([right - left, top - bottom]) / 2
    distance = np.maximum(np.linalg.norm(local, axis=-1), max(camera.near, 1e-6))
    if camera.ortho_scale is None:
        depth = -local[..., 2]
        in_front = depth > 0.05 * distance
    else:
        depth, distance = np.ones_like(distance), np.full_like(distance, camera.ortho_scale)
        in_front = local[..., 2] < 0.0
    places = local[..., :2] / np.where(in_front, depth, 1.0)[..., None]
    beyond = np.maximum(np.abs(places - centre) / half - 1.0, 0.0).max(axis=-1)
    return np.maximum(in_front / (1.0 + 2.0 * beyond), _OUTSIDE) / distance


def _sphere(scene: Scene, instance: Instance) -> tuple[np.ndarray, float, float]:
    """Centre, radius and roundness (0 flat, 1 closed) of a reflector in the world."""
    corners = world_corners(scene.meshes[instance.mesh], instance)
    points = corners.reshape(-1, 3)
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = max(float(np.linalg.norm(points - centre, axis=1).max()), 1e-6)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    agreed = np.linalg.norm(facing.sum(axis=0)) / max(np.linalg.norm(facing, axis=1).sum(), 1e-30)
    return centre, radius, 1.0 - float(agreed)


def world_corners(mesh: Mesh, instance: Instance) -> np.ndarray:
    """(T, 3, 3) float64: the corners of an instance's triangles in the world."""
    return mesh.corners.astype(np.float64) @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]


def seen_area(scene: Scene, index: int, seen: Appearance) -> tuple[np.ndarray, np.ndarray]:
    """Of each triangle of an instance, (T,): how large a metre of it appears, and its area in square metres."""
    instance = scene.instances[index]
    corners = world_corners(scene.meshes[instance.mesh], instance)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return seen(corners.mean(axis=1)), area


def split_where_seen(scene: Scene, receivers: list[int], seen: Appearance) -> Scene:
    """`scene` with the triangles of `receivers` split until each appears about equally large all over.

    An edge is halved or not by its ends alone, so that neighbours agree and no gap opens; all that
    corners carry is interpolated. Meshes that mirror keep their triangles: their normals are seen. Those
    with lightmap coordinates were split for them, and stay as they are.
    """
    mirrors = {scene.instances[index].mesh for index in scene.reflectors}
    meshes = list(scene.meshes)
    for number, users in users_of_meshes(scene, receivers).items():
        if number not in mirrors and meshes[number].lightmap_uvs is None:
            meshes[number] = _split(meshes[number], [scene.instances[index] for index in users], seen)
    return replace(scene, meshes=tuple(meshes))


def users_of_meshes(scene: Scene, instances: list[int]) -> dict[int, list[int]]:
    """Which of the instances show a mesh, by mesh."""
    users: dict[int, list[int]] = {}
    for index in instances:
        users.setdefault(scene.instances[index].mesh, []).append(index)
    return users


def _split(mesh: Mesh, users: list[Instance], seen: Appearance) -> Mesh:
    parents = np.arange(len(mesh.triangles))
    weights = np.broadcast_to(np.eye(3), (len(parents), 3, 3))
    open_ones = np.ones(len(parents), bool)
    for _ in range(_ROUNDS):
        corners = weights[open_ones] @ mesh.corners[parents[open_ones]].astype(np.float64)
        halved = np.zeros((len(parents), 3), bool)
        halved[open_ones] = np.any([_uneven(corners, user, seen) for user in users], axis=0)
        if not halved.any():
            break
        kept = ~halved.any(axis=1)
        origin, parts = _halve(weights, halved)
        weights = np.concatenate([weights[kept], parts])
        open_ones = np.repeat([False, True], [kept.sum(), len(parts)])
        parents = np.concatenate([parents[kept], parents[origin]])
    if len(parents) == len(mesh.triangles):
        return mesh
    order = np.argsort(parents, kind="stable")
    return _rebuilt(mesh, parents[order], weights[order])


def _uneven(corners: np.ndarray, instance: Instance, seen: Appearance) -> np.ndarray:
    """(T, 3) bool: which edges appear much larger at one end than at the other; edge k leaves corner k."""
    start = corners @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
    end = start[:, [1, 2, 0]]
    sizes = np.stack([seen(start), seen((start + end) / 2), seen(end)])
    largest = sizes.max(axis=0)
    return (largest > _STEEPEST * sizes.min(axis=0)) & (np.linalg.norm(end - start, axis=-1) * largest > _SHORTEST)


def _halve(weights: np.ndarray, halved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The parts (P, 3, 3) of triangles with edges to halve, and the triangle (P,) each comes from."""
    origins, results = [], []
    count = halved.sum(axis=1)
    for edges, parts in _PARTS.items():
        chosen = np.flatnonzero(count == edges)
        # Turned so that the halved edges come first: behind the one that stays, or from the only one.
        first = np.argmax(halved[chosen], axis=1) if edges == 1 else (np.argmin(halved[chosen], axis=1) + 1) % 3
        turned = weights[chosen[:, None], (first[:, None] + [0, 1, 2]) % 3]
        points = np.concatenate([turned, (turned + turned[:, [1, 2, 0]]) / 2], axis=1)
        results.append(points[:, parts].reshape(-1, 3, 3))
        origins.append(np.repeat(chosen, len(parts)))
    return np.concatenate(origins), np.concatenate(results)


def _rebuilt(mesh: Mesh, parents: np.ndarray, weights: np.ndarray) -> Mesh:
    """The mesh of triangles given by their corners' `weights` (P, 3, 3) in the triangles they are parts of."""
    # A corner is known by the vertices that it lies between and its weights, whichever triangle it is part of.
    flat = weights.reshape(-1, 3)
    vertices = np.where(flat > 0, np.repeat(mesh.triangles[parents], 3, axis=0), -1)
    order = np.argsort(vertices, axis=1, kind="stable")
    names = [np.take_along_axis(part, order, axis=1) for part in (vertices.astype(np.float64), flat)]
    _, first, index = np.unique(np.concatenate(names, axis=1), axis=0, return_index=True, return_inverse=True)
    positions = np.einsum("nk,nkc->nc", flat, np.repeat(mesh.corners[parents].astype(np.float64), 3, axis=0))
    normals = weights @ mesh.normals[parents]
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    return replace(
        mesh,
        positions=positions[first].astype(np.float32),
        triangles=index.reshape(-1, 3).astype(np.int32),
        normals=(normals / np.where(lengths > 0, lengths, 1.0)).astype(np.float32),
        uvs=(weights @ mesh.uvs[parents]).astype(np.float32),
        slots=mesh.slots[parents],
        colors=None if mesh.colors is None else (weights @ mesh.colors[parents]).astype(np.float32),
        lightmap_uvs=None,
    )
