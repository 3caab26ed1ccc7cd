"""What stands in a bathroom, as shapes or as lists of parts, pairs of a shape and a material. Metres.

All face -Y, their backs to a wall in y = 0 or their middles at the origin. What stands on the floor
goes a little way into it.
"""

import numpy as np

from . import shapes
from .shapes import Shape

SUNK = 0.01


def _smooth(sections, steps: int) -> np.ndarray:
    """Sections for a loft, with `steps` to each of those given."""
    curve = shapes.through(np.array(sections, dtype=np.float64), steps)
    curve[:, 1:3] = np.maximum(curve[:, 1:3], 0.0)
    return curve


def tub() -> Shape:
    """A free-standing bath, long along Y: its foot, belly and rolled rim, and its inside down to the drain."""
    outside = [
        (-SUNK, 0.26, 0.56, 0, 3.0),
        (0.04, 0.27, 0.58, 0, 3.0),
        (0.25, 0.33, 0.72, 0, 2.8),
        (0.5, 0.37, 0.82, 0, 2.6),
    ]
    rim = [(0.55, 0.39, 0.85, 0, 2.6), (0.575, 0.375, 0.835, 0, 2.6), (0.555, 0.35, 0.81, 0, 2.6)]
    inside = [
        (0.4, 0.32, 0.74, 0, 2.6),
        (0.18, 0.26, 0.6, 0, 2.7),
        (0.13, 0.18, 0.45, 0, 2.6),
        (0.12, 0.0, 0.0, 0, 2.2),
    ]
    foot = np.array([(-SUNK, 0.0, 0.0, 0.0, 2.2)])
    return shapes.loft(np.concatenate([foot, _smooth(outside + rim + inside, 5)]), 96)


def toilet(porcelain, wood, chrome_button) -> list:
    """A close-coupled toilet against the wall, its seat and lid of wood."""
    foot = [(-SUNK, 0.12, 0.22, -0.34, 2.8), (0.03, 0.115, 0.21, -0.34, 2.6), (0.16, 0.1, 0.18, -0.33, 2.3)]
    bowl = [(0.28, 0.14, 0.22, -0.37, 2.2), (0.37, 0.18, 0.255, -0.4, 2.2), (0.4, 0.185, 0.26, -0.4, 2.2)]
    inside = [
        (0.4, 0.14, 0.215, -0.4, 2.1),
        (0.33, 0.12, 0.18, -0.4, 2.1),
        (0.2, 0.07, 0.1, -0.37, 2.0),
        (0.18, 0, 0, -0.37, 2),
    ]
    start = np.array([(-SUNK, 0.0, 0.0, -0.34, 2.2)])
    parts = [(shapes.loft(np.concatenate([start, _smooth(foot + bowl + inside, 6)]), 72), porcelain)]
    seat = [(0.405, 0.13, 0.2, -0.4, 2.1), (0.405, 0.19, 0.265, -0.4, 2.2), (0.42, 0.197, 0.272, -0.4, 2.2)]
    seat += [(0.43, 0.185, 0.26, -0.4, 2.2), (0.428, 0.13, 0.2, -0.4, 2.1), (0.405, 0.13, 0.2, -0.4, 2.1)]
    parts.append((shapes.loft(np.array(seat), 72), wood))
    lid = [
        (0, 0, 0, 0, 2.2),
        (0.0, 0.19, 0.235, 0, 2.3),
        (0.012, 0.195, 0.24, 0, 2.3),
        (0.022, 0.185, 0.23, 0, 2.3),
        (0.024, 0, 0, 0, 2.2),
    ]
    raised = shapes.turn("X", 98.0)
    parts.append((shapes.loft(np.array(lid), 64).moved((0.0, 0.24, 0.0)).turned(raised).moved((0.0, -0.2, 0.42)), wood))
    tank = [
        (0.38, 0, 0, -0.09, 5),
        (0.38, 0.17, 0.07, -0.09, 5),
        (0.4, 0.185, 0.08, -0.09, 6),
        (0.72, 0.2, 0.085, -0.09, 6),
        (0.72, 0, 0, -0.09, 5),
    ]
    cover = [
        (0.722, 0, 0, -0.09, 5),
        (0.722, 0.21, 0.092, -0.09, 6),
        (0.745, 0.212, 0.093, -0.09, 6),
        (0.76, 0.2, 0.083, -0.09, 5),
        (0.762, 0, 0, -0.09, 5),
    ]
    parts += [(shapes.loft(np.array(tank), 64), porcelain), (shapes.loft(np.array(cover), 64), porcelain)]
    parts.append((shapes.box((0.2, 0.16, 0.3)).moved((0.0, -0.16, 0.1)), porcelain))
    button = [
        (0.755, 0.03, 0.03, -0.09, 2),
        (0.77, 0.03, 0.03, -0.09, 2),
        (0.774, 0.026, 0.026, -0.09, 2),
        (0.774, 0, 0, -0.09, 2),
    ]
    return [*parts, (shapes.loft(np.array(button), 32), chrome_button)]


