"""mirror-bowl: a concave reflector, with things lying in it and a lantern floating above."""

import numpy as np

from . import pictures, sculptures, shapes, stage

RADIUS, WALL = 1.5, 0.06


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Bowl", _bowl(), stage.mirror("Steel", "#f2f2f2"))
    wood = stage.matte("Table", picture=pictures.planks(384))
    stage.put("Table", shapes.disc(4.5, 96, repeat=2.4), wood, smooth=False)
    gores = ["#d64545", "#f4efe2", "#3a86a8", "#f4efe2", "#f2b134", "#f4efe2"]
    ball = stage.matte("Ball", picture=pictures.beach_ball(gores))
    stage.put("Ball", shapes.sphere(0.34, 48, 24), ball, (-0.42, -0.05, 0.465), (30.0, -25.0, 0.0))
    die = stage.matte("Die", picture=pictures.checkers("#e9e1cf", "#24505e"))
    stage.put("Die", shapes.box((0.42, 0.42, 0.42)), die, (0.42, 0.3, 0.24), (18.0, -24.0, 30.0), smooth=False)
    ring = stage.matte("Ring", "#e0684b")
    stage.put("Ring", shapes.torus(0.24, 0.085, 48, 24), ring, (0.36, -0.42, 0.3), (22.0, -20.0, 0.0))
    paint = stage.matte("Lantern", picture=pictures.stripes(["#7a4b8f", "#f1c453"], 6, 1))
    lantern = stage.put("Lantern", sculptures.lantern().moved(scale=0.42), paint, (0.15, 0.62, 1.55), (8.0, 12.0, 0.0))
    stage.subdivide(lantern, 3)
    stage.sky(pictures.Sky(azimuth=240.0, elevation=48.0, cover=0.45, seed=61), sun=3.0)
    stage.camera((0.0, -4.4, 5.0), (0.0, 0.12, 0.76), 50.0)


def _bowl() -> shapes.Shape:
    """A round bowl with a wall and a small foot: up outside, over the lip, down inside to the axis."""
    angle = np.radians(np.linspace(-62.0, 0.0, 49))
    outside = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * RADIUS
    rim = np.radians(np.linspace(0.0, 180.0, 9)[1:-1])
    lip = np.stack([RADIUS - WALL / 2 + np.cos(rim) * WALL / 2, np.sin(rim) * WALL / 2], axis=-1)
    angle = np.radians(np.linspace(0.0, -90.0, 65))
    inside = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * (RADIUS - WALL)
    inside[-1, 0] = 0.0
    base = RADIUS * 0.98
    foot = [(0.0, -base), (0.3, -base), (0.62, -base), (0.66, -0.95 * RADIUS)]
    profile = np.concatenate([foot, outside, lip, inside])
    return shapes.lathe(profile, 128).moved((0.0, 0.0, base + 0.001))
