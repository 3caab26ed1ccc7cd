"""The flat parts of a mesh: planes that are known beforehand."""

import numpy as np
import pytest
import trimesh
from catoptric.addon.tracing import FlatParts, flat_parts
from hypothesis import given
from hypothesis import strategies as st

from .mirror_stage import bent, grid, holed
from .stage import mesh_of, placed

DEGREES, METRES, MOST = 0.5, 0.001, 8


def parts_of(mesh, among=None, degrees=DEGREES, metres=METRES, most=MOST) -> FlatParts:
    """The parts of all triangles, or of those that `among` names."""
    chosen = np.ones(len(mesh.triangles), bool) if among is None else among
    return flat_parts(mesh.corners, mesh.normals, chosen, degrees, metres, most)


def areas_of(mesh):
    corners = mesh.corners.astype(float)
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2


def box():
    return mesh_of(trimesh.creation.box((1.0, 2.0, 3.0)))


def test_a_box_has_six_planes():
    mesh = box()
    parts = parts_of(mesh)
    assert parts.share == pytest.approx(1.0)
    assert sorted(np.bincount(parts.part)) == [2] * 6
    distances = np.abs(mesh.corners @ parts.planes[parts.part][:, :3, None])[..., 0]
    np.testing.assert_allclose(distances, np.abs(parts.planes[parts.part, 3:]).repeat(3, axis=1), atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(parts.planes[:, :3], axis=1), 1.0)
    assert sorted(np.round(np.abs(parts.planes[:, 3]), 6)) == [0.5, 0.5, 1.0, 1.0, 1.5, 1.5]


def test_the_largest_parts_are_found_first():
    parts = parts_of(box(), most=2)
    assert np.abs(parts.planes[:, 3]) == pytest.approx([0.5, 0.5])
    assert parts.share == pytest.approx(12.0 / 22.0)
    assert (parts.part == -1).sum() == 8


def test_a_part_of_many_small_triangles_comes_before_few_large_ones():
    fine = grid(20, 20)
    corners, normals = [fine.corners], [fine.normals]
    for number in range(MOST + 4):  # each larger than any triangle of the grid
        turned = placed(turn=0.1 * (number + 1))[:3, :3].astype(np.float32)
        corners.append((0.2 * fine.corners[:1] / 0.05 + np.float32([0, 1, 0])) @ turned.T)
        normals.append(fine.normals[:1] @ turned.T)
    corners, normals = np.concatenate(corners), np.concatenate(normals)
    parts = flat_parts(corners, normals, np.ones(len(corners), bool), DEGREES, METRES, MOST)
    assert (parts.part[:800] == 0).all()
    assert len(parts.planes) == MOST


@pytest.mark.parametrize("shape", [holed, bent], ids=["a hole", "an L"])
def test_an_outline_is_as_it_likes(shape):
    mesh = shape()
    parts = parts_of(mesh)
    assert (parts.part == 0).all()
    np.testing.assert_allclose(np.abs(parts.planes), [[0, 1, 0, 0]], atol=1e-12)


def test_panes_of_one_plane_are_one_part_and_others_are_not():
    pane = grid(1, 1)
    shifts = np.float32([[0, 0, 0], [2, 0, 0], [0, 0.01, 3]])
    corners = np.concatenate([pane.corners + shift for shift in shifts])
    parts = flat_parts(corners, np.concatenate([pane.normals] * 3), np.ones(6, bool), DEGREES, METRES, MOST)
    assert parts.part[0] == parts.part[1] == parts.part[2] == parts.part[3] != parts.part[4] == parts.part[5]
    assert len(parts.planes) == 2


def test_faces_of_either_side_are_one_part():
    pane = grid(1, 1)
    corners = np.stack([pane.corners[0], pane.corners[1][::-1]])
    parts = flat_parts(corners, pane.normals * [[[1]], [[-1]]], np.ones(2, bool), DEGREES, METRES, MOST)
    assert parts.part.tolist() == [0, 0]
    np.testing.assert_allclose(np.abs(parts.planes), [[0, 1, 0, 0]], atol=1e-12)


def roof(degrees: float):
    """Two unit squares that meet at an edge, one turned about it."""
    angle = np.radians(degrees)
    turned = [np.cos(angle), np.sin(angle), 0.0]
    vertices = [[0, 0, 0], [0, 0, 1], [-1.2, 0, 0], [-1.2, 0, 1], turned, [*turned[:2], 1.0]]
    faces = [[0, 1, 3], [0, 3, 2], [0, 4, 5], [0, 5, 1]]
    return mesh_of(trimesh.Trimesh(vertices, faces, process=False))


@pytest.mark.parametrize(("turn", "together"), [(0.0, True), (0.9, True), (1.1, False)])
def test_turned_by_at_most_the_tolerance(turn, together):
    parts = parts_of(roof(turn), degrees=1.0, metres=1.0)
    assert len(parts.planes) == (1 if together else 2)
    assert parts.share == pytest.approx(1.0)


