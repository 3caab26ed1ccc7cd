"""The stonework of the cathedral as shapes: piers, vaults, arches, windows. Metres; no Blender.

Whatever stands on a floor goes a little way into it, so that nothing lies in the floor's own plane.
"""

import numpy as np

from .shapes import Shape, box, disc, joined, lathe, pointed_arch, sheet, sweep, turn

SUNK = 0.02
PIER_SIDES = 32
STONE = 1.6  # metres in which the stones' texture repeats


def pier(height: float) -> Shape:
    """A round pillar with four shafts against it, on an eight-sided plinth, under a leafy capital."""
    angle = np.linspace(0.0, 2.0 * np.pi, PIER_SIDES + 1)
    lobes = 0.36 + 0.12 * np.maximum(np.cos(4.0 * angle), 0.0) ** 0.7
    octagon = 0.52 / np.cos((angle + np.pi / 8) % (np.pi / 4) - np.pi / 8)
    leaves = 0.5 + 0.05 * np.cos(8.0 * angle)
    rings = [
        (-SUNK, 1.08 * octagon),
        (0.34, 1.08 * octagon),
        (0.44, 1.16 * lobes),
        (0.56, lobes),
        (height - 0.62, lobes),
        (height - 0.56, 1.12 * lobes),
        (height - 0.2, leaves),
        (height - 0.14, 1.05 * octagon),
        (height, 1.05 * octagon),
    ]
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    grid = np.array([np.column_stack([radius[:, None] * circle, np.full(len(angle), z)]) for z, radius in rings])
    return sheet(grid).textured(STONE)


def shaft(low: float, high: float) -> Shape:
    """A thin half column against a wall, from a corbel at `low` to a small capital at `high`."""
    profile = [(0.0, low), (0.17, low + 0.3), (0.11, low + 0.36), (0.11, high - 0.3), (0.2, high - 0.06), (0.2, high)]
    return lathe(profile, 8).textured(STONE)


def vault(width: float, depth: float, springing: float, rise: float, steps: int) -> Shape:
    """The webs of a groin vault over `width` (X) by `depth` (Y), seen from below: two pointed barrels that cross.

    A web's grid goes from the crown (0) to the wall (1), and from the web's own ridge to its groin.
    """
    half = pointed_arch(2.0, 2.0 * rise / width, steps)[steps:]  # from the crown down to the right springing
    share, height = half[:, 0], half[:, 1] * width / 2.0
    out, along = np.meshgrid(share, np.linspace(0.0, 1.0, steps + 1), indexing="ij")
    level = springing + np.interp(out * along, share, height)
    webs = []
    for sign in (1, -1):
        for mirrored in (1, -1):
            x = np.stack([sign * out * width / 2, mirrored * out * along * depth / 2, level], axis=-1)
            y = np.stack([mirrored * out * along * width / 2, sign * out * depth / 2, level], axis=-1)
            webs += [x if sign * mirrored > 0 else x[:, ::-1], y if sign * mirrored < 0 else y[:, ::-1]]
    return joined([sheet(web) for web in webs])


def ribs(width: float, depth: float, springing: float, rise: float, steps: int) -> Shape:
    """The two diagonal ribs of a vault and the boss where they meet."""
    arch = pointed_arch(width, rise, steps)
    length = np.hypot(width, depth)
    direction = np.array([width, depth, 0.0]) / length
    parts = []
    for sign in (1, -1):
        line = direction * (1.0, sign, 1.0)
        path = arch[:, :1] * (length / width) * line + arch[:, 1:] * (0.0, 0.0, 1.0) + (0.0, 0.0, springing)
        parts.append(sweep(path, ROLL, np.cross((0.0, 0.0, 1.0), line)))
    boss = lathe([(0.0, -0.16), (0.2, -0.1), (0.26, 0.04), (0.0, 0.1)], 10).moved((0.0, 0.0, springing + rise - 0.08))
    return joined([*parts, boss]).textured(STONE)


def _roll(width: float, depth: float) -> np.ndarray:
    """The cross-section of a rib: a moulding, open where it lies in the web or the wall above."""
    return np.array([(-1, 0.4), (-1, -0.4), (-0.45, -1), (0.45, -1), (1, -0.4), (1, 0.4)]) * (width, depth)


ROLL = _roll(0.12, 0.14)


def arch(
    span: float, rise: float, springing: float, width: float, depth: float, steps: int, walled: bool = False
) -> Shape:
    """An arch in the plane y = 0, `width` half its thickness along Y, `depth` that of its stones.

    Its back is open, for webs cover it; `walled`, it reaches back into a thinner wall above it.
    """
    line = pointed_arch(span, rise, steps)
    path = np.stack([line[:, 0], 0.0 * line[:, 0], line[:, 1] + springing], axis=-1)
    back = np.array([(0.6, 0.55)]) * (width, depth)  # into the wall that the arch stands proud of
    profile = np.concatenate([back * (-1, 1), _roll(width, depth), back]) if walled else _roll(width, depth)
    return sweep(path, profile, (0.0, 1.0, 0.0)).textured(STONE)


