"""What stands in a living room, as shapes or lists of parts, pairs of a shape and a material. Metres.

All face -Y, their backs to a wall in y = 0 or their middles at the origin. What is soft is modelled
coarsely, for a subdivision where it is placed.
"""

import numpy as np

from . import bath, furniture, shapes
from .shapes import Shape

SUNK = 0.005  # what stands on the floor goes a little way into it


def bent(corners, radius: float, steps: int = 6) -> np.ndarray:
    """A path through `corners` (N, 3), each rounded off over `radius`; a loop where the last is the first."""
    corners = np.asarray(corners, dtype=np.float64)
    loop = np.allclose(corners[0], corners[-1])
    before = np.roll(corners[:-1], 1, axis=0) if loop else corners[:-2]
    at, after = (corners[:-1], np.roll(corners[:-1], -1, axis=0)) if loop else (corners[1:-1], corners[2:])
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    pieces = []
    for start, corner, end in zip(before, at, after, strict=True):
        enter = corner + radius * (start - corner) / np.linalg.norm(start - corner)
        leave = corner + radius * (end - corner) / np.linalg.norm(end - corner)
        pieces.append((1 - share) ** 2 * enter + 2 * share * (1 - share) * corner + share**2 * leave)
    ends = ([], pieces[:1]) if loop else ([corners[:1]], [corners[-1:]])
    path = np.concatenate([*ends[0], *pieces, *(end[:1] for end in ends[1])])
    return path


def cushion(width: float, depth: float, height: float, sides: int = 44, fullness: float = 1.0) -> Shape:
    """A cushion on z = 0 with a seam round its middle, puffed up by `fullness`."""
    level = np.array([0.0, 0.04, 0.2, 0.42, 0.5, 0.58, 0.8, 0.96, 1.0])
    out = np.array([0.62, 0.86, 0.975, 0.995, 1.012, 0.995, 0.975, 0.86, 0.62])
    bulge = fullness * 0.06 * height * np.sin(np.pi * level)
    rows = [
        (height * z, width / 2 * o + b, depth / 2 * o + b, 0.0, 5.0) for z, o, b in zip(level, out, bulge, strict=True)
    ]
    puff = 0.14 * height * fullness
    return shapes.loft(np.array([(-puff * 0.3, 0, 0, 0, 4), *rows, (height + puff, 0, 0, 0, 4)]), sides)


def slab(width: float, depth: float, height: float, sides: int = 44) -> Shape:
    """An upholstered block on z = 0 with soft edges."""
    level, out = np.array([0.0, 0.02, 0.08, 0.5, 0.92, 0.98, 1.0]), np.array([0.93, 0.97, 1.0, 1.0, 1.0, 0.97, 0.92])
    rows = [(height * z, width / 2 * o, depth / 2 * o, 0.0, 9.0) for z, o in zip(level, out, strict=True)]
    return shapes.loft(np.array([(0, 0, 0, 0, 8), *rows, (height, 0, 0, 0, 8)]), sides)


def cantilever() -> Shape:
    """The frame of a cantilever chair, bent of one endless tube, on z = 0."""
    x = 0.26
    side = [(0.3, 0.86), (0.24, 0.44), (-0.25, 0.46), (-0.27, 0.0125), (0.24, 0.0125)]
    corners = [(x, *point) for point in side] + [(-x, *point) for point in side[::-1]]
    return shapes.tube(bent([*corners, corners[0]], 0.07, 8), 0.0125, 28)


def arc_lamp() -> tuple[Shape, Shape, Shape, Shape]:
    """A floor lamp with its base at the origin, bowing to +X: base, bow, shade (a hollow dome) and bulb."""
    base = [
        (0, -SUNK),
        (0.19, -SUNK),
        (0.2, 0.0),
        (0.2, 0.05),
        (0.193, 0.06),
        (0.18, 0.064),
        (0.03, 0.07),
        (0.022, 0.09),
        (0, 0.092),
    ]
    curve = np.array(
        [(0, 0.06), (0, 0.6), (0.02, 1.2), (0.2, 1.75), (0.62, 2.12), (1.12, 2.18), (1.52, 2.0), (1.68, 1.86)]
    )
    bow = shapes.through(curve, 10)
    bow = shapes.tube(np.stack([bow[:, 0], 0 * bow[:, 0], bow[:, 1]], axis=-1), 0.014, 40)
    angle = np.linspace(np.pi / 2, 0.0, 21)
    outside = 0.2 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inside = 0.195 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)[::-1]
    outside[0, 0] = inside[-1, 0] = 0.0
    dome = shapes.lathe(np.concatenate([outside, [(0.1985, -0.003), (0.1965, -0.003)], inside])[::-1], 80)
    place = (1.7, 0.0, 1.66)
    return shapes.lathe(base, 80), bow, dome.moved(place), shapes.sphere(0.05, 32, 16).moved((1.7, 0.0, 1.72))


