"""mirror-room: a chrome teapot on a table, in a closed and furnished room. Metres, 4.8 by 4.4 by 2.7."""

import numpy as np

from . import pictures, shapes, stage

WIDE, DEEP, HIGH, WALL = 4.8, 4.4, 2.7, 0.12


def build() -> None:
    """Build the scene into the open, empty file."""
    oak = stage.matte("Oak", "#a9774a")
    _shell()
    _windows()
    _table(oak, (0.0, -0.2), 0.74)
    _chair("Chair left", oak, (-0.95, 0.2), 75.0)
    _chair("Chair right", oak, (1.0, 0.35), -70.0)
    _sofa((0.0, 1.6))
    _shelf(oak, (-1.75, 2.05))
    _standing_lamp((1.75, 1.75))
    _pictures()
    _teapot((0.0, -0.25, 0.74))
    stage.plain_world("#808890", 0.3)
    stage.camera((0.1, -1.12, 1.08), (0.018, -0.2, 0.868), 48.5)


def _block(name: str, size, material, location, turned: float = 0.0, repeat: float | None = None):
    return stage.put(name, shapes.box(size, repeat), material, location, (0.0, 0.0, turned), smooth=False)


def _shell() -> None:
    plaster = stage.matte("Plaster", "#e6dfd2")
    green = stage.matte("Green wall", "#7f9a87")
    floor = stage.matte("Floor", picture=pictures.planks(384))
    outer = (WIDE + 2 * WALL, DEEP + 2 * WALL)
    _block("Floor", (*outer, WALL), floor, (0, 0, -WALL), repeat=1.6)
    _block("Ceiling", (*outer, WALL), stage.matte("Ceiling", "#f1eee8"), (0, 0, HIGH))
    for name, side in (("Wall left", -1), ("Wall right", 1)):
        _block(name, (WALL, DEEP, HIGH), plaster, (side * (WIDE + WALL) / 2, 0, 0))
    _block("Wall front", (outer[0], WALL, HIGH), plaster, (0, -(DEEP + WALL) / 2, 0))
    _block("Wall back", (outer[0], WALL, HIGH), green, (0, (DEEP + WALL) / 2, 0))
    rug = stage.matte("Rug", picture=pictures.rug(384))
    _block("Rug", (2.6, 2.0, 0.015), rug, (0.0, 0.1, 0.0))


def _windows() -> None:
    """Two bright panes with glazing bars in the left wall, one behind the camera; lamps shine in before them."""
    pane, frame = stage.glowing("Daylight", "#dcebff", 2.2), stage.matte("Window frame", "#f6f3ec")
    depth = WIDE / 2 - 0.02
    for name, y in (("Window near", -0.95), ("Window far", 0.75)):
        _block(name, (0.02, 1.1, 1.3), pane, (-depth, y, 0.95))
        _bars(name, frame, lambda along, y=y: (-depth + 0.03, y + along), 90.0, 1.1)
        stage.area_lamp(name, 45.0, (1.0, 1.2), (-depth + 0.1, y, 1.6), (0.6, y * 0.6, 0.7), "#e6f0ff")
    _block("Window front", (1.5, 0.02, 1.3), pane, (0.9, -DEEP / 2 + 0.02, 0.95))
    _bars("Window front", frame, lambda along: (0.9 + along, -DEEP / 2 + 0.05), 0.0, 1.5)
    stage.area_lamp("Window front", 40.0, (1.4, 1.2), (0.9, -DEEP / 2 + 0.12, 1.6), (0.4, 0.8, 0.8), "#e6f0ff")
    stage.area_lamp("Ceiling light", 25.0, (1.6, 1.6), (0.0, 0.2, HIGH - 0.05), (0.0, 0.2, 0.0), "#ffe9cc")


