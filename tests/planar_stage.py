"""Scenes of flat mirrors, and when a picture of them is right."""

from dataclasses import replace

import numpy as np
import trimesh
from catoptric.addon.drawing import Clipping

from .mirror_stage import SKY, apart, arch, bent, differing, holed, pane
from .stage import looking, mesh_of, placed, scene_of

BOX, BALL = mesh_of(trimesh.creation.box()), mesh_of(trimesh.creation.icosphere(subdivisions=3), smooth=True)
TORUS = mesh_of(trimesh.creation.torus(0.6, 0.2, major_sections=24, minor_sections=12))
EYE = looking((1.4, -5.5, 1.4))
ABOVE = looking((1.4, -4.5, 2.4), (0.3, -0.5, -1.0))
WALL = placed((0, 1.8, 0.5), (4, 1, 3), turn=0.1)
WAYS = [clipping.value for clipping in Clipping]


def room():
    """A box that is seen from within."""
    shape = trimesh.creation.box()
    shape.invert()
    return mesh_of(shape)


def bevelled():
    """A box with a narrow plane along every edge and corner: 26 planes, more than are mirrors of their own."""
    ends = np.array([(1.0, 0.9, 0.9), (0.9, 1.0, 0.9), (0.9, 0.9, 1.0)])
    signs = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 1, 3)
    return mesh_of(trimesh.convex.convex_hull((0.5 * signs * ends).reshape(-1, 3)))


def things():
    """A box, a ring and the ground."""
    return [
        (BOX, placed((0.2, -0.5, -0.4), (0.5, 0.5, 0.9), turn=0.4), False),
        (TORUS, placed((0.9, 0.6, 0.6), turn=1.0, axis=(1, 0, 0)), False),
        (BOX, placed((0, 0, -1.2), (9, 9, 0.2)), False),
    ]


def standing():
    """What stands on the ground, which is at -1.1."""
    return [(BOX, placed((0.2, -0.5, -0.5), (0.9, 0.5, 1.2), turn=0.4), False), things()[1]]


def before_things(*mirrors, camera=EYE, bounces=4):
    """The mirrors, (mesh, matrix) each, among things."""
    return scene_of([(mesh, at, True) for mesh, at in mirrors] + things(), camera, bounces, world=SKY)


def two_walls(camera=EYE):
    return before_things((pane(), WALL), (pane(), placed((-2.6, 0, 0.5), (3, 1, 3), turn=1.3)), camera=camera)


def three_walls(camera=EYE):
    third = pane(), placed((2.8, 0.4, 0.5), (2.5, 1, 3), turn=-1.1)
    return before_things((pane(), WALL), (pane(), placed((-2.6, 0, 0.5), (3, 1, 3), turn=1.3)), third, camera=camera)


def partly_hidden():
    screen = (BOX, placed((0.3, -1.5, 0.4), (1, 0.3, 1.4)), False)
    return scene_of([(pane(), WALL, True), screen, *things()], EYE, world=SKY)


def in_a_box(camera=None):
    """Six mirrors around a box."""
    eye = camera or looking((1.2, -1.9, 0.6), (0, 0.5, 0), lens=28)
    parts = [(room(), placed(scale=(4, 5, 3)), True), (BOX, placed((0.2, 0.5, -0.4), (0.5, 0.5, 0.9), turn=0.4), False)]
    return scene_of(parts, eye, bounces=3, world=SKY)


def facing(bounces=4):
    """Two mirrors, face to face but for a little, and the viewer in between."""
    far, near = placed((0, 1.0, 0.5), (4, 1, 3)), placed((0, -2.0, 0.5), (6, 1, 4), turn=np.pi + 0.05)
    eye = looking((0.9, -1.6, 1.0), (0.2, 1, 0.6), lens=22)
    return before_things((pane(), far), (pane(), near), camera=eye, bounces=bounces)


SCENES = {
    "one mirror": lambda: before_things((pane(), WALL)),
    "three mirrors": three_walls,
    "partly hidden": partly_hidden,
    "arched": lambda: before_things((arch(), WALL)),
    "with a hole, something behind it": lambda: scene_of(
        [(holed(), WALL, True), (BOX, placed((0.1, 3.5, 0.5)), False), *things()], EYE, world=SKY
    ),
    "an L": lambda: before_things((bent(), WALL)),
    "a block, free-standing": lambda: before_things((BOX, placed((0, 0, 0.5), (1.5, 1.2, 1.9), turn=0.5))),
    "something through the mirror": lambda: before_things((pane(), placed((0, 0.6, 0.5), (4, 1, 3), turn=0.1))),
    "the ground": lambda: scene_of([(BOX, placed((0, 0, -1.2), (9, 9, 0.2)), True), *standing()], ABOVE, world=SKY),
    "ground beyond the far end": lambda: scene_of(
        [(pane(), placed((0, 0, -0.9), (900, 1, 900), np.pi / 2, (1, 0, 0)), True), *standing()],
        replace(ABOVE, far=9.0),
        world=SKY,
    ),
    "from behind": lambda: before_things((pane(), WALL), camera=looking((1.0, 6.5, 2), (0, 0, 0.5))),
    "from behind a block's edge": lambda: before_things(
        (BOX, placed((0, 1.8, 0.5), (4, 0.1, 3))), camera=looking((4.0, 6.5, 2), (0, 0, 0.5))
    ),
    "orthographic": lambda: three_walls(replace(EYE, ortho_scale=6.0)),
    "orthographic, on both sides of the camera": lambda: two_walls(
        replace(looking((0.6, 0.3, 0.75), (0.0, 2.0, 0.5)), ortho_scale=6.0, near=-50.0, far=50.0)
    ),
    "orthographic, in a box": lambda: in_a_box(replace(looking((1.2, -1.9, 0.6), (0, 0.5, 0)), ortho_scale=2.0)),
    "a box of mirrors": in_a_box,
    "bevelled": lambda: before_things((bevelled(), placed((0, 0, 0.5), (2, 1.6, 2), turn=0.5)), bounces=2),
    "face to face": facing,
    "shifted and squeezed": lambda: two_walls(replace(EYE, shift=(0.2, -0.1), pixel_aspect=1.5)),
}


def assert_is_true(frame, expected):
    """Every pixel shows what Embree sees, those at edges what it sees beside; distances as well."""
    assert not apart(frame.color, expected.color).any()
    wrong = differing(frame.color, expected.color)
    assert wrong.mean() < 0.001
    assert ((frame.reflectors > 0.5) == np.isnan(expected.distance)).mean() < 0.001
    far = np.isinf(frame.distance) != np.isinf(expected.distance)
    assert far.mean() < 0.001
    both = np.isfinite(frame.distance) & np.isfinite(expected.distance)
    assert both.sum() > 300
    assert np.percentile(np.abs(frame.distance[both] - expected.distance[both]), 99) < 1e-3


def inside_of(mask, by):
    """The pixels of a mask that are `by` pixels or more from its border."""
    for _ in range(by):
        padded = np.pad(mask, 1)
        mask = mask & padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
    return mask
