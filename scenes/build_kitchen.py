"""kitchen: a chrome kettle on a worktop beside a bowl of fruit, with taps, pans and a ladle before a tiled wall.

Metres; the room is 3.2 wide (X), 3.0 deep (Y) and 2.5 high. The worktop runs along the far wall and,
with the sink in it, along the left one, under a window that the morning sun comes through.
"""

import numpy as np

from . import bath, furniture, kitchenware, larder, patterns, pictures, shapes, stage, surfaces

LEFT, RIGHT, NEAR, FAR, HIGH = -0.95, 2.25, -2.4, 0.62, 2.5
TOP = 0.9  # of the worktop
WINDOW = (-1.25, 0.1, 1.06, 2.2)  # in the left wall: from and to along Y, from and to in height
EDGE = -0.34  # of the worktop, towards the camera
SINK = (-0.45, 0.36)
KETTLE = (-0.02, 0.14)
KETTLE_SIZE = 1.36
BOWL = (0.325, 0.04)
RESTING = TOP - 0.0005  # what stands on the worktop stands a hair in it


def build() -> None:
    """Build the scene into the open, empty file."""
    chrome = stage.mirror("Chrome", "#f2f3f4")
    steel = stage.mirror("Steel", "#d9dbdd")
    copper = stage.mirror("Copper", "#e39a72")
    oak = stage.matte("Oak", "#b07a46", pictures.planks(256, 8), 88)
    _shell()
    _window()
    _worktop(oak)
    _kettle(chrome)
    _taps(chrome)
    _pans(steel, copper)
    _spoons(steel)
    _sugar(steel)
    _fruit()
    _bread(oak)
    _crockery()
    _room(oak)
    _light()
    stage.camera((0.14, -1.02, 1.29), (0.045, 0.3, 1.066), 45.0)


def _shell() -> None:
    """Floor, ceiling and walls, the far one tiled."""
    middle = ((LEFT + RIGHT) / 2, (NEAR + FAR) / 2)
    wide, deep = RIGHT - LEFT, FAR - NEAR
    floor = stage.matte("Floor tiles", "#b0714c", pictures.checkers("#c98a60", "#efe3cd", 256), 85)
    stage.put("Floor", shapes.rectangle(wide + 0.2, deep + 0.2, 0.5), floor, (*middle, 0.0), smooth=False)
    ceiling = stage.matte("Ceiling", "#f4efe4")
    stage.put("Ceiling", shapes.rectangle(wide + 0.2, deep + 0.2), ceiling, (*middle, HIGH), (180, 0, 0), smooth=False)
    tiles = stage.matte("Wall tiles", "#dfe3e6", patterns.azulejo(), 88)
    plaster = stage.matte("Wall", "#efe0c2", surfaces.plaster("#f4e4c4"), 85)
    upright = shapes.turn("X", 90.0)
    tall = HIGH - TOP + 0.02
    far = shapes.rectangle(wide, tall).turned(upright).moved((0, 0, TOP - 0.02 + tall / 2)).textured(0.28)
    stage.put("Wall far", far, tiles, (middle[0], FAR, 0.0), smooth=False)
    for name, width, place, turned in (
        ("Wall right", deep, (RIGHT, middle[1], 0.0), -90.0),
        ("Wall near", wide, (middle[0], NEAR, 0.0), 180.0),
    ):
        wall = shapes.rectangle(width, HIGH).turned(upright).moved((0, 0, HIGH / 2)).textured(1.5)
        stage.put(name, wall, plaster, place, (0, 0, turned), smooth=False)
    low, high, sill, head = WINDOW
    panels = [
        shapes.rectangle(to - start, top - foot)
        .turned(shapes.turn("Z", 90.0) @ upright)
        .moved((LEFT, (start + to) / 2, (foot + top) / 2))
        for start, to, foot, top in (
            (NEAR, low, 0.0, HIGH),
            (high, FAR, 0.0, HIGH),
            (low, high, 0.0, sill),
            (low, high, head, HIGH),
        )
    ]
    stage.put("Wall left", shapes.joined(panels).textured(1.5), plaster, smooth=False)


