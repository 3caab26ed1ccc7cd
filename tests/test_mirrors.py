"""Flat mirrors as geometry: the reflection, the camera behind it, and what may be left out of its picture."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import MOST_CUTS, Clipping, world_to_clip
from catoptric.addon.methods.mirrors import (
    Mirror,
    before,
    clipped_by,
    cut_at,
    edge_planes,
    mirrored,
    mirrors_of,
    parts_of,
    reached,
    reflection_matrix,
    seen_within,
    towards,
    why_not_flat,
)
from catoptric.addon.scene import ColorSource
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from .mirror_stage import arch, bent, grid, holed, pane
from .stage import Judge, camera_rays, looking, mesh_of, placed, scene_of
from .stage import mirrored as reflected_rays

SIZE = (48, 32)
WHOLE = (0, 0, *SIZE)


def unit(vector):
    return np.asarray(vector, float) / np.linalg.norm(vector)


directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda vector: np.linalg.norm(vector) > 0.1).map(unit)
planes = st.builds(lambda normal, offset: np.array([*normal, offset]), directions, st.floats(-50, 50))
seeds = st.integers(0, 10**6)


def mirror_in(mesh, matrix=None, camera=None, others=()) -> tuple[Mirror, object]:
    """The mesh's first flat part, and the scene in which it stands."""
    at = np.eye(4) if matrix is None else matrix
    scene = scene_of([(mesh, at, True), *others], camera or looking((0, -5, 1)))
    return mirrors_of(scene, 0, parts_of(scene, scene.instances[0], 0.5, 0.001))[0], scene


def by_the_text(plane):
    """17.1.2: the plane to the origin, into x and y, a scale of -1 along z, and back again."""
    normal = plane[:3]
    to_origin, flip = np.eye(4), np.diag([1.0, 1.0, -1.0, 1.0])
    to_origin[:3, 3] = plane[3] * normal
    side = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    into_plane = np.eye(4)
    into_plane[:3, :3] = side, np.cross(normal, side), normal
    return np.linalg.inv(to_origin) @ into_plane.T @ flip @ into_plane @ to_origin


@given(planes)
def test_the_reflection_is_the_texts_five_steps(plane):
    np.testing.assert_allclose(reflection_matrix(plane), by_the_text(plane), atol=1e-10)


@given(planes, st.tuples(*[st.floats(-20, 20)] * 3))
def test_the_reflection_undoes_itself_and_turns_hands(plane, point):
    matrix = reflection_matrix(plane)
    np.testing.assert_allclose(matrix @ matrix, np.eye(4), atol=1e-10)
    assert np.linalg.det(matrix) == pytest.approx(-1.0)
    image = (matrix @ [*point, 1.0])[:3]
    height = plane @ [*point, 1.0]
    np.testing.assert_allclose(image, np.asarray(point) - 2.0 * height * plane[:3], atol=1e-9)


def test_the_mirrored_camera_stands_behind_and_is_left_handed():
    camera = looking((1.0, -4.0, 2.0))
    mirror, scene = mirror_in(pane(), camera=camera)
    behind = mirrored(camera, mirror, scene)
    np.testing.assert_allclose(behind.position, (1.0, 4.0, 2.0), atol=1e-12)
    assert np.linalg.det(behind.matrix[:3, :3]) == pytest.approx(-1.0)
    on_it = np.array([0.3, 0.0, -0.2, 1.0])
    ours, theirs = (world_to_clip(one, *SIZE) @ on_it for one in (camera, behind))
    np.testing.assert_allclose(ours[:2] / ours[3], theirs[:2] / theirs[3])  # a mirror lies where it is seen


@given(seeds, st.booleans())
def test_the_mirrored_camera_sees_from_the_mirror_to_the_farthest_thing(seed, flat):
    rng = np.random.default_rng(seed)
    camera = replace(looking(rng.uniform(-4, 4, 3) + (0, -5, 0)), near=-90.0 if flat else 0.01)
    camera = replace(camera, ortho_scale=6.0) if flat else camera
    far_thing = (mesh_of(trimesh.creation.box()), placed(rng.uniform(-80, 80, 3)), False)
    mirror, scene = mirror_in(
        pane(), placed(rng.uniform(-3, 3, 3), turn=rng.uniform(0, 6), axis=rng.normal(size=3)), camera, [far_thing]
    )
    behind = mirrored(camera, mirror, scene)
    depth = (mirror.points - camera.position) @ -camera.matrix[:3, 2]
    assert behind.near <= max(depth.min(), camera.near)
    corners = scene.meshes[1].positions @ scene.instances[1].matrix[:3, :3].T + scene.instances[1].matrix[:3, 3]
    assert behind.far >= ((corners - behind.position) @ -behind.matrix[:3, 2]).max()


