"""The image textures of the cathedral, the hall, the street and the bathroom, painted as those in `pictures`."""

import numpy as np

from .pictures import color, cover, noise, paint, texels


def ashlar(code: str, rows: int = 4, columns: int = 2, size: int = 512, joint: float = 0.004) -> np.ndarray:
    """Dressed stones in staggered rows, each of its own tone. Repeats; `rows` must be even."""
    x, y = texels(size)
    row = (y * rows).astype(int)
    along = x * columns + 0.5 * (row % 2)
    stone = row * columns + along.astype(int) % columns
    tone = np.random.default_rng(8).uniform(0.86, 1.0, rows * columns)[stone]
    gap = np.minimum((0.5 - abs(along % 1 - 0.5)) / columns, (0.5 - abs(y * rows % 1 - 0.5)) / rows)
    grain = 0.8 + 0.2 * noise((size, size), 1.1, 4) + 0.06 * noise((size, size), 0.2, 14)
    picture = color(code) * (tone * grain)[..., None]
    return np.clip(paint(picture, 0.55 * cover(gap - joint, size), "#5d5242"), 0.0, 1.0)


def marble_floor(size: int = 768) -> np.ndarray:
    """Two by two slabs, pale and dark, veined, with a red lozenge set into each crossing. Repeats."""
    x, y = texels(size)
    veins = 1.0 - np.abs(2.0 * noise((size, size), 1.7, 31) - 1.0)
    veins = np.clip((veins - 0.9) / 0.1, 0.0, 1.0)[..., None]
    cloud = noise((size, size), 1.5, 32)[..., None]
    pale = color("#a3947b") * (0.84 + 0.16 * cloud) - 0.12 * veins
    dark = color("#2b3a3a") * (0.75 + 0.4 * cloud) + 0.2 * veins
    picture = np.where(((x < 0.5) ^ (y < 0.5))[..., None], pale, dark)
    within = np.minimum(0.5 - abs(x * 2 % 1 - 0.5), 0.5 - abs(y * 2 % 1 - 0.5)) / 2
    lozenge = (0.5 - abs(x * 2 % 1 - 0.5) + 0.5 - abs(y * 2 % 1 - 0.5)) / 2
    picture = paint(picture, 0.8 * cover(within - 0.0016, size), "#6b6253")
    red = color("#7c3a2e") * (0.8 + 0.3 * cloud) + 0.1 * veins
    picture = paint(picture, cover(lozenge - 0.094, size), "#a08a5c")
    return np.clip(picture + cover(lozenge - 0.086, size) * (red - picture), 0.0, 1.0)


def starry_vault(size: int = 384) -> np.ndarray:
    """Gold stars on blue, in staggered rows. Repeats."""
    x, y = texels(size)
    x, y = x * 4.0, y * 4.0
    x = (x + 0.5 * (np.floor(y) % 2)) % 1 - 0.5
    y = y % 1 - 0.5
    angle, far = np.arctan2(y, x), np.hypot(x, y)
    star = far - 0.2 * (0.62 + 0.38 * np.cos(6.0 * angle))
    picture = color("#1d3f7a") * (0.75 + 0.35 * noise((size, size), 1.3, 41))[..., None]
    return np.clip(paint(picture, cover(star / 4.0, size), "#e8c25a"), 0.0, 1.0)


_GLASS = ("#1f4fb0", "#b3202c", "#2f8a4c", "#e0a52c", "#6a3d9a", "#2a7fc0", "#d9662b", "#f0e2b0")