def _bars(name: str, frame, at, turned: float, width: float) -> None:
    """The frame and the cross of a window `width` wide, its middle bar where `at(0)` says."""
    for i, along in enumerate((-width / 2, 0.0, width / 2)):
        _block(f"{name} upright {i}", (0.06, 0.05, 1.36), frame, (*at(along), 0.92), turned)
    for i, height in enumerate((0.9, 1.72, 2.24)):
        _block(f"{name} crossbar {i}", (width + 0.12, 0.055, 0.06), frame, (*at(0.0), height), turned)


def _table(wood, place, height: float) -> None:
    x, y = place
    _block(
        "Table top", (1.5, 0.95, 0.04), stage.matte("Table top", picture=pictures.planks(256, 8)), (x, y, height - 0.04)
    )
    for i, (along, across) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        _block(f"Table leg {i}", (0.07, 0.07, height - 0.04), wood, (x + 0.66 * along, y + 0.4 * across, 0.0))
    cloth = stage.matte("Runner", picture=pictures.star_tiles(256))
    runner = shapes.box((1.3, 0.36, 0.004))
    stage.put(
        "Runner",
        shapes.Shape(runner.points, runner.faces, runner.uvs * (7.0, 2.0)),
        cloth,
        (x, y - 0.05, height),
        smooth=False,
    )
    cup = shapes.lathe([(0, 0), (0.03, 0), (0.045, 0.05), (0.048, 0.09), (0.043, 0.09), (0.038, 0.04), (0, 0.012)], 48)
    for name, code, (dx, dy) in (("Cup red", "#c4452f", (-0.4, -0.06)), ("Cup blue", "#2d5f8a", (0.42, 0.0))):
        stage.put(name, cup, stage.matte(name, code), (x + dx, y + dy, height + 0.0045))
    fruit = stage.matte("Orange", "#e88a1c")
    for i, (dx, dy) in enumerate(((0.5, -0.22), (0.41, -0.25), (0.46, -0.3))):
        stage.put(f"Orange {i}", shapes.sphere(0.043, 32, 16), fruit, (x + dx, y + dy, height + 0.043))


def _chair(name: str, wood, place, turned: float) -> None:
    turn = shapes.turn("Z", turned)

    def part(label, size, offset, material=wood):
        x, y, z = turn @ np.array(offset)
        _block(f"{name} {label}", size, material, (place[0] + x, place[1] + y, z), turned)

    for i, (along, across) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        part(f"leg {i}", (0.04, 0.04, 0.44 if across < 0 else 0.95), (0.19 * along, 0.19 * across, 0.0))
    part("seat", (0.44, 0.44, 0.05), (0.0, 0.0, 0.44), stage.matte(f"{name} seat", "#b5533c"))
    for i, height in enumerate((0.6, 0.74, 0.88)):
        part(f"slat {i}", (0.36, 0.025, 0.06), (0.0, 0.19, height))


def _sofa(place) -> None:
    x, y = place
    cloth, cushion = (
        stage.matte("Sofa", "#38566b"),
        stage.matte("Cushion", picture=pictures.checkers("#d9b56b", "#f4efe2", 128)),
    )
    _block("Sofa seat", (1.9, 0.8, 0.42), cloth, (x, y, 0.0))
    _block("Sofa back", (1.9, 0.2, 0.85), cloth, (x, y + 0.4, 0.0))
    for side in (-1, 1):
        _block(f"Sofa arm {side}", (0.2, 0.85, 0.6), cloth, (x + side * 1.02, y, 0.0))
        stage.put(
            f"Cushion {side}",
            shapes.box((0.42, 0.14, 0.42)),
            cushion,
            (x + 0.62 * side, y + 0.1, 0.44),
            (-18, 0, 8 * side),
            False,
        )


