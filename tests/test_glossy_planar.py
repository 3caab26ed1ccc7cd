"""glossy-planar against a Monte Carlo of its own light: GGX facets in NumPy, rays by Embree."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.glossy_planar import GlossyPlanar
from catoptric.addon.methods.planar import Planar
from catoptric.addon.scene import (
    BLACK,
    ColorSource,
    Fresnel,
    Image,
    Instance,
    Lighting,
    Material,
    Mesh,
    Scene,
    World,
    grey,
)

from .stage import Judge, camera_rays, looking, mesh_of, placed

WIDTH, HEIGHT, BLOCK = 96, 64, 8
SHOTS = 96
"""Rays a pixel of the Monte Carlo."""

IOR = 1.5
METAL = Material("metal", base=BLACK, diffuse=0.0, reflection=ColorSource((0.9, 0.7, 0.4)), fresnel=Fresnel.CONSTANT)
VARNISH = Material("varnish", base=BLACK, reflection=grey(1.0), fresnel=Fresnel.DIELECTRIC, ior=IOR)
COLORS = ((1.0, 0.1, 0.1), (0.1, 1.0, 0.2), (0.2, 0.3, 1.0))


def sheet(half: float = 20.0) -> Mesh:
    """A square in the plane z = 0; its texture coordinates are 0..1 across."""
    positions = np.array([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], np.float32)
    uvs = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], np.float32)
    triangles, slots = np.array([(0, 1, 2), (0, 2, 3)], np.int32), np.zeros(2, np.int32)
    return Mesh("sheet", positions, triangles, np.tile(np.array((0, 0, 1.0), np.float32), (2, 3, 1)), uvs, slots)


def lamps_over(material: Material, world=(0.0, 0.0, 0.0), images=(), boxes=True) -> Scene:
    """Three bright boxes, on the floor and above it; the camera sees floor alone in its lower half."""
    box = mesh_of(trimesh.creation.box((1.0, 1.0, 1.0)))
    places = [
        ((-1.8, 2.0, 0.6), (1.2, 0.6, 1.2)),
        ((0.1, 3.0, 1.2), (0.8, 0.8, 2.4)),
        ((2.0, 2.4, 1.1), (1.0, 0.5, 1.0)),
    ]
    lit = [Instance(f"lamp {i}", 1, placed(*place), (1 + i,)) for i, place in enumerate(places)] if boxes else []
    glow = [Material(f"glow {i}", base=BLACK, emission=ColorSource(color)) for i, color in enumerate(COLORS)]
    floor = Instance("floor", 0, np.eye(4), (0,), reflector=True)
    camera = looking((0.0, -4.0, 1.7), (0.0, 2.2, 0.2), lens=32.0)
    return Scene("lamps", camera, (sheet(), box), (floor, *lit), (material, *glow), tuple(images), world=World(world))


def rendered(scene: Scene, method=GlossyPlanar, samples=4, lighting=Lighting.DIRECT, **settings) -> np.ndarray:
    """(H, W, 3) radiance."""
    drawn = method(settings)
    drawn.prepare(scene, lighting)
    try:
        return drawn.render(View(scene.camera, WIDTH, HEIGHT, samples)).color
    finally:
        drawn.release()


# ---- The judge: written for itself, and by another road than the shader's


def lambda_of(direction: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Smith's function of GGX, from the angle's tangent."""
    tangent = np.sqrt(np.maximum(1.0 - direction[:, 2] ** 2, 0.0)) / direction[:, 2]
    return (np.sqrt(1.0 + (alpha * tangent) ** 2) - 1.0) / 2.0


def fresnel_of(cosine: np.ndarray) -> np.ndarray:
    """Snell's law and the two polarisations."""
    refracted = np.sqrt(1.0 - (1.0 - cosine**2) / IOR**2)
    across = (cosine - IOR * refracted) / (cosine + IOR * refracted)
    along = (IOR * cosine - refracted) / (IOR * cosine + refracted)
    return (across**2 + along**2) / 2.0


