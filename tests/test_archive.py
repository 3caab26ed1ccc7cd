"""A Scene goes into a file and comes back the same; a bad file is one clear line."""

import dataclasses
import json
import os
import zipfile
from enum import Enum

import numpy as np
import pytest
from catoptric.addon import scene as contract
from catoptric.addon.errors import SceneError
from catoptric.addon.scene import archive
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

FINITE = st.floats(allow_nan=False, width=64)
COLOR = st.tuples(FINITE, FINITE, FINITE)
NAME = st.text(st.characters(codec="utf-8"), max_size=12)


def arrays(shape, dtype=np.float32):
    return npst.arrays(dtype, shape)


@st.composite
def meshes(draw):
    vertices, count = draw(st.integers(1, 5)), draw(st.integers(0, 4))
    return contract.Mesh(
        name=draw(NAME),
        positions=draw(arrays((vertices, 3))),
        triangles=draw(npst.arrays(np.int32, (count, 3), elements=st.integers(0, vertices - 1))),
        normals=draw(arrays((count, 3, 3))),
        uvs=draw(arrays((count, 3, 2))),
        slots=np.zeros(count, np.int32),
        lightmap_uvs=draw(st.none() | arrays((count, 3, 2))),
        colors=draw(st.none() | arrays((count, 3, 4))),
    )


@st.composite
def images(draw):
    shape = (draw(st.integers(1, 3)), draw(st.integers(1, 3)), 4)
    return contract.Image(draw(NAME), draw(arrays(shape) | arrays(shape, np.uint8)), draw(st.booleans()))


SOURCES = st.builds(
    contract.ColorSource,
    COLOR,
    st.none() | st.just(0),
    st.sampled_from(contract.Interpolation),
    st.sampled_from(contract.Extension),
    st.booleans(),
)
MATERIALS = st.builds(
    contract.Material, NAME, SOURCES, FINITE, SOURCES, SOURCES, st.sampled_from(contract.Fresnel), FINITE, SOURCES
)
MATRICES = arrays((4, 4), np.float64)
CAMERAS = st.builds(
    contract.Camera,
    MATRICES,
    FINITE,
    st.tuples(FINITE, FINITE),
    st.sampled_from(contract.SensorFit),
    st.tuples(FINITE, FINITE),
    st.none() | FINITE,
)
LAMPS = st.builds(contract.Lamp, NAME, st.sampled_from(contract.LampKind), MATRICES, COLOR)
INSTANCES = st.builds(
    contract.Instance,
    NAME,
    st.just(0),
    MATRICES,
    st.just((0, 0)),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.none() | st.just(0),
)


def some(items, least=0):
    return st.lists(items, min_size=least, max_size=2).map(tuple)


SCENES = st.builds(
    contract.Scene,
    name=NAME,
    camera=CAMERAS,
    meshes=some(meshes(), 1),
    instances=some(INSTANCES),
    materials=some(MATERIALS, 1),
    images=some(images(), 1),
    lamps=some(LAMPS),
    world=st.builds(contract.World, COLOR, st.none() | arrays((2, 4, 3))),
    frame=st.integers(-1000, 10**6),
    resolution=st.tuples(st.integers(1, 10**5), st.integers(1, 10**5)),
    warnings=some(NAME),
)


def assert_same(one, other):
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()
    elif isinstance(one, tuple):
        assert len(one) == len(other)
        for pair in zip(one, other, strict=True):
            assert_same(*pair)
    elif dataclasses.is_dataclass(one) and not isinstance(one, Enum):
        for field in dataclasses.fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name))
    else:
        assert one == other


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(scene=SCENES)
def test_what_is_saved_comes_back_bit_for_bit(tmp_path_factory, scene):
    path = tmp_path_factory.mktemp("archive") / "scene.catoptric"
    archive.save(scene, path)
    assert_same(archive.load(path), scene)
    assert os.listdir(path.parent) == [path.name]