@pytest.mark.parametrize(("height", "together"), [(0.0, True), (0.009, True), (0.011, False)])
def test_apart_by_at_most_the_tolerance(height, together):
    pane = grid(1, 1)
    higher = pane.corners * np.float32([0.9, 1, 0.9]) + np.float32([0, height, 2])
    corners, normals = np.concatenate([pane.corners, higher]), np.concatenate([pane.normals] * 2)
    assert len(flat_parts(corners, normals, np.ones(4, bool), DEGREES, 0.01, MOST).planes) == (1 if together else 2)


def test_the_plane_of_what_is_uneven_runs_through_the_middle():
    mesh = roof(0.4)
    (plane,) = parts_of(mesh, degrees=1.0, metres=1.0).planes
    heights = mesh.corners @ plane[:3] + plane[3]
    assert np.average(heights.mean(axis=1), weights=areas_of(mesh)) == pytest.approx(0.0, abs=1e-9)
    assert heights.min() < -1e-4
    assert heights.max() > 1e-4


def test_no_tolerance_at_all_still_joins_what_is_exactly_flat():
    assert len(parts_of(grid(4, 4), degrees=0.0, metres=0.0).planes) == 1


def test_smooth_normals_that_tilt_are_not_flat():
    cube = mesh_of(trimesh.creation.box(), smooth=True)
    parts = parts_of(cube)
    assert (parts.part == -1).all()
    assert parts.share == 0.0
    assert len(parts.planes) == 0


def test_one_tilted_corner_leaves_its_triangle_out():
    mesh = grid(3, 3)
    mesh.normals[4, 1] = [np.sin(0.02), -np.cos(0.02), 0]
    parts = parts_of(mesh)
    assert np.flatnonzero(parts.part == -1).tolist() == [4]
    assert parts.share == pytest.approx(17.0 / 18.0)


def test_little_of_a_faceted_ball_lies_in_few_planes():
    parts = parts_of(mesh_of(trimesh.creation.icosphere(subdivisions=3)))
    assert len(parts.planes) == MOST
    assert parts.share == pytest.approx(MOST / 1280, rel=0.5)


def test_only_what_is_asked_for_counts():
    mesh = box()
    among = areas_of(mesh) > 2.5  # the largest sides alone
    parts = parts_of(mesh, among)
    assert ((parts.part >= 0) == among).all()
    assert parts.share == pytest.approx(1.0)


@pytest.mark.parametrize("wrong", ["normal", "corner", "area"])
@pytest.mark.filterwarnings("error")
def test_what_is_no_number_or_has_no_area_counts_for_nothing(wrong):
    mesh = grid(2, 2)
    corners, normals = mesh.corners.copy(), mesh.normals.copy()
    if wrong == "normal":
        normals[3, 1] = np.nan
    elif wrong == "corner":
        corners[3, 1] = np.nan
    else:
        corners[3] = corners[3, 0]
    parts = flat_parts(corners, normals, np.ones(8, bool), DEGREES, METRES, MOST)
    assert np.flatnonzero(parts.part == -1).tolist() == [3]
    np.testing.assert_allclose(np.abs(parts.planes), [[0, 1, 0, 0]], atol=1e-12)
    assert parts.share == pytest.approx(1.0)


@pytest.mark.filterwarnings("error")
def test_nothing_has_no_share():
    pane = grid(1, 1)
    empty = flat_parts(np.zeros((0, 3, 3)), np.zeros((0, 3, 3)), np.zeros(0, bool), DEGREES, METRES, MOST)
    for parts in (
        empty,
        parts_of(pane, np.zeros(2, bool)),
        flat_parts(pane.corners * 0, pane.normals, np.ones(2, bool), 1, 1, 8),
    ):
        assert np.isnan(parts.share)
        assert parts.planes.shape == (0, 4)
        assert (parts.part == -1).all()


@given(
    turn=st.floats(-np.pi, np.pi),
    axis=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda axis: np.linalg.norm(axis) > 0.1),
    move=st.tuples(*[st.floats(-100, 100)] * 3),
)
def test_where_it_stands_makes_no_difference(turn, axis, move):
    mesh = mesh_of(trimesh.creation.cylinder(2.0, 0.1, sections=12))
    matrix = placed(move, turn=turn, axis=axis)
    corners = mesh.corners.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    normals = mesh.normals.astype(float) @ matrix[:3, :3].T
    still = parts_of(mesh)
    moved = flat_parts(corners, normals, np.ones(len(corners), bool), DEGREES, METRES, MOST)
    assert moved.share == pytest.approx(still.share)
    ends = [{frozenset(np.flatnonzero(parts.part == number)) for number in (0, 1)} for parts in (still, moved)]
    assert ends[0] == ends[1]  # equal ones may come in either order
    assert {len(end) for end in ends[0]} == {12}
    for number in (0, 1):
        heights = corners[moved.part == number] @ moved.planes[number, :3] + moved.planes[number, 3]
        assert np.abs(heights).max() < 1e-5


def test_an_uneven_mirror_is_one_part_though_each_triangle_points_elsewhere():
    mesh = grid(40, 10)
    waves = mesh.positions + 0.0005 * np.sin(9.0 * mesh.positions[:, :1]) * np.float32([0, 1, 0])
    uneven = mesh_of(trimesh.Trimesh(waves, mesh.triangles, process=False))
    assert len(parts_of(uneven).planes) == 1
    assert len(parts_of(uneven, metres=0.0001).planes) > 1
