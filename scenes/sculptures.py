"""The objects that stand in for the meshes of Zhang et al., Table 1, each with the paper's number of triangles.

The hollow box has 135 triangles in the paper, and so cannot be closed (3 F = 2 E wants an even
number); ours has 136 and is. The others have the paper's number to the triangle, or within 1 %.
"""

import numpy as np

from .shapes import Shape, joined, lathe, soup, sphere, through, torus, tube, turn


def hollow_box(size: float, wall: float, opening: float) -> Shape:
    """A cube round the origin with a square hole in four sides; the sides at +X and +Z are whole. 136 triangles.

    `size` of an edge, thickness of the `wall` and width of an `opening` in metres.
    """
    frame = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2.0
    outer, inner = size, size - 2.0 * wall
    quads = []
    for axis in range(3):
        for sign in (-1, 1):
            whole = sign > 0 and axis != 1

            def corner(extent, depth, axis=axis, sign=sign):
                points = np.insert(frame[:: 1 if sign > 0 else -1] * extent, 0, sign * depth / 2.0, axis=1)
                return np.roll(points, axis, axis=1)

            hole_out, hole_in = corner(opening, outer), corner(opening, inner)
            quads += _band(corner(outer, outer), hole_out) + _band(hole_in, corner(inner, inner))
            quads += [hole_out, hole_in[::-1]] if whole else _band(hole_out, hole_in)
    return soup(np.array(quads))


def _band(outside: np.ndarray, inside: np.ndarray) -> list[np.ndarray]:
    """The four quads between two squares (4, 3)."""
    following = [1, 2, 3, 0]
    return list(np.stack([outside, outside[following], inside[following], inside], axis=1))


def lantern(twist: float = 100.0) -> Shape:
    """Two poles joined by four arcs that turn round Z by `twist` degrees: the cage of a closed surface of genus 3.

    Its 104 quads, subdivided three times (Catmull-Clark), give 13,312 triangles, the paper's Genus3.
    About 2 m high; texture u runs along an arc, v round it.
    """
    core, thick, steps = 0.24, 0.16, 6
    share = np.linspace(0.0, 1.0, steps + 1)
    slope = np.pi * share  # an arc leaves the upper pole outwards and comes into the lower one inwards
    centre = np.stack([core + 0.78 * np.sin(slope), 0.82 * np.cos(slope)], axis=-1)
    normal = np.stack([np.sin(slope), np.cos(slope)], axis=-1)
    width = core + (thick - core) * np.sin(slope) ** 2
    azimuth = np.radians(twist) * (share - np.sin(2.0 * slope) / (2.0 * np.pi))
    arcs = [_arc(centre, normal, width, thick, azimuth + np.pi / 2 * arc) for arc in range(4)]
    quads = [np.stack([rings[:-1], _next(rings[:-1]), _next(rings[1:]), rings[1:]], axis=2) for rings in arcs]
    u, v = np.meshgrid(share, np.arange(5) / 4.0, indexing="ij")
    grid = np.stack([u, v], axis=-1)
    uvs = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    ends = np.array([rings[[0, 0, -1, -1], [3, 0, 0, 3]] for rings in arcs])  # above and below each pole
    knob = ends[:, 0] * (1.25, 1.25, 1.0) + (0.0, 0.0, 0.3)
    caps = [*_band(ends[:, 0], knob), knob, ends[::-1, 1], ends[:, 2], ends[::-1, 3]]
    cap_uvs = np.broadcast_to([[0.0, 0.0], [0.25, 0.0], [0.25, 0.25], [0.0, 0.25]], (len(caps), 4, 2))
    return soup(
        np.concatenate([np.array(quads).reshape(-1, 4, 3), caps]),
        np.concatenate([np.tile(uvs.reshape(-1, 4, 2), (4, 1, 1)), cap_uvs]),
    )


def _arc(centre, normal, width, thick, azimuth) -> np.ndarray:
    """Corners (N, 4, 3) of the cross-sections of an arc given by radius and height, half sides and azimuth."""
    outward = np.stack([np.cos(azimuth), np.sin(azimuth), 0.0 * azimuth], axis=-1)
    sideways = np.stack([-np.sin(azimuth), np.cos(azimuth), 0.0 * azimuth], axis=-1)
    up = np.array([0.0, 0.0, 1.0])
    middle = centre[:, :1] * outward + centre[:, 1:] * up
    across = thick * (normal[:, :1] * outward + normal[:, 1:] * up)
    along = width[:, None] * sideways
    return np.stack([middle + i * along + j * across for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))], axis=1)


