"""Furniture and ornaments as lists of parts, pairs of a shape and a material, for `stage.assemble`. Metres."""

import numpy as np

from . import shapes
from .shapes import Shape


def frame(outline: np.ndarray, width: float, depth: float, turns: float = 8.0) -> Shape:
    """A moulding round a pane in y = 0 with an `outline` (N, 2) of X and Z, counter-clockwise as seen from -Y.

    It overlaps the pane's rim by a hair and stands `depth` before it; its texture repeats `turns` times a metre.
    """
    path = np.concatenate([outline, outline[:1]])
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    inside, outside = -0.012, width
    profile = np.array(
        [(-0.02, outside), (depth * 0.6, outside), (depth, outside * 0.75), (depth * 0.8, outside * 0.45)]
        + [(depth * 0.85, outside * 0.25), (depth * 0.35, inside), (-0.02, inside)]
    )
    points = np.insert(path, 1, 0.0, axis=1)
    return shapes.sweep(points, profile[::-1], (0.0, -1.0, 0.0), (1.0, max(round(turns * length), 1)))


def casement(width: float, height: float, wood) -> list:
    """A window of three lights in an opening about the origin, through a wall 0.16 m thick behind y = 0."""
    x, z = width / 2, height / 2
    outline = np.array([(-x, -z), (x, -z), (x, z), (-x, z)])
    edge = np.insert(np.concatenate([outline, outline[:1]]), 1, 0.0, axis=1)
    upright, across = shapes.box((0.036, 0.04, height - 0.002)), shapes.box((width - 0.002, 0.03, 0.04))
    bars = [upright.moved((side, 0.12, 0.001 - z)) for side in (0.02 - x, -x / 3, x / 3, x - 0.02)]
    bars += [across.moved((0, 0.121, level)) for level in (0.001 - z, 0.2 * z, z - 0.041)]
    sill = shapes.box((width + 0.1, 0.2, 0.025)).moved((0, 0.06, -z - 0.024))
    reveal = shapes.sheet(np.stack([edge, edge + (0, 0.16, 0)]))
    return [(shape, wood) for shape in (reveal, frame(outline, 0.06, 0.02, 1.0), *bars, sill)]


def dresser(paint, wood) -> list:
    """A kitchen dresser 1.5 m wide before a wall in y = 0: a cupboard, and three shelves over it."""
    parts = [(shapes.box((1.5, 0.42, 0.88)).moved((0, -0.21, 0)), paint)]
    parts.append((shapes.box((1.56, 0.46, 0.035)).moved((0, -0.22, 0.88)), wood))
    parts += [(shapes.box((0.03, 0.2, 1.15)).moved((side * 0.735, -0.1, 0.914)), paint) for side in (-1, 1)]
    return parts + [(shapes.box((1.45, 0.2, 0.025)).moved((0, -0.1, z)), paint) for z in (1.24, 1.6, 2.04)]


def table(width: float, depth: float, top, wood) -> list:
    """A table 0.75 m high, its top textured every 0.3 m."""
    x, y = width / 2 - 0.07, depth / 2 - 0.065
    legs = [shapes.box((0.06, 0.06, 0.721)).moved((side * x, end * y, 0)) for side in (-1, 1) for end in (-1, 1)]
    return [(shapes.box((width, depth, 0.03), 0.3).moved((0, 0, 0.72)), top), *((leg, wood) for leg in legs)]


def book(width: float, height: float, binding, paper) -> list:
    """A book that stands on z = 0, its spine towards -Y."""
    pages = shapes.box((width - 0.006, 0.182, height - 0.012)).moved((0, 0.004, 0.006))
    return [(shapes.box((width, 0.18, height)), binding), (pages, paper)]


def chair(wood, cloth) -> list:
    """A chair with turned legs, a round seat and an oval back; it faces -Y."""
    leg = [(0, 0), (0.014, 0), (0.018, 0.05), (0.014, 0.07), (0.024, 0.36), (0.03, 0.38), (0.03, 0.44), (0, 0.44)]
    parts = [(shapes.lathe(leg, 16).moved((x, y, 0.0)), wood) for x in (-0.19, 0.19) for y in (-0.17, 0.17)]
    rail = [(0, 0.4), (0.25, 0.4), (0.265, 0.43), (0.25, 0.46), (0, 0.46)]
    cushion = [(0, 0.455), (0.235, 0.455), (0.255, 0.48), (0.235, 0.515), (0.15, 0.53), (0, 0.535)]
    parts += [(shapes.lathe(rail, 48), wood), (shapes.lathe(cushion, 48), cloth)]
    lean = shapes.turn("X", -9.0)
    back = np.array((0.0, 0.235, 0.78))
    oval = shapes.ellipse(0.4, 0.46, 48)
    ring = np.stack([np.append(oval[:, 0], oval[0, 0]), np.zeros(49), np.append(oval[:, 1], oval[0, 1])], axis=-1)
    pad = shapes.sphere(1.0, 32, 16).moved(scale=(0.195, 0.03, 0.225))
    for shape, material in ((shapes.tube(ring, 0.022, 12), wood), (pad, cloth)):
        parts.append((shape.turned(lean).moved(back), material))
    for x in (-0.12, 0.12):
        parts.append((shapes.tube(np.array([(x, 0.2, 0.42), (x * 1.05, 0.215, 0.61)]), 0.018, 12), wood))
    return parts


