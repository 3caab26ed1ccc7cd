"""statue: a four-armed dancer, dense and closed, before a mirror ball (Table 2, "Buddha"; figure 1).

The file holds a few thousand points; modifiers melt them into one surface of about 130,000
triangles when it is opened.
"""

import bpy

from . import pictures, sculptures, shapes, stage

VOXEL = 0.01497  # metres: gives the paper's 129,484 triangles, within 1 %


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Reflector", shapes.sphere(1.2, 128, 64), stage.mirror("Silver"), (-0.75, 0.4, 0.9))
    dancer = stage.put(
        "Statue", sculptures.dancer(), stage.matte("Bronze", "#b98a45"), (0.92, -1.2, -0.2), (0.0, 0.0, -48.0)
    )
    _melt(dancer)
    stage.sky(pictures.Sky(azimuth=215.0, elevation=42.0, cover=0.45, seed=52), sun=3.0)
    stage.camera((0.2, -8.4, 1.9), (0.16, 0.0, 0.98), 62.0)


def _melt(thing) -> None:
    """Melt the overlapping parts into one closed surface, soften their joints and hammer it."""
    melt = thing.modifiers.new("Remesh", "REMESH")
    melt.mode, melt.voxel_size, melt.use_smooth_shade = "VOXEL", VOXEL, True
    soften = thing.modifiers.new("Smooth", "SMOOTH")
    soften.factor, soften.iterations = 0.5, 6
    hammer = bpy.data.textures.new("Hammered", "CLOUDS")
    hammer.noise_scale = 0.06
    dents = thing.modifiers.new("Hammered", "DISPLACE")
    dents.texture, dents.texture_coords, dents.strength, dents.mid_level = hammer, "LOCAL", 0.012, 0.5
