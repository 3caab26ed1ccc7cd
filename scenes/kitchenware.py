"""What a kitchen is used with, as shapes or lists of parts, pairs of a shape and a material. Metres.

Reflectors are closed, and each is of one piece: what is soldered together in a real kettle are here
shapes of their own, that run a little way into one another.
"""

import numpy as np

from . import shapes
from .shapes import Shape


def _upright(curve) -> np.ndarray:
    """A curve (N, 2) of X and Z, in y = 0: (N, 3)."""
    curve = np.asarray(curve, dtype=np.float64)
    return np.stack([curve[:, 0], 0 * curve[:, 0], curve[:, 1]], axis=-1)


def _turned(points, steps: int, segments: int, repeat=(1.0, 1.0)) -> Shape:
    """What a smooth curve through `points` (radius, height) sweeps round Z."""
    curve = shapes.through(np.array(points, dtype=np.float64), steps)
    curve[:, 0] = np.maximum(curve[:, 0], 0.0)
    return shapes.lathe(curve, segments, repeat)


def kettle_body() -> Shape:
    """A round kettle's body, 0.24 m wide and 0.17 m high."""
    profile = [(0, 0), (0.04, 0), (0.082, 0.0), (0.096, 0.006), (0.114, 0.034), (0.12, 0.068), (0.114, 0.104)]
    profile += [(0.095, 0.136), (0.068, 0.156), (0.034, 0.166), (0, 0.168)]
    return _turned(profile, 3, 96)


def kettle_lid() -> Shape:
    """Its lid, with a knob."""
    rim = [(0, 0.15), (0.052, 0.15), (0.056, 0.161), (0.055, 0.168), (0.048, 0.173), (0.03, 0.18), (0.012, 0.184)]
    knob = [(0.0085, 0.189), (0.0095, 0.195), (0.017, 0.201), (0.0195, 0.21), (0.015, 0.219), (0.006, 0.2225)]
    return _turned([*rim, *knob, (0, 0.223)], 2, 36)


def kettle_spout() -> Shape:
    """Its spout, towards +X, with an open mouth."""
    path = _upright(shapes.through(np.array([(0.085, 0.055), (0.135, 0.078), (0.158, 0.128), (0.2, 0.162)]), 8))
    width = np.interp(np.linspace(0, 1, len(path)), (0, 0.3, 0.65, 0.95, 1), (0.034, 0.027, 0.018, 0.0145, 0.0155))
    return shapes.tube(path, width, 32, bore=0.0125)


def kettle_handle() -> tuple[Shape, Shape]:
    """Its bow over the lid, in the plane of the spout, and the grip on that."""
    curve = np.array([(-0.086, 0.136), (-0.1, 0.19), (-0.075, 0.25), (0, 0.277), (0.075, 0.25), (0.1, 0.19)])
    path = shapes.through(np.concatenate([curve, [(0.086, 0.136)]]), 8)
    grip = path[17:32]
    width = 0.0145 - 0.003 * np.abs(np.linspace(-1, 1, len(grip))) ** 3
    return shapes.tube(_upright(path), 0.0075, 18), shapes.tube(_upright(grip), width, 20)


def pan(radius: float, height: float, flare: float = 1.0, wall: float = 0.004) -> Shape:
    """A pan with a rolled rim and a rounded bottom, inside and outside; `flare` is its rim's width by its base's."""
    base = radius / flare
    corner = min(0.35 * height, 0.02)
    outside = [(0, 0), (base * 0.6, 0), (base - corner, 0), (base - 0.25 * corner, 0.3 * corner), (base, corner)]
    neck = radius - 0.12 * (radius - base)
    rim = [(neck, 0.88 * height), (radius, height), (radius + 0.003, height + 0.003), (radius + 0.001, height + 0.005)]
    rim += [(radius - wall, height + 0.001), (neck - wall, 0.88 * height)]
    inside = [(base - wall, corner + wall), (base - wall - 0.3 * corner, 0.35 * corner + wall)]
    inside += [(base - corner - wall, wall), (base * 0.5, wall), (0, wall)]
    return _turned([*outside, *rim, *inside], 2, 44)


def pan_handle(length: float, start: float, rise: float) -> Shape:
    """A pan's flat handle: from `start` along X for `length`, up by `rise`, ending in a rounded tip."""
    path = _upright(
        [(start, 0), (start + 0.2 * length, 0.6 * rise), (start + 0.6 * length, rise), (start + length, rise)]
    )
    path = shapes.through(path, 8)
    share = np.linspace(0, 1, len(path))
    width = np.interp(share, (0, 0.25, 0.9, 0.97, 1), (0.009, 0.0075, 0.011, 0.009, 0.004))
    bar = shapes.tube(path, width, 16)
    across = bar.points[:, 1]
    return Shape(np.stack([bar.points[:, 0], 1.3 * across, bar.points[:, 2]], axis=-1), bar.faces, bar.uvs)