def _next(rings: np.ndarray) -> np.ndarray:
    """Each corner's following corner in its cross-section."""
    return np.roll(rings, -1, axis=1)


KNOT_TURNS, KNOT_PASSES, KNOT_STEPS, KNOT_SIDES, KNOT_RADIUS = 7, 15, 673, 8, 0.038


def knotty_cup() -> Shape:
    """A beaker with an ear, knotted from one endless strand: closed, genus 1, 10,768 triangles, 1.2 m high."""
    return tube(knot_path(), KNOT_RADIUS, KNOT_SIDES)


def knot_path() -> np.ndarray:
    """The middle of the cup's strand, (674, 3) metres, evenly spaced, the first point repeated at the end.

    A torus knot: seven times round the axis, fifteen times round the cross-section of the beaker's
    wall, up outside and down inside. Two neighbouring strands bulge out as the ear.
    """
    turn = np.linspace(0.0, 1.0, 20001)
    azimuth = 2.0 * np.pi * KNOT_TURNS * turn
    phase = 2.0 * np.pi * KNOT_PASSES * turn
    height = (1.0 - np.cos(phase)) / 2.0
    radius = 0.36 + 0.22 * height - 0.1 * np.sin(2.0 * np.pi * height)
    radius += 0.075 * np.sign(np.sin(phase)) * np.sqrt(np.abs(np.sin(phase)))
    number = np.floor(turn * KNOT_PASSES)
    neighbour = pow(KNOT_TURNS, -1, KNOT_PASSES)
    radius += 0.4 * np.isin(number, (0, neighbour)) * np.clip(np.sin(phase), 0.0, 1.0) ** 4
    path = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), 1.2 * height], axis=-1)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    even = np.linspace(0.0, length[-1], KNOT_STEPS + 1)
    even_path = np.stack([np.interp(even, length, path[:, i]) for i in range(3)], axis=-1)
    even_path[-1] = even_path[0]
    return even_path


def dancer() -> Shape:
    """A four-armed dancer in a ring of flames on a lotus: overlapping closed parts, 2.3 m high, facing -Y.

    They become one surface, and dense, by a Remesh modifier where the statue is placed.
    """
    plinth = [(0, 0), (0.56, 0), (0.62, 0.07), (0.48, 0.15), (0.64, 0.25), (0.5, 0.33), (0, 0.33)]
    parts = [lathe(plinth, 48), *_lotus(0.56, 0.2), *_flames(0.95, 1.35)]
    torso = [(0, 0, 1.04), (0.03, 0.0, 1.18), (0.01, -0.02, 1.36), (0.0, 0.0, 1.52), (0.0, 0.0, 1.64), (0, -0.02, 1.74)]
    parts += _limb(torso, (0.17, 0.16, 0.125, 0.18, 0.1, 0.07))
    parts += _limb(
        [(0.08, 0, 1.06), (0.26, -0.2, 0.78), (0.08, -0.08, 0.42), (0.06, -0.24, 0.36)], (0.14, 0.1, 0.06, 0.05)
    )
    parts += _limb(
        [(-0.08, 0, 1.06), (-0.42, -0.3, 1.04), (0.0, -0.44, 0.86), (0.14, -0.54, 0.86)], (0.14, 0.1, 0.06, 0.045)
    )
    for side in (-1, 1):
        shoulder = (0.17 * side, 0, 1.57)
        parts += _limb([shoulder, (0.5 * side, 0.06, 1.48), (0.64 * side, -0.04, 1.86)], (0.085, 0.06, 0.045))
        parts += _limb(
            [shoulder, (0.4 * side, -0.12, 1.3), (0.16 * side, -0.42, 1.4 + 0.1 * side)], (0.08, 0.06, 0.045)
        )
        parts.append(sphere(0.085, 24, 12).moved((0.66 * side, -0.06, 1.95)))
        parts.append(torus(0.1, 0.03, 24, 12).moved((0.09 * side, 0, 1.06)))
    crown = [(0, 0), (0.14, 0.0), (0.15, 0.05), (0.1, 0.1), (0.11, 0.15), (0.06, 0.22), (0.05, 0.3), (0, 0.36)]
    parts += [sphere(1.0, 24, 16).moved((0, -0.03, 1.85), (0.12, 0.13, 0.155)), lathe(crown, 24).moved((0, 0, 1.94))]
    return joined(parts)