def pedestal(height: float, radius: float, stone) -> list:
    """A round column for a statue or a vase."""
    shares = [(0, 0), (1, 0), (1, 0.06), (0.86, 0.09), (0.9, 0.12), (0.7, 0.16), (0.64, 0.5), (0.7, 0.84), (0.9, 0.88)]
    shares += [(0.86, 0.92), (1, 0.95), (1, 1), (0, 1)]
    return [(shapes.lathe(np.array(shares) * (radius, height), 48).textured(0.6), stone)]


def vase(height: float, glaze) -> list:
    """A bulging vase with a wide lip, hollow inside."""
    outside = np.array(
        [(0.0, 0.0), (0.11, 0.0), (0.12, 0.02), (0.24, 0.3), (0.25, 0.5), (0.13, 0.76), (0.11, 0.86), (0.17, 1.0)]
    )
    inside = np.array([(0.15, 0.985), (0.095, 0.86), (0.11, 0.74), (0.0, 0.6)])
    curve = shapes.through(outside[1:], 8)
    return [(shapes.lathe(np.concatenate([outside[:1], curve, inside]) * height, 48), glaze)]


def flowers(height: float, count: int, stalk, petals: list) -> list:
    """A bunch out of the mouth of a vase `height` high: tulips on bent stalks."""
    random = np.random.default_rng(3)
    cup = shapes.through(np.array([(0.0, 0.0), (0.022, 0.008), (0.034, 0.035), (0.026, 0.075), (0.03, 0.085)]), 4)
    bloom = shapes.lathe(np.concatenate([cup, [(0.0, 0.06)]]), 16)
    parts = []
    for number in range(count):
        azimuth = 2.4 * number
        out = np.array([np.cos(azimuth), np.sin(azimuth), 0.0]) * (0.06 + 0.22 * np.sqrt(number / count))
        top = out + (0.0, 0.0, height * 1.5 - 0.35 * np.hypot(*out[:2]) + random.uniform(-0.03, 0.03))
        path = shapes.through(np.array([(0.0, 0.0, height * 0.7), out * 0.2 + (0, 0, height), top]), 6)
        lean = shapes.turn("Z", np.degrees(azimuth)) @ shapes.turn("Y", 90.0 * np.hypot(*out[:2]))
        parts.append((shapes.tube(path, 0.006, 6), stalk))
        parts.append((bloom.turned(lean).moved(top - 0.01 * out), petals[number % len(petals)]))
    return parts


def chandelier(gold, wax, light, arms: int = 8) -> list:
    """Candles on curved arms round a baluster that hangs from the origin; 1.3 m high."""
    stem = np.array(
        [(0.0, -1.3), (0.03, -1.27), (0.05, -1.2), (0.02, -1.14), (0.09, -1.05), (0.1, -0.98), (0.03, -0.88)]
    )
    stem = np.concatenate(
        [shapes.through(stem, 4), [(0.03, -0.6), (0.06, -0.56), (0.012, -0.5), (0.012, -0.03), (0.08, 0.0)]]
    )
    parts = [(shapes.lathe(stem, 24), gold)]
    arm = shapes.through(np.array([(0.06, 0, -1.0), (0.2, 0, -1.16), (0.4, 0, -1.08), (0.46, 0, -0.9)]), 8)
    dish = shapes.lathe([(0.0, -0.92), (0.015, -0.92), (0.06, -0.88), (0.055, -0.875), (0.0, -0.9)], 16)
    candle = shapes.lathe([(0.012, -0.89), (0.012, -0.76), (0.0, -0.755)], 10)
    flame = shapes.sphere(1.0, 12, 8).moved((0, 0, -0.735), (0.012, 0.012, 0.03))
    for number in range(arms):
        around = shapes.turn("Z", 360.0 * number / arms)
        parts.append((shapes.tube(arm, 0.011, 8).turned(around), gold))
        for shape, material in ((dish, gold), (candle, wax), (flame, light)):
            parts.append((shape.moved((0.46, 0, 0)).turned(around), material))
    return parts