def _window() -> None:
    """A casement, its reveal and sill, a half curtain, and herbs on the sill."""
    low, high, sill, head = WINDOW
    white = stage.matte("Woodwork", "#f6f1e6")
    middle, wide, tall = (low + high) / 2, high - low, head - sill
    parts = furniture.casement(wide, tall, white)
    stage.assemble("Window", parts, (LEFT, middle, (sill + head) / 2), (0, 0, 90))
    cloth = stage.matte("Curtain", "#c8584a", patterns.gingham("#c4463a", 6, 128), 88)
    for name, along in (("Curtain near", low + 0.08), ("Curtain far", high - 0.06)):
        drape = bath.curtain(0.22, tall + 0.06, 4, 40, 8)
        stage.assemble(name, [(drape, cloth)], (LEFT + 0.055, along, head + 0.08), (0, 0, 90), 80.0)
    rod = shapes.tube(
        np.array([(LEFT + 0.055, low - 0.12, head + 0.085), (LEFT + 0.055, high + 0.14, head + 0.085)]), 0.009, 12
    )
    stage.assemble("Curtain rod", [(rod, stage.matte("Iron", "#2e2b29"))])
    pot = [
        (0, 0),
        (0.045, 0),
        (0.058, 0.085),
        (0.063, 0.088),
        (0.063, 0.102),
        (0.052, 0.102),
        (0.05, 0.085),
        (0, 0.085),
    ]
    clay = stage.matte("Terracotta", "#c0683f")
    herb = larder.basil(8, 0.12, stage.matte("Stalk", "#5a8a3a"), stage.matte("Basil", "#4f9a3c"))
    parts = [(shapes.lathe(pot, 36), clay)] + [(shape.moved((0, 0, 0.08)), material) for shape, material in herb]
    stage.assemble("Basil", parts, (0.67, 0.47, RESTING), crease=80.0)


def _worktop(oak) -> None:
    """An oak top along two walls, cut out for a white sink, on sage cupboards."""
    x, y = SINK
    thick, edge = 0.04, LEFT + 0.6
    left, right, near, far = x - 0.2, x + 0.2, y - 0.17, y + 0.17
    boxes = [((LEFT, RIGHT), (far, FAR)), ((right, RIGHT), (near, far)), ((LEFT, left), (near, far))]
    boxes += [((LEFT, RIGHT), (EDGE, near)), ((LEFT, edge), (-1.5, EDGE))]
    parts = []
    for (start, to), (front, back) in boxes:
        slab = shapes.box((to - start, back - front, thick)).moved(((start + to) / 2, (front + back) / 2, TOP - thick))
        parts.append((slab.textured(0.9), oak))
    stage.assemble("Worktop", parts, crease=None)
    ceramic = stage.matte("Sink", "#f3f0e8")
    stage.assemble("Sink", [(kitchenware.sink(0.41, 0.35, 0.19), ceramic)], (x, y, TOP - 0.004), crease=50.0)
    sage = stage.matte("Cupboards", "#8ba28a")
    brass = stage.matte("Brass", "#b08a4a")
    fronts = []
    for (start, to), (front, back) in (
        ((LEFT, left), (EDGE + 0.05, FAR)),
        ((right, RIGHT), (EDGE + 0.05, FAR)),
        ((left, right), (EDGE + 0.05, near)),
        ((LEFT, edge - 0.05), (-1.45, EDGE + 0.05)),
    ):
        block = shapes.box((to - start, back - front, TOP - thick - 0.001))
        fronts.append((block.moved(((start + to) / 2, (front + back) / 2, 0)), sage))
    knob = shapes.lathe([(0, 0), (0.008, 0), (0.008, 0.015), (0.016, 0.022), (0.014, 0.034), (0, 0.038)], 20)
    knob = knob.turned(shapes.turn("X", 90.0))
    for i in range(5):
        door = shapes.box((0.44, 0.02, 0.66)).moved((edge + 0.26 + 0.46 * i, EDGE + 0.04, 0.12))
        fronts += [(door, sage), (knob.moved((edge + 0.42 + 0.46 * i, EDGE + 0.03, 0.7)), brass)]
    stage.assemble("Cupboards", fronts)


def _kettle(chrome) -> None:
    place, turned = (*KETTLE, RESTING), (0, 0, 208)
    handle, grip = kitchenware.kettle_handle()
    wood = stage.matte("Grip", "#5a2f1c")
    for name, shape, material in (
        ("Kettle", kitchenware.kettle_body(), chrome),
        ("Kettle lid", kitchenware.kettle_lid(), chrome),
        ("Kettle spout", kitchenware.kettle_spout(), chrome),
        ("Kettle handle", handle, chrome),
        ("Kettle grip", grip, wood),
    ):
        stage.put(name, shape.moved(scale=KETTLE_SIZE), material, place, turned)


