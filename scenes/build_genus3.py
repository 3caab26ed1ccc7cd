"""genus3: a lantern of four winding arcs, a closed surface of genus 3, beside a mirror ball (Table 2; figure 8a)."""

from . import pictures, sculptures, shapes, stage


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Reflector", shapes.sphere(1.0, 128, 64), stage.mirror("Silver"), (-0.5, 0.0, 0.0))
    shape = sculptures.lantern().moved(scale=0.66)
    lantern = stage.put("Genus3", shape, stage.matte("Jade", "#5fa777"), (0.86, -0.98, -0.1), (12.0, 14.0, 20.0))
    stage.subdivide(lantern, 3)
    stage.sky(pictures.Sky(azimuth=200.0, elevation=36.0, cover=0.45, seed=33), sun=3.0)
    stage.camera((0.2, -7.2, 1.1), (0.1, -0.3, -0.02), 66.0)
