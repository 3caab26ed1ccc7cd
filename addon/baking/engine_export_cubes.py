"""Captured cubes as engines take them: faces in a cube map's own orientation, and the cross they unfold to."""

import numpy as np

CUBE_FACES = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")
"""A cube map's faces in the order of OpenGL, Vulkan and KTX2."""

_SOURCES = ((0, 0), (1, 0), (4, 2), (5, 0), (2, -1), (3, 1))
"""Of each face: the captured face of the house's order, and its quarter turns anticlockwise.

A cube map is left-handed with Y up and Z ahead, so the world's (x, y, z) is its (x, z, y).
"""

_CELLS = ((2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (3, 1))
"""Column and row of each face in the cross."""

_AXES = (
    ("+X", "-Y", "+Z"),
    ("-X", "+Y", "+Z"),
    ("+Z", "+X", "-Y"),
    ("-Z", "+X", "+Y"),
    ("+Y", "+X", "+Z"),
    ("-Y", "-X", "+Z"),
)
"""Of each face, as directions of the world: where it looks, its right and its up."""


def cube_map(captured: np.ndarray) -> np.ndarray:
    """(6, N, N, 3) faces in the order of CUBE_FACES, row 0 the top, of one cube that `EnvironmentCubes.read` gave.

    `captured` is (6, N + 2, N + 2, 3), row 0 at the bottom, with a border of one texel.
    """
    upright = captured[:, -2:0:-1, 1:-1]
    return np.stack([np.rot90(upright[source], turns) for source, turns in _SOURCES])


def cross(faces: np.ndarray) -> np.ndarray:
    """(3 N, 4 N, 3) horizontal cross of `faces` (6, N, N, 3), row 0 the top; black beside the faces."""
    size = faces.shape[1]
    unfolded = np.zeros((3, size, 4, size, 3), faces.dtype)
    for face, (column, row) in zip(faces, _CELLS, strict=True):
        unfolded[row, :, column] = face
    return unfolded.reshape(3 * size, 4 * size, 3)


def cross_layout(size: int) -> dict[str, dict[str, object]]:
    """Of each face: its upper left texel in a cross of faces of `size` texels, and its directions in the world."""
    return {
        name: {"left": column * size, "top": row * size, "looks": looks, "right": right, "up": up}
        for name, (column, row), (looks, right, up) in zip(CUBE_FACES, _CELLS, _AXES, strict=True)
    }