def _taps(chrome) -> None:
    """A swan-necked tap between two valves, behind the sink."""
    place = np.array((SINK[0], FAR - 0.065, TOP))
    stage.put("Tap", kitchenware.tap_body(), chrome, tuple(place))
    stage.put("Tap neck", kitchenware.swan_neck(), chrome, tuple(place + (0, 0, 0.088)), (0, 0, 12))
    first = stage.put("Valve hot", kitchenware.tap_valve(), chrome, tuple(place + (-0.12, 0, 0)))
    stage.again(first, tuple(place + (0.12, 0, 0)), (0, 0, 20)).name = "Valve cold"


def _pans(steel, copper) -> None:
    """Three pans on a rail: two show their inside, one its outside."""
    iron = stage.matte("Cast iron", "#2e2b29")
    rail = (FAR - 0.05, 1.475)
    bar = shapes.tube(np.array([(-0.8, rail[0], rail[1]), (1.4, rail[0], rail[1])]), 0.006, 16)
    hung = (
        ("Copper pan", copper, 0.33, 0.095, 0.055, 0.14, 90.0),
        ("Frying pan", steel, 0.56, 0.11, 0.04, 0.15, 90.0),
        ("Milk pan", copper, -0.21, 0.07, 0.075, 0.13, -90.0),
    )
    hooks = [(kitchenware.hanger().moved((x, *rail)), iron) for x in (*(each[2] for each in hung), 0.165)]
    stage.assemble("Rail", [(bar, iron), *hooks])
    for name, metal, x, radius, height, length, tip in hung:
        handle = kitchenware.pan_handle(length, radius - 0.012, 0.012).moved((0, 0, height * 0.8))
        away = 0.03 if tip > 0 else 0.03 - height
        place = (x, rail[0] + away, rail[1] - 0.03 - radius - length)
        facing = shapes.turn("X", tip)
        stage.put(name, kitchenware.pan(radius, height, 1.15).turned(facing), metal, place)
        stage.put(f"{name} handle", handle.turned(facing @ shapes.turn("Z", tip)), iron, place)


def _spoons(steel) -> None:
    """A ladle on the rail, and a serving spoon on a folded cloth in front."""
    bowl, stem = kitchenware.ladle()
    place = (0.165, FAR - 0.058, 1.425)
    stage.put("Ladle", bowl, steel, place)
    stage.put("Ladle stem", stem, steel, place)
    cloth = stage.matte("Napkin", "#c8584a", patterns.gingham("#3f6f9a", 8, 128), 88)
    folded = [(0, 0.085, 0.06, 0, 7), (0.006, 0.088, 0.062, 0, 7), (0.011, 0.085, 0.06, 0, 7), (0.0112, 0, 0, 0, 6)]
    napkin = shapes.loft(np.array([(0, 0, 0, 0, 6), *folded]), 48).textured(0.16)
    stage.assemble("Napkin", [(napkin, cloth)], (-0.185, -0.16, RESTING), (0, 0, 24), 50.0)
    bowl, stem = kitchenware.spoon()
    place, turned = (-0.22, -0.17, RESTING + 0.0105), (0, 0, 30)
    stage.put("Spoon", bowl, steel, place, turned)
    stage.put("Spoon stem", stem, steel, place, turned)


def _sugar(steel) -> None:
    bowl, lid = kitchenware.sugar_bowl()
    place = (-0.305, 0.0, RESTING)
    stage.put("Sugar bowl", bowl, steel, place)
    stage.put("Sugar bowl lid", lid, steel, place)


