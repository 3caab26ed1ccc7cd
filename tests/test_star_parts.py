"""How mirrors split into parts that a map from one centre can hold."""

import numpy as np
import pytest
import trimesh
from catoptric.addon.tracing import Curvature, star_parts
from catoptric.scenes import shapes
from hypothesis import given, settings
from hypothesis import strategies as st

SPREAD, FACING = 35.0, 0.2


def smooth(positions, triangles):
    """Triangles with vertex normals averaged by area: what smooth shading gives."""
    positions, triangles = np.asarray(positions, float), np.asarray(triangles)
    corners = positions[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(positions)
    np.add.at(normals, triangles, across[:, None])
    return positions, triangles, normals[triangles]


def flat(positions, triangles):
    """Triangles with their own normals at every corner."""
    corners = np.asarray(positions, float)[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(positions, float), np.asarray(triangles), np.repeat(across[:, None], 3, axis=1)


def of_shape(shape: shapes.Shape):
    """A smooth mesh of a scene's shape, quads cut in two."""
    quads = shape.faces[shape.faces[:, 3] >= 0]
    triangles = np.concatenate([shape.faces[:, :3], quads[:, [0, 2, 3]]])
    return smooth(shape.points, triangles)


def torus(radius=1.0, thickness=0.4, segments=96, sides=48):
    """Corners' normals are exact."""
    positions, triangles, _ = of_shape(shapes.torus(radius, thickness, segments, sides))
    ring = positions * (1, 1, 0)
    ring *= radius / np.linalg.norm(ring, axis=1, keepdims=True)
    return positions, triangles, ((positions - ring) / thickness)[triangles]


def sheet(points):
    """A smooth mesh of a grid of points (N, M, 3), not welded."""
    rows, columns = points.shape[:2]
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    triangles = np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in ((a, b, c), (a, c, d))])
    return smooth(points.reshape(-1, 3), triangles)


def bowl(thickness=0.1):
    """Half a sphere with a wall, opening upwards, and a sharp, level rim."""
    angle = np.linspace(-np.pi / 2, 0, 25)
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    arc[0, 0] = 0.0
    positions, triangles, _ = of_shape(shapes.lathe(np.concatenate([arc, (1.0 - thickness) * arc[::-1]]), 64))
    radius = np.linalg.norm(positions, axis=1)[triangles]
    side = np.select([radius.min(axis=1) > 0.99, radius.max(axis=1) < 0.99], [1.0, -1.0], 0.0)[:, None, None]
    return positions, triangles, side * positions[triangles] + (side == 0) * (0.0, 0.0, 1.0)


def helicoid(turns=3.0, pitch=0.5):
    """A spiral stair's slope: no one direction of its normals is far from up."""
    angle, radius = np.linspace(0, 2 * np.pi * turns, int(48 * turns)), np.linspace(0.6, 1.6, 9)
    a, r = np.meshgrid(angle, radius, indexing="ij")
    return sheet(np.stack([r * np.cos(a), r * np.sin(a), pitch * a / (2 * np.pi)], axis=-1)[:, ::-1])


