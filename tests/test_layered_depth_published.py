"""`layered-depth-published` against Embree: right where the paper is right, wrong where it says so."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.layered_depth import bake_layers
from catoptric.addon.baking.layered_depth_tables import ResidentLayers, fitting_resolution
from catoptric.addon.drawing import Resident
from catoptric.addon.errors import UsageError
from catoptric.addon.gl import call
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.layered_depth_published import LayeredDepthPublished, surroundings
from catoptric.addon.methods.registry import named
from catoptric.addon.scene import ColorSource, Lighting, Material
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed, scene_of

SIZE = (128, 96)
WORLD = (0.0, 0.0, 0.25)
QUICK = {"resolution": 128, "size": 16}


@dataclass
class Result:
    """Over the reflectors' pixels: what the method shows and what Embree finds, and a texel in metres."""

    frame: object
    chosen: np.ndarray
    color: np.ndarray
    distance: np.ndarray
    instance: np.ndarray
    wanted: np.ndarray
    point: np.ndarray
    flat: np.ndarray
    direction: np.ndarray
    texel: float

    def errors(self, which=True):
        """Distance errors in texels where both hit."""
        both = np.isfinite(self.distance) & np.isfinite(self.wanted) & which
        return np.abs(self.distance[both] - self.wanted[both]) / self.texel


def result_of(scene, **given):
    """Render and judge a scene whose first part is the mirror and whose second is the object."""
    method = LayeredDepthPublished({**QUICK, **given})
    method.prepare(scene, Lighting.UNLIT)
    try:
        frame = method.render(View(scene.camera, *SIZE, samples=1))
        bake = method.bakes[1]
    finally:
        method.release()
    judge = Judge(scene)
    origins, directions = camera_rays(scene.camera, *SIZE)
    first = judge.meet(origins, directions)
    mirrors = np.array([instance.reflector for instance in scene.instances])
    start, reflected = mirrored(first, directions)
    chosen = (first.instance >= 0) & mirrors[first.instance] & ((reflected * first.flat).sum(-1) > 0.01)
    second = judge.meet(start[chosen], reflected[chosen])
    stretch = np.linalg.svd(scene.instances[1].matrix[:3, :3], compute_uv=False).max()
    texel = 1.0 if bake is None else stretch * bake.size.max() / method.settings["resolution"]
    color, distance = frame.color.reshape(-1, 3)[chosen], frame.distance.reshape(-1)[chosen]
    judged = second.instance, second.distance, second.position, second.flat
    return Result(frame, chosen, color, distance, *judged, reflected[chosen], texel)


def ball():
    """A round mirror."""
    return mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True)


def plane(corners):
    """A flat mirror of two triangles."""
    return mesh_of(trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False))


def beside_ball(shape, matrix, smooth=False):
    """A mirror ball with an object beside it, seen so that the object does not hide the ball."""
    parts = [(ball(), placed(), True), (mesh_of(shape, smooth), matrix, False)]
    return scene_of(parts, looking((0, -4, 0.6), lens=65.0), world=WORLD)


def under_ceiling(shape, matrix=None):
    """An object under a flat mirror that the camera looks up to: rays come down on the object."""
    ceiling = plane([[-6, -6, 3], [-6, 6, 3], [6, 6, 3], [6, -6, 3]])
    camera = looking((0, -3.5, 1.2), (0, -1.2, 3.0), lens=30.0)
    return scene_of(
        [(ceiling, placed(), True), (shape, placed() if matrix is None else matrix, False)], camera, world=WORLD
    )


def lids_red_and_sides_green(scene):
    """The object of the scene with what looks up or down in one colour and the rest in another."""
    mirror, thing = scene.instances
    mesh = scene.meshes[thing.mesh]
    slots = np.where(np.abs(mesh.normals[:, 0, 2]) > 0.5, 0, 1).astype(np.int32)
    lid, side = (Material(name, base=ColorSource(color)) for name, color in (("lid", (1, 0, 0)), ("side", (0, 1, 0))))
    return replace(
        scene,
        meshes=(scene.meshes[mirror.mesh], replace(mesh, slots=slots)),
        materials=(scene.materials[0], lid, side),
        instances=(mirror, replace(thing, materials=(1, 2))),
    )


# ------------------------------------------------------------------ right


@pytest.mark.parametrize(
    ("shape", "smooth"), [(trimesh.creation.icosphere(4), True), (trimesh.creation.box(), False)], ids=["sphere", "box"]
)
def test_a_convex_object_is_met_within_a_texel(shape, smooth):
    result = result_of(
        beside_ball(shape, placed((1.5, -0.9, 0.2), (0.5,) * 3, 0.5, (0, 0.3, 1)), smooth), regions=False
    )
    hits, wanted = np.isfinite(result.distance), result.instance == 1
    assert wanted.sum() > 100
    assert (hits != wanted).sum() <= 0.02 * wanted.sum()
    away_from_grazing = -(result.flat * result.direction).sum(-1) > 0.3
    errors = result.errors(away_from_grazing)
    assert np.median(errors) <= 0.5
    assert np.quantile(errors, 0.99) <= 1.5
    both = hits & wanted
    assert (result.color[both] == (2.0, 1.0, 0.0)).all()


@settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.floats(0.0, 6.0), st.tuples(*[st.sampled_from([-0.7, 0.3, 0.5, 0.8])] * 3))
def test_turned_and_stretched_objects_are_met_as_well(turn, scale):
    shape = trimesh.creation.cylinder(0.7, 1.6, sections=24)
    result = result_of(beside_ball(shape, placed((1.6, -0.8, 0.2), scale, turn, (1, 0.4, 0.7))), regions=False)
    hits, wanted = np.isfinite(result.distance), result.instance == 1
    assert (hits != wanted).sum() <= 3 + 0.05 * wanted.sum()
    assert np.median(result.errors()) <= 1.0


def test_figure_5_the_side_of_a_cylinder_needs_a_second_face():
    """The rays enter by the top and meet the side, which the top sees edge-on: it knows the lid's colour alone."""
    scene = lids_red_and_sides_green(under_ceiling(mesh_of(trimesh.creation.cylinder(1.0, 2.0, sections=48))))
    result = result_of(scene)
    entry = result.point - result.direction * ((result.point[:, 2] - 1.0) / result.direction[:, 2])[:, None]
    by_top = (result.instance == 1) & (np.abs(result.flat[:, 2]) < 0.1) & (np.abs(entry[:, :2]) < 0.98).all(axis=1)
    by_top &= np.isfinite(result.distance)
    assert by_top.sum() > 30
    assert (result.color[by_top, 1] == 1).mean() > 0.95
    one_face = result_of(scene, threshold=1e6)
    assert (one_face.color[by_top, 0] == 1).mean() > 0.5


def slabs():
    """Two slabs above each other: from above one hides the other, from the side a gap shows."""
    upper, lower = (trimesh.creation.box((2.0, 2.0, 0.3)) for _ in range(2))
    upper.apply_translation((0, 0, 0.8))
    lower.apply_translation((0, 0, -0.8))
    return mesh_of(trimesh.util.concatenate(upper, lower))


def before_wall(*parts):
    """Objects before a flat mirror at y = 3, seen from above between them and behind."""
    wall = plane([[-8, 3, -6], [8, 3, -6], [8, 3, 6], [-8, 3, 6]])
    camera = looking((0.5, -1.5, 2.5), (0.2, 3.0, 1.2), lens=24.0)
    return scene_of([(wall, placed(), True), *((shape, matrix, False) for shape, matrix in parts)], camera, world=WORLD)


def test_figure_6_what_lies_under_something_else_needs_layers():
    scene = lids_red_and_sides_green(before_wall((slabs(), placed())))
    deep, shallow = result_of(scene), result_of(scene, layers=1)
    between = (deep.instance == 1) & (deep.flat[:, 2] > 0.9) & (deep.point[:, 2] < 0)
    assert between.sum() > 50
    assert (deep.color[between, 0] == 1).mean() > 0.98
    assert np.median(deep.errors(between)) <= 1.0
    assert (shallow.color[between, 0] == 1).mean() < 0.1


def test_a_flat_mirror_loses_nothing_to_the_region_test():
    scene = before_wall((slabs(), placed((0.3, 0, 0), turn=0.4)))
    with_test, without = result_of(scene), result_of(scene, regions=False)
    assert np.array_equal(with_test.frame.color, without.frame.color)
    assert np.array_equal(with_test.distance, without.distance)
    assert np.isfinite(with_test.distance).sum() > 100


def test_the_world_is_what_is_left_where_nothing_is_met():
    """The objects that are searched stand once in the mirror, not again in the environment map."""
    scene = beside_ball(trimesh.creation.box(), placed((1.6, -0.5, 0), (0.6,) * 3))
    result = result_of(scene)
    missed = ~np.isfinite(result.distance)
    assert 0.5 < missed.mean() < 0.99
    np.testing.assert_allclose(result.color[missed], np.tile(WORLD, (missed.sum(), 1)), atol=1e-5)
    assert np.isnan(result.frame.distance.reshape(-1)[~result.chosen]).any()
    assert not np.isnan(result.distance).any()


def test_a_room_around_the_mirror_stays_in_the_environment_map():
    room = trimesh.creation.box((9, 9, 9))
    parts = [(ball(), placed(), True), (mesh_of(room), placed(), False)]
    parts.append((mesh_of(trimesh.creation.box()), placed((1.7, -0.4, 0), (0.5,) * 3), False))
    scene = scene_of(parts, looking((0, -4, 0.5), lens=60.0), world=WORLD)
    assert surroundings(scene) == {1}
    result = result_of(scene)
    met = np.isfinite(result.distance)
    np.testing.assert_allclose(result.color[met], np.tile((3.0, 1.0, 0.0), (met.sum(), 1)))
    np.testing.assert_allclose(result.color[~met], np.tile((2.0, 1.0, 0.0), ((~met).sum(), 1)), atol=1e-5)
    assert met.sum() > 50