@pytest.fixture
def saved(tmp_path):
    """A small archive on disk."""
    mesh = contract.Mesh(
        "tri",
        np.eye(3, dtype=np.float32),
        np.array([[0, 1, 2]], np.int32),
        np.ones((1, 3, 3), np.float32),
        np.zeros((1, 3, 2), np.float32),
        np.zeros(1, np.int32),
    )
    scene = contract.Scene(
        name="s",
        camera=contract.Camera(np.eye(4)),
        meshes=(mesh,),
        instances=(contract.Instance("i", 0, np.eye(4), (0,)),),
        materials=(contract.Material("m"),),
    )
    path = tmp_path / "scene.catoptric"
    archive.save(scene, path)
    return path


def rewritten(path, change):
    """Change the description inside an archive."""
    with zipfile.ZipFile(path) as old:
        members = {name: old.read(name) for name in old.namelist()}
    description = json.loads(members["scene.json"])
    change(description)
    members["scene.json"] = json.dumps(description).encode()
    with zipfile.ZipFile(path, "w") as new:
        for name, content in members.items():
            new.writestr(name, content)


def assert_refused(path, words):
    with pytest.raises(SceneError, match=words) as refusal:
        archive.load(path)
    assert str(refusal.value).startswith(str(path))
    assert "\n" not in str(refusal.value)


def test_a_missing_file_is_named(tmp_path):
    assert_refused(tmp_path / "gone.catoptric", "no such file")


def test_a_foreign_file_is_named(tmp_path):
    path = tmp_path / "text.catoptric"
    path.write_text("hello")
    assert_refused(path, "not a .catoptric")
    with zipfile.ZipFile(path, "w") as other:
        other.writestr("a.txt", "b")
    assert_refused(path, "not a .catoptric")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.98])
def test_a_truncated_file_is_named(saved, share):
    content = saved.read_bytes()
    saved.write_bytes(content[: int(len(content) * share)])
    assert_refused(saved, "damaged")


def test_no_single_flipped_byte_gives_a_traceback(saved):
    content = saved.read_bytes()
    refused = 0
    for position in range(0, len(content), 7):
        saved.write_bytes(content[:position] + bytes([content[position] ^ 0x5A]) + content[position + 1 :])
        try:
            archive.load(saved)
        except SceneError:
            refused += 1
    assert refused > len(content) // 7 // 3


def test_a_file_of_version_1_has_one_number_for_roughness(saved):
    def age(description):
        description["version"] = 1
        for material in description["scene"]["materials"]:
            material["roughness"] = 0.25

    rewritten(saved, age)
    assert archive.load(saved).materials[0].roughness == contract.ColorSource((0.25, 0.25, 0.25))


def test_a_newer_file_says_to_update(saved):
    rewritten(saved, lambda description: description.update(version=archive.VERSION + 1))
    assert_refused(saved, "newer Catoptric")


@pytest.mark.parametrize(
    "change",
    [
        lambda scene: scene["instances"][0].update(mesh=3),
        lambda scene: scene["instances"][0].update(mesh=-1),
        lambda scene: scene["instances"][0].update(materials=[]),
        lambda scene: scene["materials"][0]["base"].update(image=0),
        lambda scene: scene["materials"][0].update(ior="glass"),
        lambda scene: scene["materials"][0].update(fresnel=99),
        lambda scene: scene["materials"][0].update(unheard=1),
        lambda scene: scene.pop("camera"),
        lambda scene: scene.update(camera=[]),
        lambda scene: scene["meshes"][0].update(positions={"array": "arrays/99.npy"}),
        lambda scene: scene["meshes"][0].update(positions=scene["meshes"][0]["slots"]),
    ],
)
def test_nonsense_inside_is_damage(saved, change):
    rewritten(saved, lambda description: change(description["scene"]))
    assert_refused(saved, "damaged")


def test_a_failed_save_leaves_the_old_file_and_no_litter(saved):
    before = saved.read_bytes()
    scene = archive.load(saved)
    broken = dataclasses.replace(scene, meshes=(dataclasses.replace(scene.meshes[0], name=object()),))
    with pytest.raises(TypeError):
        archive.save(broken, saved)
    assert saved.read_bytes() == before
    assert os.listdir(saved.parent) == [saved.name]


def test_a_folder_that_is_not_there_is_named(saved):
    with pytest.raises(SceneError, match="no folder"):
        archive.save(archive.load(saved), saved.parent / "nowhere" / "scene.catoptric")
