"""Roughness, blur radius and Fresnel factor against integration, ray geometry and the textbook's complex form."""

import cmath
import math

import numpy as np
import pytest
from catoptric.addon.errors import UsageError
from catoptric.addon.methods.glossy.gloss import (
    LOBE_SHARE,
    alpha_of_roughness,
    figure_curves,
    filter_radius,
    fresnel,
    fresnel_factor,
    incidence_cosine,
    lobe_angle_of_roughness,
    path_from_floor,
    roughness_of_alpha,
    roughness_of_lobe_angle,
    share_within,
)
from hypothesis import given, settings
from hypothesis import strategies as st

EYE = 1.65
HALF_DEGREE = math.radians(0.5)
QUADRATURE = np.polynomial.legendre.leggauss(200)
lengths = st.floats(1e-3, 1e4)
roughnesses = st.floats(1e-3, 1.0)


def ggx(angle, alpha):
    """The normal distribution as Walter et al. 2007 write it, per unit of solid angle."""
    return alpha**2 / (np.pi * np.cos(angle) ** 4 * (alpha**2 + np.tan(angle) ** 2) ** 2)


def integrated(alpha, up_to):
    """The projected area of the microfacets in a cap, by quadrature in the logarithm of the angle."""
    nodes, weights = QUADRATURE
    low, high = math.log(1e-7 * alpha), math.log(up_to)
    angle = np.exp(low + 0.5 * (high - low) * (nodes + 1.0))
    ring = ggx(angle, alpha) * np.cos(angle) * 2.0 * np.pi * np.sin(angle)
    return 0.5 * (high - low) * float((weights * ring * angle).sum())


def eye_to_object(distance, height, eye):
    """By vectors: the floor point on the line from the eye to the mirrored object, and that line's direction."""
    start, mirrored = np.array([0.0, eye]), np.array([distance, -height])
    direction = mirrored - start
    floor = start + direction * (start[1] / -direction[1])
    return floor, direction / np.linalg.norm(direction)


def textbook_fresnel(angle, n):
    """Snell's law, then the mean of the squared amplitudes; complex, so that it covers total reflection."""
    # 1 - (sin / n)², without the difference of nearly equal numbers where light grazes an index of about 1.
    refracted = cmath.sqrt(math.cos(angle) ** 2 + (1.0 - n**-2) * math.sin(angle) ** 2)
    across = (math.cos(angle) - n * refracted) / (math.cos(angle) + n * refracted)
    along = (n * math.cos(angle) - refracted) / (n * math.cos(angle) + refracted)
    return 0.5 * (abs(across) ** 2 + abs(along) ** 2)


# ---- Roughness, alpha, lobe angle


@settings(deadline=None)
@given(roughnesses, st.floats(0.01, 1.57))
def test_share_is_the_integral_of_the_normal_distribution(roughness, angle):
    alpha = float(alpha_of_roughness(roughness))
    assert share_within(angle, alpha) == pytest.approx(integrated(alpha, angle), rel=1e-5)


@settings(deadline=None)
@given(roughnesses)
def test_lobe_angle_holds_its_share(roughness):
    angle = float(lobe_angle_of_roughness(roughness))
    assert integrated(roughness**2, angle) == pytest.approx(LOBE_SHARE, rel=1e-6)
    assert lobe_angle_of_roughness(roughness, 0.5) == pytest.approx(math.atan(roughness**2), rel=1e-12)


@settings(deadline=None)
@given(roughnesses, st.floats(0.05, 0.95))
def test_roughness_survives_the_way_there_and_back(roughness, share):
    angle = lobe_angle_of_roughness(roughness, share)
    assert roughness_of_lobe_angle(angle, share) == pytest.approx(roughness, rel=1e-9)
    assert roughness_of_alpha(alpha_of_roughness(roughness)) == pytest.approx(roughness, rel=1e-12)
    assert share_within(angle, alpha_of_roughness(roughness)) == pytest.approx(share, rel=1e-9)


@settings(deadline=None)
@given(st.floats(0.0, 1.5))
def test_lobe_angle_survives_the_way_there_and_back(angle):
    assert lobe_angle_of_roughness(roughness_of_lobe_angle(angle)) == pytest.approx(angle, rel=1e-9, abs=1e-12)


