"""wet-street: a lane of setts after rain, in the evening: puddles like mirrors among duller wet stones.

Metres; the lane runs along +Y between two rows of houses. Its paving is one flat rectangle with a
roughness texture; everything stands on it.
"""

from itertools import pairwise

import numpy as np

from . import furniture, masonry, pictures, shapes, stage, street, surfaces

WIDE, NEAR, FAR = 9.6, -4.0, 32.0
TILE = (6.5, 13.0)


def build() -> None:
    """Build the scene into the open, empty file."""
    _paving()
    roof = stage.matte("Slates", "#3f4654", surfaces.slates("#4a5160"), 85)
    iron = stage.matte("Iron", "#23282b")
    _houses(roof)
    _gate(roof)
    _street_lamps(iron)
    _things(iron)
    _string_lights(iron)
    sky = pictures.Sky(
        azimuth=84.0, elevation=3.0, zenith="#1c2f5e", horizon="#e9a67c", glow="#ff9350", cloud="#b9727c",
        hills="#2f3450", cover=0.42, seed=12,
    )  # fmt: skip
    stage.sky(sky, sun=0.3, strength=0.75)
    stage.camera((-0.5, -2.2, 1.6), (0.15, 12.0, 1.3), 27.0)


def _paving() -> None:
    colour, roughness = surfaces.setts()
    wet = stage.polished("Setts", colour, roughness, quality=76)
    plane = shapes.rectangle(WIDE + 0.6, FAR - NEAR)
    uvs = plane.uvs * (np.array([WIDE + 0.6, FAR - NEAR]) / TILE)
    place = (0.0, (FAR + NEAR) / 2, 0.0)
    stage.reflects(stage.put("Paving", shapes.Shape(plane.points, plane.faces, uvs), wet, place, smooth=False))


def _houses(roof) -> None:
    """Three houses a side, of brick and of plaster."""
    brick = stage.matte("Brick", "#8a4a38", surfaces.bricks("#93503b", "#b3a593"), 85)
    dark = stage.matte("Dark brick", "#5d4038", surfaces.bricks("#68463c", "#8d8278"), 85)
    ochre = stage.matte("Ochre plaster", "#c99a5a", surfaces.plaster("#c99a5a"), 85)
    blue = stage.matte("Blue plaster", "#7f95a8", surfaces.plaster("#7f95a8"), 85)
    white, stone = stage.matte("White paint", "#e4ddd0"), stage.matte("Trim", "#b9ad98")
    glass = street.Glass()
    left = (
        street.House(11.0, 2, 4, ochre, white, shop="CAFE", lit=4),
        street.House(9.0, 3, 3, dark, stone, lit=5),
        street.House(16.0, 2, 5, blue, white, ("#24507a", "#efe6d4"), "BOOKS", lit=6),
    )
    right = (
        street.House(9.0, 2, 3, blue, white, lit=7),
        street.House(12.0, 3, 4, brick, stone, ("#2f6b4a", "#efe6d4"), "HOTEL", lit=9),
        street.House(15.0, 2, 5, ochre, stone, lit=11),
    )
    for side, row in ((-1, left), (1, right)):
        y = NEAR
        for number, kind in enumerate(row):
            name = f"House {('left', 'right')[side > 0]} {number + 1}"
            place = (side * WIDE / 2, y + kind.width / 2, 0.0)
            stage.assemble(name, street.house(kind, glass, roof), place, (0, 0, -90 * side), 30.0)
            y += kind.width


def _gate(roof) -> None:
    """The town gate at the end of the lane: an arch, battlements, and a tower with a clock and a steep roof."""
    stone = stage.matte("Gate", "#8f8271", surfaces.ashlar("#978a78", 6, 3), 85)
    width, high, half = WIDE + 1.0, 6.4, 1.8
    parts = [
        (masonry.arch(2 * half - 0.1, 2.2, 2.6, 0.7, 0.25, 10, walled=True), stone),
        (masonry.wall_over_arch(2 * half, 2.25, 2.6, width, high, 10).moved((0.0, -0.55, 0.0)), stone),
        (shapes.box((4.4, 2.0, 5.4)).moved((0.0, 0.3, high - 0.6)).textured(1.6), stone),
        (masonry.course(4.4, 0.14, 0.3).moved((0.0, -0.7, high + 0.1)), stone),
        (masonry.course(width, 0.12, 0.24).moved((0.0, -0.55, high - 0.7)), stone),
    ]
    for side in (-1, 1):
        pier = shapes.box((width / 2 - half, 1.1, 2.6 + street.SUNK)).moved(
            (side * (width / 4 + half / 2), 0, -street.SUNK)
        )
        parts.append((pier.textured(1.6), stone))
        merlons = [shapes.box((0.5, 0.4, 0.6)).moved((side * x, -0.352, high - 0.05)) for x in (2.75, 3.6, 4.45)]
        parts += [(merlon.textured(1.6), stone) for merlon in merlons]
    spire = shapes.lathe([(0.0, 11.1), (3.5, 11.1), (3.5, 11.2), (0.35, 15.6), (0.0, 16.6)], 4).turned(
        shapes.turn("Z", 45.0)
    )
    parts.append((spire.moved((0.0, 0.3, 0.0)).textured(2.0), roof))
    clock = stage.glowing("Clock", "#ffe9b8", 2.2, surfaces.clock())
    rim = shapes.ellipse(2.0, 2.0, 32)
    parts.append((shapes.pane(rim).moved((0.0, -0.72, 9.2)), clock))
    parts.append((furniture.frame(rim, 0.16, 0.12, 1.0).moved((0.0, -0.72, 9.2)), stone))
    stage.assemble("Gate", parts, (0.0, FAR - 0.6, 0.0))


