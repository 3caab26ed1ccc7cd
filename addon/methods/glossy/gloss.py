"""How wide and how strong a floor's reflection is: roughness, blur and Fresnel, in closed form.

Source: the paper on glossy planar reflections, section 2, figures 3 to 6. Its floor is seen from the eye, at
`eye_height` above it, and mirrors a point at `height` above the floor and `distance` along it, measured from
the point under the eye. The view ray meets the floor on the line from the eye to the mirrored point.

All functions take numbers or arrays that broadcast, in metres and radians, and give float64. They raise
`UsageError` for what is no number or out of range.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from ...errors import UsageError

LOBE_SHARE = math.sqrt(0.5)
"""The share of a GGX lobe's microfacets that the paper's cone of largest deviation stands for.

The slopes of GGX's normals, weighted by cosine, have the density a²/(π (a² + s²)²) in the plane of slopes: it
has no largest deviation. Blurring by the cone is blurring by a uniform disc, so the cone is set by the disc that is
closest to that density: the integral of the squared difference is least at the slope s = a √(1 + √2), within which
lies the share 1/√2. Two other measures agree: the least absolute difference gives 0.68, and the least squares over
pictures whose power falls with the square of the frequency, as that of photographs does, give 0.715.
"""


def positive(name: str, values: ArrayLike, zero: bool = False, endless: bool = False) -> np.ndarray:
    """float64 `values`, checked: all above 0, or with `zero` none below it; infinity only if `endless`.

    `name` says in the error which they are.
    """
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise UsageError(f"{name}: {values!r} is not a number") from None
    wrong = ~((array >= 0.0) if zero else (array > 0.0)) | (np.isinf(array) & (not endless))
    if wrong.any():
        bound = "0 or more" if zero else "above 0"
        finite = "" if endless else "finite "
        raise UsageError(f"{name}: {array[wrong].flat[0]:g} is out of range: give a {finite}number, {bound}")
    return array


# ---- Roughness, GGX alpha, lobe angle


def alpha_of_roughness(roughness: ArrayLike) -> np.ndarray:
    """GGX's alpha of Blender's roughness (0 to 1 there): its square."""
    return positive("roughness", roughness, zero=True) ** 2


def roughness_of_alpha(alpha: ArrayLike) -> np.ndarray:
    """Blender's roughness of GGX's alpha; inverse of `alpha_of_roughness`."""
    return np.sqrt(positive("alpha", alpha, zero=True))


def share_within(lobe_angle: ArrayLike, alpha: ArrayLike) -> np.ndarray:
    """The share, 0 to 1, of GGX's microfacets, weighted by cosine, that deviate by at most `lobe_angle`.

    The integral of D(t) cos t over the cap t <= lobe_angle: tan² / (alpha² + tan²). `alpha` above 0.
    """
    squared = np.tan(_cap(lobe_angle)) ** 2
    return squared / (positive("alpha", alpha) ** 2 + squared)


def lobe_angle_of_roughness(roughness: ArrayLike, share: float = LOBE_SHARE) -> np.ndarray:
    """The paper's alpha, in radians from 0 to below π/2: the largest deviation of microfacet normals, as a half-angle.

    It holds the `share`, between 0 and 1, of the lobe of Blender's `roughness`: tan² = alpha² share / (1 - share).
    Half a degree, the caption of figure 5, is roughness 0.075; five degrees, its text, are 0.237.
    """
    return np.arctan(alpha_of_roughness(roughness) * _spread(share))


def roughness_of_lobe_angle(lobe_angle: ArrayLike, share: float = LOBE_SHARE) -> np.ndarray:
    """Blender's roughness of the paper's lobe angle (0 to below π/2); inverse of `lobe_angle_of_roughness`.

    Above 1, which Blender does not offer, for lobes wider than 57.2 degrees.
    """
    return roughness_of_alpha(np.tan(_cap(lobe_angle)) / _spread(share))


def _spread(share: float) -> float:
    if not 0.0 < share < 1.0:
        raise UsageError(f"share: {share!r} is out of range: give a share of the lobe between 0 and 1")
    return math.sqrt(share / (1.0 - share))


def _cap(angle: ArrayLike) -> np.ndarray:
    angle = positive("lobe angle", angle, zero=True)
    if (angle >= 0.5 * np.pi).any():
        raise UsageError(f"lobe angle: {angle.max():g} is no cap of a hemisphere: give radians below π/2")
    return angle


# ---- Figure 4: the way from the eye over the floor to the object


def path_from_floor(distance: ArrayLike, height: ArrayLike, eye_height: ArrayLike) -> np.ndarray:
    """L, metres from the floor point that mirrors the object to the object.

    The floor point is at distance · eye / (eye + height), by similar triangles, so L is the share
    height / (eye + height) of the way from the eye to the mirrored object. 0 where the object touches the floor.
    """
    distance, height, eye = _seen(distance, height, eye_height)
    return height / (eye + height) * np.hypot(distance, eye + height)


def filter_radius(distance: ArrayLike, height: ArrayLike, eye_height: ArrayLike, lobe_angle: ArrayLike) -> np.ndarray:
    """r/d of figure 5: the radius of the reflected cone at the object over the distance, both in metres.

    r = L tan(2 lobe_angle): a normal that turns by an angle turns the reflected ray by twice that. The distance is
    the normal one to a vertical projection plane through the object, so r/d is the radius in a picture plane one
    unit away. It falls with the distance towards tan(2 lobe_angle) · height / (eye + height). From 5 m on it is at
    most 9 % above that limit for a height of 0.5 m and 30 % for 2.5 m, the eye at 1.65 m.

    0 where the object touches the floor, even at distance 0; infinite at distance 0 above it, and for a lobe of
    π/4 or more, whose cone is wider than the half-space above the floor. An infinite distance gives the limit.
    """
    distance, height, eye = _seen(distance, height, eye_height)
    angle = _cap(lobe_angle)
    slope = np.where(angle < 0.25 * np.pi, np.tan(2.0 * np.minimum(angle, 0.25 * np.pi)), np.inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ratio = slope * (height * np.hypot(1.0 / (eye + height), 1.0 / distance))
    return np.where((height == 0.0) | (angle == 0.0), 0.0, ratio)


def incidence_cosine(distance: ArrayLike, height: ArrayLike, eye_height: ArrayLike) -> np.ndarray:
    """Cosine, 0 to 1, of the angle between the floor's normal and the ray that mirrors the object: 1 at distance 0."""
    distance, height, eye = _seen(distance, height, eye_height)
    return (eye + height) / np.hypot(distance, eye + height)