def geometry(positions, triangles):
    corners = np.asarray(positions, float)[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(across, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return corners, across / doubled[:, None], doubled / 2


def checked(mesh, spread=SPREAD, alone=False):
    """The parts, after what must be true of any: with `alone`, single triangles may turn as they like."""
    positions, triangles, normals = mesh
    parts = star_parts(positions, triangles, normals, spread)
    corners, facing, areas = geometry(positions, triangles)
    shading = normals / np.linalg.norm(normals, axis=2, keepdims=True)
    facing = facing * np.sign(np.einsum("tcx,tx->t", shading, facing))[:, None]
    times = np.zeros(len(triangles), int)
    for part in parts:
        times[part.triangles] += 1
    np.testing.assert_array_equal(times, areas > 0)
    for part in parts:
        assert part.triangles.dtype == part.margin.dtype == np.int32
        np.testing.assert_allclose(part.frame @ part.frame.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(part.frame) > 0
        if np.isinf(part.reach):
            assert part.curvature is Curvature.CONVEX
            assert not len(part.margin)
        else:
            check_patch(part, corners, facing, shading, np.radians(spread), alone)
    assert all(np.diff([areas[part.triangles].sum() for part in parts]) <= 1e-9 * areas.max())
    return parts


def check_patch(part, corners, facing, shading, spread, alone):
    axis = part.frame[2]
    if not (alone and len(part.triangles) == 1):
        assert (facing[part.triangles] @ axis).min() >= np.cos(spread) - 1e-9
        assert (shading[part.triangles] @ axis).min() >= np.cos(spread) - 1e-9
    assert not set(part.triangles) & set(part.margin)
    seen = np.concatenate([part.triangles, part.margin])
    rays = corners[seen] - part.centre
    cosines = np.einsum("tcx,tx->tc", rays, facing[seen]) / np.linalg.norm(rays, axis=2)
    assert cosines.min() >= FACING
    local = rays @ part.frame.T
    assert (local[..., 2] > 0).all()
    tangents = np.linalg.norm(local[..., :2], axis=2) / local[..., 2]
    assert 0 < tangents.max() <= part.reach * (1 + 1e-9)
    assert part.reach <= 1.0
    assert most_layers(local[..., :2] / local[..., 2:]) <= 1


def most_layers(flat, count=300):
    """How many triangles (N, 3, 2) lie over one place, at most, of some inside of them."""
    rng = np.random.default_rng(1)
    chosen = rng.integers(len(flat), size=count)
    places = np.einsum("pc,pcx->px", rng.dirichlet([1, 1, 1], count), flat[chosen])
    start, end = flat, np.roll(flat, -1, axis=1)
    along, there = end - start, places[:, None, None] - start
    left = along[..., 0] * there[..., 1] - along[..., 1] * there[..., 0]
    return int((left > 1e-12 * np.ptp(flat) ** 2).all(axis=2).sum(axis=1).max())


def shares(mesh, parts):
    """Of all the area, by curvature."""
    areas = geometry(*mesh[:2])[2]
    return {
        kind: sum(areas[p.triangles].sum() for p in parts if p.curvature is kind) / areas.sum() for kind in Curvature
    }


@pytest.mark.parametrize(
    "body",
    [
        trimesh.creation.icosphere(3),
        trimesh.creation.uv_sphere(count=[24, 24]),
        trimesh.creation.box((1.0, 2.0, 1.5)),
        trimesh.creation.cylinder(1.0, 2.0, sections=32),
    ],
    ids=["icosphere", "sphere of rings", "box", "cylinder"],
)
@pytest.mark.parametrize("shading", [smooth, flat])
def test_a_convex_body_is_one_part_around_its_middle(body, shading):
    moved = body.vertices + (3.0, -2.0, 5.0)
    (part,) = checked(shading(moved, body.faces))
    assert np.isinf(part.reach)
    np.testing.assert_allclose(part.centre, (3.0, -2.0, 5.0), atol=1e-6)
    np.testing.assert_array_equal(part.frame, np.eye(3))


def test_a_thin_body_is_not_seen_at_a_grazing_angle():
    pane = trimesh.creation.box((2.0, 3.0, 0.02))
    parts = checked(flat(pane.vertices, pane.faces))
    assert len(parts) == 6
    assert {part.curvature for part in parts} == {Curvature.FLAT}


def test_the_centre_is_that_of_the_volume():
    cone = trimesh.creation.cone(1.0, 2.0, sections=64)
    (part,) = checked(flat(cone.vertices, cone.faces))
    np.testing.assert_allclose(part.centre, cone.center_mass, atol=1e-6)


def test_a_sphere_inside_out_is_concave():
    ball = trimesh.creation.icosphere(4)
    mesh = smooth(ball.vertices, ball.faces[:, ::-1])
    parts = checked(mesh)
    assert 12 <= len(parts) <= 60
    assert {part.curvature for part in parts} == {Curvature.CONCAVE}


def test_normals_say_which_way_a_sphere_faces_not_how_it_is_wound():
    ball = trimesh.creation.icosphere(3)
    positions, triangles, normals = smooth(ball.vertices, ball.faces)
    parts = checked((positions, triangles, -normals))
    assert {part.curvature for part in parts} == {Curvature.CONCAVE}
    outwards = checked((positions, triangles[:, ::-1], normals[:, ::-1]))
    assert {part.curvature for part in outwards} == {Curvature.CONVEX}


def test_a_torus_is_convex_outside_and_a_saddle_inside():
    mesh = torus(segments=192, sides=96)
    parts = checked(mesh)
    assert len(mesh[1]) == 36864
    assert 40 <= len(parts) <= 160
    corners, _, areas = geometry(*mesh[:2])
    outside = np.linalg.norm(corners.mean(axis=1)[:, :2], axis=1) - 1.0  # the sign of Gauss curvature
    clear = np.abs(outside) > 0.05 * 0.4
    said = np.zeros(len(areas))
    for part in parts:
        said[part.triangles] = {Curvature.CONVEX: 1, Curvature.SADDLE: -1}[part.curvature]
    agrees = said == np.sign(outside)
    assert areas[agrees & clear].sum() > 0.95 * areas[clear].sum()
    assert all(len(part.margin) > 0.2 * len(part.triangles) for part in parts)


def test_a_bowl_is_concave_inside_and_convex_outside():
    mesh = bowl()
    parts = checked(mesh, alone=True)
    share = shares(mesh, parts)
    expected = 0.9**2 / (1 + 0.9**2 + (1 - 0.9**2) / 2)  # inner half sphere, of all with the rim
    assert share[Curvature.CONCAVE] == pytest.approx(expected, abs=0.005)
    assert share[Curvature.CONVEX] == pytest.approx(expected / 0.9**2, abs=0.005)
    assert len(parts) < 60


def test_an_open_bowl_of_no_thickness():
    angle, turn = np.linspace(0.02, np.pi / 2, 24), np.linspace(0, 2 * np.pi, 49)
    a, t = np.meshgrid(angle, turn, indexing="ij")
    mesh = sheet(np.stack([np.sin(a) * np.cos(t), np.sin(a) * np.sin(t), np.cos(a)], axis=-1)[:, ::-1])
    parts = checked(mesh)
    assert len(parts) < 30
    assert len({part.curvature for part in parts}) == 1


def test_a_tube_without_ends_is_convex_strips():
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 65), np.linspace(0, 4, 33))
    mesh = sheet(np.stack([np.cos(angle), np.sin(angle), height], axis=-1))
    # Welded by place, the seam's normals differ from the average by half a step.
    mesh = mesh[0], mesh[1], (mesh[0] * (1, 1, 0))[mesh[1]]
    parts = checked(mesh)
    assert {part.curvature for part in parts} == {Curvature.CONVEX}
    assert 6 <= len(parts) <= 16


def test_a_closed_surface_of_genus_3():
    rings = [shapes.torus(1.0, 0.3, 48, 24).moved((2.6 * i, 0.0, 0.0)) for i in range(3)]
    mesh = of_shape(shapes.joined(rings))
    parts = checked(mesh)
    assert {Curvature.CONVEX, Curvature.SADDLE} <= {part.curvature for part in parts}
    assert len(parts) < 500


def test_a_flat_square_is_one_part():
    square = sheet(np.stack([*np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9)), np.zeros((9, 9))], axis=-1))
    (part,) = checked(square)
    assert part.curvature is Curvature.FLAT
    np.testing.assert_allclose(part.frame[2], (0, 0, 1), atol=1e-9)
    assert part.centre[2] < 0
    np.testing.assert_allclose(part.centre[:2], (0.5, 0.5), atol=1e-9)


