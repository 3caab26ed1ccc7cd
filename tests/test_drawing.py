"""What the shaders read and light, against closed forms."""

import dataclasses

import numpy as np
import pytest
import trimesh
from catoptric.addon import gl
from catoptric.addon.baking.environment import EnvironmentCubes
from catoptric.addon.drawing import Canvas, Resident, reflectors_seen
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.environment_map import EnvironmentMap
from catoptric.addon.methods.layered_depth import LayeredDepth
from catoptric.addon.scene import (
    BLACK,
    Camera,
    ColorSource,
    Extension,
    Fresnel,
    Image,
    Instance,
    Interpolation,
    Lamp,
    LampKind,
    Lighting,
    Material,
    Mesh,
    Scene,
    World,
)

from .stage import camera_rays, looking, mesh_of, placed, scene_of


def picture(scene, size=(64, 64), lighting=Lighting.UNLIT, method=LayeredDepth):
    """One sample a pixel, (H, W, 3)."""
    drawn = method()
    drawn.prepare(scene, lighting)
    try:
        return drawn.render(View(scene.camera, *size, samples=1)).color
    finally:
        drawn.release()


def sheet(uvs, material, **more):
    """A square that fills an orthographic picture, with `uvs` of its corners, lower left first, counter-clockwise."""
    positions = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    normals = np.broadcast_to(np.float32([0, 0, 1]), (2, 3, 3)).copy()
    colors = more.pop("colors", None)
    mesh = Mesh(
        "sheet", positions, triangles, normals, np.float32(uvs)[triangles], np.zeros(2, np.int32), colors=colors
    )
    camera = Camera(placed((0, 0, 3)), ortho_scale=2.0)
    return Scene("sheet", camera, (mesh,), (Instance("sheet", 0, np.eye(4), (0,)),), (material,), **more)


def decoded(value):
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def wrapped(index, size, extension):
    if extension is Extension.REPEAT:
        return index % size
    if extension is Extension.MIRROR:
        index = index % (2 * size)
        return np.where(index < size, index, 2 * size - 1 - index)
    return np.clip(index, 0, size - 1)


def looked_up(pixels, u, v, interpolation, extension):
    """The image at (u, v) as Cycles reads it, before sRGB is decoded."""
    height, width = pixels.shape[:2]

    def texel(i, j):
        outside = (extension is Extension.CLIP) & ((i < 0) | (j < 0) | (i >= width) | (j >= height))
        return np.where(outside[..., None], 0.0, pixels[wrapped(j, height, extension), wrapped(i, width, extension)])

    if interpolation is Interpolation.CLOSEST:
        return texel(np.floor(u * width).astype(int), np.floor(v * height).astype(int))
    x, y = u * width - 0.5, v * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    f, g = (x - i)[..., None], (y - j)[..., None]
    return (1 - g) * ((1 - f) * texel(i, j) + f * texel(i + 1, j)) + g * (
        (1 - f) * texel(i, j + 1) + f * texel(i + 1, j + 1)
    )


@pytest.mark.parametrize("extension", Extension)
@pytest.mark.parametrize("interpolation", Interpolation)
def test_image_is_read_as_cycles_reads_it(interpolation, extension):
    pixels = np.random.default_rng(1).integers(0, 256, (5, 7, 4), np.uint8)
    source = ColorSource((1, 1, 1), 0, interpolation, extension)
    material = Material("m", base=source)
    uvs = [[-2.3, -1.7], [3.1, -1.7], [3.1, 2.9], [-2.3, 2.9]]
    scene = sheet(uvs, material, images=(Image("i", pixels, srgb=True),))
    size = 96
    place = (np.arange(size) + 0.5) / size
    u, v = np.meshgrid(-2.3 + 5.4 * place, 2.9 - 4.6 * place)
    expected = decoded(looked_up(pixels[..., :3] / 255.0, u, v, interpolation, extension))
    wrong = np.abs(picture(scene, (size, size)) - expected).max(axis=-1)
    # Closest texels may round the other way at their borders.
    assert (wrong < 2e-3).mean() > (0.995 if interpolation is Interpolation.CLOSEST else 0.9999)