def basin() -> Shape:
    """An oval bowl that stands on a vanity, hollow, with a rim."""
    outside = [
        (0.0, 0.13, 0.1, 0, 2.0),
        (0.02, 0.16, 0.12, 0, 2.0),
        (0.08, 0.235, 0.175, 0, 2.2),
        (0.145, 0.27, 0.2, 0, 2.3),
    ]
    inside = [
        (0.155, 0.268, 0.198, 0, 2.3),
        (0.15, 0.256, 0.186, 0, 2.3),
        (0.08, 0.215, 0.155, 0, 2.2),
        (0.03, 0.12, 0.085, 0, 2.0),
    ]
    bottom = [(0.022, 0.0, 0.0, 0, 2.0)]
    start = np.array([(0.0, 0.0, 0.0, 0.0, 2.0)])
    return shapes.loft(np.concatenate([start, _smooth(outside + inside + bottom, 5)]), 80)


def tap() -> Shape:
    """A tall mixer: a base, a bent spout towards -Y, and a lever."""
    base = [
        (0, 0),
        (0.028, 0),
        (0.03, 0.006),
        (0.022, 0.012),
        (0.021, 0.2),
        (0.024, 0.205),
        (0.024, 0.225),
        (0.012, 0.238),
        (0, 0.24),
    ]
    spout = shapes.through(
        np.array([(0, 0, 0.17), (0, -0.05, 0.26), (0, -0.13, 0.285), (0, -0.175, 0.23), (0, -0.178, 0.2)]), 10
    )
    lever = shapes.through(np.array([(0, 0, 0.232), (0.045, 0.01, 0.262), (0.1, 0.015, 0.27)]), 8)
    width = np.interp(np.linspace(0, 1, len(lever)), (0, 0.3, 1), (0.009, 0.007, 0.009))
    mouth = shapes.lathe([(0, -0.006), (0.015, -0.006), (0.0165, 0.0), (0.0165, 0.02), (0, 0.03)], 32).moved(
        (0, -0.178, 0.196)
    )
    parts = [shapes.lathe(base, 48), shapes.tube(spout, 0.0125, 32), shapes.tube(lever, width, 20), mouth]
    return shapes.joined([*parts, shapes.sphere(0.012, 20, 12).moved((0.1, 0.015, 0.27))])


def shower() -> Shape:
    """A mixer on a wall in y = 0, a riser and a wide head."""
    riser = [
        (0, -0.05, 0.0),
        (0, -0.05, 0.5),
        (0, -0.05, 0.95),
        (0, -0.09, 1.1),
        (0, -0.22, 1.14),
        (0, -0.36, 1.12),
        (0, -0.38, 1.06),
    ]
    head = [(0.0, 1.02), (0.11, 1.02), (0.115, 1.026), (0.11, 1.034), (0.03, 1.05), (0.02, 1.075), (0.0, 1.075)]
    body = shapes.tube(
        np.array([(-0.13, -0.05, 0.0), (-0.1, -0.05, 0.0), (0.1, -0.05, 0.0), (0.13, -0.05, 0.0)]), 0.022, 24
    )
    parts = [shapes.tube(shapes.through(np.array(riser), 8), 0.011, 20), body]
    parts.append(shapes.lathe(head, 64).moved((0.0, -0.38, 0.0)))
    knob = shapes.lathe([(0, 0), (0.026, 0), (0.03, 0.01), (0.028, 0.045), (0, 0.05)], 28)
    for side in (-1, 1):
        parts.append(knob.turned(shapes.turn("Y", side * 90.0)).moved((side * 0.13, -0.05, 0.0)))
        parts.append(shapes.tube(np.array([(side * 0.09, -0.05, 0.0), (side * 0.09, 0.01, 0.0)]), 0.016, 20))
    parts.append(shapes.tube(np.array([(0, -0.05, 0.8), (0, 0.01, 0.8)]), 0.009, 16))
    return shapes.joined(parts)


def rail(length: float) -> Shape:
    """A towel rail along X before a wall in y = 0."""
    half = length / 2
    bar = np.array([(-half, -0.08, 0.0), (half, -0.08, 0.0)])
    parts = [shapes.tube(bar, 0.01, 24)]
    ball = shapes.sphere(0.016, 24, 12)
    rose = shapes.lathe([(0, 0), (0.025, 0), (0.022, 0.01), (0.009, 0.016), (0.008, 0.09), (0, 0.09)], 28).turned(
        shapes.turn("X", 90.0)
    )
    for side in (-1, 1):
        parts += [ball.moved((side * half, -0.08, 0.0)), rose.moved((side * (half - 0.03), 0.0, 0.0))]
    return shapes.joined(parts)