def _street_lamps(iron) -> None:
    """Four lanterns, each with a lamp that nobody sees."""
    light = stage.glowing("Lantern", "#ffd59a", 7.0, lamp=False)
    first = None
    for x, y in ((3.35, 3.6), (-3.35, 8.6), (3.35, 14.6), (-3.35, 21.0)):
        if first is None:
            first = stage.assemble("Lantern", street.lantern(iron, light), (x, y, 0.0))
        else:
            stage.again(first, (x, y, 0.0))
        stage.point_lamp("Lantern light", 220.0, 0.3, (x * 0.9, y, 3.4), "#ffc27a")


def _things(iron) -> None:
    """What stands on the lane: a telephone box, bollards with chains, a bicycle, a cafe's table and chairs, tubs."""
    red = stage.matte("Red paint", "#b3201f")
    pale = stage.glowing("Booth light", "#ffeecb", 1.6, lamp=False)
    stage.assemble("Telephone box", street.phone_box(red, pale), (2.9, 7.4, 0.0), (0, 0, -14))
    stage.point_lamp("Booth lamp", 25.0, 0.2, (2.4, 6.3, 1.6), "#ffe6c0")
    posts = [(-2.4, y, 0.0) for y in (2.6, 4.6, 6.6)]
    first = stage.assemble("Bollard", street.bollard(iron), posts[0])
    for place in posts[1:]:
        stage.again(first, place)
    chains = [
        shapes.tube(street.hanging(np.add(a, (0, 0, 0.74)), np.add(b, (0, 0, 0.74)), 0.22), 0.018, 8)
        for a, b in pairwise(posts)
    ]
    stage.assemble("Chains", [(chain, iron) for chain in chains])
    black, steel = stage.matte("Rubber", "#1c1c1e"), stage.matte("Steel", "#9aa0a6")
    cycle = street.bicycle(stage.matte("Green paint", "#2d6a4f"), black, steel)
    stage.assemble("Bicycle", cycle, (3.1, 4.1, 0.0), (-9, 0, 96))
    top = stage.matte("Table top", "#c9bba0")
    stage.assemble("Table", street.cafe_table(iron, top), (-3.3, 5.0, -0.01))
    wood, seat = stage.matte("Bistro green", "#3c5a49"), stage.matte("Bistro seat", "#b58a56")
    chair = stage.assemble("Bistro chair", furniture.chair(wood, seat), (-3.75, 4.35, -0.01), (0, 0, 145))
    stage.again(chair, (-3.5, 5.75, -0.01), (0, 0, 10))
    pot = shapes.lathe(
        [(0, 0), (0.2, 0), (0.28, 0.4), (0.31, 0.42), (0.31, 0.48), (0.26, 0.48), (0.25, 0.42), (0, 0.42)], 28
    )
    clay, leaf = stage.matte("Clay", "#a4593b"), stage.matte("Box tree", "#3f5f36", surfaces.leaves(), 88)
    bush = shapes.sphere(0.4, 24, 16).moved((0.0, 0.0, 0.82))
    tub = stage.assemble("Tub", [(pot, clay), (bush, leaf)], (3.6, 10.4, -0.01))
    for place in ((3.6, 12.4, -0.01), (-3.7, 11.2, -0.01), (-3.7, 1.6, -0.01)):
        stage.again(tub, place)


def _string_lights(iron) -> None:
    """Bulbs on three cables across the lane."""
    warm = stage.glowing("Bulb", "#ffcf80", 6.0, lamp=False)
    bulb = shapes.sphere(0.06, 12, 8)
    parts = []
    for y, left, right in ((6.0, 5.6, 5.9), (11.0, 5.9, 5.5), (17.5, 5.7, 5.8)):
        line = street.hanging((-WIDE / 2, y, left), (WIDE / 2, y + 1.2, right), 0.9, 22)
        parts.append((shapes.tube(line, 0.012, 6), iron))
        parts += [(bulb.moved(point - (0.0, 0.0, 0.07)), warm) for point in line[2:-1:2]]
    stage.assemble("String lights", parts)