def hanger() -> Shape:
    """A hook of wire that hangs over a rail in the origin; what hangs from it hangs 0.05 m below."""
    curve = [(0.0, -0.008), (0.008, 0.0), (0.0, 0.009), (-0.008, 0.0), (-0.006, -0.02), (-0.001, -0.035)]
    curve += [(0.006, -0.05), (0.0, -0.058), (-0.007, -0.05)]
    path = _upright(shapes.through(np.array(curve), 3))[:, [1, 0, 2]]
    return shapes.tube(path, 0.002, 6)


def ladle() -> tuple[Shape, Shape]:
    """A ladle that hangs from the origin: its bowl, open upwards and forwards (-Y), and its stem."""
    angle = np.linspace(-np.pi / 2, 0.12, 13)
    outside = 0.045 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inside = 0.0435 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)[::-1] + (0, 0.0008)
    outside[0, 0] = inside[-1, 0] = 0.0
    bowl = shapes.lathe(np.concatenate([outside, inside]), 40).turned(shapes.turn("X", 38.0)).moved((0, -0.03, -0.29))
    curve = np.array([(-0.004, 0.0), (0.0, -0.012), (0.0, -0.15), (0.002, -0.24), (-0.002, -0.262)])
    path = shapes.through(np.stack([0 * curve[:, 0], curve[:, 0], curve[:, 1]], axis=-1), 8)
    return bowl, shapes.tube(path, np.interp(np.linspace(0, 1, len(path)), (0, 0.2, 1), (0.008, 0.0065, 0.0055)), 14)


def spoon() -> tuple[Shape, Shape]:
    """A large spoon that lies on z = 0 along X, its bowl open upwards at the origin, and its stem towards +X."""
    angle = np.linspace(-np.pi / 2, 0.0, 14)
    outside = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inside = outside[::-1] * (0.965, 0.93) + (0.0, 0.012)
    outside[0, 0] = inside[-1, 0] = 0.0
    bowl = shapes.lathe(np.concatenate([outside, inside]), 48).moved((0, 0, 0.0215), (0.047, 0.033, 0.0215))
    curve = [(0.043, 0.0195), (0.06, 0.024), (0.1, 0.03), (0.18, 0.022), (0.255, 0.007)]
    path = _upright(shapes.through(np.array(curve), 8))
    width = np.interp(np.linspace(0, 1, len(path)), (0, 0.2, 0.8, 0.95, 1), (0.004, 0.0035, 0.0055, 0.0065, 0.003))
    bar = shapes.tube(path, width, 14)
    return bowl, Shape(bar.points * (1.0, 1.5, 1.0), bar.faces, bar.uvs)


def sugar_bowl() -> tuple[Shape, Shape]:
    """A ball of a bowl on a foot, 0.11 m high with its lid and knob, which come second."""
    bowl = [
        (0, 0),
        (0.02, 0),
        (0.03, 0.001),
        (0.031, 0.004),
        (0.022, 0.01),
        (0.03, 0.017),
        (0.047, 0.032),
        (0.053, 0.052),
    ]
    bowl += [(0.047, 0.072), (0.04, 0.08), (0.038, 0.083), (0.03, 0.082), (0.012, 0.081), (0, 0.081)]
    lid = [(0, 0.08), (0.036, 0.08), (0.041, 0.083), (0.04, 0.086), (0.032, 0.092), (0.018, 0.098), (0.007, 0.1)]
    lid += [(0.0055, 0.104), (0.01, 0.108), (0.0105, 0.114), (0.006, 0.118), (0, 0.119)]
    return _turned(bowl, 2, 48), _turned(lid, 1, 40)


def swan_neck() -> Shape:
    """The neck of a kitchen tap, on z = 0, its mouth towards -Y."""
    curve = [(0, -0.01), (0, 0.12), (0, 0.22), (-0.025, 0.285), (-0.085, 0.31), (-0.145, 0.285), (-0.165, 0.225)]
    path = shapes.through(np.array(curve), 6)
    path = np.stack([0 * path[:, 0], path[:, 0], path[:, 1]], axis=-1)
    share = np.linspace(0, 1, len(path))
    return shapes.tube(path, np.interp(share, (0, 0.94, 0.95, 1), (0.0115, 0.0115, 0.014, 0.014)), 20, bore=0.0095)


def tap_body() -> Shape:
    """The pillar that the neck rises from."""
    profile = [
        (0, -0.004),
        (0.03, -0.004),
        (0.031, 0.004),
        (0.024, 0.009),
        (0.019, 0.02),
        (0.02, 0.05),
        (0.0215, 0.062),
    ]
    profile += [(0.0195, 0.07), (0.016, 0.078), (0.0165, 0.086), (0.012, 0.092), (0, 0.093)]
    return _turned(profile, 2, 32)


def tap_valve() -> Shape:
    """A pillar valve beside it with four spokes on its head, as one joined shape on z = 0."""
    profile = [
        (0, -0.004),
        (0.026, -0.004),
        (0.027, 0.004),
        (0.02, 0.009),
        (0.014, 0.02),
        (0.015, 0.045),
        (0.011, 0.054),
    ]
    profile += [(0.0115, 0.074), (0.014, 0.078), (0.013, 0.084), (0, 0.087)]
    spokes = []
    for degrees in (25.0, 115.0, 205.0, 295.0):
        path = _upright([(0.0, 0.066), (0.012, 0.066), (0.028, 0.067), (0.031, 0.067), (0.034, 0.067)])
        spoke = shapes.tube(path, np.array([0.0045, 0.0045, 0.0055, 0.0065, 0.004]), 10)
        spokes.append(spoke.turned(shapes.turn("Z", degrees)))
    return shapes.joined([_turned(profile, 1, 28), *spokes])


