"""living-room: a fireplace under a wide mirror, chrome and steel on and round a table, and a camera that flies.

Metres; the room is 6 wide (X), 5 deep (Y) and 2.8 high. Half of its triangles reflect: the mirrors are
flat (over the fireplace), convex (balls, a round mirror, vases) and concave (a bowl, a lamp's shade).
"""

import numpy as np

from . import furniture, lounge, patterns, pictures, sculptures, shapes, stage, surfaces

WIDE, DEEP, HIGH = 6.0, 5.0, 2.8
WINDOWS = (-1.15, 1.05)  # where along the right wall their middles are
OPENING = (1.3, 2.15, 0.3)  # of a window: wide, high, and above the floor
TABLE = (0.0, 0.35, 0.42)  # the middle of the coffee table's top
EYE, AIM = (0.34, -2.12, 1.46), (0.12, 2.4, 1.02)


def build() -> None:
    """Build the scene into the open, empty file."""
    chrome = stage.mirror("Chrome", "#f2f3f4")
    steel = stage.mirror("Steel", "#dcdee0")
    gold = stage.mirror("Gold", "#f0c878")
    gilt = stage.matte("Gilding", "#c8963c", surfaces.gilding(), 92)
    oak = stage.matte("Oak", "#9a673c", pictures.planks(256, 6), 88)
    _shell()
    _windows()
    _fireplace(gilt, gold)
    _sofa()
    _chairs(chrome)
    _table(oak, steel, chrome, gold)
    _sculpture(chrome)
    _lamp(chrome)
    _walls(oak, gilt, chrome)
    _plants()
    _light()
    stage.camera(EYE, AIM, 27.0)
    stage.fly(_path())


def _path() -> list:
    """Along the sculpture to the table, round it by the fire, and back between sofa and lamp."""
    return [
        (*EYE, *AIM),
        (0.18, -1.88, 1.43, 0.06, 2.2, 0.98),
        (-0.1, -1.52, 1.36, -0.02, 1.9, 0.94),
        (-0.38, -1.16, 1.28, 0.04, 1.4, 0.82),
        (-0.5, -0.86, 1.2, 0.16, 1.0, 0.7),
        (-0.4, -0.64, 1.14, 0.2, 0.9, 0.62),
        (-0.12, -0.52, 1.12, 0.12, 1.0, 0.64),
        (0.14, -0.38, 1.15, -0.14, 1.2, 0.74),
        (0.34, -0.12, 1.21, -0.5, 1.3, 0.88),
        (0.48, 0.2, 1.28, -0.9, 1.2, 0.98),
        (0.56, 0.56, 1.34, -1.2, 0.9, 1.05),
        (0.56, 0.92, 1.4, -1.3, 0.5, 1.02),
        (0.48, 1.24, 1.42, -1.25, 0.1, 0.94),
        (0.3, 1.46, 1.42, -0.95, -0.4, 0.86),
        (0.06, 1.58, 1.4, -0.4, -0.8, 0.84),
        (-0.2, 1.6, 1.37, 0.3, -0.8, 0.86),
        (-0.46, 1.5, 1.33, 0.95, -0.5, 0.9),
    ]


