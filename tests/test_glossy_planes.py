"""glossy-planes against closed forms: planes by ray and plane, the kernel's mean, slabs, and what a mirror is."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.glossy.attenuation_planes import attenuation, parallel_planes, tilted_planes
from catoptric.addon.methods.glossy.darkroom import KERNEL_SPREAD
from catoptric.addon.methods.glossy.gloss import fresnel, lobe_angle_of_roughness
from catoptric.addon.methods.glossy_planes import GlossyPlanes
from catoptric.addon.methods.planar import Planar
from catoptric.addon.scene import (
    BLACK,
    Camera,
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
    mean_roughness,
)

from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed

WIDTH, HEIGHT = 96, 64
SIDE, TALL = 20.0, 3.0
"""Metres: the floor, and the highest thing over it."""

POLISH = Material("polish", base=BLACK, reflection=grey(1.0), fresnel=Fresnel.DIELECTRIC, ior=1.5, roughness=grey(0.2))
METAL = replace(POLISH, name="metal", fresnel=Fresnel.CONSTANT, reflection=ColorSource((0.9, 0.5, 0.2)), diffuse=0.0)
EYE = (0.3, -9.0, 1.65)
LOBE = math.degrees(float(lobe_angle_of_roughness(0.2)))


def glowing(*color: float) -> Material:
    """Gives off light of this radiance, and scatters none."""
    return Material("glow", base=BLACK, emission=ColorSource(color))


def floor_scene(material: Material = POLISH, camera: Camera | None = None, world=(1.0, 1.0, 1.0), turn=None) -> Scene:
    """Three pillars of radiance 1, up to `TALL`, on a floor of `SIDE` metres, z = 0; `turn` (4, 4) moves all of it."""
    floor = mesh_of(trimesh.creation.box((SIDE, SIDE, 1.0)))
    pillar = mesh_of(trimesh.creation.box((1.0, 1.0, 1.0)))
    turn = np.eye(4) if turn is None else turn
    camera = looking(EYE, (0.0, 4.0, 0.6)) if camera is None else camera
    pillars = [(-2.0, -2.0, 1.0), (2.5, 1.0, 2.0), (0.2, 6.0, TALL)]
    places = [placed((x, y, high / 2.0), (1.2, 0.8, high)) for x, y, high in pillars]
    instances = [Instance("floor", 0, turn @ placed((0.0, 0.0, -0.5)), (0,), reflector=True)]
    instances += [Instance(f"pillar {number}", 1, turn @ place, (1,)) for number, place in enumerate(places)]
    return Scene(
        "floor",
        replace(camera, matrix=turn @ camera.matrix),
        (floor, pillar),
        tuple(instances),
        (material, glowing(1.0, 1.0, 1.0)),
        world=World(world),
    )


def rendered(scene: Scene, method=GlossyPlanes, lighting=Lighting.DIRECT, size=(WIDTH, HEIGHT), samples=1, **settings):
    """A frame of the scene."""
    drawn = method(settings)
    drawn.prepare(scene, lighting)
    try:
        return drawn.render(View(scene.camera, *size, samples))
    finally:
        drawn.release()


@pytest.fixture(scope="module")
def seen():
    """Of the floor's pixels: which show it, and what is mirrored there, by Embree."""
    scene = floor_scene()
    origins, directions = camera_rays(scene.camera, WIDTH, HEIGHT)
    judge = Judge(scene)
    first = judge.meet(origins, directions)
    on_floor = (first.instance == 0) & (first.flat[:, 2] > 0.99)
    ways = mirrored(first, directions)
    met = judge.meet(*ways)
    ahead = -scene.camera.matrix[:2, 2] / np.linalg.norm(scene.camera.matrix[:2, 2])
    distance = (met.position[:, :2] - scene.camera.position[:2]) @ ahead
    slope = ways[1][:, 2] / np.maximum(ways[1][:, :2] @ ahead, 1e-9)
    return on_floor, met.instance < 0, distance, met.position[:, 2], slope, ways[1][:, 2]


# ---- Planes


def expected(planes, seen) -> np.ndarray:
    """What is left of radiance 1 in every pixel; the world is above all planes that rise less than the ray."""
    _, world, distance, height, slope, _ = seen
    near = attenuation(planes, np.where(world, 0.0, distance), np.where(world, 0.0, height))
    crossed = slope[:, None] > np.tan(planes.tilts)
    far = planes.strength * np.prod(np.where(crossed, planes.factors, 1.0), axis=1)
    return np.where(world, far, near)


