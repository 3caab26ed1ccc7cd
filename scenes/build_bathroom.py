"""bathroom: a wide wall mirror over a washbasin, in a small tiled room; the mirror shows what lies behind the camera.

Metres; the room is 3.4 wide (X), 3.2 deep (Y) and 2.5 high, the mirror on its far wall. The floor's
tiles are slightly glossy; taps, shower and rails are chrome.
"""

import numpy as np

from . import bath, furniture, pictures, shapes, stage, surfaces

WIDE, DEEP, HIGH = 3.4, 3.2, 2.5
TILED = 1.35  # height of the tiles on the walls
TOP = 0.82  # of the vanity
MIRROR = (2.5, 1.24)
VANITY = (-0.1, 1.33)
EYE, AIM = (0.2, -1.4, 1.53), (-0.08, 1.6, 1.2)


def build() -> None:
    """Build the scene into the open, empty file."""
    chrome = stage.mirror("Chrome", "#f1f3f4")
    porcelain = stage.matte("Porcelain", "#eeece6")
    oak = stage.matte("Oak", "#a9774a", pictures.planks(256, 4), 88)
    brass = stage.matte("Brass", "#b08a4a")
    _shell()
    _mirror(brass)
    _vanity(oak, brass, porcelain, chrome)
    _bath(porcelain, chrome)
    _toilet(porcelain, oak)
    _towels(oak, chrome)
    _window_and_door(oak, brass)
    _light()
    stage.camera(EYE, AIM, 25.0)
    stage.fly(_path())


def _path() -> list:
    """A round of the room that comes back to where it began: towards the mirror, along it, down to the floor."""
    return [
        (*EYE, *AIM),
        (0.42, -1.22, 1.51, -0.1, 1.6, 1.22),
        (0.72, -0.88, 1.47, -0.28, 1.6, 1.2),
        (0.85, -0.45, 1.43, -0.5, 1.58, 1.14),
        (0.68, -0.08, 1.43, -0.48, 1.55, 1.1),
        (0.32, 0.1, 1.46, -0.2, 1.55, 1.12),
        (-0.08, 0.05, 1.5, 0.12, 1.58, 1.14),
        (-0.38, -0.22, 1.54, 0.36, 1.55, 1.04),
        (-0.4, -0.55, 1.55, 0.42, 1.5, 0.9),
        (-0.2, -0.84, 1.52, 0.32, 1.45, 0.8),
        (0.06, -1.08, 1.5, 0.14, 1.5, 0.92),
        (0.2, -1.28, 1.51, -0.02, 1.57, 1.1),
        (*EYE, *AIM),
    ]


def _shell() -> None:
    """Floor, ceiling and walls: tiles below, plaster above, a bullnose between."""
    floor = stage.polished("Floor tiles", surfaces.octagon_tiles(), 0.08)
    stage.reflects(stage.put("Floor", shapes.rectangle(WIDE + 0.04, DEEP + 0.04, 0.6), floor, smooth=False))
    white = stage.matte("Ceiling", "#f2efe9")
    stage.put("Ceiling", shapes.rectangle(WIDE, DEEP), white, (0, 0, HIGH), (180, 0, 0), smooth=False)
    tiles = stage.matte("Wall tiles", "#e6e9e4", surfaces.metro_tiles("#e6eae6", "#a9aca6"), 88)
    plaster = stage.matte("Wall", "#8fa898", surfaces.plaster("#96ae9f"), 85)
    upright = shapes.turn("X", 90.0)
    for name, width, place, turned in (
        ("Wall far", WIDE, (0.0, DEEP / 2, 0.0), 0.0),
        ("Wall right", DEEP, (WIDE / 2, 0.0, 0.0), -90.0),
        ("Wall near", WIDE, (0.0, -DEEP / 2, 0.0), 180.0),
        ("Wall left", DEEP, (-WIDE / 2, 0.0, 0.0), 90.0),
    ):
        low, high = TILED + bath.SUNK, HIGH - TILED
        lower = shapes.rectangle(width, low).turned(upright).moved((0.0, 0.0, low / 2 - bath.SUNK)).textured(0.6)
        upper = shapes.rectangle(width, high).turned(upright).moved((0.0, 0.0, TILED + high / 2)).textured(1.5)
        stage.assemble(name, [(lower, tiles), (upper, plaster)], place, (0.0, 0.0, turned), None)
    x, y = WIDE / 2, DEEP / 2
    corners = np.array([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0), (-x, -y, 0)], dtype=np.float64)
    trim = stage.matte("Trim tiles", "#1f4a4c")
    bull = [(0.03, 0.0), (0.026, -0.014), (0.0, -0.02), (-0.026, -0.014), (-0.03, 0.0)][::-1]
    stage.assemble("Trim", [(shapes.sweep(corners + (0, 0, TILED), bull, (0.0, 0.0, 1.0)), trim)])
    cove = [(0.0, -0.12), (-0.03, -0.1), (-0.06, -0.05), (-0.1, -0.03), (-0.12, 0.0)][::-1]
    stage.assemble("Cove", [(shapes.sweep(corners + (0, 0, HIGH), cove, (0.0, 0.0, 1.0)), white)])