def test_a_mirror_behind_an_orthographic_camera_is_not_cut_off():
    camera = replace(looking((0, -5, 0)), ortho_scale=6.0, near=-90.0)
    mirror, scene = mirror_in(pane(), placed((0, -20, 0)), camera)
    depth = (mirror.points - camera.position) @ -camera.matrix[:3, 2]
    assert -15.5 < mirrored(camera, mirror, scene).near <= depth.min() < -14.9


def test_the_plane_turns_to_the_camera_and_vanishes_edge_on():
    plane = np.array([0.0, 1.0, 0.0, 0.0])
    np.testing.assert_array_equal(towards(plane, looking((0, -3, 1))), -plane)
    np.testing.assert_array_equal(towards(plane, looking((0, 3, 1))), plane)
    assert towards(plane, looking((2.0, 0.0, 1.0))) is None
    sideways = replace(looking((2.0, 1.0, 0.0), (0.0, 1.0, 0.0)), ortho_scale=3.0)
    assert towards(plane, sideways) is None  # beside it, but along it
    np.testing.assert_array_equal(towards(plane, replace(looking((0, 3, 1), (0, 9, 1)), ortho_scale=3.0)), -plane)


def test_a_cut_leaves_the_mirror_behind_and_next_to_nothing_else():
    mirror, scene = mirror_in(holed(), placed((3, -2, 1), (7, 1, 7), turn=0.7, axis=(1, 2, 3)))
    facing = replace(mirror, plane=towards(mirror.plane, scene.camera))
    cut = cut_at(facing, scene)
    heights = facing.points @ cut[:3] + cut[3]
    assert heights.max() < 0.0
    assert heights.min() > -2e-5
    assert not before(cut, facing)
    assert before(-cut, facing)


def test_a_cut_clears_an_uneven_mirror():
    mesh = grid(10, 10)
    positions = mesh.positions + 0.0003 * np.sin(9.0 * mesh.positions[:, :1]) * np.float32([0, 1, 0])
    mirror, scene = mirror_in(replace(mesh, positions=positions.astype(np.float32)))
    cut = cut_at(replace(mirror, plane=towards(mirror.plane, scene.camera)), scene)
    assert (positions @ cut[:3] + cut[3]).max() < 0.0


def hull_area(points):
    """Of corners in order, in x and z."""
    x, z = points[:, 0], points[:, 2]
    return 0.5 * abs((x * np.roll(z, -1) - z * np.roll(x, -1)).sum())


@pytest.mark.parametrize(
    ("mesh", "corners", "area"), [(pane(), 4, 1.0), (grid(9, 4), 4, 1.0), (holed(), 4, 1.0), (bent(), 5, 0.875)]
)
def test_the_outline_is_the_convex_hull(mesh, corners, area):
    mirror, _ = mirror_in(mesh)
    assert len(mirror.outline) == corners
    assert hull_area(mirror.outline) == pytest.approx(area)


def test_rounding_adds_no_corner_to_the_outline():
    fine = grid(30, 30)
    turn = placed((30.0, 20.0, 10.0), turn=0.7, axis=(1, 2, 3))
    positions = (fine.positions @ turn[:3, :3].T + turn[:3, 3]).astype(np.float32)
    normals = (fine.normals @ turn[:3, :3].T).astype(np.float32)
    mirror, _ = mirror_in(replace(fine, positions=positions, normals=normals))
    assert len(mirror.outline) == 4


@settings(max_examples=40, deadline=None)
@given(st.integers(3, 7), seeds, directions)
def test_outlines_of_few_corners_are_found_among_many_points(count, seed, axis):
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(-0.2, 0.2, count)) / count
    corners = np.c_[np.cos(angles), np.zeros(count), np.sin(angles)]
    inner = rng.dirichlet(np.full(count, 0.3), 60) @ corners
    triangles = [[0, number, number + 1] for number in range(1, count - 1)]
    triangles += rng.integers(0, count + 60, (80, 3)).tolist()
    mesh = mesh_of(trimesh.Trimesh(np.vstack([corners, inner]), triangles, process=False))
    mesh = replace(mesh, normals=np.broadcast_to(np.float32([0, -1, 0]), mesh.normals.shape).copy())
    turn = placed((3, 1, 2), turn=1.0, axis=axis)
    mirror, _ = mirror_in(mesh, turn)
    wanted = corners @ turn[:3, :3].T + turn[:3, 3]
    gaps = np.linalg.norm(mirror.outline[:, None] - wanted, axis=2)
    assert len(mirror.outline) == count
    assert gaps.min(axis=1).max() < 1e-5
    steps = (gaps.argmin(axis=1) - np.roll(gaps.argmin(axis=1), 1)) % count
    assert set(steps) in ({1}, {count - 1})  # in order, either way round