def test_the_share_makes_the_disc_that_is_closest_to_the_lobe():
    """Squared difference of both densities over the plane of slopes, for an alpha of 1."""
    slope, width = np.linspace(0.0, 60.0, 600001, retstep=True)
    density = 1.0 / (np.pi * (1.0 + slope**2) ** 2)
    radii = np.arange(1.40, 1.72, 0.005)
    off = [
        (2.0 * np.pi * slope * (density - (slope < radius) / (np.pi * radius**2)) ** 2).sum() * width
        for radius in radii
    ]
    closest = radii[np.argmin(off)]
    assert closest == pytest.approx(math.tan(lobe_angle_of_roughness(1.0)), abs=0.005)
    assert share_within(math.atan(closest), 1.0) == pytest.approx(LOBE_SHARE, abs=0.002)


def test_a_mirror_has_no_lobe_and_arrays_stay_arrays():
    roughness = np.array([[0.0, 0.1], [0.2, 0.5]])
    angle = lobe_angle_of_roughness(roughness)
    assert angle[0, 0] == 0.0
    assert roughness_of_lobe_angle(angle) == pytest.approx(roughness)
    assert roughness_of_lobe_angle(np.radians([0.5, 5.0])) == pytest.approx([0.075, 0.237], abs=5e-4)
    assert roughness_of_lobe_angle(math.radians(57.2)) == pytest.approx(1.0, abs=1e-3)


# ---- Figure 5


@settings(deadline=None)
@given(lengths, lengths, lengths)
def test_path_and_angle_are_those_of_the_mirrored_ray(distance, height, eye):
    floor, direction = eye_to_object(distance, height, eye)
    path = np.linalg.norm(np.array([distance, height]) - floor)
    assert path_from_floor(distance, height, eye) == pytest.approx(path, rel=1e-6)
    assert incidence_cosine(distance, height, eye) == pytest.approx(-direction[1], rel=1e-9)


@settings(deadline=None)
@given(st.floats(0.1, 100), st.floats(0.1, 100), st.floats(0.1, 100), st.floats(1e-4, 0.7))
def test_filter_radius_is_that_of_the_reflected_cone(distance, height, eye, angle):
    """A microfacet that deviates by the lobe angle sends the eye's ray along the cone's rim."""
    floor, direction = eye_to_object(distance, height, eye)
    normals = np.array([[0.0, 1.0], [math.sin(angle), math.cos(angle)]])
    centre, rim = direction - 2.0 * (normals @ direction)[:, None] * normals
    path = np.linalg.norm(np.array([distance, height]) - floor)
    radius = path * abs(centre[0] * rim[1] - centre[1] * rim[0]) / (centre @ rim)
    assert filter_radius(distance, height, eye, angle) == pytest.approx(radius / distance, rel=1e-6)


def test_figure_5_spans_what_half_a_degree_gives():
    heights = [0.5, 1.0, 1.5, 2.0, 2.5]
    radii, _ = figure_curves([5.0, 10.0, 20.0], heights)
    assert (np.diff(radii, axis=0) > 0.0).all()
    # By hand: tan(1°) · 2.5/4.15 · √(1 + (4.15/20)²), at the top of the plotted range.
    assert radii[-1, -1] == pytest.approx(0.0107391, rel=1e-5)
    assert radii[:-1, -1].max() < 0.01
    assert filter_radius(20.0, 2.5, EYE, math.radians(5.0)) > 0.1
    # Nearly constant from five metres on: a metre nearer matters little, but much at one metre.
    limits = filter_radius(np.inf, np.array(heights), EYE, HALF_DEGREE)
    assert (radii[:, 0] / limits < 1.31).all()
    assert radii[0, 0] / limits[0] < 1.09
    assert (filter_radius(1.0, np.array(heights), EYE, HALF_DEGREE) / limits > 2.3).all()


def test_filter_radius_at_its_ends():
    assert filter_radius(0.0, 0.0, EYE, HALF_DEGREE) == 0.0
    assert filter_radius(3.0, 0.0, EYE, 1.0) == 0.0
    assert filter_radius(0.0, 2.0, EYE, 0.0) == 0.0
    assert filter_radius(0.0, 2.0, EYE, HALF_DEGREE) == np.inf
    assert filter_radius(3.0, 2.0, EYE, math.pi / 4) == np.inf
    assert path_from_floor(0.0, 2.0, EYE) == pytest.approx(2.0)


# ---- Figure 6


