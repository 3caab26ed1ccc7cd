"""two-balls: two textured balls beside a mirror ball, in the open air (Table 2, "2 balls"; figure 9a)."""

from . import pictures, shapes, stage


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Reflector", shapes.sphere(1.0, 128, 64), stage.mirror("Silver"))
    gores = ["#d64545", "#f2b134", "#3a86a8", "#f4efe2", "#5a9367", "#7a4b8f"]
    beach = stage.matte("Beach ball", picture=pictures.beach_ball(gores))
    marble = stage.matte("Marble", picture=pictures.stripes(["#d95d39", "#f1c453", "#3c6e71"], 3, 1))
    ball = shapes.sphere(0.5, 40, 20)  # 1,520 triangles, as in Table 1
    stage.put("Beach ball", ball, beach, (-1.12, -1.0, 0.25), (25.0, 20.0, 0.0))
    stage.put("Marble", ball, marble, (1.1, -1.05, -0.35), (35.0, -30.0, 10.0))
    stage.sky(pictures.Sky(azimuth=215.0, elevation=38.0, cover=0.45, seed=12), sun=3.0)
    stage.camera((0.1, -7.0, 0.75), (0.0, 0.0, -0.02), 66.0)