def _shell() -> None:
    """Floor, ceiling and walls, the right one with two openings; a skirting and a cornice."""
    boards = stage.matte("Floor", "#a9713f", pictures.planks(512, 8), 88)
    stage.put("Floor", shapes.rectangle(WIDE + 0.3, DEEP + 0.3, 1.4), boards, smooth=False)
    white = stage.matte("White", "#f3eee4")
    stage.put("Ceiling", shapes.rectangle(WIDE, DEEP), white, (0, 0, HIGH), (180, 0, 0), smooth=False)
    paint = stage.matte("Wall", "#5f7f86", surfaces.plaster("#6f929a"), 85)
    paper = stage.matte("Wallpaper", "#d9c9a8", surfaces.damask("#dccdae", "#c5b08a", 256), 85)
    upright = shapes.turn("X", 90.0)
    for name, width, material, place, turned in (
        ("Wall far", WIDE, paint, (0, DEEP / 2, 0), 0),
        ("Wall near", WIDE, paper, (0, -DEEP / 2, 0), 180),
        ("Wall left", DEEP, paper, (-WIDE / 2, 0, 0), 90),
    ):
        wall = (
            shapes.rectangle(width, HIGH)
            .turned(upright)
            .moved((0, 0, HIGH / 2))
            .textured(0.7 if material is paper else 1.5)
        )
        stage.put(name, wall, material, place, (0, 0, turned), smooth=False)
    wide, tall, sill = OPENING
    edges = [-DEEP / 2, *(middle + side * wide / 2 for middle in WINDOWS for side in (-1, 1)), DEEP / 2]
    panels = [(edges[i], edges[i + 1], 0.0, HIGH) for i in (0, 2, 4)]
    panels += [(edges[i], edges[i + 1], low, high) for i in (1, 3) for low, high in ((0.0, sill), (sill + tall, HIGH))]
    parts = []
    for start, end, low, high in panels:
        panel = shapes.rectangle(end - start, high - low).turned(shapes.turn("Z", -90.0) @ upright)
        parts.append(panel.moved((WIDE / 2, (start + end) / 2, (low + high) / 2)))
    stage.put("Wall right", shapes.joined(parts).textured(0.7), paper, smooth=False)
    x, y = WIDE / 2, DEEP / 2
    corners = np.array([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0), (-x, -y, 0)], dtype=np.float64)
    for name, z, profile in (
        ("Skirting", 0.0, [(0.13, 0.0), (0.12, -0.012), (0.1, -0.02), (-0.01, -0.02)]),
        ("Cornice", HIGH, [(0.0, -0.16), (-0.03, -0.14), (-0.06, -0.07), (-0.13, -0.04), (-0.16, 0.0)]),
    ):
        moulding = shapes.sweep(corners + (0, 0, z), profile[::-1], (0.0, 0.0, 1.0))
        stage.assemble(name, [(moulding, white)])


def _windows() -> None:
    """Two tall windows with curtains; the afternoon sun comes in."""
    wide, tall, sill = OPENING
    wood, cloth = stage.matte("Woodwork", "#f6f1e6"), stage.matte("Curtain", "#b9603f")
    iron = stage.matte("Iron", "#2b2a2a")
    hanging = None
    for name, middle in zip(("near", "far"), WINDOWS, strict=True):
        place = (WIDE / 2, middle, sill + tall / 2)
        stage.assemble(f"Window {name}", furniture.casement(wide, tall, wood), place, (0, 0, -90))
        rod = np.array([(WIDE / 2 - 0.1, middle + side * 0.98, 2.6) for side in (-1, 1)])
        stage.assemble(f"Curtain rod {name}", [(shapes.tube(rod, 0.014, 16), iron)])
        for side in (-1, 1):
            at = (WIDE / 2 - 0.1, middle + side * 0.77, 2.585)
            if hanging is None:
                hanging = stage.put("Curtain", lounge.drape(0.4, 2.56), cloth, at, (0, 0, -90))
                stage.subdivide(hanging, 1)
            else:
                stage.subdivide(stage.again(hanging, at, (0, 0, -90)), 1)


def _fireplace(gilt, gold) -> None:
    """The fireplace, the wide mirror over it, and on the mantel candlesticks, a clock and a vase."""
    stone = stage.matte("Stone", "#dcd6c8", surfaces.marble("#e2dccf", "#a79c8a"), 88)
    soot, logs = stage.matte("Soot", "#2a2421"), stage.matte("Logs", "#5b3b26")
    ember = stage.glowing("Fire", "#ff9a3c", 2.2, lamp=False)
    y = DEEP / 2
    stage.assemble("Fireplace", lounge.hearth(stone, soot, logs, ember), (0, y, 0))
    outline = shapes.rounded(2.3, 1.26, 0.1, 6)
    place = (0.0, y - 0.035, 1.2 + 0.68)
    stage.put("Wall mirror", shapes.pane(outline), stage.mirror("Silver", "#f3f5f4"), place, smooth=False)
    stage.assemble("Mirror frame", [(furniture.frame(outline, 0.09, 0.06), gilt)], place)
    stick, candle = lounge.candlestick()
    first = stage.put("Candlestick", stick, gold, (-0.7, y - 0.2, 1.1495))
    wax = stage.matte("Candle", "#f4ecd8")
    for i, x in enumerate((-0.7, -0.58, 0.66)):
        if i:
            stage.subdivide(stage.again(first, (x, y - 0.2, 1.1495)), 1)
        stage.put(f"Candle {i}", candle, wax, (x, y - 0.2, 1.1495))
    stage.subdivide(first, 1)
    dial, walnut = stage.matte("Dial", "#fff0cf", surfaces.clock(128), 90), stage.matte("Walnut", "#6b4329")
    stage.assemble("Clock", lounge.clock(walnut, dial), (0.2, y - 0.2, 1.1495), crease=40.0)