@settings(deadline=None)
@given(st.floats(0.0, 0.5 * math.pi), st.floats(0.05, 20.0))
def test_fresnel_is_the_textbooks(angle, ior):
    assert fresnel(min(1.0, math.cos(angle)), ior) == pytest.approx(textbook_fresnel(angle, ior), abs=1e-9)


@settings(deadline=None)
@given(lengths, lengths, lengths, st.floats(0.5, 5.0))
def test_fresnel_factor_is_that_of_the_mirrored_ray(distance, height, eye, ior):
    angle = math.atan2(distance, eye + height)
    assert fresnel_factor(distance, height, eye, ior) == pytest.approx(textbook_fresnel(angle, ior), abs=1e-6)


@settings(deadline=None)
@given(st.floats(0.05, 20.0))
def test_fresnel_at_its_ends(ior):
    assert fresnel(1.0, ior) == pytest.approx(((ior - 1.0) / (ior + 1.0)) ** 2, rel=1e-9, abs=1e-15)
    assert fresnel_factor(0.0, 2.0, EYE, ior) == fresnel(1.0, ior)
    assert fresnel(0.0, ior) == (0.0 if ior == 1.0 else pytest.approx(1.0))


@settings(deadline=None)
@given(st.floats(0.0, 1.0), st.floats(1.0, 5.0))
def test_light_that_leaves_reflects_as_light_that_enters(cosine, ior):
    refracted = math.sqrt(1.0 - (1.0 - cosine**2) / ior**2)
    assert fresnel(refracted, 1.0 / ior) == pytest.approx(fresnel(cosine, ior), abs=1e-6)


def test_fresnel_where_one_polarisation_or_all_or_nothing_is_reflected():
    brewster = math.cos(math.atan(1.5))
    assert fresnel(brewster, 1.5) == pytest.approx(0.5 * ((1 - 1.5**2) / (1 + 1.5**2)) ** 2)
    assert fresnel(np.array([0.0, 0.3, 0.7]), 1.0 / 1.5) == pytest.approx(1.0)
    assert (fresnel(np.array([0.0, 1e-200, 0.5, 1.0]), 1.0) == 0.0).all()


def test_figure_6_falls_with_height_and_grows_with_distance():
    distances, heights = np.linspace(0.0, 20.0, 81), np.array([0.5, 1.0, 1.5, 2.0, 2.5])
    radii, factors = figure_curves(distances, heights)
    assert radii.shape == factors.shape == (5, 81)
    assert (np.diff(factors, axis=1) > 0.0).all()
    assert (np.diff(factors[:, 1:], axis=0) < 0.0).all()
    assert factors[:, 0] == pytest.approx(0.04)
    assert factors[0, 80] == pytest.approx(textbook_fresnel(math.atan(20.0 / 2.15), 1.5))


# ---- What cannot be


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: alpha_of_roughness(-0.1), "roughness: -0.1"),
        (lambda: alpha_of_roughness([0.2, np.nan]), "roughness: nan"),
        (lambda: alpha_of_roughness("rough"), "roughness: 'rough' is not a number"),
        (lambda: roughness_of_alpha(np.inf), "alpha: inf .* finite"),
        (lambda: share_within(0.1, 0.0), "alpha: 0 .* above 0"),
        (lambda: lobe_angle_of_roughness(0.2, 1.0), "share: 1.0"),
        (lambda: roughness_of_lobe_angle(math.pi / 2), "lobe angle"),
        (lambda: filter_radius(-1.0, 1.0, EYE, 0.1), "distance: -1"),
        (lambda: filter_radius(1.0, [1.0, -2.0], EYE, 0.1), "height: -2"),
        (lambda: fresnel_factor(1.0, 1.0, 0.0, 1.5), "eye height: 0"),
        (lambda: fresnel(1.1, 1.5), "cosine: 1.1"),
        (lambda: fresnel(0.5, 0.0), "ior: 0"),
    ],
)
def test_what_is_out_of_range_is_named_in_a_line(call, said):
    with pytest.raises(UsageError, match=said) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_the_narrowest_lobe_is_no_exception():
    """The least positive number there is: nearly no blur, and still an infinite one at distance 0."""
    least = np.nextafter(0.0, 1.0)
    assert filter_radius(0.0, 1.0, 1.65, least) == np.inf
    assert filter_radius(1.0, 1.0, 1.65, least) < 1e-300
