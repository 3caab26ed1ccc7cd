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