def _mirror(brass) -> None:
    outline = shapes.rounded(*MIRROR, 0.12, 8)
    place = (VANITY[0], DEEP / 2 - 0.035, 0.98 + MIRROR[1] / 2)
    stage.put("Wall mirror", shapes.pane(outline), stage.mirror("Silver", "#f3f5f4"), place, smooth=False)
    stage.assemble("Mirror frame", [(furniture.frame(outline, 0.035, 0.035), brass)], place)
    globe = stage.glowing("Globe", "#fff1d8", 3.0, lamp=False)
    arm = shapes.through(np.array([(0, 0.02, 0), (0, -0.05, 0.0), (0, -0.1, 0.02), (0, -0.11, 0.06)]), 6)
    parts = [(shapes.tube(arm, 0.009, 14), brass), (shapes.sphere(0.075, 32, 16).moved((0, -0.11, 0.135)), globe)]
    rose = shapes.lathe([(0, 0), (0.045, 0), (0.04, 0.012), (0.012, 0.02), (0, 0.02)], 28).turned(
        shapes.turn("X", 90.0)
    )
    first = stage.assemble("Sconce left", [*parts, (rose, brass)], (-1.53, DEEP / 2, 1.62))
    stage.again(first, (1.33, DEEP / 2, 1.62)).name = "Sconce right"


def _vanity(oak, brass, porcelain, chrome) -> None:
    """A cabinet with drawers, its marble top, the basin and what stands beside it."""
    x, y = VANITY
    marble = stage.matte("Marble", "#e4e1da", surfaces.marble("#e4e1da", "#9a958c"), 88)
    body = shapes.box((1.5, 0.48, 0.62)).moved((0, 0, 0.16)).textured(0.7)
    parts = [(body, oak), (shapes.box((1.56, 0.53, 0.04)).moved((0, -0.005, 0.78)).textured(0.8), marble)]
    parts.append((shapes.box((1.56, 0.02, 0.1)).moved((0, 0.247, 0.815)).textured(0.8), marble))
    leg = shapes.lathe([(0, -bath.SUNK), (0.018, -bath.SUNK), (0.026, 0.17), (0, 0.17)], 20)
    parts += [(leg.moved((side * 0.68, end * 0.18, 0)), oak) for side in (-1, 1) for end in (-1, 1)]
    knob = shapes.lathe([(0, 0), (0.008, 0), (0.008, 0.015), (0.016, 0.022), (0.014, 0.034), (0, 0.038)], 20)
    knob = knob.turned(shapes.turn("X", 90.0))
    for column in (-0.495, 0.0, 0.495):
        for z, tall in ((0.2, 0.27), (0.49, 0.25)):
            parts.append((shapes.box((0.475, 0.02, tall)).moved((column, -0.245, z)).textured(0.7), oak))
            parts.append((knob.moved((column, -0.255, z + tall * 0.6)), brass))
    stage.assemble("Vanity", parts, (x, y, 0.0))
    stage.assemble("Basin", [(bath.basin(), porcelain)], (x, y - 0.02, TOP - 0.0005), crease=50.0)
    stage.assemble("Tap", [(bath.tap(), chrome)], (x, y + 0.2, TOP - 0.001), crease=50.0)
    _toiletries((x, y))


