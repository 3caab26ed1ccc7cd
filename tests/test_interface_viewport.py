"""Which pictures a viewport asks for, one after the other."""

from types import SimpleNamespace

import bpy
import pytest
from catoptric.addon.interface import viewport
from catoptric.addon.interface.overlays import DEVELOPS
from catoptric.addon.methods.contract import View
from mathutils import Matrix

from .interface_stage import found, registered, small_scene, until

WIDTH, HEIGHT = 48, 32
LENS = Matrix(((1.5, 0, 0, 0), (0, 2.25, 0, 0), (0, 0, -1.02, -2.02), (0, 0, -1, 0)))


class Seen:
    """A viewport and what Blender would tell it: a region, and where it looks from."""

    def __init__(self) -> None:
        self.stage, self.viewport = found(), viewport.Viewport()
        self.viewport._stage = self.stage
        self.region = SimpleNamespace(width=WIDTH, height=HEIGHT)
        self.data = SimpleNamespace(view_matrix=Matrix.Translation((0, 0, -8)), window_matrix=LENS)

    def turn(self) -> None:
        """Turn the camera."""
        self.data.view_matrix = self.data.view_matrix @ Matrix.Rotation(0.1, 4, "Z")

    def draw(self, overlay: str = "PICTURE") -> View:
        """Of the newest picture once Blender has drawn, and the studio as well."""
        context = SimpleNamespace(region=self.region, region_data=self.data, scene=bpy.context.scene)
        self.viewport._ask(context, DEVELOPS[overlay])
        until(lambda: not self.stage.studio.busy)
        return self.stage.studio.picture(self.viewport).view


def sizes(views: list[View]) -> list[tuple[int, int]]:
    """Width and samples."""
    return [(view.width, view.samples) for view in views]


@pytest.fixture
def seen(monkeypatch):
    """Of a scene that takes long to draw."""
    monkeypatch.setattr(viewport, "_REST_S", 0.0)
    with registered():
        small_scene().catoptric.method = "environment-map"
        seen = Seen()
        seen.viewport._pace.took(1, 1.0)
        yield seen
        bpy.context.scene.catoptric.scale = viewport.AUTOMATIC


def test_a_slow_picture_is_coarse_then_whole_then_smooth(seen):
    assert sizes(seen.draw() for _ in range(4)) == [(WIDTH // 2, 1), (WIDTH, 1), (WIDTH, 4), (WIDTH, 4)]
    seen.turn()
    assert sizes(seen.draw() for _ in range(3)) == [(WIDTH // 2, 1), (WIDTH, 1), (WIDTH, 4)]


def test_it_is_coarse_for_as_long_as_anything_moves(seen, monkeypatch):
    seen.draw()
    monkeypatch.setattr(viewport, "_REST_S", 1000.0)
    views = []
    for _ in range(3):
        seen.turn()
        views += [seen.draw(), seen.draw()]
    assert sizes(views) == [(WIDTH // 2, 1)] * 6
    seen.viewport._moved = -1000.0
    seen.stage.read()  # as if an object had moved
    assert sizes([seen.draw(), seen.draw()]) == [(WIDTH // 2, 1)] * 2


def test_what_is_whole_stays_so_when_pictures_turn_out_slow(seen):
    seen.viewport._pace = viewport.Pace(2)
    assert sizes([seen.draw()]) == [(WIDTH, 1)]
    seen.viewport._pace.took(1, 1.0)
    assert sizes([seen.draw()]) == [(WIDTH, 4)]


@pytest.mark.parametrize(("scale", "width"), [("1", WIDTH), ("2", WIDTH // 2)])
def test_a_resolution_that_was_chosen_holds_always(seen, scale, width):
    bpy.context.scene.catoptric.scale = scale
    assert sizes(seen.draw() for _ in range(3)) == [(width, 1), (width, 4), (width, 4)]


def test_what_tells_of_a_move_is_whole_at_once_and_never_smooth(seen):
    assert sizes(seen.draw("RETRACED") for _ in range(2)) == [(WIDTH, 1)] * 2
