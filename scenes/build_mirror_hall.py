"""mirror-hall: two facing mirrors, one of them with a window through it, and a third that stands at an angle.

Metres; the hall is 3.8 wide (X), 7.2 deep (Y) and 3.2 high.
"""

import numpy as np

from . import furniture, pictures, sculptures, shapes, stage, surfaces

WIDE, NEAR, FAR, HIGH = 3.8, -3.2, 4.0, 3.2
DEEP, MIDDLE = FAR - NEAR, (FAR + NEAR) / 2
DADO = 0.45
PROUD = 0.05  # metres from a wall to the mirror before it
WINDOW = (0.9, 1.35)
BESIDE = 1.4  # where along the hall the window is


def build() -> None:
    """Build the scene into the open, empty file."""
    gilt = stage.matte("Gilding", "#c8963c", surfaces.gilding(), 92)
    white = stage.matte("Panelling", "#e9e4d8")
    _shell(white)
    _arched_mirror(gilt)
    _pierced_mirror(gilt)
    _standing_mirror(gilt)
    _furniture()
    _light(gilt)
    stage.camera((0.98, -2.75, 1.6), (-0.28, 0.7, 1.3), 20.0)
    stage.bounces(2)  # a path may be mirrored three times


def _shell(white) -> None:
    """Floor, ceiling and walls, the right one with an opening for the window; skirtings and cornices."""
    floor = stage.matte("Floor", "#8a8378", pictures.checkers("#e3dccb", "#4a2f2a", 384), 88)
    stage.put("Floor", shapes.rectangle(WIDE, DEEP, 0.9), floor, (0, MIDDLE, 0), smooth=False)
    stage.put("Ceiling", shapes.rectangle(WIDE, DEEP), white, (0, MIDDLE, HIGH), (180, 0, 0), smooth=False)
    paper = stage.matte("Wallpaper", "#5d7f74", surfaces.damask("#5b8175", "#93b09d"), 88)
    upright = shapes.turn("X", 90.0)
    whole = shapes.rectangle(DEEP, HIGH).turned(upright).textured(0.6)
    side = shapes.rectangle(WIDE, HIGH).turned(upright).textured(0.6)
    outer, inner = shapes.framed(
        np.array([(1, -1), (1, 1), (-1, 1), (-1, -1)]) * np.array(WINDOW) / 2, 2 * (FAR - BESIDE), HIGH
    )
    pierced = shapes.pane(outer, inner).textured(0.6)
    height = HIGH / 2
    stage.put("Wall left", whole, paper, (-WIDE / 2, MIDDLE, height), (0, 0, 90), smooth=False)
    stage.put("Wall right", pierced, paper, (WIDE / 2, BESIDE, height), (0, 0, -90), smooth=False)
    rest = shapes.rectangle(2 * (BESIDE - MIDDLE), HIGH).turned(upright).textured(0.6)
    stage.put("Wall right near", rest, paper, (WIDE / 2, NEAR + BESIDE - MIDDLE, height), (0, 0, -90), smooth=False)
    stage.put("Wall far", side, paper, (0, FAR, height), smooth=False)
    stage.put("Wall near", side, paper, (0, NEAR, height), (0, 0, 180), smooth=False)
    corners = np.array([(-WIDE / 2, NEAR), (WIDE / 2, NEAR), (WIDE / 2, FAR), (-WIDE / 2, FAR), (-WIDE / 2, NEAR)])
    for name, z, profile in (
        (
            "Skirting",
            0.0,
            [(DADO, 0.0), (DADO, -0.05), (DADO - 0.04, -0.03), (0.14, -0.02), (0.1, -0.04), (0.0, -0.04)],
        ),
        ("Cornice", HIGH, [(0.0, -0.22), (-0.06, -0.2), (-0.09, -0.1), (-0.18, -0.06), (-0.24, -0.04), (-0.24, 0.0)]),
    ):
        moulding = shapes.sweep(np.insert(corners, 2, z, axis=1), profile[::-1], (0.0, 0.0, 1.0))
        stage.assemble(name, [(moulding, white)])


def _arched_mirror(gilt) -> None:
    """On the left wall: 3.8 metres wide, round above."""
    arch = shapes.ellipse(3.8, 1.7, 48)[:25] + (0.0, 1.85)
    outline = np.concatenate([[(-1.9, 0.6), (1.9, 0.6)], arch])
    place = (-WIDE / 2 + PROUD, 0.55, 0.0)
    stage.put(
        "Mirror left", shapes.pane(outline), stage.mirror("Silver left", "#f2f4f2"), place, (0, 0, 90), smooth=False
    )
    stage.assemble("Frame left", [(furniture.frame(outline, 0.13, 0.05), gilt)], place, (0, 0, 90))


