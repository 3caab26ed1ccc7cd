"""Trees of triangles: all are there, no tree is too deep, and a search finds what brute force finds."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import grow_trees, trees
from catoptric.addon.tracing import build_tree, clusters
from catoptric.addon.tracing.layers import padded_box
from catoptric.addon.tracing.splitting import split
from catoptric.addon.tracing.trees import DEPTH, STEPS
from hypothesis import given, settings
from hypothesis import strategies as st

from .ray_stage import Tracer, brute_force
from .stage import looking, mesh_of, placed, scene_of


def tree_of(corners):
    """The tree of triangles (T, 3, 3)."""
    corners = np.asarray(corners, np.float32)
    return build_tree(corners, *padded_box(corners))


def children_of(tree):
    """Node, child (-1 - triangle for a leaf) and box (2, 3) in metres of every child there is."""
    low, high = tree.nodes[:, :3] & 0xFFFF, tree.nodes[:, :3] >> 16
    node, slot = np.nonzero((low <= high).all(axis=1))
    boxes = np.stack([low, high], axis=1).transpose(0, 3, 1, 2)[node, slot] / STEPS * tree.size + tree.low
    return node, tree.nodes[node, 3, slot].view(np.int32), boxes


def soup(seed, count, kind):
    """Triangles anywhere, and of every odd kind."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (count, 1, 3)) + random.normal(size=(count, 3, 3)) * random.choice([0.02, 0.5])
    if kind == "one point":
        corners[:] = corners[0, 0]
    elif kind == "one triangle":
        corners[:] = corners[0]
    elif kind == "no area":
        corners[:, 2] = corners[:, 1]
    elif kind == "in a row":
        corners = corners[:1] + np.arange(count)[:, None, None] * [0.0, 0.0, 0.02]
    elif kind == "ever farther":
        corners = corners * np.exp2(np.arange(count) % 100)[:, None, None]
    elif kind == "flat":
        corners[..., 2] = 0.25
    elif kind == "needles":
        corners[:, 2] = corners[:, 1] + 1e-4
    return corners.astype(np.float32)


KINDS = ("any", "one point", "one triangle", "no area", "in a row", "ever farther", "flat", "needles")


@given(st.integers(0, 10_000), st.integers(1, 300), st.sampled_from(KINDS))
@settings(max_examples=80, deadline=None)
def test_every_triangle_lies_in_the_boxes_above_it(seed, count, kind):
    corners = soup(seed, count, kind)
    tree = tree_of(corners)
    assert 1 <= tree.depth <= DEPTH
    node, child, boxes = children_of(tree)
    assert sorted(child[child >= 0]) == list(range(1, len(tree.nodes)))  # each node but the root has one parent
    assert (child[child >= 0] > node[child >= 0]).all()  # and comes after it: no walk goes round for ever
    assert set(-1 - child[child < 0]) == set(range(count))
    parent = np.full(len(tree.nodes), -1)
    parent[child[child >= 0]] = np.flatnonzero(child >= 0)
    points = np.einsum("sc,tck->tsk", np.random.default_rng(seed).dirichlet([1, 1, 1], 20), corners.astype(float))
    hair = 1e-6 * tree.size + 1e-9
    for triangle in range(count):
        inside = np.zeros(len(points[triangle]), bool)
        for leaf in np.flatnonzero(child == -1 - triangle):  # one for each piece
            within, row = np.ones_like(inside), leaf
            while row >= 0:
                low, high = boxes[row]
                within &= ((points[triangle] >= low - hair) & (points[triangle] <= high + hair)).all(axis=1)
                row = parent[node[row]]
            inside |= within
        assert inside.all()


@pytest.mark.parametrize("kind", KINDS)
def test_ten_thousand_triangles_of_any_kind_make_a_tree_soon(kind, monkeypatch):
    rounds = []

    def counted(row):
        rounds.append(row.shape[1])
        return partners(row)

    partners = clusters._partners
    monkeypatch.setattr(clusters, "_partners", counted)
    tree = tree_of(soup(1, 10_000, kind))
    assert len(rounds) < 70
    assert tree.depth <= DEPTH
    assert len(tree.nodes) < 10_000