def _toiletries(place) -> None:
    x, y = place
    cork = stage.matte("Stopper", "#2c2a28")
    for name, code, (dx, dy), size in (
        ("Shampoo", "#c96a3b", (-0.45, 0.1), (0.034, 0.19, 0.4)),
        ("Tonic", "#3f7d78", (-0.54, 0.04), (0.03, 0.24, 0.34)),
        ("Scent", "#8a4f6d", (-0.37, 0.15), (0.026, 0.13, 0.36)),
        ("Lotion", "#e0d3b4", (-0.6, 0.15), (0.038, 0.16, 0.42)),
    ):
        radius, height, _ = size
        parts = [(bath.bottle(*size), stage.matte(name, code)), (bath.stopper(radius, height), cork)]
        stage.assemble(name, parts, (x + dx, y + dy, TOP - 0.0005))
    glass = shapes.lathe([(0, 0), (0.03, 0), (0.036, 0.1), (0.033, 0.1), (0.028, 0.008), (0, 0.008)], 40)
    beaker = [(glass, stage.matte("Beaker", "#d9e3e0"))]
    for angle, code in ((20.0, "#d94f4f"), (-24.0, "#4f86c9")):
        handle = shapes.tube(np.array([(0, 0, 0.012), (0, 0, 0.1), (0, 0, 0.17)]), 0.0042, 10)
        bristles = shapes.box((0.01, 0.012, 0.03)).moved((0, -0.008, 0.145))
        lean = shapes.turn("Y", angle * 0.5) @ shapes.turn("Z", angle)
        brush = stage.matte(f"Toothbrush {code}", code)
        beaker += [(handle.turned(lean), brush), (bristles.turned(lean), stage.matte(f"Bristles {code}", "#f4f4f0"))]
    stage.assemble("Beaker", beaker, (x + 0.4, y + 0.12, TOP - 0.0005))
    soap = [
        (0, 0, 0, 0, 2.4),
        (0.0, 0.03, 0.02, 0, 2.6),
        (0.012, 0.042, 0.028, 0, 2.6),
        (0.024, 0.03, 0.02, 0, 2.6),
        (0.026, 0, 0, 0, 2.4),
    ]
    dish = [(0, 0), (0.05, 0), (0.068, 0.014), (0.064, 0.016), (0.045, 0.006), (0, 0.006)]
    parts = [
        (shapes.lathe(dish, 40), stage.matte("Dish", "#7fa6ad")),
        (shapes.loft(np.array(soap), 40).moved((0, 0, 0.0058)), stage.matte("Soap", "#e8c9c4")),
    ]
    stage.assemble("Soap dish", parts, (x + 0.4, y - 0.08, TOP - 0.0005))
    pot = shapes.lathe(
        [(0, 0), (0.055, 0), (0.075, 0.11), (0.08, 0.115), (0.08, 0.13), (0.068, 0.13), (0.066, 0.11), (0, 0.11)], 36
    )
    plant = bath.fern(22, 0.3, stage.matte("Stalk", "#5a7a3c"), stage.matte("Frond", "#4c8a48"))
    parts = [(pot, stage.matte("Pot", "#b5654a"))] + [(shape.moved((0, 0, 0.1)), material) for shape, material in plant]
    stage.assemble("Fern", parts, (x + 0.6, y + 0.06, TOP - 0.0005), crease=80.0)


