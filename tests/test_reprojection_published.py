"""Reflections that shift on their mirrors, as published, and those that stay: against closed form and traced ones."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.drawing import world_to_clip
from catoptric.addon.gl import call
from catoptric.addon.methods.image_warp import ImageWarp
from catoptric.addon.methods.reprojection import Reprojection
from catoptric.addon.methods.reprojection_published import ReprojectionPublished
from catoptric.addon.methods.reuse.warping import PRECISION
from catoptric.addon.scene import Camera
from hypothesis import given, settings
from hypothesis import strategies as st

from .reprojection_stage import EYE, filming, is_right, pillars, seen_from, stage, with_placed
from .search_stage import alhazen
from .stage import looking, mesh_of, placed, scene_of

INVALID = -32768
FULL = {"precision": "full", "threshold": 1.0}


@pytest.fixture
def film():
    with filming() as begin:
        yield begin


@dataclass(frozen=True, eq=False)
class Key:
    """A key frame, row 0 at the bottom: `geometry` and `light` (H, W, 4), `offsets` (H, W, 2) of the last picture."""

    geometry: np.ndarray
    light: np.ndarray
    offsets: np.ndarray
    camera: Camera

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows."""
        return self.geometry.shape[1::-1]

    def rays(self) -> tuple[np.ndarray, np.ndarray]:
        """Origins and directions (H, W, 3) of the camera's rays."""
        columns, rows = self.size
        left, right, bottom, top = self.camera.window(columns, rows)
        x = left + (np.arange(columns) + 0.5) / columns * (right - left)
        y = bottom + (np.arange(rows) + 0.5) / rows * (top - bottom)
        at = np.stack([*np.meshgrid(x, y), np.zeros((rows, columns))], axis=-1)
        ahead = np.array([0.0, 0.0, -1.0])
        parallel = self.camera.ortho_scale is not None
        origin, way = (at, np.broadcast_to(ahead, at.shape)) if parallel else (np.zeros_like(at), at + ahead)
        matrix = self.camera.matrix
        direction = way / np.linalg.norm(way, axis=-1, keepdims=True) @ matrix[:3, :3].T
        return origin @ matrix[:3, :3].T + matrix[:3, 3], direction

    def surface(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and normals (H, W, 3)."""
        origin, direction = self.rays()
        x, y = self.geometry[..., 0], self.geometry[..., 1]
        z = 1.0 - np.abs(x) - np.abs(y)
        below = z < 0.0
        folded = [(1.0 - np.abs(b)) * np.where(a >= 0.0, 1.0, -1.0) for a, b in ((x, y), (y, x))]
        normal = np.stack([np.where(below, folded[0], x), np.where(below, folded[1], y), z], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return origin + self.geometry[..., 2:3] * direction, normal

    def points(self) -> np.ndarray:
        """(H, W, 3): where the mirrored rays end, those that meet nothing after 60 km."""
        position, normal = self.surface()
        direction = self.rays()[1]
        mirrored = direction - 2.0 * (direction * normal).sum(axis=-1, keepdims=True) * normal
        return position + np.minimum(self.light[..., 3:], 6e4) * mirrored

    def matched(self) -> np.ndarray:
        """(H, W) bool: the pixels that have a best matched one."""
        return self.offsets[..., 0] != INVALID

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """(N, 2) columns and rows of points (N, 3) in the picture; whole numbers are middles of pixels."""
        clip = np.append(points, np.ones((len(points), 1)), axis=1) @ world_to_clip(self.camera, *self.size).T
        return (0.5 * clip[:, :2] / clip[:, 3:] + 0.5) * self.size - 0.5


def key_of(film) -> Key:
    """What a film's method knows of its last key frame."""

    def read() -> Key:
        (history,) = film.taken._histories.values()
        (key,) = (film.taken._known[key] for key in history._keys.values())
        rows = key.light.size[::-1]
        texels = [np.frombuffer(one.read(), one.dtype).reshape(*rows, 4) for one in (key.geometry, key.light)]
        offsets = np.zeros((*rows, 2), np.int16)
        if key in getattr(film.taken, "_matchings", {}):
            offsets = np.frombuffer(film.taken._matchings[key].offsets.read(), np.int16).reshape(*rows, 2)
        return Key(*(texel.astype(float) for texel in texels), offsets.astype(int), key.sample.view.camera)

    return call(read)


def distances(eye: np.ndarray, point: np.ndarray, position: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(N,) from the eye to the rays from `point` (N, 3), mirrored in planes, through these planes' `position`."""
    mirrored = point - 2.0 * ((point - position) * normal).sum(axis=-1, keepdims=True) * normal
    along = position - mirrored
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    way = eye - mirrored
    past = np.maximum((way * along).sum(axis=-1, keepdims=True), 0.0)
    return np.linalg.norm(way - past * along, axis=-1)


def room(mirror, matrix, camera):
    """A mirror in a large, tiled-like room: walls at different distances, so that points have no common depth."""
    wall = mesh_of(trimesh.creation.box((30, 0.1, 30)))
    box = mesh_of(trimesh.creation.box())
    parts = [
        (mirror, matrix, True),
        (wall, placed((0, -9.0, 0)), False),
        (box, placed((1.5, -6.5, 0.4), turn=0.4), False),
        (box, placed((-1.7, -7.0, -0.6), turn=0.9), False),
    ]
    return scene_of(parts, camera, bounces=0, world=(0.2, 0.5, 0.9))


def flat(camera):
    return room(mesh_of(trimesh.creation.box((6, 0.1, 4))), placed((0, 0.05, 0)), camera)


def round_(camera):
    return room(mesh_of(trimesh.creation.icosphere(subdivisions=6), smooth=True), placed(), camera)


# Algorithm 2

NEAR = st.floats(-0.3, 0.3)


@settings(max_examples=8, deadline=None)
@given(NEAR, NEAR, NEAR)
def test_matched_pixels_are_where_a_flat_mirror_shows_the_same(x, y, z):
    eye = np.array([x, -3.0 + y, z])
    with filming() as film:
        shown = film(flat(looking((0.1, -3.0, 0.0))), ReprojectionPublished, settings=FULL, size=(120, 80))
        shown.show(shown.scene)
        shown.show(seen_from(shown.scene, tuple(eye), (0.0, 0.0, 0.0)))
        key = key_of(shown)
    found = key.matched()
    assert found.mean() > 0.5
    point = key.points()[found]
    mirrored = point * (1.0, -1.0, 1.0)  # the mirror is the plane y = 0
    crossing = eye + (mirrored - eye) * (eye[1] / (eye[1] - mirrored[:, 1]))[:, None]
    matched = np.argwhere(found)[:, ::-1] + key.offsets[found]
    assert np.abs(key.pixels(crossing) - matched).max() <= 1.0


def test_matched_pixels_are_where_a_ball_shows_the_same(film):
    eye = np.array([0.2, -3.1, 0.15])
    shown = film(round_(looking((0.0, -3.0, 0.0))), ReprojectionPublished, settings=FULL, size=(200, 200))
    shown.show(shown.scene)
    shown.show(seen_from(shown.scene, tuple(eye), (0.0, 0.0, 0.0)))
    key = key_of(shown)
    found = key.matched()
    position = key.surface()[0]
    front = found & (np.linalg.norm(position[..., [0, 2]], axis=-1) < 0.7)  # reflections crowd at the rim
    assert front.sum() > 3000
    exact = alhazen(np.append(eye, 1.0), key.points()[front])
    matched = np.argwhere(front)[:, ::-1] + key.offsets[front]
    off = np.abs(key.pixels(exact) - matched).max(axis=1)
    assert np.quantile(off, 0.99) <= 1.0
    assert off.max() <= 2.0


@pytest.mark.parametrize("made", [flat, round_])
def test_no_pixel_beside_a_matched_one_is_better(film, made):
    eye = np.array([0.25, -2.9, 0.1])
    shown = film(made(looking((0.0, -3.0, 0.0))), ReprojectionPublished, settings=FULL, size=(160, 120))
    for x in (0.0, 0.1, eye[0]):  # the last search begins where the one before it ended
        shown.show(seen_from(shown.scene, (x, *eye[1:]) if x else (0.0, -3.0, 0.0), (0.0, 0.0, 0.0)))
    key = key_of(shown)
    found = np.argwhere(key.matched())
    position, normal = key.surface()
    point, at = key.points()[key.matched()], found + key.offsets[key.matched()][:, ::-1]
    assert np.any(key.offsets[key.matched()] != 0)

    def of(rows, columns):
        return distances(eye, point, position[rows, columns], normal[rows, columns])

    here = of(*at.T)
    for row, column in [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]:
        assert np.all(of(*(at + (row, column)).T) >= here - 1e-5)


def test_parallel_rays_are_matched_as_well(film):
    camera = replace(looking((0.5, -4.0, 0.3), (0.0, 0.0, 0.0)), ortho_scale=2.5)
    turned = replace(looking((0.62, -4.0, 0.25), (0.0, 0.0, 0.0)), ortho_scale=2.5)
    shown = film(flat(camera), ReprojectionPublished, settings=FULL, size=(120, 80))
    shown.show(shown.scene)
    shown.show(replace(shown.scene, camera=turned))
    key = key_of(shown)
    found = key.matched()
    assert found.mean() > 0.5
    mirrored = key.points()[found] * (1.0, -1.0, 1.0)
    ahead = -turned.matrix[:3, 2]
    crossing = mirrored - mirrored[:, 1:2] / ahead[1] * ahead
    matched = np.argwhere(found)[:, ::-1] + key.offsets[found]
    assert np.abs(key.pixels(crossing) - matched).max() <= 1.0


def test_silhouettes_match_nothing(film):
    scene = stage()
    shown = film(scene, ReprojectionPublished, settings=FULL)
    shown.show(scene)
    shown.show(seen_from(scene, (0.52, -4.5, 1.0)))
    key = key_of(shown)
    depth, at = key.geometry[..., 2], np.argwhere(key.matched())
    matched = at + key.offsets[key.matched()][:, ::-1]
    assert matched.min() > 0
    assert np.all(matched < np.subtract(depth.shape, 1))
    for row, column in [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)]:
        beside = depth[(*(matched + (row, column)).T,)]
        assert np.all(beside > 0.0)
        assert np.all(np.abs(beside / depth[(*matched.T,)] - 1.0) <= 0.06)


def test_no_reflection_moves_to_another_mirror(film):
    scene = stage()
    shown = film(scene, ReprojectionPublished, settings=FULL)
    shown.show(scene)
    shown.show(seen_from(scene, (2.5, -4.0, 1.0)))
    key = key_of(shown)
    at = np.argwhere(key.matched())
    is_ball = np.linalg.norm(key.surface()[0], axis=-1) < 1.01
    matched = at + key.offsets[key.matched()][:, ::-1]
    assert np.array_equal(is_ball[(*at.T,)], is_ball[(*matched.T,)])


def test_a_search_begins_where_the_last_one_ended(film):
    """Steps that are too few for the whole way are enough for a part of it at a time."""
    shares = []
    for parts in (1, 12):
        shown = film(flat(looking((0.0, -3.0, 0.0))), ReprojectionPublished, settings={**FULL, "steps": 5})
        for x in np.linspace(0.0, 0.4, parts + 1):
            frame, _ = shown.show(seen_from(shown.scene, (x, -3.0, 0.0), (x, 0.0, 0.0)))
        shares.append(frame.reuse.share)
    assert shares[0] > 0.9
    assert shares[1] < 0.4


def test_a_search_that_may_take_no_step_finds_nothing(film):
    shares = []
    for steps in (1, 4096):
        shown = film(flat(looking((0.0, -3.0, 0.0))), ReprojectionPublished, settings={**FULL, "steps": steps})
        shown.show(shown.scene)
        shares.append(shown.show(seen_from(shown.scene, (0.4, -3.0, 0.0), (0.4, 0.0, 0.0)))[0].reuse.share)
    assert shares[0] > 0.9
    assert shares[1] < 0.4


# Pictures


@pytest.mark.parametrize("method", [ReprojectionPublished, ImageWarp])
@pytest.mark.parametrize("precision", PRECISION.choices)
def test_a_still_camera_repeats_the_key_frame_bit_by_bit(film, method, precision):
    shown = film(stage(), method, settings={"precision": precision}, samples=2)
    first, off = shown.show(shown.scene)
    second, _ = shown.show(replace(shown.scene))
    assert is_right(off)
    assert [one.reuse.is_key for one in (first, second)] == [True, False]
    assert second.reuse.share == 0.0
    assert np.array_equal(first.color, second.color)
    assert np.array_equal(first.distance, second.distance, equal_nan=True)


@pytest.mark.parametrize("method", [ReprojectionPublished, ImageWarp])
def test_a_cut_is_right_at_once(film, method):
    shown = film(stage(), method)
    shown.show(shown.scene)
    frame, off = shown.show(seen_from(shown.scene, (-4.0, 1.0, 2.5)))
    assert frame.reuse.is_key
    assert is_right(off)


@pytest.mark.parametrize("method", [ReprojectionPublished, ImageWarp])
def test_what_moves_begins_a_key_frame(film, method):
    scene = stage()
    shown = film(scene, method)
    shown.show(scene)
    matrix = scene.instances[2].matrix.copy()
    matrix[:3, 3] += 0.05
    frame, off = shown.show(with_placed(scene, 2, matrix))
    assert frame.reuse.is_key
    assert is_right(off)


def test_reflections_shift_on_a_flat_mirror_or_stay(film):
    wrong = {}
    for method in (ReprojectionPublished, ImageWarp):
        shown = film(flat(looking((0.0, -3.0, 0.0))), method, settings=FULL, size=(320, 200))
        shown.show(shown.scene)
        frame, off = shown.show(seen_from(shown.scene, (0.1, -3.0, 0.0), (0.1, 0.0, 0.0)))
        assert frame.reuse.share < 0.2
        wrong[method] = off.mean()
    assert wrong[ReprojectionPublished] < 0.2 * wrong[ImageWarp]


def test_a_grid_that_grows_has_no_holes(film):
    shown = film(flat(looking((0.0, -3.0, 0.0))), ReprojectionPublished, settings=FULL, size=(320, 200))
    shown.show(shown.scene)
    frame, _ = shown.show(seen_from(shown.scene, (0.0, -3.6, 0.0), (0.0, 0.0, 0.0)))
    assert not frame.reuse.retraced[50:150, 80:240].any()


def test_a_painted_mirror_keeps_its_picture(film):
    """What image-warp shows of a point of the mirror is what the key frame's camera saw there."""
    shown = film(flat(looking((0.0, -3.0, 0.0))), ImageWarp, settings=FULL, size=(160, 100))
    before, _ = shown.show(shown.scene)
    after, _ = shown.show(seen_from(shown.scene, (0.0, -1.5, 0.0), (0.0, 0.0, 0.0)))
    # Half as far away, the middle quarter of the picture fills it.
    middle = before.color[25:75, 40:120].repeat(2, axis=0).repeat(2, axis=1)
    assert np.mean(np.abs(after.color - middle).max(axis=-1) > 0.01) < 0.05


def test_halves_are_precise_enough(film):
    frames = []
    for precision in PRECISION.choices:
        shown = film(stage(), ReprojectionPublished, settings={"precision": precision})
        shown.show(shown.scene)
        frames.append(shown.show(seen_from(shown.scene, (0.55, -4.5, 1.0)))[0])
    packed, full = frames
    assert not np.array_equal(packed.color, full.color)
    assert all(np.isinf(frame.distance).sum() > 7000 for frame in frames)  # 7159, when traced
    assert abs(packed.reuse.share - full.reuse.share) < 0.02
    assert np.mean(np.abs(packed.color - full.color).max(axis=-1) > 0.02) < 0.02


def behind_pillars(film, method, step, **given):
    """How many pixels are wrong after the camera has gone `step` to the side, and the frame."""
    shown = film(pillars(), method, size=(320, 60), settings={"threshold": 1.0, **given})
    shown.show(shown.scene)
    frame, off = shown.show(seen_from(shown.scene, (step, -1.0, 0.0), (step, 0.0, 0.0)))
    return np.sum(off > 0.5), frame


def test_what_emerges_behind_a_pillar_is_missed(film):
    """Figure 9: the gap behind the pillar is filled with the wall, and ours sees the other pillar there."""
    missed, _ = behind_pillars(film, ReprojectionPublished, 0.25)
    found, _ = behind_pillars(film, Reprojection, 0.25)
    assert missed > 300
    assert found < 20


def test_what_is_magnified_too_much_is_traced(film):
    """Between pillar and wall a cell of a pixel grows to a gap of about 20."""
    smeared, trusting = behind_pillars(film, ReprojectionPublished, 0.45, magnification=1e6)
    traced, frame = behind_pillars(film, ReprojectionPublished, 0.45)
    assert frame.reuse.retraced.sum() > trusting.reuse.retraced.sum() + 800
    assert smeared > traced + 300


def test_what_is_not_known_is_not_drawn(film):
    """Neither stretched to pixels without a match, however far triangles may grow, nor blended with them."""
    shares = []
    for magnification in (1e3, 1e6):
        shown = film(stage(), ReprojectionPublished, settings={**FULL, "magnification": magnification})
        shown.show(shown.scene)
        shares.append(shown.show(seen_from(shown.scene, (0.9, -4.5, 1.0)))[0].reuse.share)
    assert shares[1] > 0.9 * shares[0]
    _, frame = behind_pillars(film, ReprojectionPublished, 0.45)
    assert 0.0 < frame.reuse.share < 0.1
    assert frame.color[..., 0].min() > 1.99  # no surface there is darker


def test_a_grid_that_is_not_cut_spans_silhouettes(film):
    shares = {}
    for cut in (0.05, 10.0):
        shown = film(stage(), ImageWarp, settings={**FULL, "cut": cut, "epsilon": 10.0})
        shown.show(shown.scene)
        shares[cut] = shown.show(seen_from(shown.scene, (0.9, -4.5, 1.0)))[0].reuse.share
    assert shares[10.0] < shares[0.05] - 0.01


def test_what_is_warped_off_its_surface_is_traced(film):
    shares = []
    for epsilon in (1e-6, 0.01):
        shown = film(stage(), ImageWarp, settings={**FULL, "epsilon": epsilon})
        shown.show(shown.scene)
        shares.append(shown.show(seen_from(shown.scene, (EYE[0] + 0.1, *EYE[1:])))[0].reuse.share)
    assert shares[0] > 2.0 * shares[1]
