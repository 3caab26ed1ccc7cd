"""How near the searches come step by step, and their curves in the report."""

import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.reflector_maps import FINER, SIZE, SPREAD
from catoptric.addon.methods.virtual.convergence import STEPS, convergence, frame_before
from catoptric.addon.scene.archive import save
from catoptric.batch.cli import main
from catoptric.batch.searches import Curve, load

from .stage import looking, mesh_of, placed, scene_of

MAPS = {parameter.name: parameter.default for parameter in (SIZE, FINER, SPREAD)}
PICTURE = (300, 200)


def scene(reflector: bool = True, ortho: float | None = None):
    """A chrome ball beside a finely divided ball, which it shows."""
    chrome = mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True)
    beside = mesh_of(trimesh.creation.icosphere(subdivisions=3))
    camera = replace(looking((0.0, -5.0, 1.0)), ortho_scale=ortho)
    return scene_of([(chrome, placed(), reflector), (beside, placed((1.6, -1.8, 0.3), (0.5, 0.5, 0.5)), False)], camera)


@pytest.fixture(scope="module")
def curves():
    """Of a ball."""
    return convergence(scene(), PICTURE, MAPS)


def test_all_searches_come_within_a_pixel(curves):
    assert curves.keys() == {"published", "ours", "moving"}
    for curve in curves.values():
        assert len(curve.within) == len(curve.farthest) == STEPS
        assert curve.within[-1] == 1.0
        assert curve.farthest[-1] < 0.1


def test_ours_takes_fewer_steps(curves):
    assert curves["ours"].exact_after <= 4
    assert curves["ours"].exact_after < curves["published"].exact_after <= 9


def test_what_the_published_search_lacks_is_halved_step_by_step(curves):
    published = curves["published"].farthest[:7]
    assert (published[1:] < 0.75 * published[:-1]).all()
    assert published[0] > 2.0


def dented_egg():
    """Its mirror is no convex body, and nowhere alike: numbers rounded differently do not change its patches."""
    egg = trimesh.creation.icosphere(subdivisions=4)
    dent = 0.15 * np.exp(-8.0 * ((egg.vertices - (0.2, -0.3, 0.93)) ** 2).sum(axis=1))
    egg.vertices *= (1.0 - dent)[:, None] * (1.0, 0.93, 0.85)
    before = scene()
    return replace(before, meshes=(mesh_of(egg, smooth=True), *before.meshes[1:]))


def test_patches_are_followed_as_well():
    curves = convergence(dented_egg(), PICTURE, MAPS)
    # The first step begins where a ray of the picture does; those that are too short take a third.
    assert curves["ours"].farthest[1] < 0.5
    assert curves["published"].within[8] > 0.8


def test_what_a_frame_before_has_found_saves_steps():
    """On a ball the first guess is exact already; in patches it is a ray that may be far."""
    curves = convergence(dented_egg(), PICTURE, MAPS)
    assert curves["moving"].exact_after == 1 < curves["ours"].exact_after


def test_a_frame_before_saw_the_mirror_from_aside():
    """A camera on the way to the middle goes around by a quarter of a right angle in 15 frames."""
    eye, centre = np.array([3.0, 1.0, 2.0, 1.0]), np.array([1.0, 1.0, 0.0])
    for _ in range(15):
        eye = frame_before(eye, centre)
    angle = np.radians(-22.5)
    np.testing.assert_allclose(eye, [1.0 + 2.0 * np.cos(angle), 1.0 + 2.0 * np.sin(angle), 2.0, 1.0])
    np.testing.assert_allclose(frame_before(np.array([0.0, 0.0, 1.0, 0.0]), centre), [0.0, 0.0, 1.0, 0.0])


def test_patches_are_followed_where_the_picture_shows_them(monkeypatch):
    """The largest patch is behind, as seen from this camera: it is none of those that are followed."""
    monkeypatch.setattr("catoptric.addon.methods.virtual.convergence._MOST_PARTS", 8)
    curves = convergence(dented_egg(), PICTURE, MAPS)
    assert curves["ours"].within[2] == 1.0


def test_a_camera_without_perspective_sees_it_as_well():
    assert convergence(scene(ortho=4.0), PICTURE, MAPS)["ours"].within[-1] == 1.0


def test_there_is_nothing_to_follow_without_mirrors_or_things_to_mirror():
    alone = scene()
    assert convergence(replace(alone, instances=alone.instances[:1]), PICTURE, MAPS) is None
    assert convergence(scene(reflector=False), PICTURE, MAPS) is None


# The report


def test_points_stand_where_the_numbers_do():
    curve = Curve("ours", [0.0, 0.5, *[1.0] * (STEPS - 2)], [100.0, 1.0, *[1e-9] * (STEPS - 2)])
    within, farthest = (
        np.array([pair.split(",") for pair in curve.points(what, 110.0, 50.0).split()], float)
        for what in ("within", "farthest")
    )
    np.testing.assert_allclose(within[:, 0], 10.0 * np.arange(STEPS))
    assert within[:3, 1].tolist() == [50.0, 25.0, 0.0]
    assert farthest[:3, 1].tolist() == [0.0, 25.0, 50.0]


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"ours": 3}', '{"ours": {"within": [1], "farthest": ["far"]}}'])
def test_what_is_no_file_of_curves_has_none(tmp_path, text):
    path = tmp_path / "searches.json"
    assert load(path) == []
    path.write_text(text)
    assert load(path) == []


@pytest.mark.parametrize(("method", "charts"), [("virtual-objects-published", 2), ("environment-map", 0)])
def test_the_report_draws_them_where_a_search_was_measured(tmp_path, method, charts):
    save(scene(), tmp_path / "balls.catoptric")
    options = ["--methods", method, "--resolution", "60x40", "--samples", "4", "--out", str(tmp_path / "out")]
    assert main(["compare", str(tmp_path / "balls.catoptric"), *options]) == 0
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.count('<svg class="chart searches"') == charts
    drawn = re.findall(r'<polyline class="curve (\w+)" points="([^"]+)"', page)
    assert [name for name, _ in drawn] == ["published", "ours", "moving"] * charts
    assert all(len(points.split()) == STEPS for _, points in drawn)