@pytest.mark.parametrize("count", [5, 64, 128])
@pytest.mark.parametrize("attenuated", ["tilted", "parallel"])
def test_drawn_planes_attenuate_as_their_closed_form(seen, attenuated, count):
    """A plane's edge on what it cuts may fall into the next pixel; nowhere else do they differ but by rounding."""
    lobe, farthest = math.radians(LOBE), math.hypot(SIDE, SIDE)
    planes = (
        tilted_planes(count, lobe, 1.5, 1.65, farthest, TALL)
        if attenuated == "tilted"
        else parallel_planes(count, lobe, 1.65, TALL, farthest / 4.0, farthest)
    )
    color = rendered(floor_scene(), attenuation=attenuated, planes=count, blur="none").color.reshape(-1, 3)
    wanted, on_floor = expected(planes, seen), seen[0]
    off = np.abs(color[on_floor] - wanted[on_floor][:, None]).max(axis=1)
    assert on_floor.sum() > 2000
    assert np.ptp(wanted[on_floor]) > 0.1
    assert (off > 1e-4).mean() < 0.01
    assert off.max() <= planes.step * 1.01 or (off > planes.step * 1.01).mean() < 0.005


def test_without_planes_everything_is_mirrored_in_full(seen):
    for settings in ({"attenuation": "none"}, {"planes": 0}):
        color = rendered(floor_scene(), blur="none", **settings).color.reshape(-1, 3)
        assert np.allclose(color[seen[0]], 1.0, atol=1e-5)


def test_planes_of_a_wall_attenuate_as_those_of_a_floor():
    """A mirror's heights are along its normal, wherever that points."""
    turned = trimesh.transformations.rotation_matrix(1.1, (0.3, 1.0, 0.2))
    flat, wall = (rendered(floor_scene(turn=turn), blur="none").color for turn in (None, turned))
    assert (np.abs(flat - wall).max(axis=-1) > 0.02).mean() < 0.01


def test_a_mirror_is_the_same_from_behind():
    upside_down = trimesh.transformations.rotation_matrix(math.pi, (1.0, 0.0, 0.0))
    flipped = floor_scene(turn=upside_down)
    above, below = (rendered(scene, blur="none").color for scene in (floor_scene(), flipped))
    assert (np.abs(above - below).max(axis=-1) > 0.02).mean() < 0.01
    sheet = Mesh(
        "sheet",
        np.array([(-10, -10, 0), (-10, 10, 0), (10, 10, 0), (10, -10, 0)], np.float32),
        np.array([(0, 1, 2), (0, 2, 3)], np.int32),
        np.tile(np.array((0, 0, -1.0), np.float32), (2, 3, 1)),
        np.zeros((2, 3, 2), np.float32),
        np.zeros(2, np.int32),
    )
    scene = floor_scene()
    thin = replace(scene, meshes=(sheet, scene.meshes[1]), instances=_moved(scene, np.eye(4)))
    assert (np.abs(rendered(thin, blur="none").color - above).max(axis=-1) > 0.02).mean() < 0.01


def _moved(scene: Scene, place: np.ndarray) -> tuple[Instance, ...]:
    return replace(scene.instances[0], matrix=place), *scene.instances[1:]


@pytest.mark.parametrize("attenuated", ["tilted", "parallel"])
def test_an_orthographic_camera_has_fresnel_by_its_one_angle(attenuated):
    """A floor that mirrors nothing but the world, through all of its planes."""
    camera = replace(looking((0.0, -6.0, 6.0)), ortho_scale=6.0)
    scene = replace(floor_scene(camera=camera), instances=floor_scene().instances[:1])
    color = rendered(scene, blur="none", attenuation=attenuated, planes=4).color
    eye = float(f"{math.cos(math.pi / 4) * 6.0 * 50.0 / 36.0:.3g}")
    reach = math.hypot(SIDE, SIDE)
    planes = parallel_planes(4, math.radians(LOBE), eye, max(1.0, 1e-3 * reach), reach / 4.0, reach)
    through = planes.strength * planes.factors.prod()
    wanted = through * (fresnel(math.cos(math.pi / 4), 1.5) if attenuated == "tilted" else 1.0)
    assert np.allclose(color, wanted, rtol=2e-3)


def test_metals_keep_their_colour_under_parallel_planes(seen):
    color = rendered(floor_scene(METAL), blur="none", planes=16).color.reshape(-1, 3)[seen[0]]
    reach = math.hypot(SIDE, SIDE)
    planes = parallel_planes(16, math.radians(LOBE), 1.65, TALL, reach / 4.0, reach)
    wanted = expected(planes, seen)[seen[0]][:, None] * (0.9, 0.5, 0.2)
    assert (np.abs(color - wanted).max(axis=1) > 1e-4).mean() < 0.01