def _bath(porcelain, chrome) -> None:
    """The tub along the left wall, a shower over it and a curtain half drawn."""
    stage.assemble("Tub", [(bath.tub(), porcelain)], (-1.24, -0.6, 0.0), crease=60.0)
    stage.assemble("Shower", [(bath.shower(), chrome)], (-WIDE / 2, -0.85, 0.9), (0, 0, 90), 50.0)
    cloth = stage.matte("Curtain", "#e9e2d0", pictures.stripes(["#f1ece0", "#f1ece0", "#9fc0bd"], 4, 0, 128), 88)
    rod = shapes.tube(np.array([(-0.83, -DEEP / 2, 2.1), (-0.83, 0.36, 2.1), (-WIDE / 2, 0.36, 2.1)]), 0.011, 16)
    stage.assemble("Curtain rod", [(rod, stage.matte("White enamel", "#f4f3ef"))])
    sheet = bath.curtain(0.62, 1.82, 7, 120, 26)
    stage.assemble("Curtain", [(sheet, cloth)], (-0.83, -1.27, 2.085), (0, 0, 90), 80.0)


def _toilet(porcelain, oak) -> None:
    button = stage.matte("Button", "#b9bec2")
    stage.assemble("Toilet", bath.toilet(porcelain, oak, button), (WIDE / 2 - 0.002, 0.62, 0.0), (0, 0, -90), 45.0)
    roll = [(0.02, -0.05), (0.055, -0.05), (0.055, 0.05), (0.02, 0.05), (0.02, -0.05)]
    paper = shapes.lathe(roll, 40).turned(shapes.turn("Y", 90.0)).moved((0, -0.07, 0))
    holder = shapes.tube(np.array([(-0.07, 0.01, 0), (-0.07, -0.07, 0), (0.06, -0.07, 0)]), 0.007, 12)
    white = stage.matte("Paper", "#f5f3ee")
    parts = [(paper, white), (holder, button), (shapes.box((0.1, 0.002, 0.1)).moved((0, -0.124, -0.105)), white)]
    stage.assemble("Paper", parts, (WIDE / 2, 0.1, 0.72), (0, 0, -90))


def _towels(oak, chrome) -> None:
    """Two towels on a rail, rolled ones on a shelf, and a mat before the basin."""
    coral = stage.matte("Coral towel", "#d9795f", surfaces.terry("#dd8067", "#f3e3d2"), 85)
    cream = stage.matte("Cream towel", "#ece2cc", surfaces.terry("#ece2cc", "#7fa6a3"), 85)
    place = np.array((WIDE / 2, -0.75, 1.28))
    stage.assemble("Towel rail", [(bath.rail(1.1), chrome)], tuple(place), (0, 0, -90), 50.0)
    for name, along, cloth, drop in (("Coral towel", -0.26, coral, 0.62), ("Cream towel", 0.27, cream, 0.5)):
        shape = bath.towel(0.46, drop, drop * 0.8, 56, 44)
        stage.assemble(name, [(shape, cloth)], tuple(place + (-0.08, along, 0.0)), (0, 0, -90), 80.0)
    board = [(shapes.box((0.7, 0.22, 0.025)).moved((0, -0.11, 0)).textured(0.7), oak)]
    roll = shapes.lathe(
        [(0, -0.1), (0.056, -0.1), (0.062, -0.09), (0.062, 0.09), (0.056, 0.1), (0, 0.1)], 40, (3.0, 1.0)
    )
    lying = roll.turned(shapes.turn("X", 90.0))
    for spot, cloth in (
        ((-0.2, 0.087), cream),
        ((-0.07, 0.087), coral),
        ((0.06, 0.087), cream),
        ((-0.135, 0.195), cream),
    ):
        board.append((lying.moved((spot[0], -0.11, spot[1])), cloth))
    stage.assemble("Shelf", board, (WIDE / 2, 0.62, 1.55), (0, 0, -90))
    mat = [(-bath.SUNK, 0.42, 0.27, 0, 7), (0.012, 0.43, 0.28, 0, 7), (0.02, 0.42, 0.27, 0, 7), (0.021, 0, 0, 0, 6)]
    rug = shapes.loft(np.array(mat), 64)
    corners = rug.points[np.maximum(rug.faces, 0)]
    rug = shapes.Shape(rug.points, rug.faces, corners[..., :2] / (0.86, 0.56) + 0.5)
    stage.assemble("Mat", [(rug, coral)], (-0.1, 0.62, 0.0), crease=50.0)


