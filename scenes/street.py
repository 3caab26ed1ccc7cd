"""Houses and street furniture as lists of parts, pairs of a shape and a material, for `stage.assemble`. Metres.

All face -Y. Whatever stands on the street goes a little way into it, so that nothing lies in its plane.
"""

from dataclasses import dataclass

import numpy as np

from . import furniture, shapes, stage, surfaces

SUNK = 0.03


@dataclass(frozen=True)
class House:
    """A house's front: its `width`, storeys above the ground floor, columns of windows, and its look.

    `shop` is lettered over the ground floor's window ("" for none), `lit` seeds which windows are.
    """

    width: float
    storeys: int
    columns: int
    wall: object
    trim: object
    awning: tuple[str, str] = ("#8c2f2f", "#efe6d4")
    shop: str = ""
    lit: int = 1

    @property
    def height(self) -> float:
        """Where its roof begins."""
        return 3.7 + 3.0 * self.storeys


class Glass:
    """The panes of all houses: three lit rooms, a dark one, and a shop's window."""

    def __init__(self) -> None:
        rooms = (("#ffc97a", "#b5533c"), ("#ffd9a0", "#5f7a5a"), ("#ffb765", "#7a5a8a"))
        self.lit = [
            stage.glowing(f"Lit window {seed}", "#ffc97a", 2.2, surfaces.lit_window(wall, curtain, seed))
            for seed, (wall, curtain) in enumerate(rooms)
        ]
        self.dark = stage.matte("Dark window", "#303a4c", surfaces.dark_window(), 90)
        self.shop = stage.glowing("Shop window", "#ffd08a", 2.6, surfaces.shelves())


def house(kind: House, glass: Glass, roof) -> list:
    """A house whose front is y = 0, its middle at x = 0."""
    depth, random = 5.0, np.random.default_rng(kind.lit)
    body = shapes.box((kind.width, depth, kind.height + SUNK)).moved((0.0, depth / 2, -SUNK))
    parts = [(body.textured(1.6), kind.wall)]
    bands = ((0.16, 0.2, 3.35), (0.16, 0.2, kind.height - 0.12), (0.08, 0.5, 0.25 - SUNK))
    parts += [(_band(kind.width, *band), kind.trim) for band in bands]
    ends = np.array([(-kind.width / 2, 0.0, kind.height), (kind.width / 2, 0.0, kind.height)])
    rise = np.array([(0.0, 0.05, -0.02), (0.0, -0.3, -0.08), (0.0, -0.3, 0.0), (0.0, depth / 2, 2.1)])
    slope = shapes.sheet(ends[None] + rise[:, None])
    parts.append((slope.textured(2.0), roof))
    for column in range(kind.columns):
        x = kind.width * ((column + 0.5) / kind.columns - 0.5)
        for storey in range(kind.storeys):
            pane = glass.lit[random.integers(len(glass.lit))] if random.random() < 0.6 else glass.dark
            parts += _window((1.05, 1.6), (x, 4.35 + 3.0 * storey), pane, kind.trim)
    return parts + _ground_floor(kind, glass)


def _band(width: float, depth: float, height: float, z: float) -> shapes.Shape:
    """A course along the front, a hair shorter than the house."""
    return shapes.box((width - 0.004, depth, height)).moved((0.0, 0.04 - depth / 2, z - height / 2))


def _window(size, place, pane, trim, bars: tuple[int, int] = (1, 2)) -> list:
    """A window of `size` whose sill's middle is at `place`: pane, frame, glazing bars, sill and lintel."""
    (width, height), (x, z) = size, place
    rim = np.array([(-width / 2, 0.0), (width / 2, 0.0), (width / 2, height), (-width / 2, height)])
    shapes_of_trim = [furniture.frame(rim, 0.09, 0.07, 1.0)]
    for number in range(bars[0]):
        across = width * ((number + 1) / (bars[0] + 1) - 0.5)
        shapes_of_trim.append(shapes.box((0.045, 0.04, height)).moved((across, -0.03, 0.0)))
    for number in range(bars[1]):
        up = height * (number + 1) / (bars[1] + 1) - 0.02
        shapes_of_trim.append(shapes.box((width, 0.03, 0.04)).moved((0.0, -0.03, up)))
    shapes_of_trim.append(shapes.box((width + 0.34, 0.2, 0.09)).moved((0.0, -0.09, -0.15)))
    shapes_of_trim.append(shapes.box((width + 0.4, 0.14, 0.14)).moved((0.0, -0.06, height + 0.1)))
    parts = [(shapes.pane(rim).moved((0.0, -0.012, 0.0)), pane)]
    parts += [(shape, trim) for shape in shapes_of_trim]
    return [(shape.moved((x, 0.0, z)), material) for shape, material in parts]