def test_a_tree_that_would_be_too_deep_is_made_flat(monkeypatch):
    """A tree that is one long chain, as no input we know makes it."""

    def chain(boxes, balanced=False):
        if balanced:
            return clusters.pair_up(boxes, balanced=True)
        count = len(boxes)
        before = np.concatenate([[0], count + np.arange(count - 2)])
        joined = np.maximum.accumulate(boxes)[1:]
        return np.stack([before, np.arange(1, count)], axis=1), np.concatenate([boxes, joined])

    monkeypatch.setattr("catoptric.addon.tracing.trees.pair_up", chain)
    tree = tree_of(soup(3, 3000, "any"))
    assert tree.depth <= 12


def test_pieces_make_up_their_triangles():
    corners = np.random.default_rng(5).uniform(-1, 1, (400, 3, 3))
    corners[:, 2] = corners[:, 1] + 0.01
    unit = (corners - corners.min(axis=(0, 1))) / np.ptp(corners, axis=(0, 1)).max()
    pieces, source = split(unit)
    assert len(unit) < len(pieces) <= len(unit) + 4096

    def areas(triangles):
        return np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)

    np.testing.assert_allclose(np.bincount(source, areas(pieces), len(unit)), areas(unit), rtol=1e-5)


def test_a_fan_costs_few_boxes():
    """A disc of 96 triangles: a ray through it, off its middle, meets half as many boxes as it would uncut (14)."""
    turn = np.linspace(0, 2 * np.pi, 97)
    rim = np.stack([np.cos(turn), np.sin(turn), np.zeros(97)], axis=1)
    fan = np.stack([np.zeros((96, 3)), rim[:-1], rim[1:]], axis=1)
    _, child, boxes = children_of(tree_of(fan))
    boxes = boxes[child < 0]
    place = np.random.default_rng(0).uniform(-0.6, 0.6, (500, 2))
    place = place[np.linalg.norm(place, axis=1) > 0.3]
    met = ((place[:, None] >= boxes[:, 0, :2]) & (place[:, None] <= boxes[:, 1, :2])).all(axis=-1).sum(axis=1)
    assert met.mean() < 7


def test_trees_are_good_ones():
    """Nodes that a ray which meets the mesh's box expects to visit, by the surface of theirs.

    A sweep of all planes (Wald 2007) gives 14.4 here, halves along a space-filling curve 28.8.
    """
    shape = trimesh.creation.torus(1.0, 0.4, major_sections=96, minor_sections=48)
    tree = tree_of(shape.triangles)
    _, child, boxes = children_of(tree)
    extent = np.ptp(boxes[child >= 0], axis=1)
    surface = (extent * np.roll(extent, 1, axis=1)).sum()
    visited = surface / (tree.size * np.roll(tree.size, 1)).sum()
    assert visited < 16


# ------------------------------------------------------------------ searched on the GPU


def rays_at(scene, random, count):
    """Rays that pass through points of triangles, from anywhere; some go along an axis."""
    corners = np.concatenate(
        [
            scene.meshes[one.mesh].corners.astype(float) @ one.matrix[:3, :3].T + one.matrix[:3, 3]
            for one in scene.instances
        ]
    )
    chosen = corners[random.integers(0, len(corners), count)]
    points = (chosen * random.dirichlet([1, 1, 1], count)[..., None]).sum(axis=1)
    origins = random.normal(size=(count, 3)) * 2
    directions = points - origins
    straight = random.random(count) < 0.2
    directions[straight] = np.eye(3)[random.integers(0, 3, straight.sum())] * random.choice([-1, 1])
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def agree(scene, tracer, random, unsure=0.005):
    """Assert that the tracer finds what brute force finds, but for a small share that passes edges."""
    origins, directions = rays_at(scene, random, 400)
    found = tracer.hits(origins, directions)
    truth = brute_force(scene, origins.astype(np.float32).astype(float), directions.astype(np.float32).astype(float))
    nearest = truth.min(axis=1)
    firsts = np.cumsum([0, *(len(scene.meshes[one.mesh].triangles) for one in scene.instances)])
    own = np.where(found.instance < 0, np.inf, truth[np.arange(len(origins)), np.where(
        found.instance < 0, 0, firsts[np.maximum(found.instance, 0)] + found.triangle)])  # fmt: skip
    both = np.isfinite(nearest) & np.isfinite(own)
    same = (found.instance < 0) & ~np.isfinite(nearest)
    same[both] = np.abs(own[both] - nearest[both]) <= 1e-4 * (1 + nearest[both])
    assert (~same).mean() <= unsure, f"{(~same).sum()} of {len(same)}"
    # A ray that grazes its triangle has an end that float32 does not know well.
    assert np.quantile(np.abs(found.distance - nearest)[both & same] / (1 + nearest[both & same]), 0.9) < 1e-5
    assert both.any()