def test_float_image_is_linear_and_vertex_colors_multiply():
    pixels = np.full((2, 2, 4), 3.5, np.float32)
    colors = np.full((2, 3, 4), 0.25, np.float32)
    material = Material("m", base=ColorSource((2.0, 1.0, 0.5), 0, vertex_colors=True))
    scene = sheet([[0, 0], [1, 0], [1, 1], [0, 1]], material, images=(Image("i", pixels),), colors=colors)
    assert np.allclose(picture(scene), [1.75, 0.875, 0.4375], atol=1e-6)


def test_panorama_is_mapped_as_cycles_maps_it():
    camera = looking((0, 0, 0), (0.3, -1.0, 0.2), lens=14)
    height, width = 64, 128
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    azimuth, elevation = np.pi * (1 - 2 * u), np.pi * (v - 0.5)
    direction = np.stack(
        [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)], -1
    )
    away = (mesh_of(trimesh.creation.box()), placed((0, 50, 0)), False)
    scene = dataclasses.replace(
        scene_of([away], camera), world=World(panorama=(0.5 + 0.5 * direction).astype(np.float32))
    )
    _, directions = camera_rays(camera, 64, 48)
    assert np.abs(picture(scene, (64, 48)).reshape(-1, 3) - (0.5 + 0.5 * directions)).max() < 0.01


def test_cube_faces_are_plus_and_minus_x_y_z():
    walls = [
        (
            mesh_of(trimesh.creation.box()),
            placed(4.0 * side * np.eye(3)[axis], np.where(np.eye(3)[axis], 0.1, 8.1)),
            False,
        )
        for axis in range(3)
        for side in (1, -1)
    ]
    ball = (mesh_of(trimesh.creation.icosphere(2)), placed(), True)
    scene = scene_of([*walls, ball], looking((2, 2, 0.5)))

    def faces():
        cubes = EnvironmentCubes(Resident(scene, Lighting.UNLIT), 32)
        return cubes.read()[0]

    seen = gl.call(faces)[:, 2:-2, 2:-2, 0]
    assert np.allclose(seen, np.arange(1, 7)[:, None, None])


def test_environment_map_is_exact_far_away():
    far = (mesh_of(trimesh.creation.icosphere(5, radius=1000.0)), placed(), False)
    ball = (mesh_of(trimesh.creation.icosphere(5), smooth=True), placed(), True)
    scene = scene_of([far, ball], looking((0, -5, 1)))
    shade = np.float32(0.5 + 0.5 * np.asarray(scene.meshes[0].positions / 1000.0))
    colors = np.concatenate([shade, np.ones((len(shade), 1), np.float32)], axis=1)
    sky = dataclasses.replace(scene.meshes[0], colors=colors[scene.meshes[0].triangles])
    material = Material("sky", base=ColorSource(vertex_colors=True))
    scene = dataclasses.replace(scene, meshes=(sky, scene.meshes[1]), materials=(material, *scene.materials[1:]))
    assert np.abs(picture(scene, method=EnvironmentMap) - picture(scene)).max() < 0.02


@pytest.mark.parametrize(
    ("fresnel", "expected"),
    [
        (Fresnel.CONSTANT, lambda cosine: 0.4 + 0 * cosine),
        (Fresnel.SCHLICK, lambda cosine: 0.4 + 0.6 * (1 - cosine) ** 5),
        (
            Fresnel.DIELECTRIC,
            lambda cosine: 0.4 * _dielectric(cosine, 1.5),
        ),
    ],
)
def test_fresnel_of_a_mirror_under_a_white_sky(fresnel, expected):
    mirror = Material(
        "m", diffuse=0.0, base=BLACK, reflection=ColorSource((0.4, 0.4, 0.4)), fresnel=fresnel, roughness=BLACK
    )
    plane = mesh_of(trimesh.Trimesh([[-90, -90, 0], [90, -90, 0], [90, 90, 0], [-90, 90, 0]], [[0, 1, 2], [0, 2, 3]]))
    camera = looking((0, -3, 2), (0, 1, 0), lens=20)
    scene = dataclasses.replace(scene_of([(plane, placed(), True)], camera, world=(1, 1, 1)), materials=(mirror,))
    _, directions = camera_rays(camera, 64, 64)
    below = directions[:, 2] < -0.1
    seen = picture(scene).reshape(-1, 3)[below, 0]
    assert np.abs(seen - expected(-directions[below, 2])).max() < 1e-5


