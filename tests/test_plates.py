"""`catoptric plates`: every figure is drawn, on a page that needs nothing else, and says what it shows."""

import re
from dataclasses import replace

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
import trimesh
from catoptric.addon.blender.plain_base import plain_base
from catoptric.addon.methods.glossy.gloss import filter_radius, fresnel_factor
from catoptric.addon.scene import (
    BLACK,
    ColorSource,
    Fresnel,
    Image,
    Instance,
    Material,
    Mesh,
    Scene,
    World,
    grey,
    mean_color,
)
from catoptric.addon.scene.archive import save
from catoptric.batch.cli import main
from catoptric.batch.pictures import load_picture
from catoptric.batch.plates import PAIR, PLATES, without_texture
from catoptric.batch.plates_page import FARTHEST, HEIGHTS, charts

from .blender_stage import add_box, add_camera, add_plane, empty_scene, principled
from .stage import CHROME, looking, mesh_of, placed, scene_of

QUICK = ["--lighting", "direct", "--resolution", "48x32", "--samples", "4"]
FIGURES = {plate.name for plate in (*PLATES, *PAIR)}


def tiled() -> Scene:
    """A tall box on a polished floor of black and white tiles, in even light."""
    tiles = np.zeros((2, 2, 4), np.float32)
    tiles[..., 3] = tiles[0, 0, :3] = tiles[1, 1, :3] = 1.0
    polish = Material(
        "Polish",
        base=ColorSource((0.4, 0.2, 0.1), image=0),
        reflection=grey(1.0),
        fresnel=Fresnel.DIELECTRIC,
        roughness=grey(0.15),
    )
    sheet = Mesh(
        "floor",
        np.array([(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)], np.float32),
        np.array([(0, 1, 2), (0, 2, 3)], np.int32),
        np.tile(np.array((0, 0, 1.0), np.float32), (2, 3, 1)),
        np.array([[(0, 0), (8, 0), (8, 8)], [(0, 0), (8, 8), (0, 8)]], np.float32),
        np.zeros(2, np.int32),
    )
    box = mesh_of(trimesh.creation.box((1.0, 1.0, 1.0)))
    instances = (
        Instance("floor", 0, np.eye(4), (0,), reflector=True),
        Instance("box", 1, placed((0.0, 1.0, 1.5), (2.0, 1.0, 3.0)), (1,)),
    )
    materials = (polish, Material("Lamp", base=BLACK, emission=ColorSource((0.7, 0.4, 0.2))))
    camera = looking((0.0, -5.0, 1.6), (0.0, 1.0, 0.6), lens=30.0)
    return Scene("Scene", camera, (sheet, box), instances, materials, (Image("tiles", tiles),), world=World((0.1,) * 3))


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """The scene on disk."""
    path = tmp_path_factory.mktemp("plates") / "tiled-hall.catoptric"
    save(tiled(), path)
    return path


@pytest.fixture(scope="module")
def drawn(archive, tmp_path_factory):
    """The folder of one run."""
    out = tmp_path_factory.mktemp("drawn")
    assert main(["plates", str(archive), *QUICK, "--out", str(out)]) == 0
    return out


def picture(folder, name) -> np.ndarray:
    """0..255 as a screen shows it."""
    return load_picture(folder / f"{name}.png").astype(float)


def test_every_figure_is_a_picture_with_its_caption(drawn):
    for plate in (*PLATES, *PAIR):
        path = drawn / f"{plate.name}.png"
        assert load_picture(path).shape == (32, 48, 3)
        assert oiio.ImageBuf(str(path)).spec().getattribute("ImageDescription") == plate.caption
    assert {path.stem for path in drawn.glob("*.png")} == FIGURES | {"glossy-planar", "glossy-planar-textured"}


def test_the_page_needs_nothing_else_and_names_every_figure(drawn):
    page = (drawn / "plates.html").read_text()
    bare = re.sub(r"base64,[\w+/=]+", "", page)
    assert not re.search(r"(?:https?:)?//[a-z0-9-]+\.[a-z]|<(link|script|iframe|object)\b|@import", bare)
    assert "default-src 'none'" in page
    assert "tiled-hall" in page
    for plate in (*PLATES, *PAIR):
        assert plate.caption in page
    assert page.count("data:image/jpeg") == 2 * len(PLATES) + len(PAIR)
    assert page.count("<polyline") == 2 * len(HEIGHTS)
    assert [page.index(f"<h2>Figure {number}</h2>") for number in (10, 11, 13, 14, 12, 8)] == sorted(
        page.index(f"<h2>Figure {number}</h2>") for number in (10, 11, 13, 14, 12, 8)
    )


def test_plates_differ_as_the_paper_says(drawn):
    """The box's mirror image, in front of it: absent; in full; fading with height; weak and faded."""
    column = {name: picture(drawn, name)[21:, 20:28, 0].mean(axis=1) for name in FIGURES}
    none, perfect, parallel, tilted = (column[f"figure-{number}"] for number in (10, 11, 13, 14))
    assert np.ptp(none) < 8.0
    assert perfect[3] > none[3] + 60.0
    assert (perfect >= parallel - 2.0).all()
    assert (parallel > tilted + 5.0).mean() > 0.5
    assert (tilted >= none - 2.0).mean() > 0.8
    assert np.abs(column["figure-8-left"] - column["figure-8-right"]).max() > 2.0