def stained_glass(size: tuple[int, int] = (512, 192), seed: int = 1, ground: str = "#1d4aa6") -> np.ndarray:
    """A window: medallions one over another in a border, all of small panes between leads. (H, W)."""
    height, width = size
    random = np.random.default_rng(seed)
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / width)
    side = abs(x - 0.25 - 0.5 * (x > 0.5)) * 2.0  # each light of the window: 0 in its middle, 0.5 at its edge
    step = y * 2.0 % 1.0 - 0.5
    far, angle = np.hypot(side, step), np.arctan2(step, side)
    number = np.floor(y * 2.0).astype(int) + 50 * (x > 0.5)
    part = np.select([far < 0.13, far < 0.26, far < 0.38], [0, 1 + (angle * 4 / np.pi).astype(int) % 4, 5], 6)
    tiles = np.floor(x * 16).astype(int) + 16 * np.floor(y * 16).astype(int)
    border = side > 0.42
    pane = np.where(border, 100000 + tiles, np.where(part == 6, 200000 + tiles, number * 10 + part))
    codes, where = np.unique(pane, return_inverse=True)
    paints = np.array([color(code) for code in _GLASS])[random.integers(0, len(_GLASS), len(codes))]
    picture = paints[where.reshape(pane.shape)]
    field = (part == 6) & ~border
    picture[field] = 0.75 * color(ground) + 0.25 * picture[field]
    leads = np.zeros(pane.shape, dtype=bool)
    for axis in (0, 1):
        for shift in (-1, 1):
            leads |= pane != np.roll(pane, shift, axis)
    picture = picture * (0.72 + 0.42 * noise((height, width), 1.0, seed + 7))[..., None]
    return np.clip(np.where(leads[..., None], color("#15120f"), picture), 0.0, 1.0)


def rose_glass(petals: int, size: int = 384) -> np.ndarray:
    """A round window: rings of panes about a flower."""
    x, y = texels(size)
    x, y = 2 * x - 1, 2 * y - 1
    far, turn = np.hypot(x, y), np.arctan2(y, x) / (2 * np.pi)
    ring = np.digitize(far, (0.12, 0.3, 0.48, 0.64, 0.96))
    pane = np.floor(turn * petals * np.where(ring > 2, 2, 1)[...] + 0.5 * (ring % 2)).astype(int) + 100 * ring
    codes = ("#f3dc8a", "#c22c33", "#2554b8", "#d98a2b", "#2a8f86", "#7a1f3d")
    picture = np.array([color(code) for code in codes])[(ring + pane % 2 * 2 * (ring > 1)) % len(codes)]
    leads = (pane != np.roll(pane, 1, 0)) | (pane != np.roll(pane, 1, 1))
    picture = picture * (0.75 + 0.4 * noise((size, size), 1.0, 51))[..., None]
    return np.clip(np.where(leads[..., None], color("#15120f"), picture), 0.0, 1.0)


def gilding(size: int = 128) -> np.ndarray:
    """The gilt moulding of a frame: u runs across it, from lip to lip, v along, one egg and one dart. Repeats."""
    x, y = texels(size)
    relief = 0.62 + 0.38 * np.sin(np.pi * (x * 5.0 + 0.3)) ** 2
    egg = np.hypot((x - 0.5) / 0.2, (y - 0.5) / 0.34)
    bead = np.hypot((x - 0.84) / 0.05, ((y * 4) % 1 - 0.5) / 0.4)
    relief = np.where(egg < 1, 1.05 - 0.4 * egg**2, relief) * np.where((egg > 1) & (egg < 1.3), 0.6, 1.0)
    relief = np.where(bead < 1, 1.1 - 0.5 * bead**2, relief)
    tone = color("#6b4312") + np.clip(relief - 0.35, 0, 1)[..., None] * 1.35 * (color("#e6b84f") - color("#6b4312"))
    return np.clip(tone * (0.85 + 0.15 * noise((size, size), 0.8, 61)[..., None]), 0.0, 1.0)