def _fruit() -> None:
    """A bowl heaped with fruit, close to the kettle, and grapes, half an orange and a lemon before it."""
    glaze = stage.matte("Fruit bowl", "#2f5f8a", surfaces.delft(256), 88)
    place = np.array((*BOWL, RESTING))
    stage.put("Fruit bowl", kitchenware.bowl(0.15, 0.085), glaze, tuple(place))
    stem = stage.matte("Stem", "#5b4326")
    red = stage.matte("Apple red", "#b5332a", patterns.apple_skin("#e3b04a", "#b3201f", 131), 88)
    green = stage.matte("Apple green", "#9bb53c", patterns.apple_skin("#b4c64a", "#c0803a", 133), 88)
    for name, skin, spots in (
        (
            "Apple red",
            red,
            (
                ((-0.078, -0.03, 0.073), (20, 14, 40)),
                ((0.02, 0.078, 0.073), (-10, 30, 100)),
                ((0.015, -0.012, 0.122), (28, -12, 200)),
            ),
        ),
        ("Apple green", green, (((0.05, -0.068, 0.072), (24, 10, 10)), ((-0.057, 0.052, 0.074), (12, -20, 70)))),
    ):
        (offset, turned), *others = spots
        apple = [(larder.apple(), skin), (larder.stalk(), stem)]
        first = stage.assemble(name, apple, tuple(place + offset), turned, 75.0)
        for offset, turned in others:
            stage.again(first, tuple(place + offset), turned)
    peel = stage.matte("Orange", "#ea8a1f", patterns.orange_peel("#f08a1c"), 88)
    first = stage.put("Orange", larder.orange(), peel, tuple(place + (-0.022, -0.082, 0.075)), (30, 20, 0))
    for offset, turned in (
        ((0.085, 0.012, 0.074), (80, 0, 30)),
        ((-0.05, 0.0, 0.128), (50, 40, 0)),
        ((0.155, -0.135, 0.038), (10, 60, 20)),
    ):
        stage.again(first, tuple(place + offset), turned)
    yellow = stage.matte("Banana", "#f0c93a", patterns.banana_skin(), 88)
    first = stage.put("Banana", larder.banana(), yellow, tuple(place + (0.058, 0.035, 0.105)), (-12, 8, 120))
    for offset, turned in (((0.088, 0.02, 0.102), (-24, 4, 112)), ((0.03, 0.052, 0.112), (0, 10, 130))):
        stage.again(first, tuple(place + offset), turned)
    zest = stage.matte("Lemon", "#f0d23a", patterns.orange_peel("#f2d43c", 128), 88)
    stage.put("Lemon", larder.lemon(), zest, (0.05, -0.2, RESTING + 0.0265), (90, 0, 60))
    rind, face = larder.half()
    cut = stage.matte("Orange cut", "#f0a040", patterns.citrus_face("#f59a1e", "#ec8a1c"), 90)
    stage.assemble("Orange half", [(rind, peel), (face, cut)], (-0.025, -0.13, RESTING + 0.036), (62, 0, 15), 60.0)
    purple, pale = stage.matte("Grapes", "#5a2a52"), stage.matte("Grapes green", "#a9b84a")
    for name, skin, seed, count, at, turned in (
        ("Grapes", purple, 3, 38, (0.19, -0.155, 0.0), 165),
        ("Grapes green", pale, 5, 22, (0.43, -0.165, 0.0), 100),
    ):
        berries, stalk = larder.grapes(count, seed=seed)
        parts = [(berry, skin) for berry in berries] + [(stalk, stem)]
        stage.assemble(name, parts, (at[0], at[1], RESTING), (0, 0, turned), 80.0)


def _bread(oak) -> None:
    """A board with a loaf, slices and tomatoes, at the right."""
    walnut = stage.matte("Walnut", "#7a4a2a", pictures.planks(128, 4) * 0.72, 88)
    place = np.array((0.83, 0.2, RESTING))
    stage.assemble("Board", [(kitchenware.board(0.4, 0.26, 0.02), walnut)], tuple(place), (0, 0, 12))
    crust = stage.matte("Crust", "#b87a3c", patterns.crust(), 88)
    crumb = stage.matte("Crumb", "#f2deb4", patterns.crumb(), 88)
    stage.put("Loaf", larder.loaf(), crust, tuple(place + (0.0, 0.06, 0.0195)), (0, 0, 8))
    rind, face = larder.slice_of_bread()
    first = stage.assemble(
        "Slice", [(rind, crust), (face, crumb)], tuple(place + (-0.1, -0.06, 0.0195)), (0, 0, 20), 50.0
    )
    stage.again(first, tuple(place + (-0.07, -0.055, 0.034)), (9, 4, 65))
    red, leaf = stage.matte("Tomato", "#cf3a26"), stage.matte("Tomato leaf", "#4f7f34")
    fruit, star = larder.tomato()
    first = stage.assemble(
        "Tomato", [(fruit, red), (star, leaf)], tuple(place + (0.03, -0.07, 0.0455)), (8, -6, 0), 60.0
    )
    stage.again(first, tuple(place + (0.1, -0.045, 0.0455)), (-6, 10, 80))