def _seen(distance: ArrayLike, height: ArrayLike, eye_height: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return (
        positive("distance", distance, zero=True, endless=True),
        positive("height", height, zero=True),
        positive("eye height", eye_height),
    )


# ---- Figure 6: the Fresnel factor


def fresnel(cosine: ArrayLike, ior: ArrayLike) -> np.ndarray:
    """The share of unpolarised light that a dielectric reflects, 0 to 1, without sines of the refracted angle.

    `cosine` (0 to 1) of the angle of incidence; `ior`, above 0, of what lies under the surface over what lies
    above. With g² = ior² - 1 + cosine² it is ½ a² (1 + b²), a = (g - c)/(g + c), b = (c(g + c) - 1)/(c(g - c) + 1).
    ((n - 1)/(n + 1))² at normal incidence and 1 at grazing. An `ior` below 1 reflects all of what it cannot
    refract; one of 1 reflects nothing.
    """
    c, n = positive("cosine", cosine, zero=True), positive("ior", ior)
    if (c > 1.0).any():
        raise UsageError(f"cosine: {c.max():g} is out of range: give a number from 0 to 1")
    excess = (n - 1.0) * (n + 1.0)
    squared = excess + c * c
    g = np.sqrt(np.maximum(squared, 0.0))
    total = np.where(g + c > 0.0, g + c, 1.0)
    # (g - c)/(g + c), but with no difference of nearly equal numbers.
    a = excess / total / total
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return np.where(squared < 0.0, 1.0, 0.5 * a * a * (1.0 + b * b))


def fresnel_factor(distance: ArrayLike, height: ArrayLike, eye_height: ArrayLike, ior: ArrayLike) -> np.ndarray:
    """F of figure 6: the share of an object's light that the floor reflects to the eye."""
    return fresnel(incidence_cosine(distance, height, eye_height), ior)


def figure_curves(
    distances: ArrayLike,
    heights: ArrayLike,
    eye_height: float = 1.65,
    lobe_angle: float = math.radians(0.5),
    ior: float = 1.5,
) -> tuple[np.ndarray, np.ndarray]:
    """The curves of figures 5 and 6: r/d and F, each (H, D), over (D,) `distances` for each of (H,) `heights`."""
    along, up = np.asarray(distances)[None, :], np.asarray(heights)[:, None]
    return filter_radius(along, up, eye_height, lobe_angle), fresnel_factor(along, up, eye_height, ior)