def bowl(radius: float, height: float, wall: float = 0.006) -> Shape:
    """A wide polished bowl on z = 0, inside and outside."""
    share = np.linspace(0.0, 1.0, 25)
    outside = np.stack([radius * np.sin(share * np.pi / 2) ** 0.8, height * share**1.7], axis=-1)
    inside = np.stack([np.maximum(outside[:, 0] - wall, 0.0), wall + (height - 0.4 * wall) * share**1.7], axis=-1)[::-1]
    outside[0, 0] = inside[-1, 0] = 0.0
    lip = [(radius - 0.1 * wall, height + 0.5 * wall), (radius - 0.6 * wall, height + 0.9 * wall)]
    return shapes.lathe(np.concatenate([outside, lip, inside]), 96)


def convex_mirror(radius: float, bulge: float) -> Shape:
    """A round mirror that bulges to -Y, closed behind."""
    share = np.linspace(1.0, 0.0, 33)
    cap = np.stack([radius * share, bulge * (1.0 - share**2)], axis=-1)
    disc = shapes.lathe(np.concatenate([[(0, -0.02), (radius, -0.02)], cap]), 96)
    return disc.turned(shapes.turn("X", 90.0))


def sunburst(radius: float, reach: float, gilt) -> list:
    """A gilt frame of rays round such a mirror."""
    ring = [
        (radius - 0.01, -0.02),
        (radius + 0.03, -0.02),
        (radius + 0.03, 0.015),
        (radius + 0.01, 0.028),
        (radius - 0.01, 0.012),
    ]
    parts = [(shapes.lathe([*ring, ring[0]], 72).turned(shapes.turn("X", 90.0)), gilt)]
    ray = shapes.lathe([(0, 0), (0.012, 0), (0.009, reach * 0.6), (0.0, reach)], 8).moved((0, 0, radius + 0.015))
    for i in range(32):
        part = ray.moved(scale=(1.0, 1.0, 1.0 if i % 2 else 0.86))
        parts.append((part.turned(shapes.turn("Y", i * 360.0 / 32)), gilt))
    return parts


def hearth(stone, soot, wood, ember) -> list:
    """A fireplace 1.7 m wide and 1.15 m high before a wall in y = 0, with logs that glow."""
    parts = [(shapes.box((0.32, 0.28, 1.0 + SUNK)).moved((side * 0.64, -0.14, -SUNK)), stone) for side in (-1, 1)]
    parts += [(shapes.box((0.24, 0.03, 0.7)).moved((side * 0.64, -0.29, 0.15)), stone) for side in (-1, 1)]
    parts.append((shapes.box((1.6, 0.285, 0.2)).moved((0, -0.1425, 0.9)), stone))
    parts.append((shapes.box((1.72, 0.36, 0.05)).moved((0, -0.18, 1.1)), stone))
    parts.append((shapes.box((1.7, 0.7, 0.03)).moved((0, -0.35, -0.005)), stone))
    parts.append((shapes.box((0.96, 0.02, 0.9)).moved((0, -0.011, 0.02)), soot))
    random = np.random.default_rng(23)
    for i, (x, y, z, spin) in enumerate(((-0.1, -0.1, 0.08, 8), (0.12, -0.2, 0.08, -6), (0.0, -0.15, 0.18, 14))):
        log = np.array([(-0.28, 0, 0), (-0.1, 0.01, 0.006), (0.1, -0.008, 0), (0.29, 0, 0.004)])
        shape = shapes.tube(shapes.through(log, 6), random.uniform(0.048, 0.06), 18)
        parts.append((shape.turned(shapes.turn("Z", spin + i)).moved((x, y, z)), wood))
    flame = shapes.lathe(
        shapes.through(np.array([(0, 0), (0.045, 0.05), (0.05, 0.11), (0.022, 0.2), (0, 0.28)]), 5), 20
    )
    for x, y, size in ((-0.16, -0.15, 0.8), (0.0, -0.12, 1.2), (0.14, -0.17, 0.95), (-0.06, -0.2, 0.6)):
        lean = shapes.turn("Y", 50.0 * x)
        parts.append((flame.moved(scale=(size, size, size)).turned(lean).moved((x, y, 0.14)), ember))
    return [(shape.textured(0.8) if material is stone else shape, material) for shape, material in parts]


