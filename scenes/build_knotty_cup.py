"""knotty-cup: a cup knotted from one strand beside a mirror ball (Table 2; figure 8b)."""

from . import pictures, sculptures, shapes, stage


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Reflector", shapes.sphere(1.0, 128, 64), stage.mirror("Silver"), (-0.55, 0.0, 0.0))
    clay = stage.matte("Clay", "#c8553d")
    stage.put("Knotty cup", sculptures.knotty_cup().moved(scale=0.85), clay, (0.86, -1.02, -0.72), (10.0, 14.0, -50.0))
    stage.sky(pictures.Sky(azimuth=210.0, elevation=40.0, cover=0.45, seed=21), sun=3.0)
    stage.camera((0.15, -7.2, 1.5), (0.12, -0.4, -0.1), 68.0)