def test_one_triangle():
    (part,) = checked(flat([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    assert part.triangles.tolist() == [0]
    assert part.curvature is Curvature.FLAT


def test_one_triangle_whose_normals_lean_far_out():
    normals = np.float32([[[9, 0, 1], [-9, 0, 1], [0, 9, 1]]])
    (part,) = checked((np.eye(3), np.array([[0, 1, 2]]), normals + 1), alone=True)
    assert part.triangles.tolist() == [0]


def test_nothing():
    assert star_parts(np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros((0, 3, 3))) == []
    assert star_parts(np.zeros((1, 3)), np.zeros((0, 3), int), np.zeros((0, 3, 3))) == []
    assert star_parts(np.zeros((3, 3)), np.array([[0, 1, 2]]), np.ones((1, 3, 3))) == []


@pytest.mark.filterwarnings("error")
def test_what_has_no_area_or_is_not_a_number_is_left_out():
    positions, triangles, normals = torus(segments=24, sides=12)
    worse = np.concatenate([positions, [[np.nan, 0, 0], [np.inf, 0, 0]]])
    count = len(positions)
    bad = np.array([[0, 1, count], [2, count + 1, 3], [4, 4, 5], [6, 6, 6]])
    there = np.concatenate([normals, np.ones((4, 3, 3))])
    parts = star_parts(worse, np.concatenate([triangles, bad]), there)
    good = star_parts(positions, triangles, normals)
    assert [part.triangles.tolist() for part in parts] == [part.triangles.tolist() for part in good]
    there[7, 1] = np.nan
    without = star_parts(worse, np.concatenate([triangles, bad]), there)
    assert 7 not in np.concatenate([part.triangles for part in without])


@pytest.mark.parametrize("first", [0, 1], ids=["the ring first", "the ball first"])
def test_two_bodies_in_one_mesh_are_seen_apart(first):
    ball, ring = trimesh.creation.icosphere(2), torus(segments=48, sides=24)
    alone = star_parts(*ring)
    one, other = (ring, smooth(ball.vertices + (5, 0, 0), ball.faces))[:: 1 - 2 * first]
    both = checked(
        (
            np.concatenate([one[0], other[0]]),
            np.concatenate([one[1], other[1] + len(one[0])]),
            np.concatenate([one[2], other[2]]),
        )
    )
    assert sum(np.isinf(part.reach) for part in both) == 1
    assert len(both) == len(alone) + 1


def test_three_squares_at_one_edge_stay_apart():
    corners = [[0, 0, 0], [0, 0, 1]]
    faces = []
    for angle in np.radians([0, 180, 190]):
        c, s = np.cos(angle), np.sin(angle)
        corners += [[c, s, 0], [c, s, 1]]
        faces += [[0, len(corners) - 2, 1], [1, len(corners) - 2, len(corners) - 1]]
    up = np.broadcast_to([0.0, -1.0, 0.0], (6, 3, 3))
    assert len(checked((np.array(corners, float), np.array(faces), up))) == 3


def test_vertices_in_the_same_place_are_one():
    positions, triangles, normals = torus(segments=48, sides=24)
    split = checked((positions[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3), normals))
    whole = star_parts(positions, triangles, normals)
    assert [part.triangles.tolist() for part in split] == [part.triangles.tolist() for part in whole]


@pytest.mark.parametrize(("degrees", "together"), [(0.9, True), (1.1, False)])
def test_a_crease_is_a_border(degrees, together):
    turned = np.radians(degrees)
    mesh = flat(
        [[0, 0, 0], [0, 1, 0], [-1, 0, 0], [-1, 1, 0], [np.cos(turned), 0, np.sin(turned)],
         [np.cos(turned), 1, np.sin(turned)]],
        [[0, 1, 3], [0, 3, 2], [0, 4, 5], [0, 5, 1]],
    )  # fmt: skip
    parts = checked(mesh)
    assert len(parts) == (1 if together else 2)
    assert all(not len(part.margin) for part in parts)


def test_a_flat_shaded_torus_is_one_part_a_facet():
    positions, triangles, _ = torus(segments=48, sides=24)
    assert len(triangles) / 3 <= len(checked(flat(positions, triangles))) <= len(triangles)


@pytest.mark.parametrize("pitch", [0.5, 1.5])
def test_a_spiral_is_split_where_it_lies_over_itself(pitch):
    parts = checked(helicoid(pitch=pitch))
    assert 3 <= len(parts) < 60


@pytest.mark.parametrize("spread", [15.0, 25.0, 50.0])
def test_the_spread_is_kept(spread):
    ring = torus(segments=48, sides=24)
    assert (len(checked(ring, spread)) > len(star_parts(*ring))) == (spread < SPREAD)


def test_a_hollow_is_seen_from_farther_back_the_more_it_bends():
    ball = trimesh.creation.icosphere(4)
    hollow = smooth(ball.vertices, ball.faces[:, ::-1])
    reach = [max(part.reach for part in checked(hollow, spread)) for spread in (35.0, 55.0)]
    assert reach[1] < 0.8 * reach[0]


def test_uneven_normals_do_not_shatter_a_torus():
    positions, triangles, normals = torus()
    uneven = np.random.default_rng(5).normal(scale=0.01, size=positions.shape)[triangles]
    assert len(checked((positions, triangles, normals + uneven))) < 2 * len(star_parts(positions, triangles, normals))


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000), bumps=st.integers(1, 4), height=st.floats(0.0, 0.5))
def test_any_surface_keeps_the_rules(seed, bumps, height):
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(3)
    waves = rng.normal(size=(bumps, 3)) * 3
    positions = ball.vertices * (1 + height * np.sin(ball.vertices @ waves.T).mean(axis=1, keepdims=True))
    positions = positions * rng.uniform(0.5, 2.0, size=3) * 10.0 ** rng.integers(-2, 3)
    checked(smooth(positions + rng.normal(size=3), ball.faces[rng.permutation(len(ball.faces))]), alone=True)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 40))
def test_any_soup_keeps_the_rules(seed, count):
    rng = np.random.default_rng(seed)
    positions = rng.integers(0, 3, size=(12, 3)).astype(float)
    triangles = rng.integers(0, 12, size=(count, 3))
    checked((positions, triangles, rng.normal(size=(count, 3, 3))), alone=True)