def bowl(radius: float, height: float) -> Shape:
    """An earthenware bowl on a foot, hollow; its glaze runs from the foot over the rim to the middle inside."""
    foot = [(0, 0), (0.42, 0), (0.46, 0.03), (0.44, 0.1)]
    outside = [(0.62, 0.24), (0.82, 0.52), (0.95, 0.84), (1.0, 1.0)]
    inside = [(0.985, 1.02), (0.96, 1.0), (0.9, 0.84), (0.76, 0.53), (0.56, 0.27), (0.3, 0.17), (0, 0.15)]
    return _turned(np.array([*foot, *outside, *inside]) * (radius, height), 3, 48, (1.0, 2.0))


def cup() -> list[Shape]:
    """A tea cup on its saucer, with an ear towards +X."""
    body = [(0, 0.008), (0.022, 0.008), (0.024, 0.014), (0.034, 0.03), (0.041, 0.055), (0.043, 0.074)]
    body += [(0.041, 0.0745), (0.038, 0.055), (0.031, 0.032), (0.02, 0.02), (0, 0.018)]
    saucer = [(0, 0), (0.035, 0), (0.04, 0.003), (0.065, 0.012), (0.074, 0.018), (0.073, 0.0205), (0.06, 0.0145)]
    saucer += [(0.036, 0.008), (0.0, 0.0075)]
    ear = shapes.through(np.array([(0.038, 0.06), (0.058, 0.064), (0.064, 0.047), (0.05, 0.03), (0.033, 0.028)]), 6)
    return [_turned(body, 2, 32), _turned(saucer, 1, 32), shapes.tube(_upright(ear), 0.0042, 10)]


def jar(radius: float, height: float) -> tuple[Shape, Shape]:
    """A storage jar and its lid of cork with a knob."""
    body = [
        (0, 0),
        (0.9, 0),
        (0.97, 0.015),
        (1.0, 0.06),
        (1.0, 0.7),
        (0.98, 0.82),
        (0.86, 0.92),
        (0.8, 0.95),
        (0.8, 1.0),
    ]
    lid = [(0, 0.96), (0.7, 0.96), (0.78, 0.99), (0.86, 1.0), (0.87, 1.05), (0.8, 1.07), (0.2, 1.08), (0.15, 1.1)]
    lid += [(0.24, 1.13), (0.24, 1.17), (0.1, 1.2), (0, 1.2)]
    size = np.array((radius, height))
    return (
        _turned(np.array([*body, (0.7, 1.0), (0.7, 0.94), (0, 0.94)]) * size, 1, 32),
        _turned(np.array(lid) * size, 1, 28),
    )


def plate(radius: float) -> Shape:
    """A dinner plate on z = 0."""
    profile = [
        (0, 0),
        (0.5, 0),
        (0.56, 0.02),
        (0.75, 0.07),
        (1.0, 0.12),
        (0.995, 0.14),
        (0.72, 0.1),
        (0.56, 0.06),
        (0, 0.05),
    ]
    return shapes.lathe(np.array(profile) * radius, 28)


def board(length: float, width: float, thick: float) -> Shape:
    """A chopping board with round corners, on z = 0, long along X."""
    outline = shapes.rounded(length, width, 0.03, 6)
    ring = np.insert(np.concatenate([outline, outline[:1]]), 2, 0.0, axis=1)
    inner = ring * (1 - 0.006 / length, 1 - 0.006 / width, 1)
    levels = [
        ring * 0,
        inner,
        ring + (0, 0, 0.003),
        ring + (0, 0, thick - 0.003),
        inner + (0, 0, thick),
        ring * 0 + (0, 0, thick),
    ]
    shape = shapes.sheet(np.stack(levels))
    return shape.textured(0.5)


def sink(wide: float, long: float, deep: float, wall: float = 0.03) -> Shape:
    """A Belfast sink, hollow, its rim in z = 0."""
    x, y = wide / 2, long / 2
    sections = [(-deep - wall, 0, 0, 0, 7), (-deep - wall, x - 0.01, y - 0.01, 0, 7), (-deep - wall + 0.02, x, y, 0, 8)]
    sections += [
        (-0.008, x, y, 0, 9),
        (0.0, x - 0.008, y - 0.008, 0, 9),
        (0.0, x - wall + 0.008, y - wall + 0.008, 0, 9),
    ]
    sections += [(-0.008, x - wall, y - wall, 0, 9), (-deep + 0.04, x - wall, y - wall, 0, 8)]
    sections += [(-deep + 0.006, x - wall - 0.03, y - wall - 0.03, 0, 6), (-deep, 0, 0, 0, 5)]
    return shapes.loft(np.array(sections), 72)