# ------------------------------------------------------------------ wrong, as published


def bars():
    """The edges of a box, as bars a twentieth of it wide, turned so that none lies along its own box."""
    parts = []
    for axis in range(3):
        for side in np.ndindex(2, 2):
            bar = trimesh.creation.box(np.where(np.arange(3) == axis, 2.0, 0.1))
            offset = np.zeros(3)
            offset[[(axis + 1) % 3, (axis + 2) % 3]] = 0.95 * (2 * np.array(side) - 1)
            bar.apply_translation(offset)
            parts.append(bar)
    shape = trimesh.util.concatenate(parts)
    shape.apply_transform(placed(turn=0.6, axis=(1, 1, 0.5)))
    return mesh_of(shape)


def test_parts_thinner_than_a_step_are_stepped_over():
    scene = before_wall((bars(), placed((0, 0.3, 0), turn=0.3)))
    wrong = {}
    for steps in (8, 32, 128):
        result = result_of(scene, linear_steps=steps, binary_steps=12)
        on_bars = result.instance == 1
        wrong[steps] = 1.0 - (np.abs(result.distance[on_bars] - result.wanted[on_bars]) < 3 * result.texel).mean()
    assert wrong[8] > wrong[32] > wrong[128]
    assert wrong[8] > 0.1
    assert wrong[128] < 0.05


def test_halving_finds_the_surface_within_the_step():
    scene = beside_ball(trimesh.creation.box(), placed((1.5, -0.9, 0.2), (0.5,) * 3, 0.5))
    coarse, fine = (np.median(result_of(scene, linear_steps=8, binary_steps=steps).errors()) for steps in (0, 10))
    assert coarse > 2.0
    assert fine < 0.5


def test_the_last_object_covers_the_others_unless_the_nearest_is_asked_for():
    box = mesh_of(trimesh.creation.box((1.5, 0.3, 1.5)))
    near, far = (box, placed((0, 1.6, 0.5))), (box, placed((0, 0.2, 0.5)))
    for parts, nearest_first in (((near, far), True), ((far, near), False)):
        scene = before_wall(*parts)
        as_published, mended = result_of(scene), result_of(scene, nearest=True)
        front, back = (2.0, 3.0) if nearest_first else (3.0, 2.0)
        covered = (as_published.color[:, 0] != mended.color[:, 0]) & np.isfinite(mended.distance)
        seen = mended.instance > 0
        assert (mended.color[seen, 0] == mended.instance[seen] + 1.0).mean() > 0.97
        assert (covered.sum() > 50) == nearest_first
        assert (mended.color[covered, 0] == front).all()
        assert (as_published.color[covered, 0] == back).all()
        assert (mended.distance[covered] < as_published.distance[covered]).all()


def test_an_open_sheet_is_left_to_the_environment_map():
    sheet = plane([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    result = result_of(scene_of([(ball(), placed((0, 0, 1)), True), (sheet, placed(), False)], looking((0, -5, 2))))
    assert np.isinf(result.distance).all()
    assert (result.color[:, 0] > 1.9).mean() > 0.1


# ------------------------------------------------------------------ the door


def test_many_objects_share_the_memory_they_are_given():
    shapes = [mesh_of(trimesh.creation.icosphere(1, radius=1.0 + index)) for index in range(12)]
    scene = scene_of([(shape, placed(), False) for shape in shapes], looking((0, -6, 1)))
    assert fitting_resolution(scene, 512, 4096) == 512
    tight = fitting_resolution(scene, 512, 64)
    assert tight < 512
    settings = {"resolution": tight, "layers": 4}
    bakes = call(lambda: bake_layers(Resident(scene, Lighting.UNLIT), settings))
    method = call(ResidentLayers, bakes)
    try:
        assert 0.6 * 64 < method.size_bytes / 2**20 <= 64
        assert all(bake.layers == 1 for bake in bakes)
    finally:
        call(method.release)


def test_the_registry_knows_it_and_its_settings_are_checked():
    assert named("layered-depth-published") is LayeredDepthPublished
    with pytest.raises(UsageError, match="linear_steps"):
        LayeredDepthPublished({"linear_steps": 0})
    with pytest.raises(UsageError, match="resolution"):
        LayeredDepthPublished({"resolution": 5000})


def test_a_texel_is_enough_on_a_scanned_mesh(shared):
    path = shared / "models" / "bunny.obj"
    if not path.is_file():
        pytest.skip(f"no {path.name} here")
    shape = trimesh.load(path, process=False)
    shape.apply_translation(-shape.bounds.mean(axis=0))
    shape.apply_scale(1.2 / np.ptp(shape.bounds, axis=0).max())
    scene = beside_ball(shape, placed((1.5, -0.9, 0.2), turn=np.pi / 2, axis=(1, 0, 0)), smooth=True)
    result = result_of(scene, resolution=512)
    hits, wanted = np.isfinite(result.distance), result.instance == 1
    assert wanted.sum() > 100
    assert (hits != wanted).sum() <= 0.04 * wanted.sum()
    assert np.median(result.errors()) <= 1.0
