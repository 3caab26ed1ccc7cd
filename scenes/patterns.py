"""The image textures of the kitchen, painted as those in `pictures`: tiles, cloth, glazes, and the skins of fruit."""

import numpy as np

from .pictures import color, cover, noise, paint, texels


def azulejo(size: int = 512) -> np.ndarray:
    """Two by two glazed tiles, a painted one and a plain one by turns, in pale blue and yellow on cream. Repeats."""
    x, y = texels(size)
    painted = (x < 0.5) ^ (y < 0.5)
    number = (x >= 0.5).astype(int) + 2 * (y >= 0.5)
    x, y = x * 2 % 1 - 0.5, y * 2 % 1 - 0.5
    far, angle = np.hypot(x, y), np.arctan2(y, x)
    pale, blue, ochre, cream = "#b9cfe6", "#7fa3cf", "#e8c987", "#f3ecdb"
    picture = np.broadcast_to(color(cream), (size, size, 3))
    flower = far - 0.26 * (0.62 + 0.38 * np.abs(np.cos(2.0 * angle)))
    picture = paint(picture, cover(flower / 2, size), blue)
    picture = paint(picture, cover((flower + 0.035) / 2, size), pale)
    picture = paint(picture, cover((far - 0.1) / 2, size), blue)
    picture = paint(picture, cover((far - 0.07) / 2, size), ochre)
    picture = paint(picture, cover((abs(far - 0.36) - 0.011) / 2, size), blue)
    corner, turned = np.hypot(0.5 - abs(x), 0.5 - abs(y)), np.arctan2(0.5 - abs(y), 0.5 - abs(x))
    leaf = corner - 0.26 * (0.55 + 0.45 * np.abs(np.cos(2.0 * turned + np.pi / 2)))
    picture = paint(picture, cover(leaf / 2, size), blue)
    picture = paint(picture, cover((leaf + 0.03) / 2, size), pale)
    picture = paint(picture, cover((corner - 0.09) / 2, size), ochre)
    tone = np.array([0.985, 1.0, 0.96, 0.99])[number] * (0.95 + 0.05 * noise((size, size), 1.4, 111))
    picture = np.where(painted[..., None], picture, color(cream)) * tone[..., None]
    return paint(picture, cover((0.488 - np.maximum(abs(x), abs(y))) / 2, size), "#cfc6b3")


def gingham(code: str, count: int = 12, size: int = 256) -> np.ndarray:
    """Checked cotton of `count` checks a side. Repeats."""
    x, y = texels(size)
    over = (((x * count) % 1 < 0.5).astype(float) + ((y * count) % 1 < 0.5)) / 2.0
    picture = color("#f6f1e6") + over[..., None] * (color(code) - color("#f6f1e6"))
    return picture * (0.9 + 0.1 * np.random.default_rng(112).random((size, size)))[..., None]


def apple_skin(ground: str, blush: str, seed: int, size: int = 192) -> np.ndarray:
    """An apple: streaks from stalk to calyx, redder on one side, with pale specks; u runs round it."""
    x, y = texels(size)
    streaks = noise((size, size), 0.9, seed, stretch=0.12)
    cloud = noise((size, size), 1.7, seed + 1)
    red = np.clip(1.5 * streaks + 1.4 * cloud + 0.35 * np.cos(2 * np.pi * x) - 1.0, 0.0, 1.0)
    red = red * np.clip(6.0 * (1.0 - y), 0.15, 1.0)
    picture = color(ground) + red[..., None] * (color(blush) - color(ground))
    specks = np.random.default_rng(seed).random((size, size)) > 0.993
    return np.clip(picture + 0.14 * specks[..., None] + 0.08 * (cloud[..., None] - 0.5), 0.0, 1.0)


def orange_peel(code: str, size: int = 192) -> np.ndarray:
    """The peel of an orange or lemon: pores, and blotches where it ripened."""
    pores = noise((size, size), 0.15, 121)
    tone = 0.86 + 0.16 * noise((size, size), 1.6, 122) - 0.22 * np.clip((pores - 0.62) / 0.2, 0.0, 1.0)
    return np.clip(color(code) * tone[..., None], 0.0, 1.0)