@pytest.mark.parametrize("place", [(0.0, 0.0, 30.0), (0.3, -9.0, 0.02), (0.0, -9.9, 0.3)])
def test_planes_are_finite_from_any_eye(place):
    camera = looking(place, (0.001, 0.5, 0.0))
    for settings in ({}, {"blur": "slabs"}, {"attenuation": "parallel"}):
        color = rendered(floor_scene(camera=camera), **settings).color
        assert np.isfinite(color).all()
        assert color.min() >= 0.0
        assert color.max() <= 1.0 + 1e-4


# ---- Blur


def test_a_constant_picture_stays_constant():
    """White all around, no planes: a kernel whose weights sum to one changes nothing, up to the picture's edge."""
    for blur in ("constant", "slabs"):
        for scale in (1, 3, 8):
            color = rendered(floor_scene(), attenuation="none", blur=blur, scale=scale).color
            assert np.allclose(color, 1.0, atol=1e-5)


@pytest.mark.parametrize("scale", [1, 4])
@pytest.mark.parametrize("blur", ["constant", "slabs"])
def test_blur_keeps_the_mean_and_its_middle(blur, scale):
    """One lamp over a mirror that fills the picture: as much light, in the same place, spread wider."""
    lamp = mesh_of(trimesh.creation.box((1.0, 1.0, 1.0)))
    sheet = mesh_of(trimesh.creation.box((40.0, 40.0, 0.1)))
    camera = looking((0.0, -6.0, 6.0))
    instances = (
        Instance("floor", 0, placed((0.0, 0.0, -0.05)), (0,), reflector=True),
        Instance("lamp", 1, placed((1.0, 3.0, 3.0), (1.6, 1.6, 1.6)), (1,), in_camera=False),
    )
    scene = Scene("lamp", camera, (sheet, lamp), instances, (POLISH, glowing(2.0, 2.0, 2.0)), world=World((0, 0, 0)))
    sharp, soft = (
        rendered(scene, attenuation="none", blur=kind, scale=scale, samples=4).color[..., 0] for kind in ("none", blur)
    )
    assert soft.max() < 2.0 + 1e-4
    assert (soft > 1e-3).sum() > (sharp > 1e-3).sum()
    if blur == "constant":
        assert soft.mean() == pytest.approx(sharp.mean(), rel=0.05)
    middles = [
        np.array([np.average(axis, weights=picture) for axis in np.indices(picture.shape)]) for picture in (sharp, soft)
    ]
    # Slabs spread the lamp's upper end more than its lower one.
    assert np.abs(middles[0] - middles[1]).max() < (0.15 * scale if blur == "constant" else 1.0)


def test_the_kernel_spreads_as_far_as_its_name_says():
    """A bright line, one texel wide at a time: its standard deviation over a picture of four-pixel texels."""
    step = mesh_of(trimesh.creation.box((30.0, 0.1, 30.0)))
    sheet = mesh_of(trimesh.creation.box((40.0, 40.0, 0.1)))
    camera = replace(looking((0.0, -12.0, 12.0)), ortho_scale=12.0)
    instances = (
        Instance("floor", 0, placed((0.0, 0.0, -0.05)), (0,), reflector=True),
        Instance("half", 1, placed((15.0, 4.0, 15.0)), (1,), in_camera=False),
    )
    scene = Scene("step", camera, (sheet, step), instances, (METAL, glowing(1.0, 1.0, 1.0)), world=World((0, 0, 0)))
    color = rendered(scene, attenuation="none", scale=4, samples=8, size=(256, 64)).color[..., 0]
    edge = np.abs(np.diff(color[20:44].mean(axis=0)))
    edge /= edge.sum()
    at = np.arange(len(edge))
    spread = math.sqrt(np.average((at - np.average(at, weights=edge)) ** 2, weights=edge))
    assert spread == pytest.approx(4.0 * KERNEL_SPREAD, rel=0.1)


def test_slabs_blur_what_is_high_more_than_what_is_low():
    """The contrast of a striped wall's mirror image, low and high on it: alike under one blur, not under slabs."""
    stripe = mesh_of(trimesh.creation.box((0.25, 0.1, 6.0)))
    sheet = mesh_of(trimesh.creation.box((60.0, 60.0, 0.1)))
    camera = looking((0.0, -12.0, 3.0), (0.0, 0.0, -2.0))
    stripes = [Instance(f"stripe {n}", 1, placed((0.5 * n, 2.0, 3.0)), (1,), in_camera=False) for n in range(-12, 13)]
    floor = Instance("floor", 0, placed((0.0, 0.0, -0.05)), (0,), reflector=True)
    materials = (replace(POLISH, roughness=grey(0.1)), glowing(1.0, 1.0, 1.0))
    scene = Scene("stripes", camera, (sheet, stripe), (floor, *stripes), materials, world=World((0, 0, 0)))

    def contrasts(**settings):
        color = rendered(scene, attenuation="none", samples=2, size=(192, 128), **settings).color[..., 0]
        rows = [_row_of(scene, height) for height in (0.3, 5.5)]
        return [float(np.std(color[row - 1 : row + 2, 72:120].mean(axis=0))) for row in rows]

    (low, high), (low_sharp, high_sharp) = contrasts(blur="slabs"), contrasts(blur="none")
    assert low > 0.8 * low_sharp
    assert high < 0.5 * high_sharp
    low, high = contrasts(blur="constant", scale=3)
    assert low / low_sharp == pytest.approx(high / high_sharp, abs=0.25)


