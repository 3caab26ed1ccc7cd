"""cathedral: a Gothic nave over a polished floor, with the triangles of the paper (40,250; figures 9 to 15).

Metres; the nave runs along +Y. The floor is one flat rectangle, its roughness one value of the material "Floor".
"""

from . import masonry, shapes, stage, surfaces

BAYS, BAY = 8, 4.5
NAVE, AISLE = 8.0, 3.4  # widths between the middles of the piers, and from there to the outer wall
LENGTH = BAYS * BAY
OUTER = NAVE / 2 + AISLE
PIER = 3.6  # height, where the arcade and the aisles' vaults spring
SPRINGING, RISE = 6.3, 3.9  # of the nave's vault
ROUGHNESS = 0.1
PETALS = 12


def build() -> None:
    """Build the scene into the open, empty file."""
    stone = stage.matte("Stone", "#d8c8a8", surfaces.ashlar("#d8c8a8"), 85)
    wall = stage.matte("Wall", "#cbb994", surfaces.ashlar("#cfbf9c", 6, 2), 85)
    vault = stage.matte("Vault", "#1d3f7a", surfaces.starry_vault(), 85)
    _floor()
    _arcades(stone, wall)
    _nave_vault(stone, vault)
    _aisles(stone, wall, vault)
    _windows(stone)
    _ends(stone, wall)
    _altar(stone)
    _light()
    stage.camera((0.45, 1.2, 1.65), (-0.1, 20.0, 1.35), 20.0)


def _floor() -> None:
    marble = stage.polished("Floor", surfaces.marble_floor(), ROUGHNESS)
    shape = shapes.rectangle(2 * OUTER, LENGTH, repeat=1.6)
    stage.reflects(stage.put("Floor", shape, marble, (0.0, LENGTH / 2, 0.0), smooth=False))


def _sides():
    """Each side's sign and the turn about Z that faces what is built facing -Y towards the nave."""
    return ((-1, 90.0), (1, -90.0))


def _row(name: str, parts, positions, turned: float, crease: float = 35.0) -> None:
    """One mesh at every one of `positions`."""
    first = stage.assemble(name, parts, positions[0], (0.0, 0.0, turned), crease)
    for position in positions[1:]:
        stage.again(first, position, (0.0, 0.0, turned))


def _bays(x: float) -> list:
    return [(x, BAY * (number + 0.5), 0.0) for number in range(BAYS)]


def _lines(ends: int) -> list[float]:
    """Where bays meet, along Y, without the first and last `ends`."""
    return [BAY * number for number in range(ends, BAYS + 1 - ends)]


def _arcades(stone, wall) -> None:
    """Piers, the arches between them and the wall above, with a shaft that carries the vault over each pier."""
    span, rise, top = BAY - 0.8, 2.35, SPRINGING + RISE + 0.3
    moulding = masonry.arch(span + 0.1, rise + 0.05, PIER, 0.34, 0.18, 8, walled=True)
    above = masonry.wall_over_arch(span + 0.2, rise + 0.1, PIER, BAY, top, 8)
    behind = above.turned(shapes.turn("Z", 180.0)).moved((0.0, 0.24, 0.0))
    course = masonry.course(BAY, 0.12, 0.14).moved((0.0, -0.24, SPRINGING - 0.13))
    pier, shaft = masonry.pier(PIER), masonry.shaft(PIER + 0.1, SPRINGING)
    for sign, turned in _sides():
        name, x = ("left", "right")[sign > 0], sign * NAVE / 2
        parts = [(moulding, stone), (above.moved((0.0, -0.24, 0.0)), wall), (behind, wall), (course, stone)]
        _row(f"Arcade {name}", parts, _bays(x), turned)
        _row(f"Pier {name}", [(pier, stone)], [(x, y, 0.0) for y in _lines(1)], turned)
        _row(f"Shaft {name}", [(shaft, stone)], [(x - sign * 0.27, y, 0.0) for y in _lines(1)], turned)


