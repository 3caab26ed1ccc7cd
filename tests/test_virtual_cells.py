"""The level-of-detail grid of `virtual-objects-published` (Estalella et al., 8)."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.virtual import refining
from catoptric.addon.methods.virtual.bundles import Bundle
from catoptric.addon.methods.virtual.cells import FEW, NOWHERE, Forest, refined
from catoptric.addon.methods.virtual_objects_published import VirtualObjectsPublished
from catoptric.addon.tracing import cell_tree

from .mirror_stage import differing, frame_of, truth
from .stage import looking, placed, scene_of
from .test_virtual_objects import torus
from .test_virtual_objects_published import floor, sphere, tessellated

PICTURE = (160, 120)
CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])


def images_of(found, positions):
    """(T, 4) what the shader makes of positions (T, 3) of vertices, as the table has them."""
    own = found.of_vertex <= 0
    images = np.zeros((len(positions), 4))
    images[own] = found.results[-found.of_vertex[own]]
    cell = found.of_vertex[~own] - 1
    low, high = found.boxes[cell, 0], found.boxes[cell, 1]
    place = np.clip((positions[~own] - low) / np.maximum(high - low, 1e-30), 0.0, 1.0)
    weights = np.where(CORNERS, place[:, None], 1.0 - place[:, None]).prod(axis=2)
    images[~own] = (weights[..., None] * found.results[found.corners[cell]]).sum(axis=1)
    return images


# ------------------------------------------------------------------ by formulas


def forest_of(count: int = 6000, seed: int = 5) -> Forest:
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 3))
    tree = cell_tree(points, FEW)
    return Forest([tree], [points[tree.order]], [np.zeros(count)])


def everywhere(axis=(0.0, 0.0, 1.0), spread=4.0) -> Bundle:
    """Rays from the middle that go anywhere, unless their spread is small."""
    none = np.zeros((16, 2, 3))
    return Bundle((1,), np.zeros(3), 0.0, np.array(axis), spread, (0, 0, 1, 1), 1, none, ())


def looked_at(forest, warp, within, bundle=None):
    """What is searched where `warp` says how vertices are reflected, seen as 100 pixels a metre; and how often."""
    asked = []

    def search(rows, points):
        asked.append(len(points))
        return warp(points).astype(np.float32)

    found = refined(
        forest, [bundle or everywhere()], np.array([[0, 0]]), search, lambda at: 100.0 * at[..., :2], within
    )
    return found, sum(asked)


def swollen(points):
    """Bent in every direction."""
    square = (points * points).sum(axis=1, keepdims=True)
    return np.c_[points / (0.5 + square), np.zeros(len(points))]


def bent(strength):
    """Bent so that trilinear interpolation is right."""
    return lambda points: np.c_[points[:, :2] * (1.0 + strength * points[:, 2:]), points[:, 2], np.zeros(len(points))]


def small(warp):
    """A tenth as large, so that no cell is too wide."""
    return lambda points: warp(points) * [0.1, 0.1, 0.1, 1.0]


@pytest.mark.parametrize("within", [0.1, 0.5, 2.0])
def test_no_vertex_is_farther_off_than_asked(within):
    forest = forest_of()
    found, searches = looked_at(forest, swollen, within)
    images, exact = images_of(found, forest.positions), swollen(forest.positions)
    assert 100.0 * np.linalg.norm((images - exact)[:, :2], axis=1).max() < within
    assert searches == len(found.results) - 1


def test_less_is_searched_where_less_is_asked():
    counts = [looked_at(forest_of(), small(swollen), within)[1] for within in (0.02, 0.2, 2.0)]
    assert counts[0] > 1.2 * counts[1] > 2.0 * counts[2]


def test_what_is_only_turned_and_small_is_one_cell():
    found, searches = looked_at(forest_of(), small(bent(0.0)), 0.01)
    assert (len(found.corners), searches) == (1, 12)
    np.testing.assert_allclose(
        images_of(found, forest_of().positions)[:, :2], 0.1 * forest_of().positions[:, :2], atol=1e-6
    )


def test_no_cell_is_wide_on_the_screen():
    found, _ = looked_at(forest_of(), bent(0.0), 0.01)
    assert 100.0 * (found.boxes[:, 1] - found.boxes[:, 0])[:, :2].max() <= 48.0


def test_vertices_beside_a_horizon_are_searched_themselves():
    def warp(points):
        return np.c_[0.1 * points, points[:, 0] > 0.123]

    forest = forest_of()
    found, searches = looked_at(forest, warp, 1.0)
    told = images_of(found, forest.positions)[:, 3]
    np.testing.assert_allclose(told, forest.positions[:, 0] > 0.123, atol=1e-6)
    assert searches < 0.5 * len(forest.positions)


def test_nothing_is_searched_where_no_ray_goes():
    forest = forest_of()
    found, searches = looked_at(forest, bent(0.3), 0.2, everywhere((1.0, 0.0, 0.0), 0.2))
    unseen = images_of(found, forest.positions)[:, 3] == NOWHERE
    away = np.linalg.norm(forest.positions, axis=1)
    off = np.arccos(forest.positions[:, 0] / away)
    assert not unseen[off <= 0.2].any()
    assert unseen[(off > 0.8) & (away > 0.7)].all()
    assert searches < 0.25 * looked_at(forest, bent(0.3), 0.2)[1]


def test_no_mesh_no_search():
    assert looked_at(forest_of(1), bent(0.0), 1.0)[1] == 1
    empty = Forest([], [], [])
    found = refined(empty, [], np.zeros((0, 2), int), None, None, 1.0)
    assert (len(found.results), len(found.of_vertex), len(found.corners)) == (1, 0, 0)


# ------------------------------------------------------------------ in pictures


def mirrors():
    """A chrome ball, and a ring in many patches, each above a floor and beside a finely divided ring."""
    ring = tessellated(trimesh.creation.torus(1.2, 0.45, major_sections=64, minor_sections=32), 0)
    around = [
        (ring, placed((1.2, -1.6, 0.3), (0.4, 0.4, 0.4), 0.4, (1, 0, 0)), False),
        (floor(5), placed((0, 0, -1.2)), False),
    ]
    camera = looking((1.0, -4.6, 1.9))
    return {
        "ball": scene_of([(sphere(), placed(), True), *around], camera, bounces=1, world=(0.0, 0.0, 0.7)),
        "ring": scene_of([(torus(), placed(), True), *around], camera, bounces=1, world=(0.0, 0.0, 0.7)),
    }


@pytest.fixture
def refinings(monkeypatch):
    """Of each refinement: images of all vertices in pixels, as they are and as they would be if all were searched, with
    what tells whether they are hidden; how many were searched."""
    seen = []

    def followed(forest, bundles, pairs, search, pixels, within):
        found = refined(forest, bundles, pairs, search, pixels, within)
        vertices = np.concatenate([np.arange(forest.vertices[mesh], forest.vertices[mesh + 1]) for _, mesh in pairs])
        rows = np.repeat(pairs[:, 0], np.diff(forest.vertices)[pairs[:, 1]])
        exact = search(rows, forest.positions[vertices])
        images = images_of(found, forest.positions[vertices])
        seen.append((pixels(images[:, :3]), images[:, 3], pixels(exact[:, :3]), exact[:, 3], len(found.results) - 1))
        return found

    monkeypatch.setattr(refining, "refined", followed)
    return seen


@pytest.mark.parametrize("name", mirrors())
def test_images_stay_within_a_pixel_of_every_vertex_searched(name, refinings):
    scene = mirrors()[name]
    every = frame_of(scene, {"grid": 0}, PICTURE, method=VirtualObjectsPublished)
    between = frame_of(scene, {"refine": 1.0}, PICTURE, method=VirtualObjectsPublished)
    ((images, told, exact, expected, searches),) = refinings
    shown = (expected == 0.0) & (told != NOWHERE) & (np.abs(exact) < np.array(PICTURE) / 2.0).all(axis=1)
    assert shown.sum() > 3000
    off = np.linalg.norm(images - exact, axis=1)[shown]
    assert (off < 1.0).mean() > 0.995
    assert off.max() < 2.0
    assert searches < 0.35 * len(told)
    expected = truth(scene, PICTURE, 2)
    mirror = (every.reflectors > 0) & ~expected.grazing
    wrong = [differing(frame.color, expected.color)[mirror].mean() for frame in (every, between)]
    assert wrong[1] < wrong[0] + 0.005


def test_the_grid_is_coarser_where_the_mirror_is_small_on_the_screen(refinings):
    scene = mirrors()["ball"]
    far = replace(scene, camera=looking((5.0, -23.0, 9.5)))
    for one in (scene, far):
        frame_of(one, {"refine": 1.0}, PICTURE, method=VirtualObjectsPublished)
    assert refinings[1][4] < 0.5 * refinings[0][4]