def bookcase(width: float, height: float, wood, bindings: list, paper) -> list:
    """A bookcase before a wall in y = 0, its shelves full of books of all sizes with gaps here and there."""
    random = np.random.default_rng(29)
    deep, shelves = 0.3, 6
    parts = [
        (shapes.box((0.03, deep, height)).moved((side * (width / 2 - 0.015), -deep / 2, -SUNK)), wood)
        for side in (-1, 1)
    ]
    parts.append((shapes.box((width - 0.06, 0.01, height)).moved((0, -0.006, -SUNK)), wood))
    levels = np.linspace(0.06, height - 0.03, shelves)
    for level, roof in zip(levels, [*levels[1:], None], strict=True):
        parts.append((shapes.box((width - 0.06, deep - 0.01, 0.025)).moved((0, -deep / 2, level)), wood))
        left = 0.04 - width / 2
        while roof is not None and left < width / 2 - 0.12:
            wide, tall = random.uniform(0.018, 0.05), random.uniform(0.62, 0.9) * (roof - level)
            if random.random() > 0.08:
                number = random.integers(len(bindings))
                middle = (left + wide / 2, -0.17 + random.uniform(-0.015, 0.015), level + 0.0255)
                parts += [
                    (shape.moved(middle), m) for shape, m in furniture.book(wide * 0.97, tall, bindings[number], paper)
                ]
            left += wide
    return [(shape.textured(0.8) if material is wood else shape, material) for shape, material in parts]


def rug(width: float, depth: float, weave, yarn) -> list:
    """A rug on z = 0 with fringes at both ends of X."""
    body = shapes.box((width, depth, 0.012 + SUNK)).moved((0, 0, -SUNK))
    parts = [(body, weave)]
    random = np.random.default_rng(31)
    for y in np.linspace(-depth / 2 + 0.01, depth / 2 - 0.01, 90):
        for side in (-1, 1):
            sway = random.uniform(-0.012, 0.012)
            path = np.array(
                [
                    (width / 2 - 0.005, y, 0.006),
                    (width / 2 + 0.04, y + 0.3 * sway, 0.005),
                    (width / 2 + 0.08, y + sway, 0.003),
                ]
            )
            parts.append((shapes.tube(path * (side, 1, 1) if side > 0 else path[::-1] * (side, 1, 1), 0.003, 5), yarn))
    return parts


def rubber_plant(pot, soil, stalk, leaf, seed: int = 37) -> list:
    """A tall pot plant: broad leaves, coarse, up three stems out of a pot."""
    random = np.random.default_rng(seed)
    shell = [
        (0, -SUNK),
        (0.14, -SUNK),
        (0.15, 0.02),
        (0.19, 0.32),
        (0.2, 0.34),
        (0.19, 0.36),
        (0.17, 0.36),
        (0.165, 0.3),
        (0, 0.3),
    ]
    parts = [
        (shapes.lathe(shell[:-1] + [(0.165, 0.31), (0.0, 0.31)], 40), pot),
        (shapes.lathe([(0.166, 0.315), (0, 0.32)], 40), soil),
    ]
    along = np.linspace(0.0, 1.0, 6)
    wide = 0.26 * np.sin(np.pi * np.clip(along, 0, 1) ** 0.85)
    across = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    grid = np.stack(
        [
            np.broadcast_to(along[:, None], (6, 5)),
            wide[:, None] * across,
            0.1 * wide[:, None] * np.abs(across) - 0.35 * along[:, None] ** 2,
        ],
        axis=-1,
    )
    both = np.concatenate([grid, (grid - (0, 0, 0.012))[:, ::-1][:, 1:], grid[:, :1]], axis=1)
    blade = shapes.sheet(both[:, ::-1])
    for stem in range(3):
        azimuth = 120.0 * stem + 20.0
        out = np.array([np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth)), 0.0])
        tall = (1.0, 0.82, 0.68)[stem]
        path = shapes.through(
            np.array([out * 0.03 + (0, 0, 0.3), out * 0.1 + (0, 0, 0.3 + 0.5 * tall), out * 0.2 + (0, 0, 0.3 + tall)]),
            12,
        )
        parts.append((shapes.tube(path, np.linspace(0.013, 0.006, len(path)), 10), stalk))
        for i, point in enumerate(path[4::2]):
            spin, lift = 137.5 * i + azimuth, -25.0 - 1.5 * i + random.uniform(-10, 10)
            turned = shapes.turn("Z", spin) @ shapes.turn("Y", lift)
            parts.append((blade.moved(scale=random.uniform(0.24, 0.34)).turned(turned).moved(point), leaf))
    return parts