def damask(ground: str, figure: str, size: int = 384) -> np.ndarray:
    """Wallpaper: pointed leaves in an ogee net, in staggered rows. Repeats."""
    x, y = texels(size)
    waves = 0.25 + 0.19 * np.cos(2 * np.pi * y)
    net = np.minimum(abs(abs(x - 0.5) - waves), abs(0.5 - abs(x - 0.5) - (0.5 - waves)))
    picture = np.broadcast_to(color(ground), (size, size, 3))
    for shift in (0.0, 0.5):
        u, v = (x + shift) % 1 - 0.5, (y + shift) % 1 - 0.5
        far, angle = np.hypot(u * 1.5, v), np.arctan2(v, u * 1.5)
        leaf = far - 0.2 * (0.55 + 0.3 * np.cos(2 * angle + np.pi) + 0.2 * np.abs(np.cos(4 * angle)))
        picture = paint(picture, 0.9 * cover(leaf, size), figure)
        picture = paint(picture, cover(abs(leaf + 0.035) - 0.005, size), ground)
        picture = paint(picture, cover(far - 0.035, size), ground)
    picture = paint(picture, 0.7 * cover(net - 0.009, size), figure)
    return picture * (0.92 + 0.08 * noise((size, size), 0.3, 62)[..., None])


def delft(size: int = 384) -> np.ndarray:
    """The glaze of a vase: blue bands, arches and flowers on white; u runs round it. Repeats along u."""
    x, y = texels(size)
    picture = np.broadcast_to(color("#f1f0ea"), (size, size, 3))
    blue, deep = "#3f66b0", "#1f3a80"
    for low, high in ((0.05, 0.08), (0.3, 0.315), (0.7, 0.72), (0.9, 0.93)):
        picture = paint(picture, cover(abs(y - (low + high) / 2) - (high - low) / 2, size), deep)
    u = x * 6 % 1 - 0.5
    far, angle = np.hypot(u, (y - 0.5) * 4.5), np.arctan2((y - 0.5) * 4.5, u)
    picture = paint(picture, cover((far - 0.36 * (0.7 + 0.3 * np.cos(7 * angle))) / 8, size), blue)
    picture = paint(picture, cover((far - 0.15) / 8, size), "#f1f0ea")
    picture = paint(picture, cover((far - 0.09) / 8, size), deep)
    scallop = np.hypot((x * 18 % 1 - 0.5) / 18, (y - 0.32) / 2.2) - 0.022
    picture = paint(picture, cover(np.maximum(scallop, 0.315 - y), size), blue)
    scallop = np.hypot((x * 18 % 1 - 0.5) / 18, (y - 0.7) / 2.2) - 0.022
    picture = paint(picture, cover(np.maximum(scallop, y - 0.7), size), blue)
    return picture * (0.94 + 0.06 * noise((size, size), 1.2, 63)[..., None])


def marble(code: str, vein: str, size: int = 384, seed: int = 71) -> np.ndarray:
    """A slab of veined stone. Repeats."""
    veins = sum(
        weight * np.clip(1.0 - abs(2.0 * noise((size, size), 1.8, seed + i) - 1.0) / width, 0.0, 1.0)
        for i, (weight, width) in enumerate(((0.7, 0.035), (0.45, 0.02)))
    )
    picture = color(code) * (0.86 + 0.14 * noise((size, size), 1.4, seed + 5))[..., None]
    return np.clip(paint(picture, np.clip(veins, 0, 1)[..., None], vein), 0.0, 1.0)