def _sofa() -> None:
    """A sofa along the left, of blocks and cushions."""
    velvet = stage.matte("Sofa", "#2f5f55")
    x, y = -1.75, 0.35
    turned = (0, 0, 90)
    legs = stage.matte("Legs", "#2e231b")
    stage.put("Sofa base", lounge.slab(2.3, 0.9, 0.2), velvet, (x, y, 0.12), turned)
    peg = shapes.lathe([(0, -lounge.SUNK), (0.018, -lounge.SUNK), (0.026, 0.13), (0, 0.13)], 20)
    pegs = [(peg.moved((sx * 1.05, sy * 0.36, 0)), legs) for sx in (-1, 1) for sy in (-1, 1)]
    stage.assemble("Sofa legs", pegs, (x, y, 0.0), turned)
    back = stage.put("Sofa back", lounge.slab(2.3, 0.2, 0.5), velvet, (x - 0.36, y, 0.3), turned)
    arm = stage.put("Sofa arm", lounge.slab(0.2, 0.86, 0.36), velvet, (x, y - 1.05, 0.26), turned)
    other = stage.again(arm, (x, y + 1.05, 0.26), turned)
    things = [back, arm, other]
    seat = lounge.cushion(0.62, 0.68, 0.15)
    rest = lounge.cushion(0.6, 0.42, 0.15)
    for i, along in enumerate((-0.63, 0.0, 0.63)):
        if i == 0:
            first = stage.put("Seat cushion", seat, velvet, (x + 0.09, y + along, 0.32), turned)
            second = stage.put("Back cushion", rest, velvet, (x - 0.13, y + along, 0.7), (75, 0, 90))
            things += [first, second]
        else:
            things.append(stage.again(first, (x + 0.09, y + along, 0.32), turned))
            things.append(stage.again(second, (x - 0.13, y + along, 0.7), (75, 0, 90)))
    soft = lounge.cushion(0.42, 0.42, 0.13, fullness=2.2)
    for name, code, along, tilt in (
        ("Pillow ochre", "#d9a441", -0.75, (68, 0, 72)),
        ("Pillow rose", "#c46a5a", 0.72, (70, 0, 112)),
        ("Pillow blue", "#6f9ab5", 0.42, (64, 0, 98)),
    ):
        cloth = stage.matte(name, code, patterns.gingham(code, 5, 96), 85)
        things.append(stage.put(name, soft, cloth, (x + 0.1, y + along, 0.68), tilt))
    for thing in things:
        stage.subdivide(thing, 1)


def _chairs(chrome) -> None:
    """Two cantilever chairs of chromed tube, opposite the sofa."""
    leather = stage.matte("Leather", "#8a4a2b")
    for number, (x, y, turned) in enumerate(((1.5, 1.25, -70.0), (1.75, 0.5, -98.0))):
        back = shapes.turn("Z", turned) @ (0.0, 0.25, 0.0) + (x, y, 0.7)
        places = [(x, y, 0.0), (x, y, 0.455), tuple(back)]
        angles = [(0, 0, turned), (0, 0, turned), (98, 0, turned)]
        if number == 0:
            shown = (
                ("Chair frame", lounge.cantilever(), chrome),
                ("Chair seat", lounge.cushion(0.5, 0.5, 0.05, 40, 0.5), leather),
                ("Chair back", lounge.cushion(0.5, 0.3, 0.04, 40, 0.5), leather),
            )
            made = [stage.put(*part, at, angle) for part, at, angle in zip(shown, places, angles, strict=True)]
        else:
            made = [stage.again(part, at, angle) for part, at, angle in zip(made, places, angles, strict=True)]
        for pad in made[1:]:
            stage.subdivide(pad, 1)