def course(length: float, depth: float, height: float) -> Shape:
    """A band of stones along X on a wall in y = 0 that faces -Y, its middle at z = 0; without ends."""
    half = height / 2.0
    path = np.array([(-length / 2, 0.0, 0.0), (length / 2, 0.0, 0.0)])
    return sweep(path, [(0, -half), (depth, -half), (depth, half), (0, half)], (0.0, -1.0, 0.0)).textured(STONE)


def wall_over_arch(span: float, rise: float, springing: float, width: float, top: float, steps: int) -> Shape:
    """A wall in y = 0, facing -Y, `width` wide, from the springing of an arched opening up to `top`."""
    line = pointed_arch(span, rise, steps)
    x = np.concatenate([[-width / 2], line[:, 0], [width / 2]])
    low = np.concatenate([[springing], line[:, 1] + springing, [springing]])
    bottom = np.stack([x, 0.0 * x, low], axis=-1)
    return sheet(np.stack([bottom, bottom * (1.0, 1.0, 0.0) + (0.0, 0.0, top)])).textured(STONE)


def lancet_pane(width: float, sill: float, springing: float, rise: float, steps: int) -> Shape:
    """The glass of a pointed window in y = 0, facing -Y, showing its texture once."""
    line = pointed_arch(width, rise, steps)
    high = np.stack([line[:, 0], 0.0 * line[:, 0], line[:, 1] + springing], axis=-1)
    low = high * (1.0, 1.0, 0.0) + (0.0, 0.0, sill)
    shape = sheet(np.stack([low, high]))
    corners = shape.points[np.maximum(shape.faces, 0)]
    size = np.array([width, springing + rise - sill])
    return Shape(shape.points, shape.faces, (corners[..., [0, 2]] + (width / 2, -sill)) / size)


def tracery(width: float, sill: float, springing: float, rise: float, steps: int) -> Shape:
    """The stones of that window: its frame, a sill, a mullion, two small arches and a ring over them."""
    line = pointed_arch(width, rise, steps)
    feet = np.array([[-width / 2, sill - springing], [width / 2, sill - springing]])
    outline = np.concatenate([feet[:1], line, feet[1:]]) + (0.0, springing)
    frame = sweep(_upright(outline), _moulding(0.13, 0.14), (0.0, -1.0, 0.0))
    ledge = box((width + 0.3, 0.36, 0.14)).moved((0.0, 0.0, sill - 0.14))
    mullion = box((0.09, 0.15, springing - sill + 0.1)).moved((0.0, -0.035, sill - 0.05))
    small = pointed_arch(width / 2, width * 0.36, max(steps // 2, 2)) + (0.0, springing - 0.15)
    arches = [sweep(_upright(small + (sign * width / 4, 0.0)), _BAR, (0.0, -1.0, 0.0)) for sign in (-1, 1)]
    ring = _ring(width * 0.17, 12).moved((0.0, 0.0, springing + rise * 0.56))
    return joined([frame, ledge, mullion, *arches, ring]).textured(STONE)


def _moulding(width: float, depth: float) -> np.ndarray:
    """The cross-section of a frame, open where it lies on the wall, `width` to either side."""
    return np.array([(-0.02, -width), (depth, -0.6 * width), (depth, 0.6 * width), (-0.02, width)])


_BAR = _moulding(0.05, 0.06)


def _upright(line: np.ndarray) -> np.ndarray:
    """(N, 2) of X and Z as points in y = 0."""
    return np.insert(line, 1, 0.0, axis=1)


def _ring(radius: float, sides: int, profile: np.ndarray = _BAR) -> Shape:
    """A round moulding in y = 0 about the origin."""
    angle = np.linspace(0.0, -2.0 * np.pi, sides + 1)
    return sweep(_upright(radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)), profile, (0.0, -1.0, 0.0))


def rose_pane(radius: float, segments: int) -> Shape:
    """The glass of a round window in y = 0, facing -Y, showing its texture once."""
    return disc(radius, segments, 2.0 * radius).turned(turn("X", 90.0))


def rose_tracery(radius: float, petals: int) -> Shape:
    """The stones of that window: two rings, spokes between them, and a small ring at the end of each petal."""
    parts = [_ring(radius, 2 * petals, _moulding(0.2, 0.22)), _ring(radius * 0.3, petals)]
    for number in range(petals):
        around = turn("Y", 360.0 * (number + 0.5) / petals)
        spoke = box((0.08, 0.1, radius * 0.68)).moved((0.0, 0.0, radius * 0.31))
        eye = _ring(radius * 0.16, 8).moved((0.0, 0.0, radius * 0.8))
        parts += [spoke.turned(around), eye.turned(turn("Y", 360.0 * number / petals))]
    return joined(parts).textured(STONE)