def setts(size: tuple[int, int] = (2048, 1024), rows: int = 96, columns: int = 32) -> tuple[np.ndarray, np.ndarray]:
    """Wet paving: the colour (H, W, 3) and the roughness (H, W) of rows of setts with puddles between. Repeats.

    Puddles are nearly mirrors (0.03), wet stones dull ones (0.2 to 0.36), their joints rougher.
    """
    height, width = size
    random = np.random.default_rng(81)
    u, v = np.meshgrid((np.arange(width) + 0.5) / width * columns, (np.arange(height) + 0.5) / height * rows)
    bend = noise(size, 1.6, 82)
    v = v + 1.2 * (bend - 0.5)
    row = np.floor(v).astype(int) % rows
    u = u + random.random(rows)[row]
    stone = row * columns + np.floor(u).astype(int) % columns
    tone, hue = random.uniform(0.55, 1.0, rows * columns)[stone], random.random(rows * columns)[stone]
    far = np.maximum(abs(u % 1 - 0.5) * 2.0, abs(v % 1 - 0.5) * 2.0)
    corner = np.hypot(np.maximum(abs(u % 1 - 0.5) - 0.32, 0.0), np.maximum(abs(v % 1 - 0.5) - 0.32, 0.0)) / 0.15
    joint = np.clip((np.maximum(far - 0.1, corner) - 0.86) / 0.1, 0.0, 1.0)
    grain = noise(size, 0.35, 83)
    puddle = np.clip((noise((height // 2, width // 2), 1.9, 84) - 0.48) / 0.06, 0.0, 1.0)
    puddle = np.repeat(np.repeat(puddle, 2, axis=0), 2, axis=1)
    puddle = puddle * puddle * (3.0 - 2.0 * puddle)
    wet = np.clip(1.25 * noise(size, 1.5, 85) - 0.1, 0.0, 1.0)
    stones = color("#6d6a68") + hue[..., None] * (color("#7b6a5c") - color("#6d6a68"))
    picture = stones * (tone * (0.62 + 0.5 * grain) * (1.0 - 0.25 * wet))[..., None]
    picture = picture + 0.9 * joint[..., None] * (color("#1d1b1a") - picture)
    picture = picture * (1.0 - 0.55 * puddle)[..., None]
    roughness = 0.36 - 0.16 * wet + 0.03 * (hue - 0.5)
    roughness = roughness + 0.12 * joint
    return np.clip(picture, 0.0, 1.0), roughness + puddle * (0.03 - roughness)


def bricks(code: str, mortar: str, rows: int = 16, columns: int = 5, size: int = 384) -> np.ndarray:
    """A brick wall in stretcher bond. Repeats; `rows` must be even."""
    x, y = texels(size)
    row = (y * rows).astype(int)
    along = x * columns + 0.5 * (row % 2)
    brick = row * columns + along.astype(int) % columns
    tone = np.random.default_rng(86).uniform(0.72, 1.05, rows * columns)[brick]
    gap = np.minimum((0.5 - abs(along % 1 - 0.5)) / columns, (0.5 - abs(y * rows % 1 - 0.5)) / rows)
    picture = color(code) * (tone * (0.82 + 0.25 * noise((size, size), 0.5, 87)))[..., None]
    return np.clip(paint(picture, cover(gap - 0.005, size), mortar), 0.0, 1.0)


def plaster(code: str, size: int = 256) -> np.ndarray:
    """A rendered wall, blotched by weather. Repeats."""
    blotches = 0.84 + 0.12 * noise((size, size), 1.2, 88) + 0.05 * noise((size, size), 0.2, 89)
    return np.clip(color(code) * blotches[..., None], 0.0, 1.0)


def slates(code: str, rows: int = 12, columns: int = 8, size: int = 256) -> np.ndarray:
    """A roof: staggered slates, each with its shadow below. Repeats; `rows` must be even."""
    x, y = texels(size)
    row = (y * rows).astype(int)
    along = x * columns + 0.5 * (row % 2)
    tone = np.random.default_rng(90).uniform(0.7, 1.05, rows * columns)[row * columns + along.astype(int) % columns]
    shade = 0.55 + 0.45 * np.clip((y * rows % 1) / 0.25, 0, 1)
    seam = np.clip((0.5 - abs(along % 1 - 0.5)) / 0.06, 0.35, 1.0)
    return np.clip(color(code) * (tone * shade * seam)[..., None], 0.0, 1.0)


def lit_window(wall: str, curtain: str, seed: int, size: int = 160) -> np.ndarray:
    """A room behind a window at night: a wall with its lamplight, curtains at the sides, a plant or a picture."""
    x, y = texels(size)
    light = np.exp(-6.0 * ((x - 0.5) ** 2 + (y - 0.72) ** 2))
    picture = color(wall) * (0.45 + 0.75 * light)[..., None]
    random = np.random.default_rng(seed)
    left, right = random.uniform(0.25, 0.45), random.uniform(0.6, 0.75)
    frame = np.maximum(abs(x - (left + right) / 2) - 0.11, abs(y - 0.55) - 0.13)
    picture = paint(picture, 0.75 * cover(frame, size), "#5a3a26")
    leaves = np.hypot(x - random.uniform(0.35, 0.65), (y - 0.1) * 0.8)
    leaves = leaves - 0.16 * (0.6 + 0.4 * noise((size, size), 0.6, seed))
    picture = paint(picture, 0.85 * cover(leaves, size), "#2c3a20")
    fold = 0.7 + 0.3 * np.sin(x * 75.0 + 2.0 * np.sin(3.0 * y))
    drawn = 0.17 + 0.09 * (1.0 - np.sin(np.pi * np.clip(y, 0, 1))) + 0.02 * np.sin(9.0 * y)
    curtains = np.clip((drawn - np.minimum(x, 1.0 - x)) * size, 0.0, 1.0)[..., None]
    return np.clip(picture + curtains * (color(curtain) * fold[..., None] - picture), 0.0, 1.0)


def dark_window(size: int = 96) -> np.ndarray:
    """A window with no light behind it: the evening sky in the glass, and net curtains."""
    x, y = texels(size)
    picture = color("#1b2233") + (y**2)[..., None] * (color("#5b6c8c") - color("#1b2233"))
    net = 0.25 * (0.5 + 0.5 * np.sin(x * 60.0))
    return np.clip(paint(picture, (net * (y > 0.3))[..., None], "#aeb4bd"), 0.0, 1.0)


def awning(first: str, second: str, size: int = 128) -> np.ndarray:
    """Broad stripes of canvas along v. Repeats."""
    x, _ = texels(size)
    picture = np.where((x < 0.5)[..., None], color(first), color(second))
    return picture * (0.9 + 0.1 * noise((size, size), 0.2, 91)[..., None])


def leaves(size: int = 192) -> np.ndarray:
    """Clipped box, close to. Repeats."""
    field = noise((size, size), 0.45, 92)
    picture = color("#2a4526") + np.clip((field - 0.35) / 0.4, 0, 1)[..., None] * (color("#6f9150") - color("#2a4526"))
    return np.clip(picture, 0.0, 1.0)


def octagon_tiles(count: int = 4, size: int = 512) -> np.ndarray:
    """Pale octagons with small dark squares between, `count` a side. Repeats."""
    x, y = texels(size)
    u, v = abs(x * count % 1 - 0.5), abs(y * count % 1 - 0.5)
    tile = np.floor(x * count).astype(int) + count * np.floor(y * count).astype(int)
    tone = np.random.default_rng(94).uniform(0.9, 1.0, count * count)[tile]
    cloud = noise((size, size), 1.2, 95)
    picture = color("#cdd3ce") * (tone * (0.9 + 0.1 * cloud))[..., None]
    lozenge = (1.0 - u - v - 0.27) / np.sqrt(2.0) / count
    picture = paint(picture, cover(lozenge, size), "#1f3d42")
    edge = np.minimum(0.5 - np.maximum(u, v), 1.0) / count
    joint = np.where(lozenge > 0.0, np.minimum(edge, lozenge), -lozenge)
    return picture + 0.85 * cover(joint - 0.0022, size) * (color("#8f9490") - picture)


def metro_tiles(code: str, grout: str, rows: int = 8, columns: int = 4, size: int = 512) -> np.ndarray:
    """Bevelled wall tiles in staggered rows: light on their upper slopes, dark on the lower. Repeats; `rows` even."""
    x, y = texels(size)
    row = (y * rows).astype(int)
    u, v = (x * columns + 0.5 * (row % 2)) % 1 - 0.5, y * rows % 1 - 0.5
    near = np.minimum((0.5 - abs(u)) / columns, (0.5 - abs(v)) / rows)
    upper = ((0.5 - v) / rows < (0.5 - abs(u)) / columns) & (v > 0)
    lower = ((0.5 + v) / rows < (0.5 - abs(u)) / columns) & (v < 0)
    shade = np.where(near < 0.014, np.select([upper, lower], [1.05, 0.8], 0.9), 0.97)
    tile = row * columns + np.floor(x * columns + 0.5 * (row % 2)).astype(int) % columns
    tone = np.random.default_rng(96).uniform(0.95, 1.0, rows * columns)[tile]
    picture = color(code) * (shade * tone)[..., None]
    return np.clip(paint(picture, cover(near - 0.0028, size), grout), 0.0, 1.0)


def terry(code: str, band: str, size: int = 256) -> np.ndarray:
    """Towelling: loops of yarn, with a woven band near each end of v."""
    x, y = texels(size)
    picture = color(code) * (0.72 + 0.28 * np.random.default_rng(97).random((size, size)))[..., None]
    woven = 0.85 + 0.15 * np.sign(np.sin(x * 2 * np.pi * 40))
    for at, wide in ((0.08, 0.022), (0.14, 0.008), (0.92, 0.022), (0.86, 0.008)):
        where = cover(abs(y - at) - wide, size)
        picture = picture + where * (color(band) * woven[..., None] - picture)
    return np.clip(picture, 0.0, 1.0)


def frosted(size: int = 192) -> np.ndarray:
    """Frosted glass with a garden behind it."""
    _, y = texels(size)
    picture = color("#a9cdbb") + (y**0.7)[..., None] * (color("#f1f7ff") - color("#a9cdbb"))
    green = np.clip((noise((size, size), 1.5, 98) - 0.45) / 0.2, 0.0, 1.0) * np.clip(1.1 - 1.4 * y, 0.0, 1.0)
    return np.clip(picture + 0.6 * green[..., None] * (color("#7fae84") - picture), 0.0, 1.0)


def clock(size: int = 256) -> np.ndarray:
    """A clock's face at a quarter past seven."""
    x, y = texels(size)
    x, y = 2 * x - 1, 2 * y - 1
    far, angle = np.hypot(x, y), np.arctan2(x, y)
    picture = np.broadcast_to(color("#fff0cf"), (size, size, 3))
    picture = paint(picture, cover((abs(far - 0.9) - 0.025) / 2, size), "#2a2118")
    for marks, inner, wide in ((12, 0.66, 0.035), (60, 0.8, 0.012)):
        turn = (angle * marks / (2 * np.pi) + 0.5) % 1 - 0.5
        mark = np.maximum(
            abs(turn) * 2 * np.pi / marks * far - wide, abs(far - (inner + 0.84) / 2) - (0.84 - inner) / 2
        )
        picture = paint(picture, cover(mark / 2, size), "#2a2118")
    for at, length, wide in ((7.25 / 12, 0.45, 0.05), (0.25, 0.72, 0.032)):
        along = far * np.cos(angle - at * 2 * np.pi)
        hand = np.maximum(abs(far * np.sin(angle - at * 2 * np.pi)) - wide, np.maximum(along - length, -0.12 - along))
        picture = paint(picture, cover(hand / 2, size), "#2a2118")
    return picture


def shelves(rows: int = 4, columns: int = 44, size: int = 320) -> np.ndarray:
    """A shop's window in the evening: shelves of bright wares under a lamp."""
    x, y = texels(size)
    random = np.random.default_rng(93)
    ware = (y * rows).astype(int) * columns + (x * columns).astype(int)
    codes = ("#a8352f", "#e0b050", "#2f6b6a", "#efe3c8", "#4a3f7a", "#c9713a", "#5f7f4a", "#7a2f4a")
    paints = np.array([color(code) for code in codes])[random.integers(0, len(codes), rows * columns)][ware]
    tall = random.uniform(0.45, 0.86, rows * columns)[ware]
    up = y * rows % 1
    rounded = 0.7 + 0.3 * np.sin(np.pi * (x * columns % 1))
    back = color("#6b4526") * (0.6 + 0.5 * y[..., None])
    picture = np.where((up < tall)[..., None], paints * rounded[..., None], back)
    picture = paint(picture, (up <= 0.07)[..., None], "#3a2414")
    light = 0.55 + 0.6 * np.exp(-5.0 * ((x - 0.5) ** 2 + (y - 0.85) ** 2))
    return np.clip(picture * light[..., None], 0.0, 1.0)