def _dielectric(cosine, ior):
    """Fresnel's equations by Snell's law."""
    inner = np.sqrt(1 - (1 - cosine**2) / ior**2)
    across = (cosine - ior * inner) / (cosine + ior * inner)
    along = (ior * cosine - inner) / (ior * cosine + inner)
    return (across**2 + along**2) / 2


@pytest.mark.parametrize(
    ("kind", "expected"),
    [(LampKind.SUN, 2.0 / np.pi), (LampKind.POINT, 2.0 / (4 * np.pi**2 * 9)), (LampKind.AREA, 2.0 / (np.pi**2 * 9))],
)
def test_lamp_straight_above_lights_a_white_sheet(kind, expected):
    lamp = Lamp("lamp", kind, placed((0, 0, 3)), (2.0, 2.0, 2.0))
    scene = sheet(np.zeros((4, 2)), Material("white"), lamps=(lamp,))
    lit = picture(scene, (65, 65), Lighting.DIRECT)
    assert lit[32, 32, 0] == pytest.approx(expected, rel=1e-3)


def test_lamp_behind_something_casts_a_shadow_and_the_world_still_lights():
    scene = sheet(np.zeros((4, 2)), Material("white"), world=World((0.25, 0.25, 0.25)))
    lid = mesh_of(trimesh.creation.box((0.5, 0.5, 0.01)))
    instances = (*scene.instances, Instance("lid", 1, placed((0, 0, 1)), (0,), in_camera=False))
    lamps = (Lamp("sun", LampKind.SUN, np.eye(4), (1.0, 1.0, 1.0)),)
    scene = dataclasses.replace(scene, meshes=(*scene.meshes, lid), instances=instances, lamps=lamps)
    lit = picture(scene, (64, 64), Lighting.DIRECT)[..., 0]
    assert lit[32, 32] == pytest.approx(0.25, abs=1e-3)
    assert lit[4, 4] == pytest.approx(0.25 + 1 / np.pi, abs=1e-3)
    assert (lit < 0.3).mean() == pytest.approx(0.25**2, abs=0.01)


def test_a_second_canvas_is_made_without_an_error():
    """moderngl binds the framebuffer before it again, even one that has been given back."""

    def made():
        for _ in range(2):
            canvas = Canvas(8, 8)
            canvas.light.use()
            canvas.release()
        return gl.require().error

    gl.call(lambda: gl.require().error)  # what was before
    assert gl.call(made) == "GL_NO_ERROR"


# Reflectors


def test_reflectors_are_where_the_camera_sees_them():
    """A mirror of half the picture's width, whose right half stands behind a sheet; row 0 is the top."""
    sheets = [(trimesh.creation.box((1.0, 0.5, 0.0)), True), (trimesh.creation.box((0.5, 0.5, 0.0)), False)]
    places = placed((0.0, 0.25, 0.0)), placed((0.25, 0.25, 1.0))
    parts = [(mesh_of(shape), place, mirrors) for (shape, mirrors), place in zip(sheets, places, strict=True)]
    scene = scene_of(parts, Camera(placed((0, 0, 3)), ortho_scale=2.0))
    expected = np.zeros((32, 32), bool)
    expected[8:16, 8:16] = True
    assert np.array_equal(reflectors_seen(scene, 32, 32), expected)
