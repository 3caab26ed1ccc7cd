"""Attenuation planes against the functions they stand for, and against segments cut by planes in space."""

import math

import numpy as np
import pytest
from catoptric.addon.errors import UsageError
from catoptric.addon.methods.glossy.attenuation_planes import (
    DETAIL,
    attenuation,
    deviation,
    parallel_planes,
    tilted_planes,
)
from catoptric.addon.methods.glossy.gloss import filter_radius, fresnel_factor
from hypothesis import given, settings
from hypothesis import strategies as st

EYE = 1.65
HALF_DEGREE, FIVE_DEGREES = math.radians(0.5), math.radians(5.0)
HEIGHTS = np.linspace(0.5, 2.5, 41)
"""Of figures 5 and 6, as are the distances."""
DISTANCES = np.linspace(0.05, 20.0, 200)
FAR = np.linspace(5.0, 20.0, 150)


def segment_through_planes(planes, distance, height):
    """In space: how much passes the planes that the segment from the eye to the mirrored point cuts.

    The floor is z = 0, the eye above it, the mirrored point below.
    """
    eye, point = np.array([0.0, 0.0, planes.fading.eye_height]), np.array([0.3, distance, -height])
    anchors = np.stack([0 * planes.foot_heights, 0 * planes.foot_heights, -planes.foot_heights], axis=1)
    normals = np.stack([0 * planes.tilts, np.sin(planes.tilts), np.cos(planes.tilts)], axis=1)
    sides = [np.einsum("nk,nk->n", normals, end - anchors) for end in (eye, point)]
    return planes.strength * np.prod(planes.factors[sides[0] * sides[1] < 0.0])


@pytest.fixture(scope="module")
def tilted():
    return {count: tilted_planes(count, HALF_DEGREE, 1.5) for count in (8, 16, 32, 64, 128)}


@pytest.fixture(scope="module")
def parallel():
    return {count: parallel_planes(count, FIVE_DEGREES) for count in (8, 16, 32, 64, 128)}


# ---- What they approximate


def test_fading_is_the_product_of_both_figures():
    planes = tilted_planes(4, HALF_DEGREE, 1.5)
    blurred = DETAIL / (DETAIL + filter_radius(7.0, 2.0, EYE, HALF_DEGREE))
    assert planes.fading(7.0, 2.0) == pytest.approx(blurred * fresnel_factor(7.0, 2.0, EYE, 1.5))
    assert parallel_planes(4, HALF_DEGREE).fading(7.0, 2.0) == pytest.approx(blurred)


@pytest.mark.parametrize(("angle", "bend"), [(0.0, 0.003), (HALF_DEGREE, 0.01), (FIVE_DEGREES, 0.02)])
@pytest.mark.parametrize("count", [8, 64, 128])
def test_tilted_planes_miss_by_half_a_step_and_what_the_curves_bend(angle, bend, count):
    """Half a step is the worst that steps of equal height can do, a third about their mean square. The curves
    of equal attenuation are straight without blur and bend with it; planes do not bend."""
    planes = tilted_planes(count, angle, 1.5)
    for heights in (HEIGHTS, np.linspace(0.0, 2.5, 51)):
        off = deviation(planes, DISTANCES, heights)
        assert off.worst < planes.step / 2.0 + bend
        assert off.rms < math.hypot(planes.step / 3.0, bend / 4.0)


def test_sixty_four_tilted_planes_are_within_a_third_of_a_percent(tilted):
    off = deviation(tilted[64], DISTANCES, HEIGHTS)
    assert off.rms < 0.0033
    assert off.worst < 0.015


@pytest.mark.parametrize("angle", [HALF_DEGREE, math.radians(2.0), FIVE_DEGREES])
@pytest.mark.parametrize("count", [8, 64])
def test_parallel_planes_miss_by_their_steps_and_what_the_fade_varies_along_them(angle, count):
    """A plane lies between the least and the greatest height that has its fade, so this bound is strict."""
    planes = parallel_planes(count, angle)
    for height in HEIGHTS:
        varies = planes.fading(20.0, height) - planes.fading(5.0, height)
        assert deviation(planes, FAR, height).worst <= 0.5 * planes.step + varies + 1e-9
    # Least squares halves, at least, what one end of the range would give.
    varies = planes.fading(20.0, HEIGHTS) - planes.fading(5.0, HEIGHTS)
    assert deviation(planes, FAR, HEIGHTS).rms < math.hypot(planes.step / math.sqrt(12.0), 0.5 * varies.max())


