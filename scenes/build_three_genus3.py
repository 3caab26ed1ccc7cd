"""three-genus3: three textured lanterns round a mirror ball (Table 2, "3 genus3s"; figure 9b)."""

from . import pictures, sculptures, shapes, stage

PLACES = (
    ("Genus3 left", ["#d95d39", "#f1c453", "#3c6e71"], (-1.2, -0.88, -0.1), (10.0, -16.0, 0.0)),
    ("Genus3 middle", ["#7a4b8f", "#f4efe2"], (0.05, -1.1, -0.64), (70.0, 10.0, 30.0)),
    ("Genus3 right", ["#24505e", "#e9e1cf", "#a8452f"], (1.2, -0.86, 0.2), (0.0, 18.0, 50.0)),
)


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Reflector", shapes.sphere(1.0, 128, 64), stage.mirror("Silver"))
    shape = sculptures.lantern().moved(scale=0.46)
    for name, colours, location, turned in PLACES:
        paint = stage.matte(name, picture=pictures.stripes(colours, 6, 1))
        stage.subdivide(stage.put(name, shape, paint, location, turned), 3)
    stage.sky(pictures.Sky(azimuth=225.0, elevation=38.0, cover=0.45, seed=41), sun=3.0)
    stage.camera((0.0, -7.4, 1.5), (0.03, 0.0, -0.14), 68.5)