def _row_of(scene: Scene, height: float) -> int:
    """The row, of 128, that mirrors the wall at `height`."""
    clip = scene.camera.projection(192, 128) @ np.linalg.inv(scene.camera.matrix) @ (0.0, 2.0, -height, 1.0)
    return round((1.0 - clip[1] / clip[3]) / 2.0 * 128 - 0.5)


# ---- Perfect mirrors, materials, more than one mirror


def test_in_unlit_light_it_equals_planar():
    scene = floor_scene()
    ours, theirs = (
        rendered(scene, method, Lighting.UNLIT, samples=2, **settings)
        for method, settings in ((GlossyPlanes, {}), (Planar, {"clipping": "projective-texture"}))
    )
    assert np.array_equal(ours.color, theirs.color)
    assert np.array_equal(ours.distance, theirs.distance, equal_nan=True)


def test_a_smooth_metal_equals_planar_in_any_light():
    scene = floor_scene(replace(METAL, roughness=BLACK))
    ours, theirs = (rendered(scene, method).color for method in (GlossyPlanes, Planar))
    assert np.array_equal(ours, theirs)


def test_a_lobe_that_is_given_counts_instead_of_the_roughness():
    scene = floor_scene()
    assert np.array_equal(rendered(scene).color, rendered(floor_scene(), lobe=LOBE).color)
    smooth = floor_scene(replace(POLISH, roughness=BLACK))
    assert np.array_equal(rendered(smooth, lobe=LOBE).color, rendered(scene).color)


def test_mean_roughness_is_over_the_image_as_light_adds_up():
    """sRGB bytes 188 are about half; floats are as they are, here 0.2, 7/30 and 4/15 in the mean."""
    for image, mean in (
        (Image("bytes", np.full((2, 2, 4), 188, np.uint8), srgb=True), 0.5029),
        (Image("plain", np.full((2, 2, 4), 51, np.uint8)), 0.2),
        (Image("floats", np.linspace(0.0, 0.5, 16, dtype=np.float32).reshape(2, 2, 4)), 0.2287),
    ):
        scene = replace(floor_scene(), images=(image,))
        material = Material("rough", roughness=ColorSource((1.0, 1.0, 1.0), image=0))
        assert mean_roughness(scene, material) == pytest.approx(mean, abs=2e-3)
    assert mean_roughness(floor_scene(), POLISH) == pytest.approx(0.2)


def test_mirrors_of_different_gloss_are_drawn_together():
    """A smooth wall stays sharp beside a rough floor, in each other as well, and drawing twice is the same."""
    wall = Instance("wall", 2, placed((0.0, 9.0, 3.0)), (2,), reflector=True)
    scene = floor_scene(replace(POLISH, roughness=grey(0.3)))
    smooth = replace(METAL, roughness=BLACK, reflection=grey(1.0))
    scene = replace(
        scene,
        meshes=(*scene.meshes, mesh_of(trimesh.creation.box((12.0, 0.2, 6.0)))),
        instances=(*scene.instances, wall),
        materials=(*scene.materials, smooth),
    )
    drawn = GlossyPlanes()
    drawn.prepare(scene, Lighting.DIRECT)
    try:
        first = drawn.render(View(scene.camera, WIDTH, HEIGHT, 1)).color
        drawn.render(View(scene.camera, 40, 30, 1))
        again = drawn.render(View(scene.camera, WIDTH, HEIGHT, 1)).color
    finally:
        drawn.release()
    assert np.array_equal(first, again)
    sharp = rendered(scene, Planar).color
    _, directions = camera_rays(scene.camera, WIDTH, HEIGHT)
    met = Judge(scene).meet(np.broadcast_to(scene.camera.position, directions.shape), directions)
    through = Judge(scene).meet(*mirrored(met, directions))
    in_wall = (met.instance == 4) & (through.instance > 0)
    assert in_wall.sum() > 50
    assert np.allclose(first.reshape(-1, 3)[in_wall], sharp.reshape(-1, 3)[in_wall], atol=1e-5)