def test_more_planes_are_closer(tilted, parallel):
    """Parallel ones soon miss by what the fade varies along them alone."""
    errors = [deviation(planes, DISTANCES, HEIGHTS).rms for planes in tilted.values()]
    assert (np.array(errors[1:]) < 0.65 * np.array(errors[:-1])).all()
    assert deviation(parallel[128], FAR, HEIGHTS).rms < 0.7 * deviation(parallel[8], FAR, HEIGHTS).rms


@pytest.mark.parametrize("count", [1, 8, 64, 128])
def test_no_step_is_higher_than_one_of_count(count):
    for planes in (tilted_planes(count, FIVE_DEGREES, 1.5), parallel_planes(count, FIVE_DEGREES)):
        light = planes.strength * np.cumprod([1.0, *planes.factors])
        assert -np.diff(light) == pytest.approx(planes.step)
        assert 0.0 < planes.step <= 1.0 / count


# ---- Where they lie


@pytest.mark.parametrize("index", [3, 20, 40])
def test_each_plane_is_the_line_of_least_squares_through_its_level(tilted, index):
    """The level's points, found in a table, are missed by more, in attenuation, if the plane is moved at all."""
    planes = tilted[64]
    light = planes.strength * np.cumprod([1.0, *planes.factors])
    level = 0.5 * (light[index] + light[index + 1])
    distance = np.linspace(0.2, 20.0, 8000)
    height = np.linspace(0.0, 2.5, 501)[:, None]
    table = planes.fading(distance, height)
    inside = (table[0] >= level) & (table[-1] <= level)
    along = distance[inside]
    up = np.array([np.interp(-level, -column, height[:, 0]) for column in table[:, inside].T])
    weight = planes.fading(along, up) - planes.fading(along, up + 1e-4)

    def missed(foot, tilt):
        return np.sum((weight * (foot + math.tan(tilt) * along - up)) ** 2)

    foot, tilt = planes.foot_heights[index], planes.tilts[index]
    best = missed(foot, tilt)
    assert best < missed(foot - 0.02, tilt)
    assert best < missed(foot + 0.02, tilt)
    assert best < missed(foot, tilt * 1.01)
    assert best < missed(foot, tilt * 0.99)


def test_planes_of_the_fresnel_factor_alone_turn_about_the_eye():
    planes = tilted_planes(64, 0.0, 1.5)
    assert planes.foot_heights == pytest.approx(-0.98 * EYE)
    assert (np.diff(planes.tilts) > 0.0).all()
    light = planes.strength * np.cumprod([1.0, *planes.factors])
    # Where the floor shows a plane's foot, it has the Fresnel factor between the plane's two sides.
    shown = fresnel_factor(0.98 * EYE / np.tan(planes.tilts), 0.0, EYE, 1.5)
    assert shown == pytest.approx(0.5 * (light[1:] + light[:-1]), abs=0.01)


def test_fresnel_planes_stand_between_the_eye_and_the_floor_and_rougher_ones_nearer_to_it():
    feet = [tilted_planes(32, math.radians(angle), 1.5).foot_heights[0] for angle in (0.0, 0.5, 2.0, 5.0, 20.0)]
    assert feet[0] > -EYE
    assert feet == sorted(feet)
    assert feet[-1] < 0.0


def test_planes_that_turn_about_the_foot_itself_are_far_worse(tilted):
    pinned = tilted_planes(64, HALF_DEGREE, 1.5, foot_height=0.0)
    assert (pinned.foot_heights == 0.0).all()
    free, held = (deviation(planes, DISTANCES, HEIGHTS).rms for planes in (tilted[64], pinned))
    assert held > 10.0 * free
    assert held == pytest.approx(0.047, abs=0.002)
    # Nothing lies between the eye and what touches the floor.
    assert attenuation(pinned, 0.5, 0.0) == pinned.strength
    assert pinned.strength - pinned.fading(0.5, 0.0) == pytest.approx(0.58, abs=0.01)


def test_of_a_dense_medium_the_planes_leave_out_the_dip_that_they_cannot_follow():
    """Above 2 + √3 the Fresnel factor first falls with the angle, and planes cannot brighten what rises."""
    assert fresnel_factor(10.0, 1.0, EYE, 3.7) > fresnel_factor(0.0, 1.0, EYE, 3.7)
    assert fresnel_factor(1.0, 1.0, EYE, 3.8) < fresnel_factor(0.0, 1.0, EYE, 3.8)
    planes = tilted_planes(32, 0.0, 6.0)
    assert planes.fading(2.0, 1.0) == pytest.approx((5.0 / 7.0) ** 2)
    assert planes.fading(200.0, 1.0) == fresnel_factor(200.0, 1.0, EYE, 6.0)


