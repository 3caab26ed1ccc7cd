"""Rough mirrors by rays that are traced, and by the rays of neighbouring pixels."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.glossy_planar import GlossyPlanar
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.methods.ray_traced import RayTraced
from catoptric.addon.scene import (
    BLACK,
    ColorSource,
    Fresnel,
    Image,
    Instance,
    Interpolation,
    Lighting,
    Scene,
    World,
    grey,
)

from .stage import looking, mesh_of, placed
from .test_glossy_planar import HEIGHT, METAL, VARNISH, WIDTH, drawn_in_blocks, lamps_over, rendered, rms, truth

NOT_SHARED = {"shared": 1}


def rough(material, roughness: float, **scene) -> Scene:
    """The lamps over a floor."""
    return lamps_over(replace(material, roughness=grey(roughness)), **scene)


def ball(roughness: float, world=(1.0, 1.0, 1.0), fresnel=Fresnel.CONSTANT) -> Scene:
    """A white metal ball on a white metal floor, both as rough, whose light between facets counts."""
    white = replace(METAL, reflection=grey(1.0), roughness=grey(roughness), multiscatter=True, fresnel=fresnel)
    meshes = mesh_of(trimesh.creation.icosphere(3, 1.0), smooth=True), lamps_over(METAL).meshes[0]
    instances = (
        Instance("ball", 0, placed((0.0, 0.0, 1.0)), (0,), reflector=True),
        Instance("floor", 1, np.eye(4), (0,), reflector=True),
    )
    camera = looking((0.0, -5.0, 2.5), (0.0, 0.0, 0.8), lens=40.0)
    return Scene("ball", camera, meshes, instances, (white,), world=World(world), glossy_bounces=11)


# ---- Traced


@pytest.mark.parametrize("method", [LayeredDepth, RayTraced])
@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
@pytest.mark.parametrize("roughness", [0.1, 0.5])
def test_traced_rays_of_a_rough_floor_are_as_the_judge_says(method, material, roughness):
    """Wide lobes too, which reach around the boxes: no mirrored camera limits what these rays see."""
    mean, error, whole = truth(material, roughness)
    color = drawn_in_blocks(rough(material, roughness), method, samples=8)
    peak = mean[whole].max()
    assert rms((color - mean)[whole]) < max(0.012 * peak, 1.5 * rms(error[whole]))
    assert color[whole].mean() == pytest.approx(mean[whole].mean(), rel=0.02)


@pytest.mark.parametrize("roughness", [0.15, 0.3])
def test_rough_white_mirrors_in_each_other_vanish_in_a_white_world(roughness):
    """From ball to floor and back, as often as light goes: nothing is lost but what is still between them."""
    color = rendered(ball(roughness), LayeredDepth, samples=4)
    np.testing.assert_allclose(color.reshape(8, 8, 12, 8, 3).mean(axis=(1, 3)), 1.0, atol=0.03)


def test_in_unlit_light_roughness_counts_for_nothing():
    scene = rough(METAL, 0.4)
    sharp = replace(scene, materials=(replace(scene.materials[0], roughness=BLACK), *scene.materials[1:]))
    pictures = [rendered(one, LayeredDepth, 1, Lighting.UNLIT) for one in (scene, sharp)]
    np.testing.assert_array_equal(*pictures)


# ---- Shared

METHODS = [GlossyPlanar, LayeredDepth]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("roughness", [0.3, 0.5])
def test_shared_rays_are_less_noisy(method, roughness):
    scene = rough(METAL, roughness, world=(0.05, 0.06, 0.08))
    many = rendered(scene, method, samples=1, rays=256, **NOT_SHARED)
    shared, own = (rendered(scene, method, samples=1, **settings) for settings in ({}, NOT_SHARED))
    assert rms(shared - many) < 0.7 * rms(own - many)
    assert shared.mean() == pytest.approx(many.mean(), rel=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_a_sharp_mirror_is_the_same_to_the_bit_beside_a_rough_one(method):
    """A roughness image: 0 on the left of the floor, 0.4 on its right."""
    pixels = np.ones((1, 2, 4), np.float32)
    pixels[0, 0, :3] = 0.0
    halves = ColorSource((0.4, 0.4, 0.4), image=0, interpolation=Interpolation.CLOSEST)
    scene = lamps_over(replace(METAL, roughness=halves), images=(Image("halves", pixels),))
    alone = lamps_over(replace(METAL, roughness=BLACK))
    ours, sharp = (rendered(one, method, samples=1) for one in (scene, alone))
    same = (ours == sharp).all(axis=-1)
    assert same[HEIGHT // 2 :, : WIDTH // 4].all()
    assert not same[HEIGHT // 2 :, 3 * WIDTH // 4 :].all()


@pytest.mark.parametrize("method", METHODS)
def test_no_shared_ray_leaks_to_where_no_lobe_reaches(method):
    mean, _, whole = truth(METAL, 0.1)
    dark = whole & (mean == 0.0).all(axis=1)
    assert dark.any()
    assert drawn_in_blocks(rough(METAL, 0.1), method, samples=1)[dark].max() < 0.002 * mean[whole].max()


@pytest.mark.parametrize(("method", "samples"), [(GlossyPlanar, 4), (LayeredDepth, 2)])
def test_pictures_of_many_samples_share_no_rays(method, samples):
    scene = rough(METAL, 0.3)
    np.testing.assert_array_equal(*(rendered(scene, method, samples=samples, shared=side) for side in (1, 8)))
    assert not np.array_equal(*(rendered(scene, method, samples=1, shared=side) for side in (1, 8)))


def test_the_samples_of_a_pixel_share_other_rays():
    """With nine samples instead of one, what noise sharing leaves is at most half as much."""
    scene = rough(METAL, 0.3, world=(0.05, 0.06, 0.08))
    many = rendered(scene, samples=6, rays=16)
    one, nine = (rendered(scene, samples=side, coarser=1) - many for side in (1, 3))
    assert rms(nine) < 0.5 * rms(one)


def test_what_touches_a_rough_floor_keeps_its_edge():
    """A lamp that stands on the floor: in the row under it, the picture with shared rays is as steep as without."""
    scene = rough(METAL, 0.3, world=(0.05, 0.06, 0.08))
    many = rendered(scene, samples=1, rays=256, **NOT_SHARED)
    shared = rendered(scene, samples=1, coarser=1)
    steps = [np.abs(np.diff(picture[..., 0], axis=1)) for picture in (many, shared)]
    rows = np.flatnonzero((steps[0] > 0.3 * many.max()).any(axis=1))
    assert len(rows) > 4
    for row in rows[rows < HEIGHT // 2 + 10]:
        assert steps[1][row].max() > 0.6 * steps[0][row].max()


def test_depth_of_the_picture_is_kept():
    """The distance of a pixel is that of its own ray."""
    scene = rough(METAL, 0.2)
    drawn = LayeredDepth()
    drawn.prepare(scene, Lighting.DIRECT)
    try:
        frame = drawn.render(View(scene.camera, WIDTH, HEIGHT, 1))
    finally:
        drawn.release()
    seen = frame.distance[frame.reflectors > 0.0]
    assert (seen > 0.0).all()
    assert np.isfinite(seen).any()


# ---- Coarser

LARGE = 512, 344


def large(scene: Scene, samples: int = 1, **settings) -> np.ndarray:
    """(H, W, 3) radiance by glossy-planar, of a size that may be drawn by coarser pictures."""
    drawn = GlossyPlanar(settings)
    drawn.prepare(scene, Lighting.DIRECT)
    try:
        return drawn.render(View(scene.camera, *LARGE, samples)).color
    finally:
        drawn.release()


@pytest.mark.parametrize("material", [METAL, VARNISH], ids=lambda material: material.name)
@pytest.mark.parametrize("roughness", [0.2, 0.4])
def test_a_coarser_mirror_shows_the_same(material, roughness):
    """In blocks of 8 by 8 pixels, against 16 rays of each pixel's own. Measured are 0.3 to 1.5 % of the brightest."""
    scene = rough(material, roughness)
    many = large(scene, rays=16, **NOT_SHARED)
    coarse, fine = (large(scene, coarser=side) for side in (2, 1))
    assert not np.array_equal(coarse, fine)
    blocks = [image.reshape(LARGE[1] // 8, 8, LARGE[0] // 8, 8, 3).mean(axis=(1, 3)) for image in (coarse, many)]
    floor = np.s_[LARGE[1] // 16 + 1 :]
    coarse, many = (image[floor] for image in blocks)
    assert rms(coarse - many) < 0.02 * many.max()
    assert coarse.mean() == pytest.approx(many.mean(), rel=0.05)


def test_a_coarser_mirror_ends_where_it_does():
    """A strip of floor that is a pixel wide far away: all of it shows a white world, and nothing beside it does."""
    over = lamps_over(METAL, world=(1.0, 1.0, 1.0), boxes=False)
    floor = replace(METAL, reflection=grey(0.5), roughness=grey(0.3))
    strip = replace(over.instances[0], matrix=placed((0.0, 0.0, 0.0), (0.004, 1.0, 1.0)))
    scene = replace(over, materials=(floor, *over.materials[1:]), instances=(strip,))
    coarse, fine = (large(scene, coarser=side)[..., 0] for side in (2, 1))
    mirror = fine < 0.999
    assert mirror.sum() > 500
    np.testing.assert_array_equal(coarse[~mirror], 1.0)
    assert rms(coarse[mirror] - fine[mirror]) < 0.03
    assert coarse[mirror].min() > 0.1


def test_a_coarser_mirror_keeps_its_own_colour_fine():
    """Stripes of two tints, pixels wide: where one pixel of four sends a ray they do not mix."""
    pixels = np.ones((1, 1024, 4), np.float32)
    pixels[0, ::2, :3] = 0.1
    tint = ColorSource(image=0, interpolation=Interpolation.CLOSEST)
    stripes = (Image("tint", pixels),)
    over = lamps_over(METAL, world=(1.0, 1.0, 1.0), boxes=False, images=stripes)
    scene = replace(over, materials=(replace(METAL, reflection=tint, roughness=grey(0.3)), *over.materials[1:]))
    coarse, fine = (large(scene, coarser=side)[-60:, ..., 0] for side in (2, 1))
    assert (np.abs(np.diff(fine, axis=1)) > 0.5).mean() > 0.02
    assert rms(coarse - fine) < 0.05
