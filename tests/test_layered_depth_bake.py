"""Layered depth textures: every crossing found, paired, coloured, kept and exported."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.layered_depth import FACES, bake_instance, bake_layers
from catoptric.addon.baking.layered_depth_peel import Peeler
from catoptric.addon.baking.layered_depth_solids import solid_triangles
from catoptric.addon.drawing import Resident
from catoptric.addon.errors import UsageError
from catoptric.addon.gl import call
from catoptric.addon.scene import ColorSource, Lighting, Material
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .stage import looking, mesh_of, placed, scene_of

SETTINGS = {"resolution": 48, "layers": 16}
IDENTITY = np.eye(4)


def scene_with(*parts):
    """A scene of (trimesh or Mesh, matrix)."""
    meshes = [(part if not isinstance(part, trimesh.Trimesh) else mesh_of(part), matrix) for part, matrix in parts]
    return scene_of([(mesh, matrix, False) for mesh, matrix in meshes], looking((0, -6, 1)))


def baked(shape, resolution=48, layers=16, matrix=IDENTITY):
    """The bake of one mesh, unlit."""

    def work():
        resident = Resident(scene_with((shape, matrix)), Lighting.UNLIT)
        try:
            return bake_instance(resident, 0, resolution, layers)
        finally:
            resident.release()

    return call(work)


def bake_all(scene, cache=None, lighting=Lighting.UNLIT, **changed):
    """The bakes of a scene."""

    def work():
        resident = Resident(scene, lighting)
        try:
            return bake_layers(resident, {**SETTINGS, **changed}, cache)
        finally:
            resident.release()

    return call(work)


def union(*shapes):
    """Several meshes as one, nothing cut."""
    return trimesh.util.concatenate(shapes)


def bowl_of(subdivisions):
    """The upper half of a sphere, open below."""
    shape = trimesh.creation.icosphere(subdivisions)
    shape.update_faces((shape.triangles[..., 2] > -1e-6).all(axis=1))
    return shape


def volume(bake, axis):
    """What the layers of one axis enclose, in cubic metres."""
    depths = bake.axes[axis].depths
    return float((depths[:, 1] - depths[:, 0]).sum()) * bake.size.prod() / bake.axes[axis].counts.size


def same(first, second):
    """Whether two bakes hold the same bits."""
    names = ("counts", "depths", "triangles", "colors", "normals")
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for a, b in zip(first.axes, second.axes, strict=True)
        for name in names
    )


# ------------------------------------------------------------------ what the peel finds


def crossings_by_hand(corners, axis, columns, rows):
    """For each texel whose centre is clear of every edge: sorted (depth, facing) of all triangles over it, and how
    steep the steepest of them is, in depth across the box.
    """
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    normals = np.cross(*(corners[:, i][:, order] - corners[:, 0][:, order] for i in (1, 2)))
    slopes = np.linalg.norm(normals[:, :2], axis=1) / np.maximum(np.abs(normals[:, 2]), 1e-12)
    points = corners[..., order] * [columns, rows, 1.0]
    found = {}
    for row in range(rows):
        for column in range(columns):
            a, b, c = (points[:, corner, :2] - (column + 0.5, row + 0.5) for corner in range(3))
            parts = np.stack([p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b))], axis=1)
            # How far inside each triangle the centre lies, in texels: near nought, rounding decides.
            edges = np.linalg.norm(np.stack([c - b, a - c, b - a], axis=1), axis=2)
            turned = np.where(parts.sum(axis=1, keepdims=True) < 0, -parts, parts)
            if (np.abs((turned / np.maximum(edges, 1e-12)).min(axis=1)) < 0.02).any():
                continue
            over = (parts > 0).all(axis=1) | (parts < 0).all(axis=1)
            weight = parts[over] / parts[over].sum(axis=1, keepdims=True)
            depth = (weight * points[over, :, 2]).sum(axis=1)
            # Facing the low side of the box means an area that turns clockwise as seen along the axis.
            facing = -np.sign(parts[over].sum(axis=1))
            sorting = np.argsort(depth)
            found[row, column] = depth[sorting], facing[sorting], slopes[over].max(initial=0.0)
    return found


def solid_spans(depth, facing):
    """Where a line is inside at least one solid."""
    spans, inside = [], 0
    for z, turn in zip(depth, facing, strict=True):
        before, inside = inside, inside + int(turn)
        if before == 0:
            spans.append([z, z])
        if inside == 0:
            spans[-1][1] = z
    return np.array(spans).reshape(-1, 2)


@st.composite
def solids(draw):
    """One to four boxes, cones and tori, turned anyhow, overlapping or not."""
    makers = (
        lambda: trimesh.creation.box((1.0, 0.6, 0.3)),
        lambda: trimesh.creation.icosphere(subdivisions=1, radius=0.5),
        lambda: trimesh.creation.cone(0.4, 1.0, sections=9),
        lambda: trimesh.creation.torus(0.6, 0.2, major_sections=9, minor_sections=6),
    )
    number = st.floats(-1.0, 1.0)
    shapes = []
    for _ in range(draw(st.integers(1, 4))):
        shape = draw(st.sampled_from(makers))()
        axis = (draw(number), draw(number), draw(st.floats(0.2, 1.0)))
        shape.apply_transform(placed([draw(number) for _ in range(3)], turn=3.0 * draw(number), axis=axis))
        shapes.append(shape)
    return union(*shapes)


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(solids(), st.integers(0, 2))
def test_layers_are_those_of_a_search_by_hand(shape, axis):
    bake = baked(shape, resolution=16)
    corners = (np.asarray(shape.vertices, np.float32).astype(float)[shape.faces] - bake.low) / bake.size
    face = bake.axes[axis]
    rows, columns = face.counts.shape
    expected = crossings_by_hand(corners, axis, columns, rows)
    assert len(expected) > 0.3 * face.counts.size
    for (row, column), (depth, facing, steepest) in expected.items():
        first = face.first[row, column]
        got = face.depths[first : first + face.counts[row, column]]
        # 32-bit places and slopes: a rounding or two of 1.2e-7 across is that much more depth on a slope.
        np.testing.assert_allclose(got, solid_spans(depth, facing), atol=2e-6 + 2.4e-7 * steepest)


@settings(max_examples=10, deadline=None)
@given(st.floats(0.0, 3.0), st.integers(0, 2))
def test_a_closed_mesh_is_left_as_often_as_entered_at_every_texel(turn, axis):
    """Watertight: triangles much smaller than a texel, whose edges run everywhere."""
    shape = trimesh.creation.icosphere(subdivisions=4)
    shape.apply_transform(placed(turn=turn, axis=(1, 2, 3)))
    places = (np.asarray(shape.vertices) * 0.49 + 0.5).astype(np.float32)

    def work():
        peeler = Peeler(places, np.asarray(shape.faces, np.int32), np.ones(len(shape.faces), bool))
        try:
            return peeler.peel(axis, (24, 24), 64)
        finally:
            peeler.release()

    found = call(work)
    assert found.cut == (0, 0)
    assert (np.bincount(found.texel, found.turn, 24 * 24) == 0).all()
    assert (found.depth[1:][np.diff(found.texel) == 0] > found.depth[:-1][np.diff(found.texel) == 0]).all()


@pytest.mark.parametrize("shape", [trimesh.creation.box(), trimesh.creation.icosphere(3)], ids=["box", "sphere"])
def test_a_convex_object_ends_with_one_layer_by_itself(shape):
    shape.apply_transform(placed(turn=0.7, axis=(1, 2, 0.5)))
    bake = baked(shape)
    assert bake.layers == 1
    assert (bake.hidden, bake.cut) == (0, (0, 0))
    for axis in range(3):
        assert volume(bake, axis) == pytest.approx(shape.volume, rel=0.01)


@pytest.mark.parametrize("axis", range(3))
def test_opposite_faces_see_the_same_crossings_reversed(axis):
    """Peel the mesh flipped along the axis, and compare with what is derived without peeling."""
    shape = union(trimesh.creation.torus(1.0, 0.3), trimesh.creation.icosphere(2, radius=0.5))
    shape.apply_transform(placed(turn=0.9, axis=(1, 1, 0.3)))
    flipped = shape.copy()
    flipped.apply_transform(np.diag([*np.where(np.arange(3) == axis, -1.0, 1.0), 1.0]))
    derived, peeled = baked(shape).axes[axis].opposite(), baked(flipped).axes[axis]
    assert np.array_equal(derived.counts, peeled.counts)
    np.testing.assert_allclose(derived.depths, peeled.depths, atol=1e-6)
    mirrored = peeled.normals * np.where(np.arange(3) == axis, -1.0, 1.0)
    assert (np.abs(derived.normals - mirrored).max(axis=(1, 2)) < 1e-4).mean() > 0.99


def test_shells_within_a_solid_are_hidden_and_do_not_count():
    bake = baked(union(trimesh.creation.box((2, 2, 2)), trimesh.creation.icosphere(2, radius=0.5)))
    assert bake.layers == 1
    assert bake.hidden > 0


def test_a_hollow_box_has_two_layers():
    inner = trimesh.creation.box((1.6, 1.6, 1.6))
    inner.invert()
    shape = union(trimesh.creation.box((2, 2, 2)), inner)
    bake = baked(shape)
    assert bake.layers == 2
    assert volume(bake, 0) == pytest.approx(8 - 1.6**3, rel=0.03)


def test_coinciding_surfaces_are_harmless():
    once = trimesh.creation.torus(1.0, 0.3, major_sections=24, minor_sections=12)
    twice = union(once, once)
    for single, double in zip(baked(once).axes, baked(twice).axes, strict=True):
        assert np.array_equal(single.counts, double.counts)
        assert np.array_equal(single.depths, double.depths)


def test_boxes_that_touch_leave_no_gap():
    left, right = trimesh.creation.box(), trimesh.creation.box()
    right.apply_translation((1, 0, 0))
    face = baked(union(left, right), resolution=64).axes[0]
    first, _ = face.layer(0)
    second, _ = face.layer(1)
    assert np.array_equal(face.depths[first, 1], face.depths[second, 0])
    assert volume(baked(union(left, right)), 0) == pytest.approx(2.0, rel=0.03)


def test_a_mesh_turned_inside_out_encloses_the_same():
    shape = trimesh.creation.torus(1.0, 0.3)
    inverted = shape.copy()
    inverted.invert()
    for normal, turned in zip(baked(shape).axes, baked(inverted).axes, strict=True):
        assert np.array_equal(normal.counts, turned.counts)
        np.testing.assert_allclose(normal.depths, turned.depths, atol=1e-6)


def test_an_open_surface_has_no_thickness():
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0.2], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    bowl = bowl_of(3)
    for shape in (sheet, bowl):
        bake = baked(shape)
        assert not bake.has_inside
        assert all((axis.depths[:, 0] == axis.depths[:, 1]).all() for axis in bake.axes)
        assert bake.axes[2].counts.max() == 1
    assert baked(bowl).axes[0].counts.max() == 2


def test_both_sides_of_a_sheet_look_at_their_own_face():
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    turned = sheet.copy()
    turned.invert()
    for shape in (sheet, turned):
        normals = baked(shape).axes[2].normals
        np.testing.assert_allclose(normals, np.broadcast_to([[0, 0, -1], [0, 0, 1]], normals.shape), atol=1e-6)


def test_walls_a_few_roundings_thin_keep_both_sides():
    """The peel knows no tolerance: a foil of 4 µm above a box of 1 m is a layer of its own."""
    foil = trimesh.creation.box((1.0, 1.0, 4e-6))
    foil.apply_translation((0, 0, 0.5 + 1e-5))
    face = baked(union(trimesh.creation.box(), foil)).axes[2]
    assert face.counts.max() == 2
    rows, texels = face.layer(1)
    assert len(texels) == (face.counts > 0).sum()
    assert (face.depths[rows, 1] > face.depths[rows, 0]).all()


def test_closed_and_open_parts_are_told_apart():
    ball, sheet = trimesh.creation.icosphere(2), bowl_of(2)
    cracked = trimesh.creation.icosphere(4)
    cracked.update_faces(np.arange(len(cracked.faces)) > 2)
    for part, closed in ((ball, True), (sheet, False), (cracked, True)):
        assert (solid_triangles(np.asarray(part.vertices), np.asarray(part.faces)) == closed).all()
    split = ball.vertices[ball.faces].reshape(-1, 3)
    assert solid_triangles(split, np.arange(len(split)).reshape(-1, 3)).all()
    sheet.apply_translation((5, 0, 0))
    both = union(ball, sheet)
    closed = solid_triangles(np.asarray(both.vertices), np.asarray(both.faces))
    assert closed.tolist() == [True] * len(ball.faces) + [False] * len(sheet.faces)


def test_the_cap_cuts_and_tells_exactly_what():
    slabs = []
    for index in range(7):
        slab = trimesh.creation.box((1.0, 1.0, 0.1))
        slab.apply_translation((0, 0, 0.25 * index))
        slabs.append(slab)
    whole, capped = baked(union(*slabs)), baked(union(*slabs), layers=2)
    assert (whole.axes[2].counts.max(), whole.cut) == (7, (0, 0))
    texels = int((whole.axes[2].counts == 7).sum())
    assert texels == (whole.axes[2].counts > 0).sum() > 0
    assert capped.cut == (2 * 3 * texels, texels)
    assert capped.axes[2].counts.max() == 4
    for kept, layer in enumerate((0, 1, 5, 6)):
        first, _ = capped.axes[2].layer(kept)
        same_layer, _ = whole.axes[2].layer(layer)
        assert np.array_equal(capped.axes[2].depths[first], whole.axes[2].depths[same_layer])
    # Seen from both sides nothing is missing.
    assert same(baked(union(*slabs), layers=4), whole)


# ------------------------------------------------------------------ colour, normal, box


def test_each_face_shows_the_colour_and_normal_of_its_side():
    mesh = mesh_of(trimesh.creation.box())
    normals = mesh.normals[:, 0]
    slots = (2 * np.abs(normals).argmax(axis=1) + (normals.sum(axis=1) < 0)).astype(np.int32)
    scene = scene_with((replace(mesh, slots=slots), placed((3, 1, 2), (2, 3, 0.5), 0.8, (1, 2, 3))))
    materials = tuple(Material(name, base=ColorSource((0.1 * i, 1.0, i))) for i, name in enumerate(FACES))
    scene = replace(scene, materials=materials, instances=(replace(scene.instances[0], materials=tuple(range(6))),))
    (bake,) = bake_all(scene)
    for index, name in enumerate(FACES):
        face = bake.face(name)
        expected = np.zeros(3)
        expected[index // 2] = 1 - 2 * (index % 2)
        np.testing.assert_allclose(
            face.colors[:, 0], np.tile([0.1 * index, 1.0, index], (len(face.colors), 1)), atol=1e-6
        )
        np.testing.assert_allclose(face.normals[:, 0], np.tile(expected, (len(face.normals), 1)), atol=1e-6)
    with pytest.raises(UsageError, match="no face"):
        bake.face("top")


def test_smooth_normals_are_those_of_the_sphere():
    shape = trimesh.creation.icosphere(5)
    bake = baked(mesh_of(shape, smooth=True))
    face = bake.axes[0]
    rows, texels = face.layer(0)
    height, width = face.counts.shape
    place = np.stack([face.depths[rows, 0], (texels % width + 0.5) / width, (texels // width + 0.5) / height], axis=1)
    np.testing.assert_allclose(face.normals[rows, 0], bake.low + bake.size * place, atol=4e-3)


def test_texels_are_square_and_the_longest_side_has_the_resolution():
    bake = baked(trimesh.creation.box((4.0, 1.0, 2.0)), resolution=64)
    assert [axis.counts.shape for axis in bake.axes] == [(32, 16), (64, 32), (16, 64)]
    assert baked(trimesh.creation.box((4.0, 1.0, 1e-4)), resolution=64).axes[0].counts.shape[0] == 1


def test_the_triangles_named_are_those_that_are_crossed():
    shape = trimesh.creation.torus(1.0, 0.3, major_sections=16, minor_sections=8)
    bake = baked(shape)
    face = bake.axes[2]
    rows, texels = face.layer(0)
    height, width = face.counts.shape
    place = np.stack([(texels % width + 0.5) / width, (texels // width + 0.5) / height, face.depths[rows, 0]], axis=1)
    corners = shape.triangles[face.triangles[rows, 0]]
    nearest = trimesh.triangles.closest_point(corners, bake.low + bake.size * place)
    assert np.abs(nearest - (bake.low + bake.size * place)).max() < 1e-2 * bake.size.max() / 48


# ------------------------------------------------------------------ real meshes

_MEASURE = """
import resource, sys, time
import numpy as np, trimesh
from catoptric.addon.baking.layered_depth import bake_instance
from catoptric.addon.drawing import Resident
from catoptric.addon.gl import call
from catoptric.addon.scene import Lighting
from catoptric.tests.stage import looking, mesh_of, scene_of
shape = trimesh.load(sys.argv[1], process=False)
scene = scene_of([(mesh_of(shape, smooth=True), np.eye(4), False)], looking((0, -6, 1)))
resident = call(Resident, scene, Lighting.UNLIT)
bake = call(bake_instance, resident, 0)
volumes = [
    float((axis.depths[:, 1] - axis.depths[:, 0]).sum()) * bake.size.prod() / axis.counts.size for axis in bake.axes
]
print(bake.layers, sum(bake.cut), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, shape.volume, *volumes)
"""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "least"), [("horse.obj", 3), ("buddha.obj", 5), ("armadillo.obj", 5)])
def test_scanned_statues_are_peeled_whole_within_two_gigabytes(shared, name, least):
    path = shared / "models" / name
    if not path.is_file():
        pytest.skip(f"no {path.name} here")
    done = subprocess.run([sys.executable, "-c", _MEASURE, str(path)], capture_output=True, text=True, check=True)
    layers, cut, megabytes, volume, *measured = map(float, done.stdout.split())
    assert layers >= least
    assert cut == 0
    assert megabytes < 2048
    assert measured == pytest.approx([volume] * 3, rel=0.01)