def _table(oak, steel, chrome, gold) -> None:
    """A coffee table on a rug: a bowl, three balls and books on it."""
    weave, yarn = stage.matte("Rug", "#7c2427", pictures.rug(384), 88), stage.matte("Fringe", "#e3d6b8")
    stage.assemble("Rug", lounge.rug(3.0, 2.2, weave, yarn), (0.05, 0.35, 0.0), crease=60.0)
    x, y, top = TABLE
    stage.put("Table top", lounge.slab(1.25, 0.8, 0.045, 64).textured(0.9), oak, (x, y, top - 0.045))
    legs = [(leg, stage.matte("Black steel", "#232323")) for leg in lounge.table_legs(top)]
    stage.assemble("Table legs", legs, (x, y, 0.0), crease=60.0)
    on = top - 0.001
    stage.put("Steel bowl", lounge.bowl(0.23, 0.13), steel, (x - 0.25, y - 0.1, on))
    ball = shapes.sphere(0.1, 104, 52)
    first = stage.put("Ball large", ball, chrome, (x + 0.26, y + 0.06, on + 0.15 - 0.0005))
    first.scale = (1.5, 1.5, 1.5)
    for name, size, dx, dy in (("Ball middle", 1.0, 0.46, -0.13), ("Ball small", 0.65, 0.13, -0.24)):
        thing = stage.again(first, (x + dx, y + dy, on + 0.1 * size - 0.0005))
        thing.name, thing.scale = name, (size, size, size)
    paper = stage.matte("Paper", "#efe6d2")
    bindings = [stage.matte(f"Book {code}", code) for code in ("#2f4858", "#d9a441", "#8c2f39")]
    parts = lounge.pile(bindings, paper)
    stage.assemble("Books", parts, (x - 0.05, y + 0.22, on), crease=None)
    tall = stage.put("Gold vase", lounge.bottle_vase(), gold, (x - 0.5, y + 0.22, on))
    stage.subdivide(tall, 2)


def _sculpture(chrome) -> None:
    """A polished lantern of winding arcs, of genus 3, on a pedestal."""
    stone = stage.matte("Pedestal", "#cfc8ba", surfaces.marble("#d6cfc0", "#8f867a", 192), 85)
    stage.assemble("Pedestal", furniture.pedestal(0.56, 0.24, stone), (1.02, -0.32, -lounge.SUNK))
    shape = sculptures.lantern().moved(scale=0.42)
    thing = stage.put("Sculpture", shape, chrome, (1.02, -0.32, 1.0), (0, 0, 24))
    stage.subdivide(thing, 4)


def _lamp(chrome) -> None:
    """A chromed lamp that bows from behind the sofa over the table."""
    base, bow, shade, bulb = lounge.arc_lamp()
    place, turned = (-1.9, 1.75, 0.0), (0, 0, -40)
    stage.put("Lamp base", base, chrome, place, turned)
    stage.put("Lamp bow", bow, chrome, place, turned)
    stage.put("Lamp shade", shade, chrome, place, turned)
    stage.put("Bulb", bulb, stage.glowing("Bulb", "#ffe2b0", 4.0, lamp=False), place, turned)