def citrus_face(flesh: str, peel: str, size: int = 192) -> np.ndarray:
    """A citrus fruit cut through: ten segments in white pith and peel; round in the square."""
    x, y = texels(size)
    x, y = 2 * x - 1, 2 * y - 1
    far, angle = np.hypot(x, y), np.arctan2(y, x)
    picture = np.broadcast_to(color(peel), (size, size, 3))
    picture = paint(picture, cover((far - 0.95) / 2, size), "#fbf0d4")
    turn = (angle * 10 / (2 * np.pi)) % 1 - 0.5
    wedge = np.maximum(far - 0.84, abs(turn) * 2 * np.pi / 10 * far - (np.pi / 10 * far - 0.022))
    wedge = np.maximum(wedge, 0.1 - far)
    picture = paint(picture, cover(wedge / 2, size), flesh)
    fibre = 0.85 + 0.3 * noise((size, size), 0.7, 123)
    return np.clip(picture * np.where(wedge < 0.0, fibre, 1.0)[..., None], 0.0, 1.0)


def banana_skin(size: int = 192) -> np.ndarray:
    """A ripe banana: green-tipped, brown at both ends, with freckles; v runs along it."""
    _, y = texels(size)
    picture = np.broadcast_to(color("#f0c93a"), (size, size, 3))
    picture = picture + (np.clip((y - 0.8) / 0.12, 0, 1) * 0.5)[..., None] * (color("#b5b845") - picture)
    freckles = np.clip((noise((size, size), 0.7, 124) - 0.62) / 0.1, 0.0, 0.75)
    picture = paint(picture, freckles[..., None], "#8a5a22")
    ends = np.clip(np.maximum((0.06 - y) / 0.03, (y - 0.95) / 0.03), 0.0, 1.0)
    return np.clip(paint(picture, ends[..., None], "#4a3520"), 0.0, 1.0)


def crust(size: int = 256) -> np.ndarray:
    """The crust of a country loaf: baked brown, split pale along the top and dusted with flour; v is along."""
    x, y = texels(size)
    baked = noise((size, size), 1.2, 125)
    picture = color("#8a4f22") + baked[..., None] * (color("#d59a55") - color("#8a4f22"))
    slash = np.abs(((y * 5 + 0.35 * np.sin(2 * np.pi * x)) % 1) - 0.5) - 0.09
    cut = np.clip(0.5 - slash * 18.0, 0.0, 1.0) * np.clip(1.6 - 7.0 * abs(x - 0.25), 0.0, 1.0)
    picture = paint(picture, cut[..., None], "#ecc98d")
    flour = np.clip((noise((size, size), 0.4, 126) - 0.5) / 0.2, 0.0, 0.4)
    return np.clip(paint(picture, flour[..., None], "#fbf3e2"), 0.0, 1.0)


def crumb(size: int = 128) -> np.ndarray:
    """A slice of bread: crumb with holes, a crust round it; round in the square."""
    x, y = texels(size)
    edge = np.hypot(2 * x - 1, 2 * y - 1)
    picture = color("#f2deb4") * (0.88 + 0.12 * noise((size, size), 0.8, 127))[..., None]
    holes = np.clip((noise((size, size), 0.9, 128) - 0.62) / 0.05, 0.0, 0.8)
    picture = paint(picture, holes[..., None], "#cda468")
    return np.clip(paint(picture, np.clip((edge - 0.9) / 0.06, 0, 1)[..., None], "#a4672e"), 0.0, 1.0)


def slip(ground: str, band: str, dots: str, size: int = 192) -> np.ndarray:
    """The glaze of earthenware: bands and a row of dots on a ground; u runs round it, v up. Repeats along u."""
    x, y = texels(size)
    picture = np.broadcast_to(color(ground), (size, size, 3))
    for low, high in ((0.2, 0.24), (0.27, 0.28), (0.52, 0.53), (0.56, 0.6)):
        picture = paint(picture, cover(abs(y - (low + high) / 2) - (high - low) / 2, size), band)
    dot = np.hypot((x * 14 % 1 - 0.5) / 14, (y - 0.4) / 3.0)
    picture = paint(picture, cover(dot - 0.02, size), dots)
    picture = paint(picture, cover(dot - 0.008, size), ground)
    return picture * (0.93 + 0.07 * noise((size, size), 1.3, 129)[..., None])