def _pierced_mirror(gilt) -> None:
    """On the right wall: a rectangle with an oval opening, through which a window is seen in its niche."""
    outline, hole = shapes.framed(shapes.ellipse(0.72, 1.15, 40), 3.4, 2.1)
    place = (WIDE / 2 - PROUD, BESIDE, HIGH / 2)
    glass = stage.mirror("Silver right", "#f4f3ef")
    stage.put("Mirror right", shapes.pane(outline, hole), glass, place, (0, 0, -90), smooth=False)
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (1.7, 1.05)
    rims = [(furniture.frame(square, 0.13, 0.05), gilt), (_inner_frame(hole), gilt)]
    stage.assemble("Frame right", rims, place, (0, 0, -90))
    width, height = np.array(WINDOW) / 2
    rim = np.array([(-width, -height), (width, -height), (width, height), (-width, height), (-width, -height)])
    reveal = shapes.sweep(np.insert(rim, 1, 0.0, axis=1), [(-0.3, 0.0), (0.0, 0.0)], (0.0, -1.0, 0.0))
    view = stage.glowing("View", "#a9c4e0", 1.3, pictures.landscape())
    white = stage.matte("Window frame", "#f3efe6")
    bars = [shapes.box((0.035, 0.04, 2.02 * height)).moved((0.0, 0.27, -1.01 * height))]
    bars += [shapes.box((2.02 * width, 0.03, 0.035)).moved((0.0, 0.27, z)) for z in (-0.25, 0.2)]
    pane = shapes.pane(rim[:4]).moved((0.0, 0.3, 0.0))
    parts = [(reveal, white), (pane, view), *((bar, white) for bar in bars)]
    stage.assemble("Window", parts, (WIDE / 2, BESIDE, HIGH / 2), (0, 0, -90))


def _inner_frame(hole: np.ndarray) -> shapes.Shape:
    """The moulding round the opening, over the mirror's inner rim."""
    return furniture.frame(hole * 0.9, 0.06, 0.04)


def _standing_mirror(gilt) -> None:
    """A cheval glass, glass and frame in one mesh: an oval between two posts, turned and tilted."""
    oak = stage.matte("Mahogany", "#5a2d1c")
    oval = shapes.ellipse(0.8, 1.5, 48)
    tilt = shapes.turn("X", -7.0)
    swung = [
        (shapes.pane(oval), stage.mirror("Silver standing", "#f5f5f5")),
        (furniture.frame(oval, 0.07, 0.03, 10.0), gilt),
        (shapes.sphere(1.0, 48, 8).moved((0, 0.02, 0), (0.44, 0.015, 0.79)), oak),
    ]
    parts = [(shape.turned(tilt).moved((0.0, 0.0, 1.05)), material) for shape, material in swung]
    post = [(0, 0), (0.03, 0), (0.022, 0.1), (0.03, 0.6), (0.018, 1.1), (0.03, 1.14), (0.035, 1.2), (0, 1.23)]
    for side in (-1, 1):
        parts.append((shapes.lathe(post, 16).moved((side * 0.53, 0.02, 0.06)), oak))
        parts.append((shapes.box((0.05, 0.62, 0.07)).moved((side * 0.53, 0.02, 0.0)), oak))
    parts.append((shapes.box((1.06, 0.04, 0.06)).moved((0.0, 0.02, 0.2)), oak))
    stage.assemble("Standing mirror", parts, (0.72, 2.75, 0.001), (0, 0, -16))


def _furniture() -> None:
    wood, silk = (
        stage.matte("Walnut", "#6d4526"),
        stage.matte("Silk", "#a83246", surfaces.damask("#a83246", "#c8606a", 192), 88),
    )
    chairs = furniture.chair(wood, silk)
    first = stage.assemble("Chair near", chairs, (-1.05, 0.25, 0.001), (0, 0, 60))
    again = stage.again(first, (-1.1, 2.6, 0.001), (0, 0, 20))
    again.name = "Chair far"
    stone = stage.matte("Marble", "#d9d3c8", surfaces.marble("#d9d3c8", "#8b8378"), 88)
    stage.assemble("Statue pedestal", furniture.pedestal(0.75, 0.26, stone), (-0.3, 1.6, 0.001))
    bronze = stage.matte("Bronze", "#7d5a30")
    stage.assemble(
        "Ballerina", [(sculptures.ballerina().moved(scale=0.8), bronze)], (-0.3, 1.6, 0.755), (0, 0, -35), 180.0
    )
    stage.assemble("Vase pedestal", furniture.pedestal(0.85, 0.2, stone), (1.3, 0.75, 0.001))
    vase = furniture.vase(0.5, stage.matte("Delft", "#8fa3c8", surfaces.delft(), 90))
    petals = [stage.matte(f"Tulip {code}", code) for code in ("#d9473f", "#f0b53a", "#f3e6df")]
    bunch = furniture.flowers(0.5, 17, stage.matte("Stalk", "#4d7a3a"), petals)
    stage.assemble("Vase", vase + bunch, (1.3, 0.75, 0.852), crease=60.0)


def _light(gilt) -> None:
    """A chandelier of candles, and broad soft lamps that nobody sees."""
    parts = furniture.chandelier(gilt, stage.matte("Wax", "#f2ead2"), stage.glowing("Flame", "#ffd27a", 5.0))
    stage.assemble("Chandelier", parts, (-0.2, 1.2, HIGH - 0.001))
    stage.area_lamp("Ceiling light", 150.0, (2.4, 5.0), (0.0, MIDDLE, HIGH - 0.3), (0.0, MIDDLE, 0.0), "#ffe3b8")
    stage.area_lamp("Window light", 40.0, (0.8, 1.2), (WIDE / 2 - 0.15, BESIDE, 1.6), (0.0, BESIDE, 0.9), "#cfe2ff")
    stage.plain_world("#707888", 0.1)
