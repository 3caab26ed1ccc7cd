"""What tables of a scene are made from is found once, and found anew for what differs."""

from dataclasses import replace

import numpy as np
import trimesh
from catoptric.addon.drawing import world_boxes
from catoptric.addon.drawing.lamps import world_light
from catoptric.addon.scene import Camera, World
from catoptric.addon.tracing import placed_box
from hypothesis import given
from hypothesis import strategies as st

from .stage import mesh_of, placed, scene_of

BALL = mesh_of(trimesh.creation.icosphere(subdivisions=2))


def boxes_of(*parts):
    """The boxes of meshes at matrices."""
    scene = scene_of([(mesh, matrix, False) for mesh, matrix in parts], Camera(np.eye(4)))
    return world_boxes(scene, range(len(parts)))


def test_a_box_holds_the_corners_wherever_the_mesh_is():
    for turn in (0.5, 2.0, 0.5):
        matrix = placed((turn, 0.0, -turn), (1.0, 2.0, 3.0), turn, (1.0, 1.0, 0.0))
        corners = BALL.corners.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
        (box,) = boxes_of((BALL, matrix))
        np.testing.assert_allclose(box, [corners.min(axis=0), corners.max(axis=0)], atol=1e-6)


def test_boxes_of_another_mesh_are_its_own():
    small = replace(BALL, positions=0.5 * BALL.positions)
    whole, half = boxes_of((BALL, placed()), (small, placed()))
    np.testing.assert_allclose(half, 0.5 * whole, atol=1e-6)


def test_a_drag_does_not_fill_the_memory():
    """What is asked for again is found anew once so many places have come after it, and is the same."""
    asked = []
    thing, points = replace(BALL), BALL.positions

    def points_of():
        asked.append(len(asked))
        return points

    boxes = [placed_box(thing, points_of, placed((x, 0.0, 0.0)), most=3) for x in (0.0, 1.0, 0.0, 2.0, 3.0, 0.0)]
    assert len(asked) == 5
    np.testing.assert_array_equal(boxes[0], boxes[-1])


@given(st.floats(0.0, 100.0))
def test_an_even_sky_lights_evenly_however_it_is_given(radiance):
    """An even sky of radiance L lights a surface by π L: by L after the division, in any direction."""
    for world in (World((radiance,) * 3), World(panorama=np.full((64, 128, 3), radiance, np.float32))):
        light = world_light(world)
        np.testing.assert_allclose(0.282095 * light[0], radiance, rtol=0.01, atol=1e-6)
        np.testing.assert_allclose(light[1:], 0.0, atol=0.01 * radiance + 1e-6)


def test_light_of_a_world_is_found_once():
    sky = World(panorama=np.ones((8, 16, 3), np.float32))
    assert world_light(sky) is world_light(sky)
    assert not np.allclose(world_light(sky), world_light(World(panorama=2.0 * sky.panorama)))