def test_an_arch_has_too_many_edges_to_cut_by():
    mirror, scene = mirror_in(arch())
    assert len(mirror.outline) >= MOST_CUTS
    assert edge_planes(mirror.outline, scene.camera).shape == (0, 4)
    cut = cut_at(mirror, scene)
    np.testing.assert_array_equal(clipped_by(Clipping.CLIP_PLANES, mirror, scene.camera, cut), cut[None])


@pytest.mark.parametrize("flat", [False, True], ids=["perspective", "orthographic"])
def test_edge_planes_cut_along_the_edges(flat):
    camera = replace(looking((1.0, -4.0, 2.0)), ortho_scale=4.0 if flat else None)
    mirror, scene = mirror_in(pane(), placed((0.3, 0.2, 0.1), turn=0.4), camera)
    edges = edge_planes(mirror.outline, camera)
    assert edges.shape == (4, 4)
    origins, rays = camera_rays(camera, *SIZE)
    inside = Judge(scene).meet(origins, rays).instance >= 0
    for distance in (3.0, 20.0):  # before the mirror and behind it
        points = np.c_[origins + distance * rays, np.ones(len(rays))]
        np.testing.assert_array_equal((points @ edges.T > 0).all(axis=1), inside)
    behind = edge_planes(mirror.outline, mirrored(camera, mirror, scene))
    points = np.c_[scene.meshes[0].positions @ scene.instances[0].matrix[:3, :3].T + (0.3, 0.2, 0.1), np.ones(4)]
    np.testing.assert_allclose((points @ behind.T).min(axis=0), 0.0, atol=1e-6)
    only_itself = clipped_by(Clipping.STENCIL, mirror, camera, cut_at(mirror, scene))
    assert len(only_itself) == 1
    assert len(clipped_by(Clipping.CLIP_PLANES, mirror, camera, only_itself[0])) == 5


def test_an_edge_that_is_seen_along_cuts_nothing():
    mirror, _ = mirror_in(pane())
    camera = looking(mirror.outline[0] + 2.0 * (mirror.outline[0] - mirror.outline[1]), (0.1, 0.1, 0.1))
    edges = edge_planes(mirror.outline, camera)
    assert np.isfinite(edges).all()
    middle = np.append(mirror.outline.mean(axis=0), 1.0)
    assert (edges @ middle > -1e-9).all()


@settings(max_examples=60, deadline=None)
@given(seeds, st.booleans())
def test_no_pixel_of_a_mirror_is_outside_its_bounds(seed, flat):
    rng = np.random.default_rng(seed)
    camera = replace(looking(rng.uniform(-2, 2, 3) + (0, -3, 0), lens=rng.uniform(15, 80)), near=rng.uniform(0.01, 0.5))
    camera = replace(camera, ortho_scale=4.0) if flat else camera
    at = placed(rng.uniform(-3, 3, 3), (*rng.uniform(0.1, 9, 2), 1.0), rng.uniform(0, 6), rng.normal(size=3))
    mirror, scene = mirror_in(pane(), at @ placed(turn=np.pi / 2, axis=(1, 0, 0)), camera)
    given_bounds = (4, 3, 30, 20)
    found = seen_within(camera, mirror, SIZE, given_bounds)
    pixels = Judge(scene).meet(*camera_rays(camera, *SIZE)).instance.reshape(SIZE[::-1])[::-1] >= 0
    inside = np.zeros_like(pixels)
    inside[3:23, 4:34] = True
    held = np.zeros_like(pixels)
    if found:
        x, y, wide, high = found
        assert wide > 0 < high
        assert x >= 4 <= x + wide <= 34
        assert y >= 3 <= y + high <= 23
        held[y : y + high, x : x + wide] = True
    assert not (pixels & inside & ~held).any()


def test_bounds_are_tight():
    mirror, scene = mirror_in(grid(40, 40), placed((0.4, 0, 0.3), (0.5, 1, 0.5)))
    x, y, wide, high = seen_within(scene.camera, mirror, SIZE, WHOLE)
    pixels = Judge(scene).meet(*camera_rays(scene.camera, *SIZE)).instance.reshape(SIZE[::-1])[::-1] >= 0
    rows, columns = np.flatnonzero(pixels.any(axis=1)), np.flatnonzero(pixels.any(axis=0))
    assert x + 3 >= columns[0]
    assert x + wide - 4 <= columns[-1]
    assert y + 3 >= rows[0]
    assert y + high - 4 <= rows[-1]


def test_what_is_behind_the_camera_or_off_the_screen_has_no_bounds():
    for place in ((0, -9, 1), (40, 0, 0), (0, 0, -30)):
        mirror, scene = mirror_in(pane(), placed(place))
        assert seen_within(scene.camera, mirror, SIZE, WHOLE) is None