def _window_and_door(oak, brass) -> None:
    """A frosted window over the tub, a door and a picture behind the camera."""
    white = stage.matte("Woodwork", "#f1eee6")
    rim = np.array([(-0.5, -0.45), (0.5, -0.45), (0.5, 0.45), (-0.5, 0.45)])
    pane = stage.glowing("Frosted glass", "#dcefe8", 1.6, surfaces.frosted())
    bars = [
        shapes.box((0.03, 0.03, 0.9)).moved((0, -0.02, -0.45)),
        shapes.box((1.0, 0.026, 0.03)).moved((0, -0.02, 0.0)),
    ]
    ledge = shapes.box((1.24, 0.12, 0.03)).moved((0, -0.05, -0.57))
    parts = [(shapes.pane(rim).moved((0, -0.012, 0)), pane), (furniture.frame(rim, 0.08, 0.04, 1.0), white)]
    parts += [(shape, white) for shape in (*bars, ledge)]
    stage.assemble("Window", parts, (-WIDE / 2, -0.05, 1.85), (0, 0, 90))
    door = [(shapes.box((0.8, 0.05, 2.0 + bath.SUNK)).moved((0, -0.005, -bath.SUNK)), white)]
    for x in (-0.19, 0.19):
        door += [
            (shapes.box((0.26, 0.02, tall)).moved((x, -0.035, z)), white) for z, tall in ((0.2, 0.6), (0.95, 0.85))
        ]
    outline = np.array([(-0.4, -bath.SUNK), (0.4, -bath.SUNK), (0.4, 2.0), (-0.4, 2.0)])
    door.append((furniture.frame(outline, 0.09, 0.04, 1.0), white))
    knob = shapes.lathe([(0, 0), (0.012, 0), (0.012, 0.03), (0.028, 0.04), (0.026, 0.065), (0, 0.075)], 28)
    door.append((knob.turned(shapes.turn("X", 90.0)).moved((0.33, -0.03, 1.0)), brass))
    stage.assemble("Door", door, (0.75, -DEEP / 2, 0.0), (0, 0, 180))
    canvas = stage.matte("Landscape", "#b9a27a", pictures.landscape(), 90)
    square = np.array([(-0.28, -0.28), (0.28, -0.28), (0.28, 0.28), (-0.28, 0.28)])
    picture = [(shapes.pane(square).moved((0, -0.012, 0)), canvas), (furniture.frame(square, 0.04, 0.03, 1.0), oak)]
    stage.assemble("Picture", picture, (-0.3, -DEEP / 2, 1.8), (0, 0, 180))


def _light() -> None:
    """Broad soft lamps: the ceiling's, the window's, and one over the mirror."""
    shade = stage.glowing("Ceiling lamp", "#fff4e2", 1.6, lamp=False)
    drum = shapes.lathe([(0, -0.09), (0.2, -0.09), (0.22, -0.07), (0.22, 0.0)], 48)
    stage.assemble("Ceiling lamp", [(drum, shade)], (0.1, -0.1, HIGH))
    stage.area_lamp("Ceiling light", 42.0, (1.8, 1.8), (0.0, 0.0, HIGH - 0.13), (0.0, 0.0, 0.0), "#ffeed6")
    stage.area_lamp("Window light", 22.0, (0.9, 0.8), (-WIDE / 2 + 0.1, -0.05, 1.85), (0.6, 0.2, 0.6), "#dcecff")
    stage.area_lamp("Mirror light", 10.0, (2.0, 0.3), (VANITY[0], 1.2, 2.35), (VANITY[0], 0.8, 0.8), "#ffe9c8")
    stage.area_lamp("Ceiling glow", 9.0, (2.2, 2.0), (0.0, 0.0, 1.95), (0.0, 0.0, HIGH), "#ffeed6")
    stage.plain_world("#8a9096", 0.1)
