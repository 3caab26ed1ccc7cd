"""Captured cubes: what they show exactly, against closed forms and Embree."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from catoptric.addon.errors import Cancelled
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.environment_map import EnvironmentMap, EnvironmentMapDynamic, EnvironmentMapParallax
from catoptric.addon.scene import Lighting, World

from .stage import Judge, camera_rays, looking, mesh_of, mirrored, placed, scene_of

SIZE = (96, 72)
BALL = (mesh_of(trimesh.creation.icosphere(subdivisions=4), smooth=True), placed(), True)


def frame_of(scene, method):
    drawn = method({"size": 256})
    drawn.prepare(scene, Lighting.UNLIT)
    try:
        return drawn.render(View(scene.camera, *SIZE, 1))
    finally:
        drawn.release()


def met_by_mirror(scene):
    """What each pixel's reflected ray meets, and its direction; NaN directions off the ball."""
    judge = Judge(scene)
    origins, directions = camera_rays(scene.camera, *SIZE)
    first = judge.meet(origins, directions)
    mirror = first.instance == 0
    met = judge.meet(*mirrored(first, directions))
    bounced = mirrored(first, directions)[1]
    bounced[~mirror] = np.nan
    return met, bounced.reshape(*SIZE[::-1], 3), mirror.reshape(SIZE[::-1])


def open_scene():
    """A ball on a floor, under a sky whose colour is its direction."""
    floor = (mesh_of(trimesh.creation.box((8, 8, 0.2))), placed((0, 0, -1.3)), False)
    scene = scene_of([BALL, floor], looking((0.5, -5.0, 1.5)))
    v, u = np.mgrid[0:128, 0:256]
    azimuth, height = 2 * np.pi * (0.5 - (u + 0.5) / 256), np.pi * ((v + 0.5) / 128 - 0.5)
    sky = np.stack([np.cos(azimuth) * np.cos(height), np.sin(azimuth) * np.cos(height), np.sin(height)], axis=-1)
    return replace(scene, world=World(panorama=np.float32(2.0 + sky)))


def test_an_open_box_shows_the_sky_by_direction():
    scene = open_scene()
    met, bounced, mirror = met_by_mirror(scene)
    sky = mirror & (met.instance.reshape(mirror.shape) < 0)
    assert sky.sum() > 300
    frame, plain = (frame_of(scene, method) for method in (EnvironmentMapParallax, EnvironmentMap))
    right, too_low = (np.abs(each.color[sky] - (2.0 + bounced[sky])).max(axis=-1) < 0.02 for each in (frame, plain))
    assert right.mean() > 0.97 > too_low.mean()  # the rest lies at the floor's edge
    assert np.isinf(frame.distance[sky]).mean() > 0.97


def test_an_open_box_shows_the_floor_where_it_is():
    scene = open_scene()
    met, _, mirror = met_by_mirror(scene)
    floor = mirror & (met.instance.reshape(mirror.shape) == 1)
    assert floor.sum() > 100
    frame = frame_of(scene, EnvironmentMapParallax)
    assert (np.abs(frame.color[floor] - (2.0, 1.0, 0.0)).max(axis=-1) < 0.02).mean() > 0.97


@pytest.mark.parametrize("away", [0.0, 1.1])
def test_a_room_s_walls_are_where_they_are(away):
    eye = np.eye(3)
    walls = [
        (mesh_of(trimesh.creation.box()), placed(3.0 * side * eye[axis], np.where(eye[axis], 1e-3, 6.0)), False)
        for axis in range(3)
        for side in (1, -1)
    ]
    ball = (BALL[0], placed((away, 0.3 * away, 0.0)), True)
    scene = scene_of([ball, *walls], looking((-1.5, -2.5, 1.0), (away, 0, 0), lens=35))
    met, _, mirror = met_by_mirror(scene)
    frame = frame_of(scene, EnvironmentMapParallax)
    wanted = met.instance.reshape(mirror.shape)[mirror] + 1.0
    assert (np.abs(frame.color[mirror][:, 0] - wanted) < 1e-3).mean() > 0.95
    np.testing.assert_allclose(
        np.median(frame.distance[mirror] / met.distance.reshape(mirror.shape)[mirror]), 1.0, atol=1e-3
    )


def three_balls():
    """Mirror balls in a row on a floor."""
    ball, floor = BALL[0], mesh_of(trimesh.creation.box((12, 12, 0.2)))
    balls = [(ball, placed((x, 0.0, 0.0)), True) for x in (-2.5, 0.0, 2.5)]
    return scene_of([*balls, (floor, placed((0, 0, -1.3)), False)], looking((0.5, -8.0, 1.5)))


def test_a_capture_tells_how_far_it_is():
    told, drawn = [], EnvironmentMap({"size": 32})
    drawn.prepare(three_balls(), Lighting.UNLIT, lambda stage, fraction: told.append((stage, fraction)))
    drawn.release()
    assert [part for stage, part in told if stage == "capturing environment cubes"] == pytest.approx([0, 1 / 3, 2 / 3])


def test_a_capture_that_was_stopped_can_be_begun_again():
    def stop(stage, fraction):
        if stage == "capturing environment cubes" and fraction > 0.5:
            raise Cancelled

    scene, drawn = three_balls(), EnvironmentMap({"size": 256})
    with pytest.raises(Cancelled):
        drawn.prepare(scene, Lighting.UNLIT, stop)
    drawn.update(scene)
    picture = drawn.render(View(scene.camera, *SIZE, 1)).color
    drawn.release()
    np.testing.assert_array_equal(picture, frame_of(scene, EnvironmentMap).color)


def test_a_cube_of_every_frame_shows_what_one_of_this_frame_does():
    scene = three_balls()
    once, always = (frame_of(scene, method).color for method in (EnvironmentMap, EnvironmentMapDynamic))
    np.testing.assert_array_equal(once, always)
