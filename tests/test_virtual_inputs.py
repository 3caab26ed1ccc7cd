"""`virtual-objects` on mirrors and scenes that are not as one would wish, against Embree."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.ray_traced import RayTraced
from catoptric.addon.methods.virtual_objects import VirtualObjects
from catoptric.addon.scene import Mesh

from .mirror_stage import differing, frame_of, pane, truth
from .search_stage import sheet
from .stage import looking, mesh_of, placed, scene_of
from .test_virtual_objects import ball, box, floor, shell, torus

SIZE = (120, 90)
ALONE = {"worth": 1_000_000, "rest": "environment-map"}
"""Settings that leave nothing to layered depth."""
VIEW = looking((1.0, -3.6, 1.9), (0.0, 0.0, 0.0), lens=45)
AROUND = [
    (floor(), placed((0, 0, -1)), False),
    (box(), placed((1.9, 0.4, -0.5), turn=0.4), False),
    (box(), placed((-1.9, -0.9, -0.7), (0.5, 1.2, 0.6), 1.1, (1, 1, 0)), False),
]
INSIDE = [(box(), placed((1, 0.5, 0)), False), (box(), placed((-1, 0.8, -0.5), (0.4, 0.4, 0.4)), False)]


def flipped(mesh: Mesh, winding: bool, normals: bool) -> Mesh:
    """The mesh with what is said turned to the other side."""
    order = [0, 2, 1] if winding else [0, 1, 2]
    return replace(mesh, triangles=mesh.triangles[:, order], normals=(-1 if normals else 1) * mesh.normals[:, order])


def room(shape: trimesh.Trimesh, smooth: bool) -> Mesh:
    """A mirror around the camera that faces inwards."""
    shape.invert()
    return mesh_of(shape, smooth=smooth)


def without_a_normal(mesh: Mesh) -> Mesh:
    normals = mesh.normals.copy()
    normals[7] = np.nan
    return replace(mesh, normals=normals)


def soup() -> Mesh:
    """Twenty triangles that pass through one another."""
    corners = np.random.default_rng(3).uniform(-1, 1, (60, 3))
    return mesh_of(trimesh.Trimesh(corners, np.arange(60).reshape(-1, 3), process=False))


def triangle() -> Mesh:
    return mesh_of(trimesh.Trimesh([[-1, 0, -1], [1, 0, -1], [0, 0, 1]], [[0, 1, 2]], process=False))


def saddle() -> Mesh:
    return sheet(lambda x, y: 0.3 * (x * x - y * y))


def twice() -> Mesh:
    """Two balls in the same place, one mesh."""
    return mesh_of(trimesh.util.concatenate([trimesh.creation.icosphere(subdivisions=2)] * 2), smooth=True)


FLAT_BALL = mesh_of(trimesh.creation.icosphere(subdivisions=2))
TILTED = placed(turn=0.9, axis=(1, 0, 0))
ODD = placed((0, 0, 0.2), (-1, 0.7, 0.9), 0.3, (1, 0, 0))
SPHERE, CRATE = trimesh.creation.icosphere(subdivisions=4, radius=3), trimesh.creation.box((6, 6, 4))

REFLECTORS = {
    "an open sheet": (shell(), placed((0, 0, 0.4))),
    "an open sheet from outside": (flipped(shell(), True, True), placed((0, 0, 0.4))),
    "a ball turned inside out": (flipped(ball(), True, True), placed()),
    "inverted normals": (flipped(ball(), False, True), placed()),
    "inverted winding": (flipped(ball(), True, False), placed()),
    "a triangle without a normal": (without_a_normal(ball()), placed()),
    "a pane": (pane(), placed((0, 1, 0), (3, 1, 2))),
    "one triangle": (triangle(), placed()),
    "a cube": (box(), placed(scale=(1.5, 1.5, 1.5), turn=0.3)),
    "a ball of facets": (FLAT_BALL, placed()),
    "a saddle": (saddle(), TILTED),
    "triangles through one another": (soup(), placed()),
    "a ball twice": (twice(), placed()),
    "a needle": (ball(), placed(scale=(1.5, 0.1, 0.1))),
    "a disc": (ball(), placed((0, 0, 0), (1.2, 1.2, 0.03), 0.4, (1, 0, 0))),
    "a ball of negative scale": (ball(), ODD),
    "a sheet of negative scale": (shell(), ODD),
    "a torus of negative scale": (torus(), ODD),
    "a ball that is sunk in the floor": (ball(), placed((0, 0, -0.7))),
    "a ball that the camera touches": (ball(), placed((1.0, -3.6, 0.8))),
}

HARD = ("a ball twice", "a sheet of negative scale", "a torus of negative scale")
"""Where rounding says which of two sheets is met first, and where caustics are, of any scale."""


def wrong_share(parts, camera=VIEW) -> tuple[float, int]:
    """The share of reflector pixels that are not what Embree sees, and how many there are."""
    scene = scene_of(parts, replace(camera, near=0.01), bounces=1, world=(0.0, 0.0, 0.7))
    frame = frame_of(scene, settings=ALONE, size=SIZE, method=VirtualObjects)
    expected = truth(scene, size=SIZE, most=2)
    mirrors = (frame.reflectors > 0) & ~expected.grazing
    assert np.isfinite(frame.color).all()
    return float(differing(frame.color, expected.color)[mirrors].mean()), int(mirrors.sum())


@pytest.mark.parametrize("name", REFLECTORS)
def test_a_reflector_of_any_make(name):
    wrong, count = wrong_share([(*REFLECTORS[name], True), *AROUND])
    assert count > 300
    assert wrong < (0.01 if name in HARD else 0.005)


@pytest.mark.parametrize("mirror", [ball(), shell()], ids=["ball", "sheet"])
def test_an_orthographic_camera(mirror):
    camera = replace(looking((0.4, -1.5, 0.7)), ortho_scale=3.0)
    wrong, count = wrong_share([(mirror, placed(), True), *AROUND], camera)
    assert count > 1000
    assert wrong < 0.003


@pytest.mark.parametrize("mirror", [room(SPHERE, True), room(CRATE, False)], ids=["sphere", "box"])
def test_a_camera_inside_the_mirror(mirror):
    wrong, count = wrong_share([(mirror, placed(), True), *INSIDE], looking((0.3, -1.2, 0.4), (0, 0.5, 0)))
    assert count > 7000
    assert wrong < 0.001


def test_a_camera_inside_a_body_that_faces_outwards():
    """Its inside is not searched, but it mirrors."""
    camera = looking((-0.5, -0.8, 0.2), (0.5, 0.2, 0.0))
    parts = [(ball(), placed(scale=(2, 2, 2)), True), (box(), placed((0.8, 0.3, 0.0), (0.5, 0.5, 0.5)), False)]
    scene = scene_of(parts, camera, world=(0.0, 0.0, 0.6))
    shown, traced = (frame_of(scene, size=SIZE, method=method) for method in (VirtualObjects, RayTraced))
    assert (traced.reflectors > 0).sum() > 0.3 * shown.reflectors.size
    assert np.mean(np.abs(shown.color - traced.color).max(axis=-1) > 1e-3) < 0.001


@pytest.mark.parametrize("matrix", [placed((0.9, -0.3, 0.2), turn=0.5), placed((0.2, -0.5, 0.2), (3, 0.2, 0.2), 0.5)])
def test_an_object_that_is_half_in_the_mirror(matrix):
    wrong, count = wrong_share([(ball(), placed(), True), (box(), matrix, False), *AROUND[:1]])
    assert count > 2000
    assert wrong < 0.002


@pytest.mark.parametrize("distance", [0.0, 0.8])
def test_mirrors_in_mirrors(distance):
    inner = placed((distance, 0, 0), (0.5, 0.5, 0.5) if distance == 0 else (1, 1, 1))
    wrong, _ = wrong_share([(ball(), placed(), True), (ball(), inner, True), *AROUND])
    assert wrong < 0.002


@pytest.mark.parametrize(("scale", "move"), [(1e-3, 0), (1e3, 0), (1, 1000)])
def test_the_picture_is_the_same_at_any_size_and_place(scale, move):
    parts = [(ball(), placed(), True), *AROUND]
    near = frame_of(scene_of(parts, VIEW, 1, (0.0, 0.0, 0.7)), settings=ALONE, size=SIZE, method=VirtualObjects)
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = move
    seen_from = VIEW.matrix.copy()
    seen_from[:3, 3] = matrix[:3, :3] @ VIEW.position + move
    camera = replace(VIEW, matrix=seen_from, near=VIEW.near * scale, far=VIEW.far * scale)
    moved = [(mesh, matrix @ own, mirrors) for mesh, own, mirrors in parts]
    far = frame_of(scene_of(moved, camera, 1, (0.0, 0.0, 0.7)), settings=ALONE, size=SIZE, method=VirtualObjects)
    assert differing(far.color, near.color).mean() < 0.002


def test_a_mirror_that_nobody_sees_and_an_object_that_nothing_mirrors():
    parts = [(ball(), placed((0, -8, 0)), True), (box(), placed((0, -6, 1)), False), *AROUND]
    scene = scene_of(parts, VIEW, 1, (0.0, 0.0, 0.7))
    frame = frame_of(scene, settings=ALONE, size=SIZE, method=VirtualObjects)
    assert not frame.reflectors.any()
    assert differing(frame.color, truth(scene, size=SIZE).color).mean() < 0.001