def test_only_figure_12_has_the_floor_s_texture(drawn):
    def roughness(name):
        floor = picture(drawn, name)[26:, :12, 1]
        return np.abs(np.diff(floor, axis=1)).mean()

    assert roughness("figure-12") > 5.0 * max(roughness(name) for name in FIGURES - {"figure-12"})


def test_a_floor_without_texture_has_the_mean_of_its_colours():
    scene = tiled()
    plain = without_texture(scene)
    assert plain.materials[0].base.color == pytest.approx((0.2, 0.1, 0.05))
    assert plain.materials[0].base.image is None
    assert plain.materials[1] is scene.materials[1]
    assert mean_color(scene, scene.materials[0].base) == pytest.approx((0.2, 0.1, 0.05))


@pytest.mark.parametrize("number", range(len(HEIGHTS)))
def test_curves_are_those_of_the_figures(number):
    """Read back from the picture: the middle and the end of each curve."""
    for chart, function, value in zip(charts(), (filter_radius, fresnel_factor), (np.deg2rad(0.5), 1.5), strict=True):
        points = np.array([point.split(",") for point in chart.points(number, 380.0, 200.0).split()], float)
        for x, y in (points[len(points) // 2], points[-1]):
            wanted = function(x / 380.0 * FARTHEST, HEIGHTS[number], 1.65, value)
            assert (1.0 - y / 200.0) * chart.highest == pytest.approx(wanted, abs=chart.highest / 1000.0)
        assert (points[:, 1] >= 0.0).all()


# ---- In Blender, and in the report of `compare`


def stage():
    """A floor with an image, and a box."""
    scene = empty_scene()
    add_camera(scene, (0.0, -6.0, 2.0), (1.25, 0.0, 0.0))
    floor = principled("Floor", (0.8, 0.1, 0.1), Roughness=0.2)
    node = floor.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Red and white", 2, 2)
    node.image.pixels[:] = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0] * 2
    node.image.pack()
    shader = next(one for one in floor.node_tree.nodes if one.type == "BSDF_PRINCIPLED")
    floor.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    add_plane(scene, "Floor", 8.0, floor)["catoptric_reflector"] = True
    add_box(scene, "Box", 1.0, principled("Blue", (0.1, 0.1, 0.8)), (0.0, 0.5, 0.5))
    return scene, shader.inputs["Base Color"], node


def test_blender_s_material_is_plain_for_a_while():
    _, socket, node = stage()
    before = tuple(socket.default_value)
    with plain_base({"Floor": (0.2, 0.3, 0.4), "nothing of that name": (1.0, 1.0, 1.0)}):
        assert not socket.is_linked
        assert tuple(socket.default_value) == pytest.approx((0.2, 0.3, 0.4, 1.0))
    assert socket.links[0].from_node == node
    assert tuple(socket.default_value) == before


def test_cycles_is_shown_beside_the_plates(tmp_path):
    stage()
    blend = tmp_path / "floor.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True, compress=False)
    size = ["--lighting", "direct", "--resolution", "32x24", "--samples", "4"]
    assert main(["plates", str(blend), *size, "--reference", "--out", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "plates.html").read_text()
    assert page.count("data:image/jpeg") == 3 * len(PLATES) + len(PAIR)
    assert page.count('alt="Cycles"') == len(PLATES)
    plain, textured = (picture(tmp_path / "out", f"cycles{mark}") for mark in ("", "-textured"))
    assert plain.shape == textured.shape == (24, 32, 3)
    assert not np.array_equal(plain, textured)


def test_the_report_leads_to_the_plates_where_there_is_light(archive, tmp_path):
    methods = ["--methods", "planar,glossy-planes"]
    for lighting, there in (("direct", True), ("unlit", False)):
        out = tmp_path / lighting
        size = ["--resolution", "32x24", "--samples", "4", "--lighting", lighting]
        assert main(["compare", str(archive), *size, *methods, "--out", str(out)]) == 0
        links = re.findall(r'<a href="(plates/[^"]+)"', (out / "report.html").read_text())
        assert len(links) == there
        assert all((out / link).is_file() for link in links)


# ---- What cannot be


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--lighting", "unlit"], "perfect"),
        (["--lighting", "direct", "--reference"], "Cycles cannot render an archive"),
        (["--lighting", "cycles"], "holds no lightmaps"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(archive, tmp_path, capsys, arguments, words):
    assert main(["plates", str(archive), "--out", str(tmp_path), *arguments]) == 2
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("catoptric:")]
    assert words in line
    assert not list(tmp_path.iterdir())


def test_a_scene_without_flat_mirrors_is_refused(tmp_path, capsys):
    ball = mesh_of(trimesh.creation.icosphere(2), smooth=True)
    scene = scene_of([(ball, np.eye(4), True)], looking((0.0, -4.0, 1.0)))
    scene = replace(scene, materials=(CHROME,))
    save(scene, tmp_path / "ball.catoptric")
    assert main(["plates", str(tmp_path / "ball.catoptric"), *QUICK, "--out", str(tmp_path / "out")]) == 2
    assert "is curved" in capsys.readouterr().err