def _ground_floor(kind: House, glass: Glass) -> list:
    """A door, and beside it a shop under its awning or a window."""
    side = kind.width * 0.5 - 0.95
    paint = stage.matte(f"Door {kind.lit}", ("#28493b", "#6b2430", "#2b3f66", "#5a4326")[kind.lit % 4])
    parts = [(shapes.box((1.1, 0.1, 2.3 + SUNK)).moved((side, -0.03, -SUNK)), paint)]
    for x, z in ((-0.25, 0.3), (0.25, 0.3), (-0.25, 1.15), (0.25, 1.15)):
        parts.append((shapes.box((0.36, 0.04, 0.7)).moved((side + x, -0.085, z)), paint))
    parts += _window((1.0, 0.4), (side, 2.45), glass.lit[0], kind.trim, (1, 0))
    if not kind.shop:
        return parts + _window((1.3, 1.6), (-0.6, 1.0), glass.lit[kind.lit % 3], kind.trim)
    width = kind.width - 2.6
    parts += _window((width, 1.7), (-0.85, 0.75), glass.shop, kind.trim, (3, 0))
    cloth = stage.matte(f"Awning {kind.lit}", kind.awning[0], surfaces.awning(*kind.awning), 90)
    neon = ("#ff5a4a", "#59d0ff", "#ffd24a", "#7dff9a")[kind.lit % 4]
    letters = stage.glowing(f"Sign {kind.lit}", neon, 4.0, lamp=False)
    parts.append((_awning(width + 0.3).moved((-0.85, 0.0, 2.98)), cloth))
    return parts + _sign(kind.shop, letters, paint, (0.2, -0.2, 4.35))


def _sign(text: str, letters, board, place) -> list:
    """A board that stands out from the front, lettered on both of its sides."""
    writing = stage.lettering(text, 0.42, 0.05)
    wide = np.ptp(writing.points[:, 0]) + 0.3
    panel = shapes.box((0.1, wide, 0.66)).moved((0.0, -wide / 2, -0.33))
    parts = [(panel, board), (shapes.box((0.05, 0.3, 0.05)).moved((0.0, 0.05, 0.2)), board)]
    for turned in (90.0, -90.0):
        side = writing.moved((0.0, -0.045, 0.0)).turned(shapes.turn("Z", turned)).moved((0.0, -wide / 2, 0.0))
        parts.append((side, letters))
    return [(shape.moved(place), material) for shape, material in parts]


def _awning(width: float) -> shapes.Shape:
    """A sloping cloth over a shop, with a hanging edge; both of its sides are modelled."""
    rows = np.array([(0.0, 0.0), (-1.15, -0.42), (-1.16, -0.64), (-1.14, -0.64), (-1.13, -0.44), (0.0, -0.025)])
    x = np.array([width / 2, -width / 2])
    cloth = shapes.sheet(np.stack([np.stack([x, [y, y], [z, z]], axis=-1) for y, z in rows]), (width / 0.5, 1.0))
    left = np.insert(rows[[[5, 4, 1, 0], [4, 3, 2, 1]]], 0, -width / 2, axis=2)
    return shapes.joined([cloth, shapes.soup(left), shapes.soup(left[:, ::-1] * (-1, 1, 1))])


def lantern(iron, light) -> list:
    """A cast-iron street lamp, 4 m high: a fluted post, a ladder bar, a six-sided lantern."""
    post = [
        (0.0, -SUNK),
        (0.2, -SUNK),
        (0.2, 0.12),
        (0.13, 0.2),
        (0.14, 0.75),
        (0.09, 0.85),
        (0.06, 0.95),
        (0.045, 2.9),
    ]
    post += [(0.08, 2.95), (0.05, 3.05), (0.09, 3.15), (0.0, 3.15)]
    glass = [(0.0, 3.16), (0.11, 3.16), (0.2, 3.62), (0.0, 3.62)]
    cap = [(0.0, 3.6), (0.26, 3.6), (0.24, 3.66), (0.1, 3.82), (0.05, 3.84), (0.06, 3.9), (0.0, 3.98)]
    bar = shapes.tube(np.array([(-0.32, 0.0, 2.8), (0.32, 0.0, 2.8)]), 0.02, 10)
    parts = [
        (shapes.lathe(post, 20), iron),
        (shapes.lathe(cap, 12), iron),
        (bar, iron),
        (shapes.lathe(glass, 6), light),
    ]
    for number in range(6):
        low, high = np.array((0.118, 0.0, 3.15)), np.array((0.21, 0.0, 3.63))
        rib = shapes.tube(np.stack([low, high]), 0.012, 6).turned(shapes.turn("Z", 60.0 * number))
        parts.append((rib, iron))
    return parts