@given(st.integers(0, 10_000), st.integers(1, 200), st.sampled_from(["any", "one triangle", "flat", "in a row"]))
@settings(max_examples=25, deadline=None)
def test_finds_what_brute_force_finds(seed, count, kind):
    random = np.random.default_rng(seed)
    corners = soup(seed, count, kind)
    mesh = mesh_of(trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), process=False))
    scene = scene_of(
        [
            (mesh, placed(), False),
            (mesh, placed((2, 0.5, 0), (-1.0, 0.3, 2.0), 1.0, (1, 2, 3)), False),
        ],
        looking((0, -5, 0)),
    )
    tracer = Tracer(scene)
    try:
        agree(scene, tracer, random)
    finally:
        tracer.release()


@pytest.mark.parametrize("kind", ["one point", "no area", "needles", "ever farther"])
def test_odd_meshes_do_not_stop_a_ray(kind):
    corners = soup(2, 100, kind)
    odd = mesh_of(trimesh.Trimesh(corners.reshape(-1, 3), np.arange(300).reshape(-1, 3), process=False))
    ball = mesh_of(trimesh.creation.icosphere(2))
    scene = scene_of([(replace(odd, normals=np.nan_to_num(odd.normals)), placed((1, 0, 0)), False),
                      (ball, placed(), False)], looking((0, -5, 0)))  # fmt: skip
    tracer = Tracer(scene)
    try:
        hit = tracer.hits(np.array([[0.0, -5.0, 0.1]]), np.array([[0.0, 1.0, 0.0]]))
        assert hit.distance[0] < 5
        if kind != "ever farther":  # than what float32 can multiply
            agree(scene, tracer, np.random.default_rng(0), unsure=0.02)
    finally:
        tracer.release()


def test_a_moved_object_is_met_where_it_is_and_nothing_is_built():
    mesh = mesh_of(trimesh.creation.torus(0.6, 0.2, major_sections=24, minor_sections=12))
    scene = scene_of([(mesh, placed(), False), (mesh, placed((0.5, 0, 0.8)), False)], looking((0, -5, 0)))
    tracer = Tracer(scene)
    try:
        random = np.random.default_rng(1)
        agree(scene, tracer, random)
        (tree,) = grow_trees(scene.meshes)
        moved = replace(scene.instances[1], matrix=placed((-0.7, 0.3, -0.5), (1.5, 1, 1), 0.5, (0, 1, 1)))
        scene = replace(scene, instances=(scene.instances[0], moved))
        tracer.update(scene)
        agree(scene, tracer, random)
        assert grow_trees(scene.meshes) == [tree]
    finally:
        tracer.release()


def test_a_mesh_that_changes_is_met_as_it_is():
    first, second = mesh_of(trimesh.creation.box()), mesh_of(trimesh.creation.cone(0.8, 1.5))
    scene = scene_of([(first, placed(), False)], looking((0, -5, 0)))
    tracer = Tracer(scene)
    try:
        random = np.random.default_rng(1)
        agree(scene, tracer, random)
        scene = replace(scene, meshes=(second,))
        tracer.update(scene)
        agree(scene, tracer, random)
    finally:
        tracer.release()


def test_a_mesh_that_is_placed_often_is_built_once(monkeypatch):
    built = []

    def counted(*given):
        built.append(given)
        return build_tree(*given)

    monkeypatch.setattr(trees, "build_tree", counted)
    meshes = [mesh_of(trimesh.creation.box()), mesh_of(trimesh.creation.icosphere(1))]
    parts = [(meshes[i % 2], placed((i, 0, 0)), False) for i in range(6)]
    for _ in range(2):
        scene = scene_of(parts, looking((0, -5, 0)))
        tracer = Tracer(scene)
        agree(scene, tracer, np.random.default_rng(0))
        tracer.release()
    assert len(built) == 2
