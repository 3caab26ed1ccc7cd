"""mirror-torus: a reflector with a hole, standing upright, and things to be seen through it."""

from . import pictures, shapes, stage


def build() -> None:
    """Build the scene into the open, empty file."""
    torus = shapes.torus(1.0, 0.4, 192, 96).turned(shapes.turn("X", 90.0))
    stage.put("Torus", torus, stage.mirror("Gold", "#ffe3b0"), (0.0, 0.0, 1.4), (0.0, 0.0, 14.0))
    slabs = stage.matte("Slabs", picture=pictures.checkers("#d8cdb8", "#4a5a54"))
    stage.put("Terrace", shapes.disc(14.0, 96, repeat=1.6), slabs, smooth=False)
    gores = ["#d64545", "#f2b134", "#3a86a8", "#f4efe2", "#5a9367", "#7a4b8f"]
    beach = stage.matte("Beach ball", picture=pictures.beach_ball(gores))
    stage.put("Beach ball", shapes.sphere(0.55, 48, 24), beach, (0.25, 2.3, 0.55), (20.0, 15.0, 40.0))
    crate = stage.matte("Crate", picture=pictures.planks(256, 4))
    stage.put("Crate", shapes.box((0.8, 0.8, 0.8)), crate, (-1.75, -0.9, 0.0), (0.0, 0.0, 24.0), smooth=False)
    stage.put("Small crate", shapes.box((0.5, 0.5, 0.5)), crate, (-1.7, -0.95, 0.8), (0.0, 0.0, -10.0), smooth=False)
    cone = shapes.lathe([(0.0, 0.0), (0.42, 0.0), (0.0, 1.15)], 64)
    stage.put("Cone", cone, stage.matte("Coral", "#e0684b"), (1.7, -1.15, 0.0), smooth=False)
    post = shapes.lathe([(0.0, 0.0), (0.2, 0.0), (0.2, 2.4), (0.0, 2.4)], 48, repeat=(2.0, 1.0))
    paint = stage.matte("Post", picture=pictures.stripes(["#24505e", "#e9e1cf"], 1, 4))
    stage.put("Post", post, paint, (-1.0, 3.4, 0.0), smooth=False)
    stage.sky(pictures.Sky(azimuth=232.0, elevation=36.0, cover=0.45, seed=71), sun=3.2, strength=0.9)
    stage.camera((0.5, -6.6, 1.75), (0.0, 0.0, 1.22), 44.0)
