"""Fruit, bread and herbs, as shapes: smooth, closed meshes dense enough to be mirrored vertex by vertex. Metres.

Round fruit have their middle at the origin and their stalk upwards.
"""

import numpy as np

from . import shapes
from .shapes import Shape


def apple(radius: float = 0.038, segments: int = 32, rings: int = 20) -> Shape:
    """An apple, dimpled at both ends and a little lobed below; its texture's v runs from calyx to stalk."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    wide = np.cos(angle) * (1.0 + 0.1 * np.sin(angle))
    high = 0.9 * np.sin(angle) - 0.34 * np.exp(-((wide / 0.3) ** 2)) * np.sign(np.sin(angle))
    wide[[0, -1]] = 0.0
    shape = shapes.lathe(np.stack([wide, high], axis=-1), segments)
    around = np.arctan2(shape.points[:, 1], shape.points[:, 0])
    lobes = 1.0 + 0.035 * np.cos(5.0 * around) * np.clip(-shape.points[:, 2], 0.0, 1.0)
    return Shape(shape.points * lobes[:, None] * radius, shape.faces, shape.uvs)


def stalk(length: float = 0.022) -> Shape:
    """The stalk of an apple of the size above."""
    path = shapes.through(np.array([(0, 0, 0.018), (0.001, 0, 0.028), (0.005, 0.002, 0.018 + length)]), 5)
    return shapes.tube(path, np.linspace(0.0012, 0.0017, len(path)), 8)


def orange(radius: float = 0.04, segments: int = 36, rings: int = 20) -> Shape:
    """An orange, a little flat, with a navel."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    wide, high = np.cos(angle), 0.94 * np.sin(angle)
    high = high - 0.06 * np.exp(-((wide / 0.12) ** 2)) * np.sign(high)
    wide[[0, -1]] = 0.0
    return shapes.lathe(radius * np.stack([wide, high], axis=-1), segments)


def half(radius: float = 0.04) -> tuple[Shape, Shape]:
    """Half a citrus fruit: its peel, and its face, upwards in z = 0."""
    angle = np.linspace(-np.pi / 2, 0.0, 15)
    rind = radius * np.stack([np.cos(angle), 0.94 * np.sin(angle)], axis=-1)
    rind[0, 0] = 0.0
    face = shapes.disc(radius, 48, 2.0 * radius)
    return shapes.lathe(rind, 48), face


def lemon(radius: float = 0.027) -> Shape:
    """A lemon, long along Z, with a nipple at either end."""
    profile = [(0, -1.52), (0.13, -1.46), (0.24, -1.34), (0.55, -1.08), (0.88, -0.6), (1.0, 0.0), (0.9, 0.58)]
    profile += [(0.6, 1.05), (0.28, 1.32), (0.16, 1.46), (0, 1.52)]
    return shapes.lathe(radius * shapes.through(np.array(profile), 2), 32)


