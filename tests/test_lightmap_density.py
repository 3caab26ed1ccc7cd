"""Texels where they are seen: how large things appear, and triangles split for it without a trace."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.lightmap_density import appearance, seen_area, split_where_seen
from catoptric.addon.blender.lightmap_uv import unwrap
from catoptric.tests import blender_stage as stage
from hypothesis import given, settings
from hypothesis import strategies as st


def chrome():
    return stage.principled("chrome", (0.9, 0.9, 0.9), Metallic=1.0, Roughness=0.0)


def floor_scene():
    """A floor of two triangles, 40 m wide, seen from near its middle."""
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, -4, 1.5), (pi / 2 - 0.25, 0, 0))
    stage.add_plane(scene, "floor", 40)
    return scene


def split(extracted):
    receivers = [index for index, instance in enumerate(extracted.instances) if not instance.reflector]
    return split_where_seen(extracted, receivers, appearance(extracted))


def test_a_ball_shows_things_smaller_the_further_they_are():
    """A sphere's image of what lies d away is f / (f + d) as large, f half the radius (thin-mirror equation)."""
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, -6, 0), (pi / 2, 0, 0))
    stage.add_sphere(scene, "ball", 1.0, chrome(), (0, 0, 0), 64, 32)
    seen = appearance(extract(scene))
    away = np.array([0.0, 0.5, 2.0])
    behind = np.stack([0 * away, 1 + away, 0 * away], axis=-1)  # in the picture, were it not for the ball
    assert seen(behind)[1:] == pytest.approx(1 / (7 + away[1:]))
    above = np.stack([0 * away, 0 * away, 1 + away], axis=-1) * (1, 1, 20)  # out of the picture
    away = 20 * (1 + away) - 1
    mirrored = 1 / (5 * (0.5 + away) / 0.5 + away)
    direct = 0.25 / np.linalg.norm(above - (0, -6, 0), axis=1)
    np.testing.assert_allclose(seen(above), np.maximum(mirrored, direct), rtol=0.02)
    beside_camera = np.array([[3.0, -6.0, 0.0], [0.0, -2.0, -4.0]])
    reach = np.linalg.norm(beside_camera, axis=1) - 1
    mirrored = 1 / (5 * (0.5 + reach) / 0.5 + reach)
    assert (seen(beside_camera) >= 0.98 * mirrored).all()
    assert seen(np.array([[0.0, -0.5, 0.8]]))[0] == pytest.approx(1 / 5, rel=0.02)


def test_a_flat_mirror_shows_things_at_the_length_of_the_path():
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 10), (0, 0, 0))  # looks down
    stage.add_plane(scene, "mirror", 2, chrome())
    behind_camera = np.array([[0.0, 0.0, 20.0]])
    away = 20 - np.sqrt(2)
    assert appearance(extract(scene))(behind_camera)[0] == pytest.approx(1 / (10 - np.sqrt(2) + away), rel=0.01)


def test_a_wide_floor_is_split_where_the_camera_stands_and_nowhere_opens():
    extracted = extract(floor_scene())
    mesh = split(extracted).meshes[0]
    assert 50 < len(mesh.triangles) < 5000
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    border = (np.abs(mesh.positions[unique]) > 19.999).all(axis=1).any(axis=1)
    assert (uses == np.where(border, 1, 2)).all()
    crosses = np.cross(mesh.corners[:, 1] - mesh.corners[:, 0], mesh.corners[:, 2] - mesh.corners[:, 0])
    assert (crosses[:, 2] > 0).all()
    assert crosses[:, 2].sum() / 2 == pytest.approx(1600, rel=1e-5)
    longest = np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2).max(axis=1)
    near = np.linalg.norm(mesh.corners.mean(axis=1)[:, :2] - (0, -1), axis=1)
    assert longest[near < 1].max() < 0.25 * longest.max()


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_what_corners_carry_is_interpolated(seed):
    """Functions that are linear in position stay so on every part, and parts keep slot and side."""
    extracted = extract(floor_scene())
    rng = np.random.default_rng(seed)
    flat = rng.normal(size=(2, 3))
    mesh = extracted.meshes[0]
    corners = mesh.corners.astype(float)
    carried = {
        "uvs": (corners @ flat.T).astype(np.float32),
        "colors": (corners @ rng.normal(size=(3, 4))).astype(np.float32),
        "slots": np.array([0, 0], np.int32),
    }
    painted = replace(mesh, **carried)
    parts = split(replace(extracted, meshes=(painted,))).meshes[0]
    assert len(parts.triangles) > 2
    np.testing.assert_allclose(parts.uvs, parts.corners @ flat.T, atol=1e-4)
    slope = np.linalg.lstsq(corners.reshape(-1, 3), carried["colors"].reshape(-1, 4), rcond=None)[0]
    np.testing.assert_allclose(parts.colors, parts.corners @ slope, atol=1e-4)
    np.testing.assert_allclose(np.linalg.norm(parts.normals, axis=-1), 1.0, atol=1e-6)
    assert (parts.normals[..., 2] > 0.999).all()


def test_a_closed_box_stays_closed():
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, -3, 1), (pi / 2, 0, 0))
    stage.add_box(scene, "room", 12)
    mesh = split(extract(scene)).meshes[0]
    assert len(mesh.triangles) > 12
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


def test_what_mirrors_and_what_is_lit_keep_their_triangles():
    scene = floor_scene()
    scene.objects["floor"].data.materials.append(chrome())
    extracted = extract(scene)
    receivers = list(range(len(extracted.instances)))
    assert split_where_seen(extracted, receivers, appearance(extracted)).meshes[0] is extracted.meshes[0]
    plain = extract(floor_scene())
    once = split(plain)
    lit = replace(once, meshes=(replace(once.meshes[0], lightmap_uvs=once.meshes[0].uvs),))
    assert split(lit).meshes[0] is lit.meshes[0]


def test_texels_are_dense_where_much_is_seen_and_none_is_shared():
    extracted = split(extract(floor_scene()))
    mesh = extracted.meshes[0]
    seen, area = seen_area(extracted, 0, appearance(extracted))
    uvs = unwrap(mesh, 512, seen).astype(float)
    edges = uvs[:, 1:] - uvs[:, :1]
    signed = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    assert (signed > 0).all() or (signed < 0).all()
    # Parts that all face one way fill the chart's own square, whose sides stay straight, exactly once.
    low, high = uvs.reshape(-1, 2).min(axis=0), uvs.reshape(-1, 2).max(axis=0)
    assert np.abs(signed).sum() / 2 == pytest.approx(np.prod(high - low), rel=1e-3)
    density = np.abs(signed) / 2 / area
    near = np.linalg.norm(mesh.corners.mean(axis=1)[:, :2] - (0, -1), axis=1)
    far = np.abs(mesh.corners.mean(axis=1)[:, :2]).min(axis=1) > 14
    assert density[near < 1].mean() > 2 * density[far].mean()
    even = unwrap(mesh, 512)
    assert even.shape == uvs.shape
    assert not np.allclose(even, uvs)