def towel(width: float, front: float, back: float, columns: int, rows: int) -> Shape:
    """A towel over a rail along X at the origin, hanging `front` before it and `back` behind, in soft folds."""
    down = np.linspace(-front, back, rows)
    bend = 0.017
    over = np.clip(down / (bend * np.pi), -0.5, 0.5) * np.pi
    y = bend * np.sin(over)
    z = bend * np.cos(over) - np.maximum(np.abs(down) - bend * np.pi / 2, 0.0)
    middle = np.stack([y, z], axis=-1)
    normal = np.stack([np.sin(over), np.cos(over)], axis=-1)
    loop = np.concatenate([middle + 0.006 * normal, (middle - 0.006 * normal)[::-1]])
    loop = np.concatenate([loop, loop[:1]])
    hang = np.clip(-loop[:, 1] / max(front, back), 0.0, 1.0)
    x = np.linspace(-width / 2, width / 2, columns)[:, None]
    folds = 0.016 * np.sin(x * 34.0 + 1.5 * hang) * hang**0.7 + 0.006 * np.sin(x * 71.0 + 4.0 * hang) * hang
    gathered = x * (1.0 - 0.06 * hang)
    grid = np.stack(
        [gathered, loop[:, 0] + folds * np.sign(loop[:, 0] + 1e-9), np.broadcast_to(loop[:, 1], folds.shape)], axis=-1
    )
    cloth = shapes.sheet(grid[::-1], (2.0, 1.0))
    return Shape(cloth.points, cloth.faces, cloth.uvs[..., ::-1])


def curtain(width: float, height: float, folds: int, columns: int, rows: int) -> Shape:
    """A curtain along X that hangs from z = 0, gathered into folds, of a thickness of 4 mm."""
    x = np.linspace(-width / 2, width / 2, columns)
    z = np.linspace(0.0, -height, rows)[:, None]
    depth = (0.03 + 0.02 * -z / height) * np.sin(2 * np.pi * folds * (x / width + 0.5) + 0.5 * np.sin(3.0 * z))
    depth = depth + 0.012 * np.sin(9.0 * x + 2.0 * z)
    front = np.stack([np.broadcast_to(x, depth.shape), depth - 0.002, np.broadcast_to(z, depth.shape)], axis=-1)
    back = front + (0.0, 0.004, 0.0)
    round_ = np.concatenate([front, back[:, ::-1], front[:, :1]], axis=1)
    return shapes.sheet(round_[::-1], (2.0 * folds * 0.5, height / width))


def bottle(radius: float, height: float, neck: float) -> Shape:
    """A round bottle with shoulders; its stopper is a `stopper`."""
    body = np.array(
        [
            (0.0, 0.0),
            (0.92, 0.0),
            (1.0, 0.02),
            (1.0, 0.62),
            (0.95, 0.72),
            (0.6, 0.82),
            (neck, 0.86),
            (neck, 0.93),
            (0, 0.93),
        ]
    )
    return shapes.lathe(np.concatenate([body[:1], shapes.through(body[1:-1], 2), body[-1:]]) * (radius, height), 40)


def stopper(radius: float, height: float) -> Shape:
    """What closes a bottle of that `height`: a round cap on its neck."""
    profile = np.array([(0, 0.92), (0.46, 0.92), (0.5, 0.93), (0.5, 1.05), (0.42, 1.08), (0, 1.08)])
    return shapes.lathe(profile * (radius, height), 32)


def fern(count: int, reach: float, stalk, leaf) -> list:
    """Arching fronds of many leaflets out of a pot's middle; both sides of a leaflet are modelled."""
    random = np.random.default_rng(7)
    parts = []
    outline = shapes.ellipse(1.0, 0.32, 6)
    thin = np.insert(outline, 2, 0.0, axis=1)
    ring = np.concatenate([thin, thin[:1]])
    leaflet = shapes.sheet(np.stack([ring * 0 + (0, 0, -0.02), ring, ring * 0 + (0, 0, 0.02)])).moved((0.5, 0.0, 0.0))
    for number in range(count):
        azimuth, lean = 2.4 * number + random.uniform(-0.2, 0.2), random.uniform(0.45, 1.0)
        line = np.array([(0, 0, 0), (0.25 * lean, 0, 0.6), (0.65 * lean, 0, 0.85), (1.0 * lean, 0, 0.55)]) * reach
        path = shapes.through(line, 6) @ shapes.turn("Z", np.degrees(azimuth)).T
        parts.append((shapes.tube(path, np.linspace(0.003, 0.001, len(path)), 5), stalk))
        for step in range(4, len(path)):
            size = reach * 0.28 * np.sin(np.pi * (step - 2) / len(path))
            for side in (-1, 1):
                turned = shapes.turn("Z", np.degrees(azimuth) + side * 65.0) @ shapes.turn("Y", 18.0)
                parts.append((leaflet.moved(scale=size).turned(turned).moved(path[step]), leaf))
    return parts