def banana(length: float = 0.19, radius: float = 0.017, bend: float = 95.0) -> Shape:
    """A banana in y = 0, its ends up and its middle's underside at the origin."""
    share = np.linspace(0.0, 1.0, 32)
    angle = np.radians(bend) * (share - 0.5)
    curve = length / np.radians(bend)
    path = np.stack([curve * np.sin(angle), 0 * angle, curve * (1.0 - np.cos(angle)) + radius], axis=-1)
    swell = np.array(
        [(0, 0.3), (0.05, 0.36), (0.1, 0.45), (0.2, 0.86), (0.45, 1.0), (0.78, 0.92), (0.9, 0.55), (0.96, 0.28)]
    )
    width = radius * np.interp(share, *np.concatenate([swell, [(1.0, 0.24)]]).T)
    smooth = np.convolve(np.pad(width, 3, mode="edge"), np.ones(7) / 7, mode="valid")
    skin = shapes.tube(path, smooth, 20)
    # Five blunt edges run along it: what lies off the middle line is drawn in between them.
    nearest = np.argmin(np.linalg.norm(skin.points[:, None] - path[None], axis=-1), axis=1)
    off = skin.points - path[nearest]
    inwards = np.stack([-np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)[nearest]
    around = np.arctan2(off[:, 1], np.einsum("pi,pi->p", off, inwards))
    edged = 1.0 + 0.055 * np.cos(5.0 * around)
    return Shape(path[nearest] + off * edged[:, None], skin.faces, skin.uvs)


def grapes(count: int, radius: float = 0.0105, seed: int = 3) -> tuple[list[Shape], Shape]:
    """A bunch that lies on z = 0, long along X: its berries, close but apart, and its stem."""
    random = np.random.default_rng(seed)
    places: list[np.ndarray] = []
    while len(places) < count:
        share = random.random()
        wide = 0.047 * np.sin(np.pi * (0.16 + 0.78 * share)) ** 0.7
        spot = np.array([0.15 * (share - 0.5), random.uniform(-wide, wide), radius + random.uniform(0.0, 0.95 * wide)])
        inside = (spot[1] / wide) ** 2 + ((spot[2] - radius) / wide) ** 2 < 1.0
        if inside and all(np.linalg.norm(spot - other) > 1.72 * radius for other in places):
            places.append(spot)
    berry = shapes.sphere(radius, 14, 9)
    stem = shapes.through(np.array([(-0.07, 0, 0.02), (-0.095, 0.004, 0.03), (-0.12, 0.012, 0.032)]), 6)
    return [berry.moved(place, random.uniform(0.93, 1.05)) for place in places], shapes.tube(stem, 0.0022, 10)


def loaf(length: float = 0.26, wide: float = 0.062, high: float = 0.095) -> Shape:
    """A country loaf that stands on z = 0, long along X; its texture's v runs along it."""
    share = np.linspace(-1.0, 1.0, 31)
    size = np.sqrt(np.maximum(1.0 - np.abs(share) ** 2.6, 0.0))
    around = np.linspace(0.0, 2.0 * np.pi, 33)
    y = wide * np.cos(around)
    z = high * np.where(
        np.sin(around) > 0, 0.5 + 0.5 * np.sin(around), 0.5 + 0.5 * np.sin(around) * (1 - 0.4 * np.cos(around) ** 2)
    )
    split = 1.0 + 0.05 * np.sin(9.0 * share[:, None]) * np.clip(np.sin(around), 0.0, 1.0)
    grid = np.stack(
        [
            np.broadcast_to(0.5 * length * share[:, None], split.shape),
            size[:, None] * y,
            0.42 * high + size[:, None] * (z - 0.42 * high) * split,
        ],
        axis=-1,
    )
    return shapes.sheet(grid)


def slice_of_bread(wide: float = 0.058, high: float = 0.088, thick: float = 0.016) -> tuple[Shape, Shape]:
    """A slice, lying on z = 0: its crust, and its upper face with the crumb."""
    outline = shapes.ellipse(2.0 * wide, high * 1.1, 56)
    outline[:, 1] = np.maximum(outline[:, 1], -0.4 * high)
    ring = np.insert(np.concatenate([outline, outline[:1]]), 2, 0.0, axis=1)
    crust = shapes.sheet(np.stack([ring * 0, ring, ring + (0.0, 0.0, thick)]))
    face = shapes.sheet(np.stack([ring, ring * 0]) + (0.0, 0.0, thick))
    corners = face.points[np.maximum(face.faces, 0)]
    return crust, Shape(face.points, face.faces, corners[..., :2] / (2.0 * wide, high * 1.1) + 0.5)


def tomato(radius: float = 0.033) -> tuple[Shape, Shape]:
    """A tomato and the green star on it."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 17)
    wide, high = np.cos(angle) ** 0.85, 0.8 * np.sin(angle)
    high = high - 0.18 * np.exp(-((wide / 0.3) ** 2)) * (high > 0)
    wide[[0, -1]] = 0.0
    fruit = shapes.lathe(radius * np.stack([wide, high], axis=-1), 28)
    around = np.linspace(0.0, 2.0 * np.pi, 61)
    reach = 0.25 + 0.75 * np.abs(np.cos(2.5 * around)) ** 3
    reach[-1] = reach[0]
    tip = np.stack([reach * np.cos(around), reach * np.sin(around), 0.0 * around], axis=-1) * 0.7 * radius
    low, high_ = tip * (1, 1, 0) + (0, 0, 0.66 * radius), tip * (0.9, 0.9, 0) + (0, 0, 0.72 * radius)
    middle = np.broadcast_to((0.0, 0.0, 0.7 * radius), tip.shape)
    star = shapes.sheet(np.stack([middle - (0, 0, 0.1 * radius), low, high_, middle]))
    return fruit, star


def basil(count: int, reach: float, stalk_material, leaf_material) -> list:
    """A pot of basil: cupped leaves in pairs up many stalks, both sides of each modelled."""
    random = np.random.default_rng(17)
    u = np.linspace(0.0, 1.0, 6)
    width = 0.36 * np.sin(np.pi * u**0.8)
    side = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    grid = np.stack(
        [
            np.broadcast_to(u[:, None], (6, 5)),
            width[:, None] * side,
            0.16 * width[:, None] * side**2 * 2 - 0.3 * (u[:, None] - 0.3) ** 2,
        ],
        axis=-1,
    )
    round_ = np.concatenate([grid, (grid - (0, 0, 0.015))[:, ::-1][:, 1:], grid[:, :1]], axis=1)
    leaf = shapes.sheet(round_[:, ::-1])
    parts = []
    for number in range(count):
        azimuth = 137.5 * number
        lean = 0.75 * np.sqrt((number + 0.5) / count)
        top = (
            np.array([lean * np.cos(np.radians(azimuth)), lean * np.sin(np.radians(azimuth)), 1.25 - 0.5 * lean])
            * reach
        )
        path = shapes.through(np.array([top * (0.1, 0.1, 0.0), top * (0.5, 0.5, 0.55), top]), 4)
        parts.append((shapes.tube(path, 0.0016, 6), stalk_material))
        for step, size in ((4, 0.34), (6, 0.42), (8, 0.36)):
            spin = random.uniform(0, 360)
            for quarter in range(2 if step < 8 else 4):
                turned = shapes.turn("Z", spin + (180.0 if step < 8 else 90.0) * quarter) @ shapes.turn(
                    "Y", random.uniform(-28, 12)
                )
                parts.append(
                    (
                        leaf.moved(scale=size * reach * random.uniform(0.85, 1.1)).turned(turned).moved(path[step]),
                        leaf_material,
                    )
                )
    return parts