def scattered_rays(view: np.ndarray, alpha: np.ndarray, dielectric: bool, rng) -> tuple[np.ndarray, np.ndarray]:
    """Directions (N, 3) and what they bring, for (N, 3) ways to the viewer over z = 0.

    Facets are drawn by the plain distribution of normals, not by that of the visible ones.
    """
    u, turn = rng.random(len(view)), rng.uniform(0.0, 2.0 * np.pi, len(view))
    tangent = alpha * np.sqrt(u / (1.0 - u))
    cosine = 1.0 / np.sqrt(1.0 + tangent**2)
    half = np.stack([tangent * cosine * np.cos(turn), tangent * cosine * np.sin(turn), cosine], axis=1)
    towards = (view * half).sum(1)
    light = 2.0 * towards[:, None] * half - view
    counts = (towards > 0.0) & (light[:, 2] > 1e-6)
    light[~counts] = (0.0, 0.0, 1.0)
    shadow = 1.0 / (1.0 + lambda_of(view, alpha) + lambda_of(light, alpha))
    weight = shadow * towards / (view[:, 2] * cosine)
    if dielectric:
        weight = weight * fresnel_of(np.clip(towards, 0.0, 1.0))
    return light, np.where(counts, weight, 0.0)


def judged(scene: Scene, roughness, seed: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean and standard error (blocks, 3) of the light in blocks of pixels, and which blocks show floor alone.

    `roughness` is a function of (N, 2) places on the floor.
    """
    rng, judge = np.random.default_rng(seed), Judge(scene)
    material = scene.materials[0]
    tint = np.array(material.reflection.color)
    sums, squares = np.zeros((HEIGHT * WIDTH, 3)), np.zeros((HEIGHT * WIDTH, 3))
    floor = np.ones(HEIGHT * WIDTH, bool)
    left, right, bottom, top = scene.camera.window(WIDTH, HEIGHT)
    for _ in range(SHOTS):
        shift = (rng.random(2) - 0.5) * ((right - left) / WIDTH, (top - bottom) / HEIGHT)
        moved = _shifted(scene.camera, shift)
        origins, directions = camera_rays(moved, WIDTH, HEIGHT)
        first = judge.meet(origins, directions)
        floor &= first.instance == 0
        alpha = roughness(np.where(first.instance[:, None] == 0, first.position[:, :2], 0.0)) ** 2
        view = np.where(floor[:, None], -directions, (0.0, 0.0, 1.0))
        light, weight = scattered_rays(view, alpha, material.fresnel is Fresnel.DIELECTRIC, rng)
        start = np.where(floor[:, None], first.position, 0.0) + (0.0, 0.0, 1e-6)
        met = judge.meet(start, light)
        seen = np.array([scene.world.color, (0.0, 0.0, 0.0), *COLORS])[met.instance + 1]
        value = weight[:, None] * tint * seen
        sums += value
        squares += value**2
    mean = sums / SHOTS
    variance = np.maximum(squares / SHOTS - mean**2, 0.0) / (SHOTS - 1)
    whole = in_blocks(floor[:, None].astype(float))[:, 0] == 1.0
    return in_blocks(mean), np.sqrt(in_blocks(variance) / BLOCK**2), whole


def _shifted(camera, shift):
    right = camera.sensor[0] / camera.lens
    return replace(camera, shift=tuple(np.add(camera.shift, shift / right)))


def in_blocks(pixels: np.ndarray) -> np.ndarray:
    """(N, C) pixels to (blocks, C) means."""
    shape = HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, pixels.shape[-1]
    return pixels.reshape(shape).mean(axis=(1, 3)).reshape(-1, pixels.shape[-1])


# ---- Held against it

ROUGH = (0.05, 0.1, 0.2, 0.3, 0.5)
SURROUNDINGS = 0.012
"""Root mean square, in shares of the brightest block, that a picture's depth alone may cost.

A ray cannot meet what the mirrored camera does not see: the backs and far sides of the boxes. Measured are 0.2 % at
roughness 0.05, 0.7 % at 0.3, and 1.9 % at 0.5, where lobes reach around the boxes; the Monte Carlo's own error is a
quarter of that.
"""


def everywhere(roughness: float):
    """The same roughness at every place."""
    return lambda places: np.full(len(places), roughness)


@cache
def truth(material: Material, roughness: float):
    """The judge's word on the lamps over a floor of one roughness."""
    return judged(lamps_over(replace(material, roughness=grey(roughness))), everywhere(roughness))


def drawn_in_blocks(scene: Scene, method=GlossyPlanar, **settings) -> np.ndarray:
    """(blocks, 3) means of the picture."""
    return in_blocks(rendered(scene, method, **settings).reshape(-1, 3).astype(float))


def rms(difference: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt((difference**2).mean()))


@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
@pytest.mark.parametrize("roughness", ROUGH)
def test_lamps_over_a_rough_floor_are_as_the_judge_says(material, roughness):
    mean, error, whole = truth(material, roughness)
    color = drawn_in_blocks(lamps_over(replace(material, roughness=grey(roughness))))
    off, peak = (color - mean)[whole], mean[whole].max()
    assert whole.sum() >= 40
    assert rms(error[whole]) < 0.01 * peak
    assert rms(off) < (SURROUNDINGS if roughness < 0.5 else 2.5 * SURROUNDINGS) * peak
    assert np.abs(off).max() < 0.1 * peak
    assert color[whole].mean() == pytest.approx(mean[whole].mean(), rel=0.05 if roughness < 0.5 else 0.15)


@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
@pytest.mark.parametrize("roughness", [0.3, 0.5])
def test_a_wide_lobe_is_far_from_a_perfect_mirror(material, roughness):
    """Blocks hide a narrow lobe; they do not hide these."""
    mean, _, whole = truth(material, roughness)
    scene = lamps_over(replace(material, roughness=grey(roughness)))
    ours, sharp = (rms((drawn_in_blocks(scene, method) - mean)[whole]) for method in (GlossyPlanar, Planar))
    assert ours < 0.3 * sharp


@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
def test_roughness_by_an_image_is_as_the_judge_says(material):
    """From 0.05 on the left to 0.5 on the right of what is seen."""

    def rough(places):
        return np.clip(0.05 + 0.45 * (places[:, 0] + 3.0) / 6.0, 0.05, 0.5)

    across = (np.arange(512) + 0.5) / 512.0 * 40.0 - 20.0
    pixels = np.ones((1, 512, 4), np.float32)
    pixels[0, :, :3] = rough(across[:, None])[:, None]
    scene = lamps_over(replace(material, roughness=ColorSource(image=0)), images=(Image("rough", pixels),))
    mean, _, whole = judged(scene, rough)
    off = (drawn_in_blocks(scene) - mean)[whole]
    assert rms(off) < 2.5 * SURROUNDINGS * mean[whole].max()
    even = lamps_over(replace(material, roughness=grey(0.5)))
    assert rms(off) < 0.5 * rms((drawn_in_blocks(even) - mean)[whole])


# ---- Energy and Fresnel: nothing but the world, so that no ray is lost


@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
def test_a_white_world_gives_what_the_lobe_lets_through(material, roughness):
    """The lobe's own sum, facet by facet: exact but for the Monte Carlo's error."""
    scene = lamps_over(replace(material, roughness=grey(roughness)), (1.0, 1.0, 1.0), boxes=False)
    mean, error, whole = judged(scene, everywhere(roughness))
    off = (drawn_in_blocks(scene, rays=64) - mean)[whole]
    assert rms(off) < 1.5 * rms(error[whole])
    assert abs(off.mean()) < 4.0 * rms(error[whole]) / np.sqrt(whole.sum())


def test_fresnel_is_taken_by_facet():
    """Near grazing, the facets that are seen lean to the viewer: a rough dielectric reflects less than a smooth one."""
    rough, smooth = (
        drawn_in_blocks(lamps_over(replace(VARNISH, roughness=grey(r)), (1.0, 1.0, 1.0), boxes=False))[:, 0]
        for r in (0.5, 0.0)
    )
    first = WIDTH // BLOCK * 4
    assert (rough[first - 12 : first] < 0.7 * smooth[first - 12 : first]).all()


# ---- Edges


@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
def test_without_roughness_it_equals_planar(material):
    scene = lamps_over(replace(material, roughness=BLACK))
    off = np.abs(rendered(scene) - rendered(scene, Planar)).max(axis=-1)
    assert off.max() < 1e-4  # but for texels that the margin's rasteriser gives to the neighbour


def test_in_unlit_light_it_equals_planar():
    scene = lamps_over(replace(METAL, roughness=grey(0.4)))
    ours, theirs = (rendered(scene, method, lighting=Lighting.UNLIT) for method in (GlossyPlanar, Planar))
    off = np.abs(ours - theirs).max(axis=-1)
    assert off.max() < 1e-4  # but for texels that the margin's rasteriser gives to the neighbour


@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
@pytest.mark.parametrize("roughness", [0.05, 0.1, 0.2])
def test_no_light_leaks_to_where_no_lobe_reaches(material, roughness):
    """Blocks of which none of the judge's 6,144 rays meets a lamp. Measured: a hundredth of a percent, 0.4 % at 0.2."""
    mean, _, whole = truth(material, roughness)
    color = drawn_in_blocks(lamps_over(replace(material, roughness=grey(roughness))))
    dark = whole & (mean == 0.0).all(axis=1)
    assert dark.any()
    assert color[dark].max() < (0.001 if roughness <= 0.1 else 0.01) * mean[whole].max()


@pytest.mark.parametrize("roughness", [0.1, 0.4])
def test_more_rays_are_less_noisy(roughness):
    """Against many rays, at one sample a pixel."""
    scene = lamps_over(replace(METAL, roughness=grey(roughness)))
    many, few, some = (rendered(scene, samples=1, rays=count) for count in (256, 4, 32))
    assert rms(some - many) < 0.6 * rms(few - many)


def test_the_samples_of_a_pixel_share_out_the_lobe():
    """One ray a sample: with four times the samples the noise is a third, where chance alone makes it a half."""
    scene = lamps_over(replace(METAL, roughness=grey(0.4)))
    many = rendered(scene, samples=8, rays=16)
    few, some = (
        rms(in_blocks((rendered(scene, samples=side, rays=1, shared=1) - many).reshape(-1, 3))) for side in (2, 4)
    )
    assert some < 0.4 * few


@pytest.mark.parametrize(("roughness", "noise"), [(0.2, 0.1), (0.4, 0.18)])
def test_a_ray_shows_the_mean_of_what_it_stands_for(roughness, noise):
    """Before a chequered wall. Measured are 8 % and 15 %; rays that show a point have 13 % and 23 %."""
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = (np.indices((64, 64)).sum(axis=0) % 2)[..., None]
    glow = Material("chequers", base=BLACK, emission=ColorSource(image=0))
    over = lamps_over(replace(METAL, roughness=grey(roughness)), images=(Image("chequers", pixels),), boxes=False)
    wall = Instance("wall", 0, placed((0.0, 4.0, 0.0), turn=np.pi / 2.0, axis=(1.0, 0.0, 0.0)), (1,))
    scene = replace(over, instances=(*over.instances, wall), materials=(over.materials[0], glow))
    few, many = (
        rendered(scene, samples=1, rays=count, coarser=1)[HEIGHT // 2 + 4 : HEIGHT // 2 + 20] for count in (4, 256)
    )
    assert many.mean() > 0.2
    assert rms(few - many) < noise * many.mean()


def test_the_margin_is_no_wider_than_lobes_are():
    scene = lamps_over(replace(METAL, roughness=grey(0.1)))
    wide, wider, none = (rendered(scene, samples=1, margin=margin) for margin in (0.5, 1.0, 0.0))
    np.testing.assert_array_equal(wide, wider)
    assert not np.array_equal(wide, none)
