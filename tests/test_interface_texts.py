"""What the panel says."""

import pytest
import trimesh
from catoptric.addon.interface.texts import ago, count_of, drawn_by, listed, reflectors_of, sentence, size_of, wrapped
from catoptric.addon.methods.auto import Choice
from hypothesis import given
from hypothesis import strategies as st

from .stage import looking, mesh_of, placed, scene_of


@given(st.text(alphabet=st.characters(categories=["L", "N", "P"]), min_size=1, max_size=200), st.floats(1, 2000))
def test_wrapping_loses_nothing(text, width):
    assert "".join(wrapped(text, width)) == text


@given(st.lists(st.text("abc", min_size=1, max_size=12), min_size=1), st.floats(200, 2000), st.floats(0.5, 3))
def test_lines_fit(words, width, scale):
    for line in wrapped(" ".join(words), width, scale):
        assert len(line) <= max(16, width / (6.5 * scale))


@pytest.mark.parametrize(
    ("count", "said"),
    [
        (0, "0 bytes"),
        (999, "999 bytes"),
        (1500, "1.5 KB"),
        (15_000, "15 KB"),
        (226_059_000, "226 MB"),
        (3.2e9, "3.2 GB"),
    ],
)
def test_sizes(count, said):
    assert size_of(count) == said


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (-3, "0 s ago"),
        (40, "40 s ago"),
        (600, "10 min ago"),
        (7200, "2 h ago"),
        (1e6, "12 days ago"),
    ],
)
def test_times(seconds, said):
    assert ago(seconds) == said


def test_a_reflector_s_line_names_the_choice_and_what_was_asked_for():
    assert drawn_by("Ball", "layered-depth", None) == "Ball: Layered depth"
    assert drawn_by("Ball", "auto", Choice("environment-map", "far")) == "Ball: Environment map (Auto)"
    assert drawn_by("Ball", "environment-map", Choice("environment-map", "")) == "Ball: Environment map"


def test_instances_of_one_object_are_one_reflector():
    ball = mesh_of(trimesh.creation.icosphere(subdivisions=1))
    scene = scene_of([(ball, placed((shift, 0, 0)), True) for shift in range(3)], looking((0, -5, 0)))
    names = [one.name for one in scene.instances]
    assert list(reflectors_of(scene)) == names if "[" not in "".join(names) else names[:1]


def test_lists_are_short():
    assert listed(["a", "b"]) == '"a", "b"'
    assert listed(["a", "b", "c", "d", "e"]) == '"a", "b", "c" and 2 more'
    assert count_of(["a"], "reflector", "reflectors") == "1 reflector"
    assert sentence("it is Blender") == "It is Blender"