def _shelf(wood, place) -> None:
    """A bookcase whose books are of random height, width and colour."""
    x, y = place
    random = np.random.default_rng(5)
    bindings = [stage.matte(f"Book {code}", code) for code in ("#8c2f39", "#2f4858", "#d9a441", "#4f6f52", "#e8dcc4")]
    for side in (-1, 1):
        _block(f"Shelf side {side}", (0.03, 0.28, 1.9), wood, (x + side * 0.5, y, 0.0))
    for level in range(5):
        height = 0.06 + 0.45 * level
        _block(f"Shelf board {level}", (0.97, 0.28, 0.03), wood, (x, y, height))
        left = x - 0.46
        while level < 4 and left < x + random.uniform(0.2, 0.42):
            width, tall = random.uniform(0.025, 0.06), random.uniform(0.22, 0.36)
            book = (left + width / 2, y - 0.02, height + 0.03)
            _block("Book", (width * 0.94, 0.2, tall), bindings[random.integers(len(bindings))], book)
            left += width


def _standing_lamp(place) -> None:
    x, y = place
    iron = stage.matte("Iron", "#2a2a2c")
    foot = [(0, 0), (0.16, 0), (0.16, 0.02), (0.012, 0.03), (0.012, 1.5), (0, 1.5)]
    stage.put("Lamp foot", shapes.lathe(foot, 32), iron, (x, y, 0.0), smooth=False)
    shade = [(0, 1.45), (0.22, 1.45), (0.15, 1.75), (0, 1.75)]
    stage.put(
        "Lamp shade", shapes.lathe(shade, 48), stage.glowing("Lamp shade", "#ffd9a0", 1.6), (x, y, 0.0), smooth=False
    )


def _pictures() -> None:
    frame = stage.matte("Picture frame", "#2f241a")
    canvas = stage.matte("Landscape", picture=pictures.landscape())
    _block("Picture frame", (1.2, 0.03, 0.8), frame, (0.35, DEEP / 2 - 0.015, 1.35))
    picture = shapes.rectangle(1.1, 0.7).turned(shapes.turn("X", 90.0))
    stage.put("Landscape", picture, canvas, (0.35, DEEP / 2 - 0.031, 1.75), smooth=False)
    door = stage.matte("Door", "#6b4a33")
    _block("Door", (0.05, 0.9, 2.05), door, (WIDE / 2 - 0.025, 0.4, 0.0))
    stage.put("Door knob", shapes.sphere(0.035, 24, 12), stage.matte("Brass", "#c9a24a"), (WIDE / 2 - 0.08, 0.75, 1.0))


def _teapot(place) -> None:
    """A round pot with a spout and an ear: closed parts that run into one another."""
    body = [
        (0, 0),
        (0.085, 0),
        (0.092, 0.006),
        (0.125, 0.035),
        (0.148, 0.075),
        (0.152, 0.11),
        (0.138, 0.15),
        (0.1, 0.182),
    ]
    lid = [
        (0.098, 0.19),
        (0.07, 0.205),
        (0.03, 0.216),
        (0.016, 0.222),
        (0.013, 0.232),
        (0.024, 0.245),
        (0.022, 0.26),
        (0, 0.268),
    ]
    profile = shapes.through(np.array(body + lid), 12)
    spout = shapes.through(np.array([(0.11, 0.06), (0.19, 0.085), (0.225, 0.15), (0.275, 0.185)]), 16)
    ear = shapes.through(np.array([(-0.12, 0.155), (-0.215, 0.165), (-0.24, 0.1), (-0.125, 0.06)]), 20)

    def upright(curve):
        return np.stack([curve[:, 0], 0 * curve[:, 0], curve[:, 1]], axis=-1)

    width = np.interp(np.linspace(0, 1, len(spout)), (0, 0.5, 1), (0.042, 0.026, 0.017))
    parts = [shapes.lathe(profile, 128), shapes.tube(upright(spout), width, 48), shapes.tube(upright(ear), 0.0125, 32)]
    stage.put(
        "Teapot",
        shapes.joined(parts),
        stage.mirror("Chrome", "#f4f4f4"),
        (place[0], place[1], place[2] + 0.005),
        (0, 0, -22),
    )