def phone_box(red, light) -> list:
    """A red telephone box, 2.6 m high, lit within."""
    half = 0.45
    parts = [(shapes.box((0.94, 0.94, 0.16 + SUNK)).moved((0, 0, -SUNK)), red)]
    parts += [(shapes.box((0.12, 0.12, 2.2)).moved((x * 0.4, y * 0.4, 0.15)), red) for x in (-1, 1) for y in (-1, 1)]
    parts.append((shapes.box((0.7, 0.7, 1.98)).moved((0, 0, 0.2)), light))
    for turned in (0.0, 90.0, 180.0, 270.0):
        spin = shapes.turn("Z", turned)
        bars = [shapes.box((0.03, 0.05, 1.98)).moved((x, -0.37, 0.2)) for x in (-0.2, 0.2)]
        bars += [shapes.box((0.7, 0.04, 0.04)).moved((0.0, -0.37, 0.45 + 0.24 * row)) for row in range(7)]
        bars.append(shapes.box((0.7, 0.08, 0.3)).moved((0.0, -0.38, 0.15)))
        parts += [(bar.turned(spin), red) for bar in bars]
        sign = shapes.box((0.6, 0.02, 0.13)).moved((0.0, -0.475, 2.23))
        parts.append((sign.turned(spin), light))
        curve = np.linspace(0.0, np.pi, 13)
        crown = np.stack([half * np.cos(curve), 0 * curve, 0.13 * np.sin(curve)], axis=-1)
        gable = shapes.sheet(np.stack([crown * (1, 1, 0), crown])[:, ::-1]).moved((0.0, -0.43, 2.44))
        parts.append((gable.turned(spin), red))
    parts.append((shapes.box((0.94, 0.94, 0.27)).moved((0, 0, 2.17)), red))
    dome = np.stack([0.6 * np.cos(np.linspace(0, np.pi / 2, 7)), 0.24 * np.sin(np.linspace(0, np.pi / 2, 7))], axis=-1)
    dome[-1, 0] = 0.0
    square = shapes.lathe(dome, 4).turned(shapes.turn("Z", 45.0)).moved((0, 0, 2.42))
    return [*parts, (square, red)]


def bicycle(paint, black, steel) -> list:
    """A bicycle along X, its front wheel at +X, leaning against nothing."""
    radius = 0.34
    rear, front, crank = np.array((-0.52, 0, radius)), np.array((0.52, 0, radius)), np.array((-0.08, 0, 0.3))
    seat, head = np.array((-0.22, 0, 0.82)), np.array((0.36, 0, 0.86))
    upright = shapes.turn("X", 90.0)
    parts = []
    for hub in (rear, front):
        tyre = shapes.torus(radius - 0.02, 0.02, 40, 8).turned(upright).moved(hub)
        parts.append((tyre, black))
        for angle in np.linspace(0.0, np.pi, 8, endpoint=False):
            out = (radius - 0.02) * np.array((np.cos(angle), 0.0, np.sin(angle)))
            parts.append((shapes.tube(np.stack([hub - out, hub + out]), 0.003, 4), steel))
    for start, end in ((crank, seat), (crank, head), (seat * (1, 1, 0.96), head), (rear, crank), (rear, seat)):
        parts.append((shapes.tube(np.stack([start, end]), 0.016, 10), paint))
    fork = shapes.through(np.array([head + (-0.02, 0, 0.1), head, (0.43, 0, 0.6), front]), 4)
    parts.append((shapes.tube(fork, 0.014, 10), paint))
    post = np.stack([seat, seat + (-0.03, 0, 0.13)])
    parts += [
        (shapes.tube(post, 0.013, 8), steel),
        (shapes.torus(0.09, 0.006, 24, 6).turned(upright).moved(crank), steel),
    ]
    saddle = shapes.sphere(1.0, 16, 8).moved(seat + (-0.02, 0, 0.15), (0.14, 0.07, 0.035))
    grip = np.array([(0.16, -0.3, 0.96), (0.3, -0.28, 0.99), (0.34, 0.0, 0.97), (0.3, 0.28, 0.99), (0.16, 0.3, 0.96)])
    parts += [(saddle, black), (shapes.tube(shapes.through(grip, 5), 0.012, 8), steel)]
    return [(shape.moved((0.0, 0.0, -0.012)), material) for shape, material in parts]


def bollard(iron) -> list:
    """A knee-high iron post with a ball on it."""
    profile = [
        (0.0, -SUNK),
        (0.11, -SUNK),
        (0.11, 0.1),
        (0.075, 0.16),
        (0.065, 0.68),
        (0.1, 0.72),
        (0.1, 0.76),
        (0.05, 0.79),
    ]
    ball = [(0.05 + 0.06 * np.sin(a), 0.85 - 0.06 * np.cos(a)) for a in np.linspace(0.2, 2.2, 6)]
    return [(shapes.lathe([*profile, *ball, (0.0, 0.91)], 20), iron)]


def hanging(start, end, sag: float, steps: int = 16) -> np.ndarray:
    """(steps + 1, 3) of a chain or a cable between two points."""
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    return np.asarray(start) * (1 - share) + np.asarray(end) * share - sag * 4 * share * (1 - share) * (0, 0, 1)


def cafe_table(iron, top) -> list:
    """A round bistro table."""
    profile = [(0.0, 0.0), (0.22, 0.0), (0.22, 0.02), (0.03, 0.05), (0.025, 0.69), (0.08, 0.71), (0.0, 0.71)]
    plate = [(0.0, 0.7), (0.33, 0.7), (0.345, 0.715), (0.33, 0.73), (0.0, 0.73)]
    return [(shapes.lathe(profile, 20), iron), (shapes.lathe(plate, 40), top)]