def _nave_vault(stone, vault) -> None:
    inner = NAVE - 0.5
    webs = masonry.vault(inner, BAY, SPRINGING, RISE, 5).textured(1.8)
    ribs = masonry.ribs(inner, BAY, SPRINGING, RISE, 7)
    _row("Nave vault", [(webs, vault), (ribs, stone)], _bays(0.0), 0.0)
    across = masonry.arch(inner, RISE, SPRINGING, 0.2, 0.2, 8)
    _row("Nave arch", [(across, stone)], [(0.0, y, 0.0) for y in _lines(0)], 0.0)


def _aisles(stone, wall, vault) -> None:
    """The side aisles: their vaults, outer walls, and the half shafts on these."""
    rise, depth = 2.2, AISLE - 0.24
    webs = masonry.vault(depth, BAY, PIER, rise, 3).textured(1.8)
    ribs = masonry.ribs(depth, BAY, PIER, rise, 4)
    across = masonry.arch(depth, rise, PIER, 0.16, 0.16, 5)
    panel = shapes.rectangle(BAY, PIER + rise + 0.3).turned(shapes.turn("X", 90.0))
    panel = panel.moved((0.0, 0.0, (PIER + rise + 0.3) / 2)).textured(masonry.STONE)
    plinth = masonry.course(BAY, 0.16, 0.5).moved((0.0, 0.0, 0.25 - masonry.SUNK))
    shaft = masonry.shaft(0.42, PIER)
    for sign, turned in _sides():
        name, middle = ("left", "right")[sign > 0], sign * (NAVE / 2 + 0.24 + depth / 2)
        _row(f"Aisle vault {name}", [(webs, vault), (ribs, stone)], _bays(middle), 0.0)
        _row(f"Aisle arch {name}", [(across, stone)], [(middle, y, 0.0) for y in _lines(0)], 0.0)
        _row(f"Aisle wall {name}", [(panel, wall), (plinth, stone)], _bays(sign * OUTER), turned)
        _row(f"Aisle shaft {name}", [(shaft, stone)], [(sign * (OUTER - 0.06), y, 0.0) for y in _lines(1)], turned)


def _windows(stone) -> None:
    """Stained glass in the aisles and above the arcades, in three patterns that take turns."""
    glass = [
        stage.glowing(f"Glass {seed}", "#88a0d0", 2.0, surfaces.stained_glass(seed=seed, ground=ground))
        for seed, ground in ((1, "#1d4aa6"), (2, "#8f1d2a"), (3, "#1f6a58"))
    ]
    kinds = (
        ("Aisle window", OUTER - 0.03, (1.5, 1.3, 3.3, 1.5)),
        ("High window", NAVE / 2 - 0.27, (1.5, SPRINGING + 0.2, SPRINGING + 1.5, 1.3)),
    )
    for kind, x, (width, sill, springing, rise) in kinds:
        pane = masonry.lancet_pane(width, sill, springing, rise, 6)
        stones = masonry.tracery(width, sill, springing, rise, 6).moved((0.0, -0.02, 0.0))
        for sign, turned in _sides():
            for number, material in enumerate(glass):
                name = f"{kind} {('left', 'right')[sign > 0]} {number + 1}"
                _row(name, [(pane, material), (stones, stone)], _bays(sign * x)[number::3], turned)


