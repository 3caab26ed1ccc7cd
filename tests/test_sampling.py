"""How many samples a comparison takes."""

import json
from pathlib import Path

import bpy
import pytest
from catoptric.batch import sampling
from catoptric.batch.cli import main

from .blender_stage import add_box, add_camera, add_plane, add_sphere, empty_scene, fly, principled

BOUND = 0.005


@pytest.mark.parametrize(
    ("samples", "squared"), [(2, 4), (32, 16), (64, 36), (128, 64), (256, 121), (512, 256), (4096, 256)]
)
def test_methods_take_half_as_many(samples, squared):
    assert sampling.supersampling(samples) ** 2 == squared


@pytest.mark.parametrize(("samples", "squared"), [(1, 1), (4, 4), (64, 64)])
def test_methods_against_each_other_take_as_many(samples, squared):
    assert sampling.supersampling(samples, "ray-traced") ** 2 == squared


@pytest.fixture(scope="session")
def flight(tmp_path_factory) -> Path:
    """A .blend in which a camera flies round a mirror ball beside a box."""
    scene = empty_scene()
    add_camera(scene, (0.0, -6.0, 2.0), (1.25, 0.0, 0.0))
    add_sphere(scene, "Ball", 1.0, principled("Silver", (1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0), (0.0, 0.0, 1.0))
    add_plane(scene, "Floor", 8.0, principled("Red", (0.8, 0.1, 0.1)))
    add_box(scene, "Box", 1.0, principled("Blue", (0.1, 0.1, 0.8)), (1.8, -0.5, 0.5))
    fly(scene)
    path = tmp_path_factory.mktemp("scenes") / "flight.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    return path


@pytest.fixture
def compare(flight, tmp_path, monkeypatch):
    """Compare without saying how many samples; returns the rows. Few are enough, so that it is soon done."""
    monkeypatch.setattr(sampling, "MOST", 128)
    monkeypatch.setattr(sampling, "LEAST", 32)
    monkeypatch.setattr(sampling, "NOISE", BOUND)

    def run(*options: str) -> list[dict]:
        arguments = ["compare", str(flight), "--out", str(tmp_path), "--resolution", "48x32", "--no-videos"]
        assert main([*arguments, *options]) == 0
        return json.loads((tmp_path / "results.json").read_text())["results"]

    return run


def test_a_comparison_takes_as_many_as_make_its_noise_low(compare, monkeypatch):
    (row,) = compare("--methods", "ray-traced")
    assert row["settings"]["samples"] == "auto"
    assert 32 < row["samples"]["reference"] < 128
    assert row["samples"]["method"] == sampling.supersampling(row["samples"]["reference"]) ** 2
    assert row["noise"]["over_reflectors"]["flip"] < 1.2 * BOUND  # its pixels differ a little from the middles
    (asked,) = compare("--methods", "ray-traced", "--samples", "32")
    assert (asked["settings"]["samples"], asked["samples"]) == (32, {"reference": 32, "method": 16})
    assert asked["noise"]["over_reflectors"]["flip"] > BOUND
    monkeypatch.setattr(sampling, "NOISE", 1e-6)
    (most,) = compare("--methods", "ray-traced")
    assert most["samples"]["reference"] == 128


def test_the_first_of_several_frames_decides_for_all(compare, monkeypatch):
    first = compare("--methods", "environment-map", "--frames", "1:2")
    assert len({row["samples"]["reference"] for row in first}) == 1
    monkeypatch.setattr(sampling, "NOISE", 1e-6)
    rows = compare("--methods", "environment-map,ray-traced", "--frames", "1:3", "--resume")
    assert {row["samples"]["reference"] for row in rows} == {first[0]["samples"]["reference"]}
    assert len(rows) == 6


def test_without_a_reference_methods_take_what_is_smooth(flight, tmp_path):
    archive = tmp_path / "flight.catoptric"
    assert main(["export", str(flight), "--out", str(archive)]) == 0
    options = ["--out", str(tmp_path), "--resolution", "48x32", "--methods", "environment-map"]
    assert main(["compare", str(archive), *options]) == 0
    (row,) = json.loads((tmp_path / "results.json").read_text())["results"]
    assert row["samples"] == {"reference": None, "method": 16}
