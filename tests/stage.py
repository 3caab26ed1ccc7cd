"""Scenes made of plain arrays, and Embree as their judge."""

from dataclasses import dataclass

import numpy as np
import trimesh
from catoptric.addon.scene import BLACK, Camera, ColorSource, Fresnel, Instance, Material, Mesh, Scene, World
from trimesh.ray.ray_pyembree import RayMeshIntersector

CHROME = Material(
    "chrome", diffuse=0.0, reflection=ColorSource((1.0, 1.0, 1.0)), fresnel=Fresnel.CONSTANT, roughness=BLACK
)


def mesh_of(shape: trimesh.Trimesh, smooth: bool = False, name: str = "mesh") -> Mesh:
    """A trimesh as a Mesh without texture coordinates."""
    triangles = np.asarray(shape.faces, np.int32)
    flat = np.repeat(shape.face_normals[:, None], 3, axis=1)
    normals = shape.vertex_normals[triangles] if smooth else flat
    uvs = np.zeros((len(triangles), 3, 2), np.float32)
    slots = np.zeros(len(triangles), np.int32)
    return Mesh(name, np.asarray(shape.vertices, np.float32), triangles, normals.astype(np.float32), uvs, slots)


def placed(position=(0.0, 0.0, 0.0), scale=(1.0, 1.0, 1.0), turn=0.0, axis=(0.0, 0.0, 1.0)) -> np.ndarray:
    """A (4, 4) matrix: scale, then a turn in radians about an axis, then a move."""
    matrix = trimesh.transformations.rotation_matrix(turn, axis) @ np.diag([*scale, 1.0])
    matrix[:3, 3] = position
    return matrix


def looking(position, target=(0.0, 0.0, 0.0), lens: float = 50.0) -> Camera:
    """A camera at `position` that looks at `target`, Z up."""
    position, target = np.asarray(position, float), np.asarray(target, float)
    back = (position - target) / np.linalg.norm(position - target)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([right, np.cross(back, right), back], axis=1)
    matrix[:3, 3] = position
    return Camera(matrix, lens=lens)


def colored(index: int) -> Material:
    """A material whose unlit radiance names the object: exact in float32, never the world's black."""
    return Material(f"object {index}", base=ColorSource((float(index + 1), 1.0, 0.0)))


def scene_of(parts, camera: Camera, bounces: int = 4, world=(0.0, 0.0, 0.0)) -> Scene:
    """A scene of (mesh, matrix, mirrors?) parts; part i has the colour of `colored(i)` or is chrome."""
    meshes = list({id(mesh): mesh for mesh, _, _ in parts}.values())
    index = {id(mesh): number for number, mesh in enumerate(meshes)}
    materials = [CHROME if mirrors else colored(number) for number, (_, _, mirrors) in enumerate(parts)]
    instances = [
        Instance(f"object {number}", index[id(mesh)], matrix, (number,), reflector=mirrors)
        for number, (mesh, matrix, mirrors) in enumerate(parts)
    ]
    return Scene(
        "stage", camera, tuple(meshes), tuple(instances), tuple(materials), world=World(world), glossy_bounces=bounces
    )


@dataclass
class Met:
    """What rays meet: `instance` (N,) or -1, `distance` (N,), `position`, `normal`, `flat` (N, 3) towards the ray."""

    instance: np.ndarray
    triangle: np.ndarray
    distance: np.ndarray
    position: np.ndarray
    normal: np.ndarray
    flat: np.ndarray


class Judge:
    """Every triangle of a scene in Embree, in world space."""

    def __init__(self, scene: Scene) -> None:
        """Build the hierarchy."""
        meshes = [scene.meshes[instance.mesh] for instance in scene.instances]
        corners = [
            mesh.corners.astype(float) @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
            for mesh, instance in zip(meshes, scene.instances, strict=True)
        ]
        normals = [
            mesh.normals.astype(float) @ np.linalg.inv(instance.matrix[:3, :3])
            for mesh, instance in zip(meshes, scene.instances, strict=True)
        ]
        turned = [
            np.full(len(c), np.sign(np.linalg.det(i.matrix[:3, :3])))
            for c, i in zip(corners, scene.instances, strict=True)
        ]
        self.corners, self.normals, self.turned = map(np.concatenate, (corners, normals, turned))
        self.owner = np.repeat(np.arange(len(corners)), [len(part) for part in corners])
        faces = np.arange(3 * len(self.corners)).reshape(-1, 3)
        shape = trimesh.Trimesh(self.corners.reshape(-1, 3), faces, process=False)
        self.rays = RayMeshIntersector(shape, scale_to_box=False)

    def meet(self, origins: np.ndarray, directions: np.ndarray) -> Met:
        """The first thing that each ray meets; directions of unit length."""
        triangle = self.rays.intersects_first(origins, directions)
        corners = self.corners[triangle]
        ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        flat = np.cross(ab, ac)
        facing = (flat * directions).sum(-1)
        distance = ((corners[:, 0] - origins) * flat).sum(-1) / np.where(facing == 0, 1, facing)
        position = origins + distance[:, None] * directions
        area = (flat * flat).sum(-1)
        v = (np.cross(position - corners[:, 0], ac) * flat).sum(-1) / area
        w = (np.cross(ab, position - corners[:, 0]) * flat).sum(-1) / area
        weight = np.stack([1 - v - w, v, w], -1)
        flat *= (self.turned[triangle] / np.sqrt(area))[:, None]
        normal = (weight[..., None] * self.normals[triangle]).sum(1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        backside = ((flat * directions).sum(-1) > 0)[:, None]
        owner = np.where(triangle < 0, -1, self.owner[triangle])
        distance = np.where(triangle < 0, np.inf, distance)
        return Met(
            owner, triangle, distance, position, np.where(backside, -normal, normal), np.where(backside, -flat, flat)
        )


def camera_rays(camera: Camera, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and unit directions (height * width, 3) through the pixels' centres, top row first."""
    left, right, bottom, top = camera.window(width, height)
    x = left + (np.arange(width) + 0.5) / width * (right - left)
    y = top - (np.arange(height) + 0.5) / height * (top - bottom)
    grid = np.stack([*np.meshgrid(x, y), -np.ones((height, width))], -1).reshape(-1, 3)
    if camera.ortho_scale is not None:
        origins = grid * (1.0, 1.0, 0.0) @ camera.matrix[:3, :3].T + camera.position
        return origins, np.broadcast_to(-camera.matrix[:3, 2], origins.shape).copy()
    directions = grid @ camera.matrix[:3, :3].T
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.broadcast_to(camera.position, directions.shape).copy(), directions


def mirrored(met: Met, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Origins (a hair off the surface) and directions of the reflected rays."""
    reflected = directions - 2 * (directions * met.normal).sum(-1, keepdims=True) * met.normal
    return met.position + 1e-6 * met.flat, reflected