def _ends(stone, wall) -> None:
    """The two end walls, a rose and five lancets in the far one, a door in the near one."""
    height = SPRINGING + RISE + 0.3
    panel = shapes.rectangle(2 * OUTER, height).turned(shapes.turn("X", 90.0)).moved((0.0, 0.0, height / 2))
    panel = panel.textured(masonry.STONE)
    stage.assemble("East wall", [(panel, wall)], (0.0, LENGTH, 0.0))
    stage.assemble("West wall", [(panel, wall)], (0.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    rose = stage.glowing("Rose", "#c08850", 2.6, surfaces.rose_glass(PETALS))
    window = [(masonry.rose_pane(1.5, 2 * PETALS), rose), (masonry.rose_tracery(1.5, PETALS), stone)]
    stage.assemble("Rose window", window, (0.0, LENGTH - 0.04, 7.6))
    lights = stage.glowing("East glass", "#88a0d0", 2.4, surfaces.stained_glass(seed=4, ground="#5a2a86"))
    size = (1.05, 2.1, 4.3, 0.9)
    parts = [(masonry.lancet_pane(*size, 6), lights), (masonry.tracery(*size, 6).moved((0.0, -0.02, 0.0)), stone)]
    _row("East window", parts, [(1.4 * number, LENGTH - 0.04, 0.0) for number in (-2, -1, 0, 1, 2)], 0.0)
    oak = stage.matte("Oak", "#5b3d26")
    door = masonry.lancet_pane(2.6, -masonry.SUNK, 2.4, 1.7, 8)
    frame = masonry.tracery(2.6, -masonry.SUNK, 2.4, 1.7, 8)
    stage.assemble("Door", [(door, oak), (frame, stone)], (0.0, 0.05, 0.0), (0.0, 0.0, 180.0))


def _altar(stone) -> None:
    """An altar on two steps, with a cloth and six candles."""
    linen, gold = stage.matte("Linen", "#efe9dc"), stage.matte("Gold", "#c79a3b")
    flame, wax = stage.glowing("Flame", "#ffc56a", 6.0), stage.matte("Wax", "#f2e6c8")
    steps = [
        (shapes.box((5.2, 2.6, 0.17)).moved((0, 0, -masonry.SUNK)), stone),
        (shapes.box((4.0, 1.9, 0.17)).moved((0, 0.2, 0.14)), stone),
    ]
    block = [(shapes.box((2.4, 0.9, 0.95)).moved((0, 0.3, 0.3)), stone)]
    cloth = [(shapes.box((2.6, 0.96, 0.06)).moved((0, 0.3, 1.255)), linen)]
    front = [(shapes.box((0.9, 0.02, 0.75)).moved((0, -0.165, 0.5)), gold)]
    parts = [(shape.textured(masonry.STONE), material) for shape, material in (*steps, *block, *cloth, *front)]
    stick = shapes.lathe([(0.09, 0), (0.1, 0.03), (0.03, 0.08), (0.03, 0.3), (0.07, 0.36), (0, 0.36)], 10)
    candle = shapes.lathe([(0.03, 0.36), (0.03, 0.72), (0, 0.73)], 8)
    light = shapes.lathe([(0.0, 0.74), (0.025, 0.79), (0.0, 0.88)], 8)
    for x in (-1.05, -0.75, -0.45, 0.45, 0.75, 1.05):
        for shape, material in ((stick, gold), (candle, wax), (light, flame)):
            parts.append((shape.moved((x, 0.4, 1.316)), material))
    stage.assemble("Altar", parts, (0.0, LENGTH - 2.2, 0.0))


def _light() -> None:
    """Daylight from the windows: a long lamp behind each row, sunny on the right, of the sky on the left."""
    middle, long = LENGTH / 2, LENGTH - 1.0
    for sign, power, code in ((1, 1000.0, "#ffdca8"), (-1, 330.0, "#bcd4ff")):
        high = (sign * 2.4, middle, SPRINGING + 1.6)
        stage.area_lamp("High windows", power, (long, 2.0), high, (-sign * 2.5, middle, 0.0), code)
        low = (sign * (OUTER - 0.7), middle, 3.2)
        stage.area_lamp("Aisle windows", power * 0.55, (long, 1.6), low, (0.0, middle, 0.4), code)
    stage.area_lamp("Rose", 200.0, (5.0, 4.0), (0.0, LENGTH - 1.0, 6.0), (0.0, LENGTH - 12.0, 0.0), "#ffcf94")
    stage.plain_world("#6a7488", 0.05)