def _crockery() -> None:
    """Jars along the wall, a cup, plates in the rack, and cookery books."""
    cork = stage.matte("Cork", "#c39a63")
    for name, colors, x, size in (
        ("Jar flour", ("#f0e6d0", "#8a3b2a", "#c9762f"), 0.25, (0.058, 0.17)),
        ("Jar tea", ("#d9a441", "#5a3a20", "#f4e6c4"), 0.38, (0.05, 0.14)),
        ("Jar salt", ("#6f9a96", "#f4efe2", "#24505e"), 0.49, (0.044, 0.11)),
    ):
        body, lid = kitchenware.jar(*size)
        glaze = stage.matte(name, colors[0], patterns.slip(*colors, size=128), 88)
        stage.assemble(name, [(body, glaze), (lid, cork)], (x, 0.52, RESTING), crease=50.0)
    china = stage.matte("China", "#f1f0ea", surfaces.delft(128), 88)
    stage.assemble("Cup", [(part, china) for part in kitchenware.cup()], (-0.5, 0.0, RESTING), (0, 0, 200), 60.0)
    bindings = [stage.matte(f"Book {code}", code) for code in ("#8c2f39", "#2f4858", "#d9a441", "#4f6f52")]
    paper = stage.matte("Paper", "#efe6d2")
    left = 0.95
    for binding, wide, tall in zip(bindings, (0.04, 0.028, 0.05, 0.033), (0.26, 0.23, 0.27, 0.24), strict=True):
        book = furniture.book(wide, tall, binding, paper)
        stage.assemble(f"Book {left:.2f}", book, (left + wide / 2, 0.5, RESTING), crease=None)
        left += wide + 0.001


def _room(oak) -> None:
    """What the mirrors see behind the camera: a dresser with plates, a table and chairs, a door and a picture."""
    x = 0.9
    dresser = furniture.dresser(stage.matte("Dresser", "#e7d9ba"), oak)
    stage.assemble("Dresser", dresser, (x, NEAR, 0.0), (0, 0, 180), None)
    delft = stage.matte("Plates", "#f1f0ea", surfaces.delft(128), 88)
    plate = kitchenware.plate(0.125).turned(shapes.turn("X", 76.0))
    spots = [(x - 0.51 + 0.34 * i, NEAR + 0.1, z + 0.12) for z in (0.914, 1.264, 1.624) for i in range(4)]
    first = stage.assemble("Plate", [(plate, delft)], spots[0], (0, 0, 180), 50.0)
    for spot in spots[1:]:
        stage.again(first, spot, (0, 0, 180))
    cloth = stage.matte("Tablecloth", "#f1ead8", patterns.gingham("#5f8a6a", 10, 128), 88)
    stage.assemble("Table", furniture.table(1.0, 0.75, cloth, oak), (1.35, -1.2, 0.0), crease=None)
    seat = stage.matte("Seat", "#a8452f")
    stage.assemble("Chair", furniture.chair(oak, seat), (0.62, -1.25, 0.0), (0, 0, -90))
    door = [(shapes.box((0.8, 0.04, 2.02)).moved((0, -0.02, 0)), stage.matte("Door", "#5f7f86"))]
    stage.assemble("Door", door, (-0.45, NEAR, 0.0), (0, 0, 180))
    canvas = stage.matte("Landscape", "#b9a27a", pictures.landscape(160), 90)
    square = np.array([(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)])
    picture = [(shapes.pane(square).moved((0, -0.012, 0)), canvas), (furniture.frame(square, 0.04, 0.03, 1.0), oak)]
    stage.assemble("Picture", picture, (RIGHT, -0.7, 1.6), (0, 0, -90))


def _light() -> None:
    """The morning sun through the window, the sky's own light there, and soft lamps that fill the shadows."""
    morning = pictures.Sky(
        azimuth=212.0, elevation=24.0, zenith="#5f8fc8", horizon="#e4e6df", glow="#ffd9a0", hills="#5f7f6a", seed=4
    )
    stage.sky(morning, 9.0, width=768)  # it is seen through the window alone
    low, high, sill, head = WINDOW
    y, z = (low + high) / 2, (sill + head) / 2
    stage.area_lamp(
        "Window light", 16.0, (high - low, head - sill), (LEFT + 0.02, y, z), (1.0, y + 0.1, 0.9), "#e3eeff"
    )
    stage.area_lamp("Ceiling light", 13.0, (1.8, 1.8), (0.7, -0.9, HIGH - 0.1), (0.7, -0.9, 0.0), "#ffe6c2")
    stage.area_lamp("Ceiling glow", 5.0, (2.0, 2.0), (0.7, -0.9, 2.0), (0.7, -0.9, HIGH), "#ffe6c2")
