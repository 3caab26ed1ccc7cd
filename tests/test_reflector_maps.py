"""Reflector cube maps: what the texels hold, where faces meet, how patches go on, and what they are made from."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.grow import grown
from catoptric.addon.baking.reflector_maps import BORDER, KIND, reflector_maps
from catoptric.addon.baking.reflector_maps_tables import ResidentMaps
from catoptric.addon.cache import Cache
from catoptric.addon.gl import call
from catoptric.addon.scene import Mesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from .search_stage import maps_of, sheet, sphere, unit
from .stage import looking, mesh_of, placed, scene_of

FACES = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)


def directions(face: int, size: int, reach: float = 1.0) -> np.ndarray:
    """(N, N, 3) unit: where the texels of a face lie as seen from the centre; those of the border beyond its sides."""
    inner = size - 2 * BORDER
    at = reach * (2 * (np.arange(size) - BORDER + 0.5) / inner - 1)
    u, v = np.meshgrid(at, at)
    axis, side = face // 2, 1 - 2 * (face % 2)
    out = np.zeros((size, size, 3))
    out[..., axis], out[..., (axis + 1) % 3], out[..., (axis + 2) % 3] = side, -side * u, v
    return unit(out)


# ------------------------------------------------------------------ whole bodies


def test_a_sphere_is_held_as_well_as_floats_can():
    (one,) = maps_of(sphere(6), 512, 2)
    assert one.positions.shape == (6, 512, 512, 3)
    assert one.is_whole
    assert one.covered.all()
    positions, normals = one.positions.astype(float), one.normals.astype(float)
    assert np.abs(np.linalg.norm(positions, axis=-1) - 1).max() < 1.5e-7
    assert np.abs(np.linalg.norm(normals, axis=-1) - 1).max() < 1.5e-7
    assert np.linalg.norm(normals - unit(positions), axis=-1).max() < 2e-7
    assert one.radius == pytest.approx(1, abs=1e-5)
    assert one.turn == 1


def test_every_texel_lies_in_its_direction():
    (one,) = maps_of(sphere(4), 64)
    for face in range(6):
        assert np.abs(unit(one.positions[face].astype(float)) - directions(face, 64)).max() < 1e-6


def test_a_cube_map_sees_each_side_of_a_box_on_its_own_face():
    box = trimesh.creation.box((2.0, 4.0, 6.0))
    box.apply_translation((5, 0, 0))
    (one,) = maps_of(mesh_of(box), 32, 0)
    assert np.allclose(one.to_mesh[:3, 3], (5, 0, 0), atol=1e-6)
    for face, normal in enumerate(FACES):
        middle = one.positions[face, 15:17, 15:17].mean(axis=(0, 1))
        assert np.allclose(middle, normal * (1, 2, 3), atol=1e-4)
        assert np.allclose(one.normals[face, 16, 16], normal, atol=1e-6)


def test_faces_meet_at_their_borders():
    (one,) = maps_of(mesh_of(_egg(), smooth=True), 64)
    for face in range(6):
        ways = directions(face, 64)
        edge = np.ones((64, 64), bool)
        edge[BORDER:-BORDER, BORDER:-BORDER] = False
        corner = np.zeros((64, 64), bool)
        corner[np.ix_((0, -1), (0, -1))] = True
        edge &= ~corner
        # The same direction, looked up in the middle of the face next door.
        for way, position, normal in zip(ways[edge], one.positions[face][edge], one.normals[face][edge], strict=True):
            other = int(np.abs(way).argmax()) * 2 + int(way[np.abs(way).argmax()] < 0)
            assert other != face
            there = _looked_up(one, other, way)
            assert np.linalg.norm(there[0] - position) < 1e-3
            assert np.linalg.norm(unit(there[1]) - normal) < 3e-3


def _egg():
    egg = trimesh.creation.icosphere(subdivisions=4)
    egg.apply_scale((1.0, 0.7, 1.3))
    return egg


def _looked_up(one, face, way):
    """Position and normal on a face where a direction meets it, between its texels."""
    axis, side = face // 2, 1 - 2 * (face % 2)
    at = np.array([-side * way[(axis + 1) % 3], way[(axis + 2) % 3]]) / abs(way[axis])
    place = (at + 1) / 2 * (one.size - 2 * BORDER) + BORDER - 0.5
    cell = np.floor(place).astype(int)
    (x, y), (column, row) = place - cell, cell
    weights = np.array([(1 - y) * (1 - x), (1 - y) * x, y * (1 - x), y * x])
    texels = [values[face, row : row + 2, column : column + 2].reshape(4, 3) for values in (one.positions, one.normals)]
    return [weights @ four for four in texels]


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (3.0, 1.0, 0.4)])
def test_the_nearest_ellipsoid_of_an_ellipsoid_is_itself(scale):
    body = trimesh.creation.icosphere(subdivisions=4)
    turn = trimesh.transformations.rotation_matrix(0.8, (1, 2, 3))[:3, :3]
    body.vertices = body.vertices * scale @ turn.T
    (one,) = maps_of(mesh_of(body, smooth=True), 32, 0)
    onto = np.linalg.inv(one.ball) @ one.positions.reshape(-1, 3).T
    assert np.abs(np.linalg.norm(onto, axis=0) - 1).max() < 0.01
    assert np.allclose(one.ball, one.ball.T)


# ------------------------------------------------------------------ patches


def test_a_patch_has_one_face_that_its_frame_and_reach_describe():
    (one,) = maps_of(sheet(), 256, spread=35.0)
    assert one.positions.shape == (1, 64, 64, 3)
    assert not one.is_whole
    frame = one.part.frame
    assert np.allclose(frame @ frame.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(frame) == pytest.approx(1)
    assert 0 < one.reach <= 1
    covered = one.covered[0]
    assert covered.mean() > 0.3
    assert np.abs(unit(one.positions[0].astype(float)) - directions(4, 64, one.reach)).max() < 1e-6
    places = one.positions[0][covered] @ one.to_mesh[:3, :3].T + one.to_mesh[:3, 3]
    assert np.abs(places[:, 2] - 0.2 * (places[:, :2] ** 2).sum(axis=1)).max() < 1e-3
    normals = one.normals[0][covered] @ frame
    exact = unit(np.c_[-0.4 * places[:, :2], np.ones(len(places))])
    assert np.linalg.norm(normals - exact, axis=1).max() < 0.02


def test_what_a_patch_does_not_cover_goes_on_smoothly():
    (one,) = maps_of(sheet(hole=0.4), 512, spread=35.0)
    covered = one.covered[0]
    assert 0.02 < (~covered).mean() < 0.9
    assert np.isfinite(one.positions).all()
    assert np.abs(np.linalg.norm(one.normals, axis=-1) - 1).max() < 1e-5
    places = one.positions[0] @ one.to_mesh[:3, :3].T + one.to_mesh[:3, 3]
    inside = ~covered & (np.linalg.norm(places[..., :2], axis=-1) < 0.4)
    assert inside.sum() > 20
    exact = 0.2 * (places[..., :2] ** 2).sum(axis=-1)
    assert np.abs(places[..., 2] - exact)[inside].max() < 0.02
    # Normals along the rim, of an edge with teeth, are uneven themselves.
    for values, most in ((one.positions[0], 2), (one.normals[0], 4)):
        steps = np.linalg.norm(np.diff(values, axis=0), axis=-1)
        assert steps.max() < most * steps[covered[1:] & covered[:-1]].max()


def test_a_flat_patch_is_flat_all_over():
    parts = maps_of(sheet(lambda x, y: 0 * x), 64, 2)
    for one in parts:
        places = one.positions[0].astype(float) @ one.to_mesh[:3, :3].T + one.to_mesh[:3, 3]
        assert np.abs(places[..., 2]).max() < 1e-5
        assert one.turn < 1e-6


# ------------------------------------------------------------------ on the GPU


def test_an_instance_is_scaled_and_turned_as_its_matrix_says():
    matrix = placed((1, 2, 3), (2.0, 0.5, 1.0), 0.7, (1, 1, 0))
    maps = maps_of(sphere(4), 32, 0)
    scene = scene_of([(sphere(4), np.eye(4), False), (sphere(4), matrix, True)], looking((0, -5, 0)))
    resident = call(ResidentMaps, scene, {1: maps})
    try:
        assert np.allclose(resident.to_world(1) @ (0, 0, 1, 1), matrix @ (0, 0, 1, 1), atol=1e-6)
        half = np.linalg.norm(matrix[:3, :3], axis=1)
        assert np.allclose(resident.boxes[0], [(1, 2, 3) - half, (1, 2, 3) + half], atol=0.01)
        assert resident.owner.tolist() == [1]
        assert resident.left_out(1) == 1
        assert resident.size_bytes > 6 * 32 * 32 * 2 * 16
    finally:
        call(resident.release)


def test_instances_share_the_texels_of_their_mesh():
    maps = maps_of(sphere(3), 32, 0)
    scene = scene_of([(sphere(3), placed((x, 0, 0)), True) for x in (0, 3, 6)], looking((0, -5, 0)))
    one, three = (call(ResidentMaps, scene, dict.fromkeys(range(n), maps)) for n in (1, 3))
    try:
        assert three.size_bytes < 1.5 * one.size_bytes
        assert three.owner.tolist() == [0, 1, 2]
    finally:
        call(one.release)
        call(three.release)


# ------------------------------------------------------------------ the cache


def same(one, other) -> bool:
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        and np.array_equal(getattr(a.part, own), getattr(b.part, own))
        for a, b in zip(one, other, strict=True)
        for name in ("positions", "normals", "covered")
        for own in ("triangles", "margin", "centre", "frame", "reach", "curvature")
    )


def test_maps_come_back_from_the_cache_bit_by_bit(tmp_path):
    cache, wanted = Cache(tmp_path), {"map_size": 64, "finer": 1, "spread": 20.0}
    mesh = sheet(lambda x, y: np.sin(2 * x))
    fresh = reflector_maps(mesh, wanted, cache)
    (path,) = tmp_path.rglob("*.npz")
    assert len(fresh) > 1
    assert same(reflector_maps(mesh, wanted, cache), fresh)
    # Proof that it is read, not baked: what lies there is what comes.
    entry = cache.get(KIND, path.stem)
    entry.arrays["0_positions"][:] = 7.0
    cache.put(KIND, path.stem, *entry)
    assert (reflector_maps(mesh, wanted, cache)[0].positions == 7.0).all()
    path.write_bytes(path.read_bytes()[:-1000])
    assert same(reflector_maps(mesh, wanted, cache), fresh)
    assert cache.get(KIND, path.stem) is not None


@pytest.mark.parametrize("change", ["positions", "normals", "map_size", "finer", "spread"])
def test_whatever_changes_a_map_bakes_it_anew(change, tmp_path):
    cache, wanted, mesh = Cache(tmp_path), {"map_size": 32, "finer": 0, "spread": 20.0}, sheet(count=6)
    reflector_maps(mesh, wanted, cache)
    if change in wanted:
        wanted[change] += 10
        wanted["finer"] = min(wanted["finer"], 1)
    else:
        mesh = replace(mesh, **{change: getattr(mesh, change) * np.float32(1.01)})
    reflector_maps(mesh, wanted, cache)
    assert len(list(tmp_path.rglob("*.npz"))) == 2


# ------------------------------------------------------------------ grown


@settings(deadline=None, max_examples=30)
@given(known=arrays(bool, st.tuples(st.integers(2, 9), st.integers(2, 9))), seed=st.integers(0, 99))
def test_grown_keeps_what_is_known_and_makes_up_the_rest(known, seed):
    values = np.random.default_rng(seed).normal(size=(*known.shape, 2)).astype(np.float32)
    full = grown(np.where(known[..., None], values, np.nan).astype(np.float32), known)
    assert np.array_equal(full[known], values[known])
    assert full.dtype == np.float32
    assert np.isfinite(full).all()
    assert known.any() or (full == 0).all()


@pytest.mark.parametrize("holed", [False, True])
def test_grown_goes_on_as_a_bowl_does(holed):
    y, x = np.mgrid[0:20, 0:30].astype(float)
    bowl = np.stack([1 + 2 * x - 3 * y + 0.1 * x * x, x * y], axis=-1)
    known = ((x - 12) ** 2 + (y - 9) ** 2 < 36) != holed
    assert np.abs(grown(bowl, known) - bowl).max() < 1e-6 * np.abs(bowl).max()


def test_grown_goes_on_as_a_wave_does_beside_it_and_never_runs_away():
    y, x = np.mgrid[0:64, 0:64].astype(float)
    wave = np.sin(x / 6)[..., None] + 0.02 * y[..., None]
    known = (x - 32) ** 2 + (y - 32) ** 2 > 200
    full = grown(wave, known)
    beside = ~known & ((x - 32) ** 2 + (y - 32) ** 2 > 170)
    assert np.abs(full - wave)[beside].max() < 0.1
    assert np.abs(full - wave).max() < 2.0


def test_a_patch_between_all_texels_has_one_all_the_same():
    needles = np.array([[[0, 0, 0], [1, 0, 0], [1, 1e-4, 0]], [[0, 0.3, 0.5], [0, 1.3, 0.5], [1e-4, 1.3, 0.5]]])
    triangles = np.arange(6, dtype=np.int32).reshape(2, 3)
    normals = np.broadcast_to(np.float32([0, 0, 1]), (2, 3, 3)).copy()
    points = needles.reshape(-1, 3).astype(np.float32)
    flat = Mesh("needles", points, triangles, normals, normals[..., :2], np.zeros(2, np.int32))
    maps = reflector_maps(flat, {"map_size": 32, "finer": 0, "spread": 20.0})
    assert len(maps) == 2
    for one in maps:
        assert one.covered.any()
        inward = (one.positions[one.covered] @ one.part.frame + one.part.centre)[0]
        assert (
            np.linalg.norm(inward - needles[one.part.triangles].reshape(-1, 3).mean(axis=0)) < 1 / 6
        )  # the width of a texel
        assert np.abs(one.normals[one.covered] @ one.part.frame - [0, 0, 1]).max() < 1e-6