@settings(max_examples=40, deadline=None)
@given(seeds, st.booleans())
def test_nothing_is_left_out_that_a_mirrored_ray_hits(seed, flat):
    rng = np.random.default_rng(seed)
    box = mesh_of(trimesh.creation.box())
    things = [
        (box, placed(rng.uniform(-6, 6, 3), rng.uniform(0.1, 3, 3), rng.uniform(0, 6), rng.normal(size=3)), False)
        for _ in range(12)
    ]
    camera = replace(looking(rng.uniform(-2, 2, 3) + (0, -4, 0)), ortho_scale=6.0 if flat else None)
    at = placed(rng.uniform(-2, 2, 3), (4, 1, 3), rng.uniform(-1, 1), rng.normal(size=3))
    mirror, scene = mirror_in(pane(), at, camera, things)
    plane = towards(mirror.plane, camera)
    bounds = seen_within(camera, mirror, SIZE, WHOLE)
    assume(plane is not None and bounds)
    facing = replace(mirror, plane=plane)
    found = reached(mirrored(camera, facing, scene), cut_at(facing, scene), SIZE, bounds, scene)
    judge = Judge(scene)
    origins, rays = camera_rays(camera, *SIZE)
    met = judge.meet(origins, rays)
    seen = met.instance == 0
    start, onwards = reflected_rays(met, rays)
    hit = judge.meet(start[seen], onwards[seen]).instance
    assert set(hit[hit > 0]) <= set(found)


def test_what_is_out_of_reach_is_left_out():
    box = mesh_of(trimesh.creation.box())
    places = {"shown": (0, -3, 0), "behind": (0, 3, 0), "aside": (30, -3, 0), "hidden": (0.2, -2, 0)}
    mirror, scene = mirror_in(pane(), others=[(box, placed(place), False) for place in places.values()])
    instances = list(scene.instances)
    instances[4] = replace(instances[4], in_reflections=False)
    scene = replace(scene, instances=tuple(instances))
    facing = replace(mirror, plane=towards(mirror.plane, scene.camera))
    camera = mirrored(scene.camera, facing, scene)
    found = reached(camera, cut_at(facing, scene), SIZE, seen_within(scene.camera, facing, SIZE, WHOLE), scene)
    assert list(found) == [1]


def reason(mesh, matrix=None, degrees=0.5, metres=0.001):
    scene = scene_of([(mesh, np.eye(4) if matrix is None else matrix, True)], looking((0, -5, 1)))
    return why_not_flat(scene, scene.instances[0], degrees, metres)


def test_what_is_flat_needs_no_reason():
    for mesh in (pane(), holed(), arch(), mesh_of(trimesh.creation.box())):
        assert reason(mesh) is None


def test_reasons_tell_what_is_wrong():
    without_normals = replace(pane(), normals=np.full((2, 3, 3), np.nan, np.float32))
    told = {
        "it is curved: 0% of it lies in few planes, within 0.5 degrees and 0.001 m": reason(
            mesh_of(trimesh.creation.icosphere(3), smooth=True)
        ),
        "it has normals that are not numbers": reason(without_normals),
        "it has no mirror-like face with an area": reason(replace(pane(), positions=np.zeros((4, 3), np.float32))),
    }
    for clue, line in told.items():
        assert line.startswith(clue)
        assert "\n" not in line


def test_a_nearly_flat_mirror_is_one_within_the_tolerances_that_are_asked_for():
    mesh = grid(40, 10)
    waves = mesh.positions + 0.01 * np.sin(9.0 * mesh.positions[:, :1]) * np.float32([0, 1, 0])
    uneven = mesh_of(trimesh.Trimesh(waves, mesh.triangles, process=False))
    assert "curved" in reason(uneven)
    assert "curved" in reason(uneven, degrees=8.0, metres=5e-5)
    assert "curved" in reason(uneven, degrees=0.05, metres=0.05)
    assert reason(uneven, degrees=8.0, metres=0.05) is None


def test_parts_are_found_anew_for_another_mesh_matrix_or_material():
    scene = scene_of([(pane(), np.eye(4), True)], looking((0, -5, 1)))
    first = parts_of(scene, scene.instances[0], 0.5, 0.001)
    assert parts_of(replace(scene, camera=looking((1, -5, 1))), scene.instances[0], 0.5, 0.001) is first
    other_mesh = replace(scene, meshes=(mesh_of(trimesh.creation.box()),))
    assert len(parts_of(other_mesh, scene.instances[0], 0.5, 0.001).planes) == 6
    moved = replace(scene.instances[0], matrix=placed((0, 2, 0)))
    assert abs(parts_of(replace(scene, instances=(moved,)), moved, 0.5, 0.001).planes[0, 3]) == pytest.approx(2.0)
    dull = replace(scene, materials=(replace(scene.materials[0], reflection=ColorSource((0.0, 0.0, 0.0))),))
    assert np.isnan(parts_of(dull, scene.instances[0], 0.5, 0.001).share)