def test_parallel_planes_are_level_and_a_mirror_needs_none(parallel):
    assert (parallel[64].tilts == 0.0).all()
    assert (np.diff(parallel[64].foot_heights) > 0.0).all()
    assert attenuation(parallel[64], 9.0, 0.0) == pytest.approx(1.0, abs=0.5 / 64)
    mirror = parallel_planes(64, 0.0)
    assert (attenuation(mirror, FAR, 2.0) == 1.0).all()


# ---- What a shader does


@given(st.floats(0.0, 40.0), st.floats(0.0, 10.0), st.sampled_from(["tilted", "foot", "parallel"]))
@settings(max_examples=200, deadline=None)
def test_attenuation_is_what_the_planes_between_eye_and_point_let_through(distance, height, kind):
    planes = SHADERS[kind]
    assert attenuation(planes, distance, height) == pytest.approx(segment_through_planes(planes, distance, height))


SHADERS = {
    "tilted": tilted_planes(16, FIVE_DEGREES, 1.5),
    "foot": tilted_planes(16, FIVE_DEGREES, 1.5, foot_height=0.0),
    "parallel": parallel_planes(16, FIVE_DEGREES),
}


def test_attenuation_broadcasts(tilted):
    along, up = np.linspace(1.0, 20.0, 7), np.linspace(0.0, 3.0, 5)[:, None]
    together = attenuation(tilted[64], along, up)
    assert together.shape == (5, 7)
    assert together[3, 2] == attenuation(tilted[64], along[2], up[3, 0])


@given(
    st.integers(1, 40),
    st.floats(0.0, 0.75),
    st.floats(1.01, 20.0),
    st.floats(0.1, 20.0),
    st.floats(1.0, 500.0),
    st.floats(0.05, 50.0),
    st.floats(1e-3, 1.0),
)
@settings(max_examples=150, deadline=None)
def test_any_planes_attenuate_more_with_height_and_less_with_distance(
    count, angle, ior, eye, farthest, highest, detail
):
    for planes in (
        tilted_planes(count, angle, ior, eye, farthest, highest, detail),
        parallel_planes(count, angle, eye, highest, 0.5 * farthest, farthest, detail),
    ):
        assert len(planes.foot_heights) == len(planes.tilts) == len(planes.factors) == count
        assert (planes.foot_heights > -eye).all()
        assert ((planes.tilts >= 0.0) & (planes.tilts < 0.5 * math.pi)).all()
        assert ((planes.factors > 0.0) & (planes.factors <= 1.0)).all()
        assert planes.step <= 1.0 / count
        grid = attenuation(planes, np.linspace(0.0, farthest, 9), np.linspace(0.0, highest, 7)[:, None])
        assert ((grid > 0.0) & (grid <= 1.0)).all()
        assert (np.diff(grid, axis=0) <= 1e-15).all()
        assert (np.diff(grid, axis=1) >= -1e-15).all()


# ---- What cannot be


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: parallel_planes(0, 0.1), "count: 0"),
        (lambda: parallel_planes(8, 0.8), "lobe angle: 0.8"),
        (lambda: parallel_planes(8, math.nan), "lobe angle: nan"),
        (lambda: parallel_planes(8, 0.1, nearest=20.0), "farthest: 20 m is not beyond"),
        (lambda: parallel_planes(8, 0.1, highest=0.0), "highest: 0"),
        (lambda: parallel_planes(8, 0.1, detail=0.0), "detail: 0"),
        (lambda: tilted_planes(8, 0.1, 1.0), "ior: 1 "),
        (lambda: tilted_planes(8, 0.1, math.nan), "ior: nan"),
        (lambda: tilted_planes(8, 0.1, 1.5, eye_height=0.0), "eye height: 0"),
        (lambda: tilted_planes(8, 0.1, 1.5, foot_height=-2.0), "foot height: -2 m"),
    ],
)
def test_what_is_out_of_range_is_named_in_a_line(call, said):
    with pytest.raises(UsageError, match=said) as caught:
        call()
    assert "\n" not in str(caught.value)