def ballerina() -> Shape:
    """A dancer in arabesque on the tip of one foot: overlapping closed parts, 1.6 m high, leaning to +X."""
    parts = _limb([(0, 0, 0), (0.0, 0, 0.12), (0.03, 0, 0.45), (0.0, 0, 0.86)], (0.018, 0.03, 0.048, 0.075))
    parts += _limb(
        [(0.0, 0, 0.86), (-0.26, 0.02, 0.93), (-0.5, 0.03, 1.06), (-0.72, 0.04, 1.17)], (0.08, 0.06, 0.04, 0.015)
    )
    parts += _limb([(0.0, 0, 0.88), (0.05, 0, 1.02), (0.12, 0, 1.18), (0.15, 0, 1.27)], (0.09, 0.068, 0.085, 0.03))
    parts += _limb([(0.15, 0, 1.25), (0.17, 0, 1.34)], (0.032, 0.028))
    parts += _limb([(0.14, 0.08, 1.22), (0.34, 0.12, 1.33), (0.56, 0.08, 1.46)], (0.035, 0.025, 0.012))
    parts += _limb([(0.13, -0.08, 1.22), (0.2, -0.3, 1.24), (0.16, -0.52, 1.3)], (0.035, 0.025, 0.012))
    skirt = [(0.07, 0.04), (0.2, 0.03), (0.34, -0.01), (0.35, -0.025), (0.2, 0.0), (0.07, -0.03), (0.07, 0.04)]
    tutu = lathe(skirt[::-1], 48)
    ruffle = 1.0 + 0.06 * np.sin(12.0 * np.arctan2(tutu.points[:, 1], tutu.points[:, 0]))
    tutu = Shape(tutu.points * np.stack([ruffle, ruffle, np.ones_like(ruffle)], axis=-1), tutu.faces, tutu.uvs)
    tilt = turn("Y", 18.0)
    parts.append(tutu.turned(tilt).moved((0.02, 0.0, 0.93)))
    parts += [
        sphere(1.0, 24, 16).moved((0.19, 0, 1.42), (0.075, 0.065, 0.09)),
        sphere(0.035, 16, 10).moved((0.12, 0, 1.49)),
    ]
    return joined(parts)


def _limb(points, radii) -> list[Shape]:
    """A rounded tube through a few joints (N, 3), of the radii given at them, and a ball at either end."""
    points, radii = np.array(points, dtype=np.float64), np.array(radii)
    path = through(np.concatenate([points, radii[:, None]], axis=1), 8)
    ends = [sphere(radius, 16, 8).moved(point) for point, radius in zip(points[[0, -1]], radii[[0, -1]], strict=True)]
    return [tube(path[:, :3], path[:, 3], 16), *ends]


def _lotus(radius: float, height: float) -> list[Shape]:
    """Sixteen petals standing round a plinth."""
    angles = np.arange(16) * np.pi / 8
    petal = sphere(1.0, 16, 10)
    return [petal.moved((radius * np.cos(a), radius * np.sin(a), height), (0.1, 0.1, 0.17)) for a in angles]


def _flames(radius: float, height: float) -> list[Shape]:
    """An upright ring with twenty-one flames on it."""
    ring = torus(radius, 0.05, 96, 16)
    upright = Shape(ring.points[:, [0, 2, 1]] * (1.0, -1.0, 1.0) + (0.0, 0.1, height), ring.faces, ring.uvs)
    angles = np.radians(np.linspace(-60, 240, 21))
    tongues = []
    for angle in angles:
        out = np.array([np.cos(angle), 0.0, np.sin(angle)])
        root, tip = out * radius, out * (radius + 0.24) + (0.0, 0.0, 0.08)
        tongues += _limb([root, (root + tip) / 2, tip], (0.065, 0.05, 0.015))
    return [upright, *(tongue.moved((0.0, 0.1, height)) for tongue in tongues)]
