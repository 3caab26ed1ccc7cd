"""What an engine gets: files, numbers and GLSL that are enough by themselves, held against Embree."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
import trimesh
from catoptric.addon.baking.engine_export import export_for_engine
from catoptric.addon.baking.engine_export_ktx2 import why_no_ktx2
from catoptric.addon.errors import Cancelled, MachineError, SceneError, UsageError
from catoptric.addon.scene import Lighting
from catoptric.addon.scene.archive import save
from catoptric.batch.cli import main
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .engine_stage import Engine
from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed, scene_of

RESOLUTION = 128
TURNED = placed((1.5, -0.9, 0.2), (0.5, 0.6, 0.5), 0.7, (0.3, 0.2, 1.0))


def ball():
    """A round mirror."""
    return mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True)


def rack():
    """Three plates with room between them."""
    return trimesh.util.concatenate(
        [trimesh.creation.box((0.3, 1.6, 1.6)).apply_translation((0.7 * step, 0.0, 0.0)) for step in (-1, 0, 1)]
    )


def beside_ball(*parts):
    """A mirror ball, `object 0`, and what stands beside it: (trimesh, matrix) parts from `object 1` on."""
    things = [(mesh_of(shape), matrix, False) for shape, matrix in parts]
    return scene_of([(ball(), placed(), True), *things], looking((0, -4, 0.6), lens=65.0), world=(0.0, 0.0, 0.25))


def exported(scene, folder, objects=None, **given):
    """An engine that has read the scene."""
    export_for_engine(scene, Lighting.UNLIT, objects, folder, {"resolution": RESOLUTION, "cube_size": 32, **given})
    return Engine(folder)


def reflected(scene, size=(160, 120)):
    """Origins and directions of the rays that the mirrors send off, and what Embree says that they meet."""
    judge = Judge(scene)
    origins, directions = camera_rays(scene.camera, *size)
    first = judge.meet(origins, directions)
    mirrors = np.array([instance.reflector for instance in scene.instances])
    start, away = mirrored(first, directions)
    chosen = (first.instance >= 0) & mirrors[first.instance] & ((away * first.flat).sum(-1) > 0.01)
    return start[chosen], away[chosen], judge.meet(start[chosen], away[chosen])


def directions_around(count=4000):
    """Unit vectors (count, 3) all around."""
    vectors = np.random.default_rng(7).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def six_walls():
    """A mirror in the middle of six walls, `object 1` to `object 6`: +X -X +Y -Y +Z -Z, and a marker at each.

    The markers stand off the middle of their walls, so that a face that is turned shows.
    """
    parts = [(ball(), placed(scale=(0.2,) * 3), True)]
    steps = [side * np.eye(3)[axis] for axis in range(3) for side in (1.0, -1.0)]
    parts += [(mesh_of(trimesh.creation.box((4, 4, 4))), placed(4.0 * step, (0.999,) * 3), False) for step in steps]
    marker = mesh_of(trimesh.creation.box((0.5, 0.5, 0.5)))
    for step in steps:
        aside = np.roll(step, 1) * 0.7 + np.abs(np.roll(step, 2)) * 0.3
        parts.append((marker, placed(1.6 * step + aside), False))
    return scene_of(parts, looking((0, -2, 0)))


# ------------------------------------------------------------------ the atlas


@pytest.mark.parametrize(("version", "rows_from_bottom"), [("330 core", False), ("410 core", True)])
@pytest.mark.parametrize(
    ("shape", "layers"),
    [(trimesh.creation.icosphere(4), 1), (trimesh.creation.torus(1.0, 0.3), 2), (rack(), 3)],
    ids=["sphere", "torus", "rack"],
)
def test_the_exported_glsl_meets_what_embree_meets(shape, layers, version, rows_from_bottom, tmp_path):
    scene = beside_ball((shape, TURNED))
    engine = exported(scene, tmp_path)
    (thing,) = engine.described["objects"]
    (standing,) = thing["instances"]
    assert (standing["name"], thing["layers"]) == ("object 1", layers)
    start, away, truth = reflected(scene)
    radiance, distance, normal = engine.trace(
        thing, standing, start, away, version=version, rows_from_bottom=rows_from_bottom
    )
    hits, wanted = np.isfinite(distance), truth.instance == 1
    assert wanted.sum() > 500
    assert (hits != wanted).sum() <= 0.03 * wanted.sum()
    both = hits & wanted & (-(truth.flat * away).sum(-1) > 0.3)
    texel = np.linalg.svd(TURNED[:3, :3], compute_uv=False).max() * max(thing["box"]["size"]) / RESOLUTION
    errors = np.abs(distance[both] - truth.distance[both]) / texel
    assert np.median(errors) <= 0.5
    assert np.quantile(errors, 0.98) <= 2.0
    assert (radiance[hits] == (2.0, 1.0, 0.0)).all()
    assert ((normal[both] * truth.flat[both]).sum(-1) > 0.9).mean() > 0.95


def test_each_face_of_the_atlas_lies_where_the_description_says(tmp_path):
    shape = trimesh.util.concatenate(
        [trimesh.creation.box((1.0, 2.0, 0.4)), trimesh.creation.icosphere(3, 0.5).apply_translation((0.2, 0.6, 0.7))]
    )
    scene = beside_ball((shape, np.eye(4)))
    scene = replace(scene, instances=(scene.instances[0], replace(scene.instances[1], matrix=np.eye(4))))
    engine = exported(scene, tmp_path, resolution=40)
    (thing,) = engine.described["objects"]
    judge = Judge(replace(scene, instances=scene.instances[1:]))
    low, size = (np.array(thing["box"][name]) for name in ("low", "size"))
    first = {name: engine.picture(texture["files"][0]) for name, texture in thing["textures"].items()}
    assert {picture.shape for picture in first.values()} == {(2 * max(thing["texels"]), 3 * max(thing["texels"]), 4)}
    for name, face in thing["faces"].items():
        axis, along, up = ("XYZ".index(letter) for letter in (name[1], face["u"][1], face["v"][1]))
        assert (face["columns"], face["rows"]) == (thing["texels"][along], thing["texels"][up])
        columns, rows = np.meshgrid(np.arange(face["columns"]), np.arange(face["rows"]))
        origins = np.empty((columns.size, 3))
        origins[:, axis] = low[axis] + (size[axis] if name[0] == "+" else 0.0)
        origins[:, along] = low[along] + (columns.ravel() + 0.5) / face["columns"] * size[along]
        origins[:, up] = low[up] + (face["rows"] - 0.5 - rows.ravel()) / face["rows"] * size[up]
        inwards = np.zeros_like(origins)
        inwards[:, axis] = -1.0 if name[0] == "+" else 1.0
        met = judge.meet(origins, inwards)
        window = np.s_[face["top"] : face["top"] + face["rows"], face["left"] : face["left"] + face["columns"]]
        held = first["color_depth"][window].reshape(-1, 4)
        seen = held[:, 3] < 1.0
        expected = np.where(np.isfinite(met.distance), met.distance / size[axis], 1.0)
        assert (seen != np.isfinite(met.distance)).mean() < 0.02
        assert (np.abs(held[:, 3] - expected) < 1e-3).mean() > 0.97
        assert ((first["normal_count"][window][..., 3].ravel() > 0) == seen).all()


def test_objects_of_one_mesh_and_material_share_an_atlas(tmp_path):
    scene = beside_ball((trimesh.creation.box(), TURNED), (trimesh.creation.box(), placed((-2, 0, 0))))
    first, second = scene.instances[1:]
    scene = replace(scene, instances=(scene.instances[0], first, replace(second, mesh=first.mesh, materials=(1,))))
    (thing,) = exported(scene, tmp_path, resolution=16).described["objects"]
    assert [one["name"] for one in thing["instances"]] == ["object 1", "object 2"]
    assert [one["object_to_world"] for one in thing["instances"]] == [first.matrix.tolist(), second.matrix.tolist()]


# ------------------------------------------------------------------ the cube


def test_the_cross_shows_each_wall_in_its_place(tmp_path):
    engine = exported(six_walls(), tmp_path, ["object 0"])
    (cube,) = engine.described["cubes"]
    assert cube["centre"] == [0.0, 0.0, 0.0]
    picture = engine.picture(cube["file"])
    assert picture.shape == (3 * 32, 4 * 32, 3)
    # Colours 2 to 7 are the walls +X -X +Y -Y +Z -Z: the sky above, the floor below, ahead in the middle.
    expected = np.array([[0, 6, 0, 0], [3, 4, 2, 5], [0, 7, 0, 0]])
    corners = picture.reshape(3, 32, 4, 32, 3)[:, 2, :, 2, 0]
    assert np.array_equal(corners, expected)


def seen_from_centre(scene, directions):
    """The red that names what Embree meets from the origin, 0 for nothing; the mirror left out."""
    met = Judge(replace(scene, instances=scene.instances[1:])).meet(np.zeros_like(directions), directions)
    return np.where(met.instance < 0, 0.0, met.instance + 2.0)


def test_each_texel_of_a_face_looks_where_the_description_says(tmp_path):
    scene = six_walls()
    engine = exported(scene, tmp_path, ["object 0"])
    (cube,) = engine.described["cubes"]
    across = (np.arange(cube["size"]) + 0.5) / cube["size"] * 2.0 - 1.0
    for face, directed in zip(engine.faces(cube), cube["faces"].values(), strict=True):
        looks, right, up = (
            (1.0 if directed[name][0] == "+" else -1.0) * np.eye(3)["XYZ".index(directed[name][1])]
            for name in ("looks", "right", "up")
        )
        directions = (looks + across[None, :, None] * right - across[:, None, None] * up).reshape(-1, 3)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        assert (face[..., 0].ravel() == seen_from_centre(scene, directions)).mean() > 0.995


@pytest.mark.parametrize(("version", "rows_from_bottom"), [("330 core", False), ("410 core", True)])
def test_cross_and_cube_map_show_what_embree_meets(version, rows_from_bottom, tmp_path):
    scene = six_walls()
    engine = exported(scene, tmp_path, ["object 0"], cube_size=64)
    (cube,) = engine.described["cubes"]
    directions = directions_around()
    wanted = seen_from_centre(scene, directions)
    looks = engine.look(cube, directions, version=version, rows_from_bottom=rows_from_bottom)
    for radiance in looks:
        right = np.abs(radiance[:, 0] - wanted) < 0.01
        assert [number for number in range(2, 14) if right[wanted == number].mean() < 0.7] == []
        assert right.mean() > 0.9
    assert (np.abs(looks[0] - looks[1]).max(axis=1) < 1e-3).mean() > 0.95


def test_cubes_hold_all_but_the_objects_that_have_an_atlas(tmp_path):
    sheet = trimesh.Trimesh([[-3, -3, -2], [3, -3, -2], [3, 3, -2], [-3, 3, -2]], [[0, 1, 2], [0, 2, 3]])
    scene = beside_ball((trimesh.creation.box(), placed((2, 0, 0))), (sheet, np.eye(4)))
    exports = export_for_engine(scene, Lighting.UNLIT, None, tmp_path, {"resolution": 16, "cube_size": 16})
    engine = Engine(tmp_path)
    (cube,) = engine.described["cubes"]
    assert cube["without"] == ["object 0", "object 1"]
    radiance, _ = engine.look(cube, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]))
    assert np.allclose(radiance, [[0.0, 0.0, 0.25], [3.0, 1.0, 0.0]])
    assert engine.described["left_out"] == [{"object": "object 2", "reason": "it is open and has no inside to search"}]
    assert any("object 2" in note for note in exports.notes)
    plain = exported(scene, tmp_path / "plain", [0], cube_size=16)
    assert plain.described["objects"] == []
    radiance, _ = plain.look(plain.described["cubes"][0], np.array([[1.0, 0.0, 0.0]]))
    assert np.allclose(radiance, [[2.0, 1.0, 0.0]])


def test_what_surrounds_a_reflector_stays_in_its_cube(tmp_path):
    room = trimesh.creation.annulus(4.0, 5.0, 10.0)
    described = exported(beside_ball((room, np.eye(4)), (trimesh.creation.box(), TURNED)), tmp_path).described
    assert [entry["object"] for entry in described["left_out"]] == ["object 1"]
    assert [one["name"] for thing in described["objects"] for one in thing["instances"]] == ["object 2"]


# ------------------------------------------------------------------ the description


@settings(max_examples=5, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    st.floats(0.01, 6.0),
    st.text(st.characters(exclude_categories=("Cs",)), min_size=1, max_size=12),
)
def test_the_description_comes_back_exactly(tmp_path_factory, position, turn, name):
    scene = beside_ball((trimesh.creation.box(), placed(np.add(position, (9, 0, 0)), (0.3, 0.7, 1.1), turn)))
    scene = replace(scene, name=name, instances=(scene.instances[0], replace(scene.instances[1], name=name)))
    folder = tmp_path_factory.mktemp("engine")
    exports = export_for_engine(scene, Lighting.UNLIT, None, folder, {"resolution": 16, "cube_size": 16})
    described = Engine(folder).described
    (thing,), (cube,) = described["objects"], described["cubes"]
    assert described["schema"] == 1
    assert (described["scene"], thing["instances"][0]["name"]) == (name, name)
    assert np.array_equal(thing["instances"][0]["object_to_world"], scene.instances[1].matrix)
    named = [file for texture in thing["textures"].values() for file in texture["files"]]
    named += [cube["file"], described["glsl"], "catoptric.json"]
    if why_no_ktx2() is None:
        named += [cube["ktx2"], *(texture["ktx2"] for texture in thing["textures"].values())]
    assert sorted(named) == sorted(path.name for path in exports.written)
    assert sorted(named) == sorted(path.name for path in folder.iterdir())
    for texture in thing["textures"].values():
        for file in texture["files"]:
            spec = oiio.ImageBuf(str(folder / file)).spec()
            assert (spec.width, spec.height, spec.nchannels) == (texture["width"], texture["height"], 4)
            assert spec.format == oiio.TypeFloat


def test_numbers_beyond_half_floats_are_held_at_their_end(tmp_path):
    scene = replace(beside_ball(), world=replace(beside_ball().world, color=(1e6, 0.5, 0.0)))
    engine = exported(scene, tmp_path, cube_size=16)
    radiance, _ = engine.look(engine.described["cubes"][0], np.array([[0.0, 0.0, 1.0]]))
    assert radiance.tolist() == [[65504.0, 0.5, 0.0]]


# ------------------------------------------------------------------ KTX2


def test_without_the_library_the_description_says_that_there_is_no_ktx2(tmp_path):
    if why_no_ktx2() is None:
        pytest.skip("pyktx is installed here")
    scene = beside_ball((trimesh.creation.box(), TURNED))
    exports = export_for_engine(scene, Lighting.UNLIT, None, tmp_path, {"resolution": 16, "cube_size": 16})
    assert "pyktx" in exports.notes[0]
    described = json.loads((tmp_path / "catoptric.json").read_text())
    assert described["cubes"][0]["ktx2"] is None
    assert not list(tmp_path.glob("*.ktx2"))


def test_ktx2_holds_what_the_exr_holds(tmp_path):
    pyktx = pytest.importorskip("pyktx", reason="pyktx and libktx are not installed", exc_type=ImportError)
    engine = exported(beside_ball((trimesh.creation.torus(1.0, 0.3), TURNED)), tmp_path, resolution=24)
    (thing,), (cube,) = engine.described["objects"], engine.described["cubes"]

    def images(name, layers, faces, dtype):
        file = pyktx.KtxTexture2.create_from_named_file(str(tmp_path / name), 1)
        assert (file.num_layers, file.num_faces, file.is_cubemap) == (layers, faces, faces == 6)
        shape = (file.base_height, file.base_width, 4)
        data, count = bytes(file.data()), int(np.prod(shape))
        places = [file.image_offset(0, layer, face) for layer in range(layers) for face in range(faces)]
        return np.stack([np.frombuffer(data, dtype, count, place).reshape(shape) for place in places])

    assert np.array_equal(images(cube["ktx2"], 1, 6, np.float16)[..., :3], engine.faces(cube))
    for texture in thing["textures"].values():
        held = images(texture["ktx2"], thing["layers"], 1, np.float32)
        assert np.array_equal(held, np.stack(list(map(engine.picture, texture["files"]))))


# ------------------------------------------------------------------ the door


def test_the_command_line_exports_what_is_named(tmp_path, capsys):
    boxes = [(trimesh.creation.box(), placed((side, 0, 0))) for side in (-2, 2)]
    save(beside_ball(*boxes), tmp_path / "stage.catoptric")
    sizes = ["--resolution", "16", "--cube-size", "16"]
    command = ["export-engine", str(tmp_path / "stage.catoptric"), "--out", str(tmp_path / "engine"), *sizes]
    assert main([*command, "--objects", "object 0, object 2"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert sorted(Path(line).name for line in printed) == sorted(path.name for path in (tmp_path / "engine").iterdir())
    described = Engine(tmp_path / "engine").described
    assert [one["name"] for thing in described["objects"] for one in thing["instances"]] == ["object 2"]
    assert [cube["reflector"] for cube in described["cubes"]] == ["object 0"]
    for wrong, clue in ((["--objects", "object 7"], "object 2"), (["--cube-size", "1"], "16")):
        assert main([*command, *wrong]) == 2
        assert clue in capsys.readouterr().err
    assert main(["export-engine", "--help"]) == 0
    assert "Usage: catoptric export-engine" in capsys.readouterr().out


# ------------------------------------------------------------------ what goes wrong


@pytest.mark.parametrize("stage", ["baking", "writing"])
def test_stopped_in_the_middle_it_leaves_nothing_half_written(stage, tmp_path):
    def stop(said, fraction):
        if said.startswith(stage) and fraction > 0.3:
            raise Cancelled

    parts = [(trimesh.creation.box(), placed((side, 0, 0))) for side in (-2, 2)]
    scene = beside_ball(*parts)
    scene = replace(scene, instances=(*scene.instances, replace(scene.instances[0], matrix=placed((0, 4, 0)))))
    settings = {"resolution": 16, "cube_size": 16}
    with pytest.raises(Cancelled):
        export_for_engine(scene, Lighting.UNLIT, None, tmp_path, settings, progress=stop)
    assert not (tmp_path / "catoptric.json").exists()
    assert not list(tmp_path.glob(".*"))
    assert all(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT).size for path in tmp_path.glob("*.exr"))
    assert len(export_for_engine(scene, Lighting.UNLIT, None, tmp_path, settings).written) > 6


def test_layers_that_are_cut_are_told(tmp_path):
    row = [trimesh.creation.box((0.1, 1.0, 1.0)).apply_translation((0.2 * step, 0.0, 0.0)) for step in range(5)]
    scene = beside_ball((trimesh.util.concatenate(row), TURNED))
    settings = {"resolution": 32, "cube_size": 16, "layers": 1}
    exports = export_for_engine(scene, Lighting.UNLIT, None, tmp_path, settings)
    (thing,) = Engine(tmp_path).described["objects"]
    assert thing["layers"] <= 2
    assert thing["cut"]["texels"] > 0
    assert any("more layers" in note for note in exports.notes)


def test_a_selection_that_cannot_be_exported_is_one_line(tmp_path):
    scene = beside_ball((trimesh.creation.box(), TURNED))
    unseen = replace(scene, instances=(scene.instances[0], replace(scene.instances[1], in_reflections=False)))
    with pytest.raises(UsageError, match=r"no object 'object 9'.*object 0, object 1"):
        exported(scene, tmp_path, ["object 9"])
    with pytest.raises(SceneError, match="object 1: reflections do not see it"):
        exported(unseen, tmp_path, ["object 1"])
    with pytest.raises(UsageError, match="cube_size"):
        exported(scene, tmp_path, cube_size=1)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(MachineError, match="cannot make the folder"):
        exported(scene, tmp_path / "file" / "below")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_the_glsl_may_go_into_any_game_and_nothing_else_says_so(tmp_path, root):
    assert "// SPDX-License-Identifier: 0BSD" in exported(beside_ball(), tmp_path, resolution=16).glsl.splitlines()
    free = [path for path in root.glob("gpu_shaders/**/*") if path.is_file() and "0BSD" in path.read_text()]
    assert [path.name for path in free] == ["catoptric.glsl"]
    assert "for any\npurpose with or without fee" in (root / "LICENSES" / "0BSD.txt").read_text()
