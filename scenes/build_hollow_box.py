"""hollow-box: a box with openings touches a mirror ball with one of its edges (Table 2; figure 7)."""

import numpy as np
from mathutils import Matrix

from . import pictures, sculptures, shapes, stage

SIZE, WALL, OPENING = 1.1, 0.08, 0.66
SEGMENTS, RINGS = 128, 64
GAP = 0.0002  # metres: near enough to touch, and no two faces coincide


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Reflector", shapes.sphere(1.0, SEGMENTS, RINGS), stage.mirror("Silver"))
    box = sculptures.hollow_box(SIZE, WALL, OPENING)
    thing = stage.put("Hollow box", box, stage.matte("Enamel", "#e2932f"), smooth=False)
    # At a vertex of the ball, so that the two meshes touch there and not only the ideal sphere.
    thing.matrix_world = _touching(azimuth=-14 * 2 * np.pi / SEGMENTS, elevation=4 * np.pi / RINGS)
    stage.sky(pictures.Sky(azimuth=205.0, elevation=35.0, cover=0.45, seed=7), sun=3.0)
    stage.camera((0.6, -7.0, 1.5), (0.42, 0.0, 0.02), 62.0)


def _touching(azimuth: float, elevation: float) -> Matrix:
    """The box's place: the middle of the edge between its -X and +Y sides rests on the ball (angles in radians)."""
    level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    outward = level * np.cos(elevation) + np.array([0.0, 0.0, np.sin(elevation)])
    along = np.array([0.0, 0.0, 1.0]) - outward * np.sin(elevation)
    along /= np.linalg.norm(along)
    sideways = np.cross(along, outward)
    # The box's diagonal (1, -1, 0) points away from the ball, its Z axis runs along the edge.
    axes = np.stack([outward + sideways, sideways - outward, np.sqrt(2.0) * along], axis=1) / np.sqrt(2.0)
    centre = outward * (1.0 + GAP + SIZE / np.sqrt(2.0))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, centre
    return Matrix(matrix.tolist())