def _walls(oak, gilt, chrome) -> None:
    """A bookcase and an oval mirror on the left; on the near wall one that bulges, a door and a picture."""
    codes = ("#8c2f39", "#2f4858", "#d9a441", "#4f6f52", "#e8dcc4", "#6a3f5a", "#b5533c")
    bindings = [stage.matte(f"Binding {code}", code) for code in codes]
    paper = stage.matte("Pages", "#efe6d2")
    stage.assemble(
        "Bookcase", lounge.bookcase(1.9, 2.2, oak, bindings, paper), (-WIDE / 2 + 0.001, -0.35, 0.0), (0, 0, 90), None
    )
    oval, place = shapes.ellipse(0.9, 1.2, 64), (0.035 - WIDE / 2, 1.42, 1.6)
    stage.put("Oval mirror", shapes.pane(oval), stage.mirror("Oval silver", "#f3f5f4"), place, (0, 0, 90), smooth=False)
    stage.assemble("Oval frame", [(furniture.frame(oval, 0.08, 0.05), gilt)], place, (0, 0, 90))
    urn = stage.put("Floor vase", lounge.floor_vase(), chrome, (-2.55, -1.62, 0.0))
    stage.subdivide(urn, 2)
    silver = stage.mirror("Round silver", "#f3f5f4")
    place, turned = (-0.75, -DEEP / 2 + 0.045, 1.62), (0, 0, 180)
    stage.put("Round mirror", lounge.convex_mirror(0.36, 0.1), silver, place, turned)
    stage.assemble("Sunburst", lounge.sunburst(0.36, 0.2, gilt), place, turned, 40.0)
    paint = stage.matte("Door", "#e9e2d2")
    leaf = shapes.box((0.9, 0.05, 2.1)).moved((0, -0.02, -lounge.SUNK))
    panels = [
        shapes.box((0.3, 0.02, tall)).moved((side * 0.2, -0.05, low))
        for side in (-1, 1)
        for low, tall in ((0.2, 0.7), (1.1, 0.8))
    ]
    outline = np.array([(-0.45, -lounge.SUNK), (0.45, -lounge.SUNK), (0.45, 2.1), (-0.45, 2.1)])
    door = [(shape, paint) for shape in (leaf, *panels, furniture.frame(outline, 0.1, 0.06, 1.0))]
    door.append((shapes.sphere(0.032, 20, 12).moved((-0.37, -0.09, 1.02)), gilt))
    stage.assemble("Door", door, (1.75, -DEEP / 2, 0.0), (0, 0, 180))
    canvas = stage.matte("Landscape", "#b9a27a", pictures.landscape(192), 90)
    square = np.array([(-0.42, -0.42), (0.42, -0.42), (0.42, 0.42), (-0.42, 0.42)])
    picture = [(shapes.pane(square).moved((0, -0.012, 0)), canvas), (furniture.frame(square, 0.06, 0.04, 1.0), oak)]
    stage.assemble("Picture", picture, (0.42, -DEEP / 2, 1.68), (0, 0, 180))
    stage.assemble(
        "Sideboard",
        [(shapes.box((1.5, 0.4, 0.7)).moved((0, -0.2, 0.06)).textured(0.8), oak)],
        (-0.75, -DEEP / 2 + 0.001, -0.0),
        (0, 0, 180),
        None,
    )


def _plants() -> None:
    """A rubber plant by the fire and another in the corner behind the camera."""
    pot, soil = stage.matte("Pot", "#b9694a"), stage.matte("Soil", "#3d2b20")
    stalk, leaf = stage.matte("Stem", "#6a5a38"), stage.matte("Leaf", "#3f7f4a")
    first = stage.assemble("Rubber plant", lounge.rubber_plant(pot, soil, stalk, leaf), (1.62, 2.08, 0.0), crease=60.0)
    second = stage.again(first, (-2.5, -2.1, 0.0), (0, 0, 140))
    for thing in (first, second):
        stage.subdivide(thing, 1)


def _light() -> None:
    """The afternoon sun through the windows, the sky's light there, the lamp, the fire and a soft ceiling."""
    sky = pictures.Sky(azimuth=-24.0, elevation=30.0, zenith="#5b8cc8", horizon="#e6e4dc", glow="#ffd9a0", seed=6)
    stage.sky(sky, 13.0, width=768)
    wide, tall, sill = OPENING
    for name, middle in zip(("near", "far"), WINDOWS, strict=True):
        stage.area_lamp(
            f"Window light {name}",
            36.0,
            (wide, tall),
            (WIDE / 2 - 0.02, middle, sill + tall / 2),
            (0.0, middle, 0.9),
            "#e3eeff",
        )
    stage.area_lamp("Ceiling light", 62.0, (3.0, 2.6), (0, 0, HIGH - 0.1), (0, 0, 0), "#ffe8c8")
    stage.area_lamp("Ceiling glow", 34.0, (3.6, 3.0), (0, 0, 2.2), (0, 0, HIGH), "#ffe8c8")
    stage.area_lamp("Fire light", 14.0, (0.5, 0.3), (0, DEEP / 2 - 0.35, 0.3), (0, 0.5, 0.3), "#ffa860")