def drape(width: float, height: float) -> Shape:
    """A coarse curtain in folds that hangs from z = 0."""
    return bath.curtain(width, height, 6, 60, 8)


def candlestick() -> tuple[Shape, Shape]:
    """A coarse candlestick on z = 0, and the candle in it."""
    stick = [(0, 0), (0.05, 0), (0.052, 0.008), (0.02, 0.022), (0.011, 0.05), (0.018, 0.07), (0.01, 0.095)]
    stick += [(0.013, 0.17), (0.02, 0.185), (0.03, 0.195), (0.028, 0.2), (0.0, 0.2)]
    candle = [(0, 0.199), (0.011, 0.199), (0.011, 0.34), (0.008, 0.344), (0, 0.344)]
    return shapes.lathe(stick, 24), shapes.lathe(candle, 20)


def clock(wood, dial) -> list:
    """A mantel clock on z = 0."""
    case = [(0, 0, 0, 0, 4), (0, 0.09, 0.045, 0, 6), (0.03, 0.09, 0.045, 0, 6), (0.04, 0.08, 0.04, 0, 5)]
    case += [(0.19, 0.075, 0.038, 0, 5), (0.23, 0.02, 0.02, 0, 3), (0.235, 0, 0, 0, 3)]
    face = shapes.pane(shapes.ellipse(0.11, 0.11, 40)).moved((0, -0.0415, 0.115))
    return [(shapes.loft(np.array(case), 40), wood), (face, dial)]


def table_legs(height: float) -> list[Shape]:
    """The two runners of a coffee table 1.25 m long whose top's upper side is at `height`."""
    corners = np.array([(-0.3, height - 0.03), (-0.3, 0.022), (0.3, 0.022), (0.3, height - 0.03)])
    leg = shapes.tube(bent(np.insert(corners, 0, -0.52, axis=1), 0.03), 0.011, 14)
    return [leg, leg.moved((1.04, 0.0, 0.0))]


def pile(bindings: list, paper) -> list:
    """Books that lie on one another on z = 0, smaller ones higher, one for each of three `bindings`."""
    parts, height = [], 0.0
    for binding, (wide, deep, thick), spin in zip(
        bindings, ((0.27, 0.2, 0.03), (0.24, 0.18, 0.025), (0.2, 0.16, 0.02)), (12.0, -8.0, 20.0), strict=True
    ):
        turned = shapes.turn("Z", spin)
        pages = shapes.box((wide - 0.008, deep - 0.004, thick - 0.006)).moved((0.006, 0, 0.003))
        parts.append((shapes.box((wide, deep, thick)).turned(turned).moved((0, 0, height)), binding))
        parts.append((pages.turned(turned).moved((0, 0, height)), paper))
        height += thick - 0.0004
    return parts


def bottle_vase() -> Shape:
    """A coarse vase with a narrow neck on z = 0, 0.4 m high, hollow at its mouth."""
    vase = [(0, 0), (0.05, 0), (0.07, 0.02), (0.1, 0.12), (0.08, 0.24), (0.035, 0.33), (0.045, 0.4), (0.04, 0.4)]
    return shapes.lathe([*vase, (0.03, 0.33), (0.03, 0.3), (0, 0.29)], 20)


def floor_vase() -> Shape:
    """A coarse, bulging vase on z = 0, 0.85 m high, hollow at its mouth."""
    vase = [(0, -SUNK), (0.11, -SUNK), (0.13, 0.02), (0.24, 0.35), (0.25, 0.5), (0.17, 0.7), (0.1, 0.79), (0.13, 0.85)]
    return shapes.lathe([*vase, (0.12, 0.85), (0.085, 0.78), (0.08, 0.7), (0, 0.66)], 20)
