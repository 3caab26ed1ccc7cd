"""The image textures and skies of the demonstration scenes, painted with NumPy.

A texture is (H, W, 3) float in 0..1 as seen on a display (sRGB), row 0 at the bottom. A sky is
(H, W, 3) float32 scene-linear radiance, mapped as Cycles maps an equirectangular image.
"""

from dataclasses import dataclass

import numpy as np


def color(code: str) -> np.ndarray:
    """(3,) display colour of a "#rrggbb" code, 0..1."""
    return np.array([int(code[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0


def linear(code: str) -> tuple[float, float, float]:
    """The scene-linear colour of a "#rrggbb" code."""
    encoded = color(code)
    decoded = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return tuple(float(channel) for channel in decoded)


def noise(shape: tuple[int, int], steepness: float, seed: int, stretch: float = 1.0) -> np.ndarray:
    """Random clouds (H, W) in 0..1 that repeat seamlessly, drawn out along x `stretch` times.

    Amplitude falls as frequency ** -steepness.
    """
    rows, columns = shape
    frequency = np.hypot(np.fft.fftfreq(rows)[:, None] * rows, np.fft.rfftfreq(columns)[None] * columns * stretch)
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    field = np.fft.irfft2(spectrum / np.maximum(frequency, 1.0) ** steepness * (frequency > 0), s=shape)
    return (field - field.min()) / np.ptp(field)


def texels(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Texel centres (size, size) of x and y in 0..1."""
    line = (np.arange(size) + 0.5) / size
    return np.broadcast_to(line, (size, size)), np.broadcast_to(line[:, None], (size, size))


def cover(distance: np.ndarray, size: int) -> np.ndarray:
    """How much of a texel (0..1) lies where `distance` (in picture widths) is negative: a soft edge of one texel."""
    return np.clip(0.5 - distance * size, 0.0, 1.0)[..., None]


def paint(picture: np.ndarray, where: np.ndarray, code: str) -> np.ndarray:
    """`picture` with "#rrggbb" laid over it, as thickly (0..1) as `where` (H, W, 1) says."""
    return picture + where * (color(code) - picture)


def star_tiles(size: int = 512) -> np.ndarray:
    """A cement tile: an eight-pointed star, quarter rosettes in the corners, joints all round. Repeats."""
    x, y = texels(size)
    x, y = x - 0.5, y - 0.5
    square, diamond = np.maximum(abs(x), abs(y)), (abs(x) + abs(y)) / np.sqrt(2)
    corner = np.hypot(0.5 - abs(x), 0.5 - abs(y))
    picture = np.broadcast_to(color("#e9e1cf"), (size, size, 3))
    picture = paint(picture, cover(np.minimum(square, diamond) - 0.285, size), "#24505e")
    picture = paint(picture, cover(np.minimum(square, diamond) - 0.235, size), "#e9e1cf")
    picture = paint(picture, cover(np.minimum(square, diamond) - 0.205, size), "#c8843c")
    picture = paint(picture, cover(np.hypot(x, y) - 0.115, size), "#24505e")
    picture = paint(picture, cover(np.hypot(x, y) - 0.055, size), "#e9e1cf")
    picture = paint(picture, cover(abs(corner - 0.235) - 0.03, size), "#24505e")
    picture = paint(picture, cover(corner - 0.15, size), "#a8452f")
    picture = paint(picture, cover(corner - 0.07, size), "#e9e1cf")
    picture = paint(picture, cover(0.492 - square, size), "#8d8577")
    return picture * (0.92 + 0.08 * noise((size, size), 1.4, 3)[..., None])


def checkers(first: str, second: str, size: int = 512) -> np.ndarray:
    """Two by two worn squares. Repeats."""
    x, y = texels(size)
    picture = np.where(((x < 0.5) ^ (y < 0.5))[..., None], color(first), color(second))
    joint = 0.25 - np.maximum(abs((x * 2) % 1 - 0.5), abs((y * 2) % 1 - 0.5)) * 0.5
    picture = paint(picture, cover(joint - 0.003, size), "#6d665c")
    return picture * (0.86 + 0.14 * noise((size, size), 1.3, 5)[..., None])


def planks(size: int = 512, rows: int = 6) -> np.ndarray:
    """A wooden floor, boards along x. Repeats."""
    x, y = texels(size)
    board = (y * rows).astype(int)
    random = np.random.default_rng(11)
    tone, shift = random.uniform(0.78, 1.0, rows)[board], random.uniform(0, 1, rows)[board]
    grain = noise((size, size), 1.1, 7, stretch=24.0)
    seam = np.minimum(abs((y * rows) % 1 - 0.5) - 0.5, 0) / rows
    butt = -abs((x + shift) % 1 - 0.5)
    picture = color("#a9713f") * (tone * (0.75 + 0.4 * grain))[..., None]
    edge = np.maximum(cover(-seam - 0.002, size), cover(-butt - 0.002, size))
    return np.clip(paint(picture, edge * 0.7, "#3a2412"), 0.0, 1.0)


def stripes(codes: list[str], count: int, slant: int, size: int = 512) -> np.ndarray:
    """`count` turns of the colours along x, moving on by `slant` turns along y. Repeats."""
    x, y = texels(size)
    phase = (x * count + y * slant) * len(codes) % len(codes)
    picture = np.array([color(code) for code in codes])[phase.astype(int)]
    edge = np.minimum(phase % 1, 1 - phase % 1) / (count * len(codes))
    return paint(picture, cover(edge - 0.004, size), "#2b2320")


def beach_ball(codes: list[str], size: int = 512) -> np.ndarray:
    """Meridian gores in `codes`, a white band round the equator with dots, white caps."""
    x, y = texels(size)
    picture = np.array([color(code) for code in codes])[(x * len(codes)).astype(int)]
    picture = paint(picture, cover(abs(y - 0.5) - 0.13, size), "#f4efe2")
    dot = np.hypot((x * 12 % 1 - 0.5) / 12, (y - 0.5) * 0.5)
    picture = paint(picture, cover(dot - 0.026, size), "#22364f")
    picture = paint(picture, cover(abs(abs(y - 0.5) - 0.13) - 0.012, size), "#22364f")
    return paint(picture, cover(0.43 - abs(y - 0.5), size), "#f4efe2")


def rug(size: int = 512) -> np.ndarray:
    """A woven rug: borders round a field of diamonds."""
    x, y = texels(size)
    edge = 0.5 - np.maximum(abs(x - 0.5), abs(y - 0.5))
    cell = abs(x * 6 % 1 - 0.5) + abs(y * 6 % 1 - 0.5)
    picture = np.broadcast_to(color("#7c2427"), (size, size, 3))
    picture = paint(picture, cover((cell - 0.36) / 6, size), "#d9b56b")
    picture = paint(picture, cover((cell - 0.2) / 6, size), "#1f3a4a")
    for width, code in (
        (0.13, "#1f3a4a"),
        (0.11, "#d9b56b"),
        (0.095, "#7c2427"),
        (0.03, "#d9b56b"),
        (0.018, "#1f3a4a"),
    ):
        picture = paint(picture, cover(edge - width, size), code)
    return picture * (0.88 + 0.12 * np.random.default_rng(2).random((size, size, 1)))


def landscape(size: int = 256) -> np.ndarray:
    """A painting for a wall: a low sun over three ranges of hills."""
    x, y = texels(size)
    picture = color("#f2c879") * (1 - y[..., None]) + color("#3f6f95") * y[..., None]
    picture = paint(picture, cover(np.hypot(x - 0.64, y - 0.6) - 0.09, size), "#fff2cf")
    for i, code in enumerate(("#8a6f86", "#5a5470", "#2e3349")):
        ridge = 0.5 - 0.13 * i + 0.07 * np.sin(x * (7 + 3 * i) + 2 * i) + 0.03 * np.sin(x * (19 + 5 * i))
        picture = paint(picture, cover(y - ridge, size), code)
    return picture


@dataclass(frozen=True)
class Sky:
    """An outdoor panorama: where its sun stands (degrees; azimuth from +X towards +Y) and its colours."""

    azimuth: float
    elevation: float
    zenith: str = "#2f62a8"
    horizon: str = "#cfdfe8"
    glow: str = "#ffd9a0"
    cloud: str = "#fffaf2"
    hills: str = "#3f5f83"
    fields: tuple[str, ...] = ("#8d9a55", "#6f8446", "#b7a465", "#a08a58", "#7d8f5c", "#c4b77d")
    cover: float = 0.5
    seed: int = 1

    def picture(self, width: int = 1536) -> np.ndarray:
        """(width / 2, width, 3) float32 radiance, 0 to about 4; the sun's disc is left to a sun lamp."""
        azimuth, up = self._directions(width)
        level = np.sqrt(1.0 - up**2)
        sun = np.radians(self.elevation)
        towards = level * np.cos(azimuth - np.radians(self.azimuth)) * np.cos(sun) + up * np.sin(sun)
        picture = self._air(up, towards)
        picture = self._clouds(picture, azimuth, up, level, towards)
        picture = self._hills(picture, azimuth, up)
        return self._ground(picture, azimuth, up, level).astype(np.float32)

    def _directions(self, width):
        """Azimuth (H, W) in radians and the height (H, W) of the unit direction at every texel."""
        u = (np.arange(width) + 0.5) / width
        v = (np.arange(width // 2) + 0.5) / (width // 2)
        return np.meshgrid((0.5 - u) * 2 * np.pi, np.sin((v - 0.5) * np.pi))

    def _air(self, up, towards):
        height = np.clip(up, 0.0, 1.0)[..., None]
        haze = np.exp(-height * 5.0)
        air = np.array(linear(self.zenith)) * (1 - haze) + np.array(linear(self.horizon)) * haze
        near = np.clip(towards, 0.0, 1.0)[..., None]
        return air + np.array(linear(self.glow)) * (0.35 * near**6 + 0.9 * near**60 + 2.5 * near**900)

    def _clouds(self, picture, azimuth, up, level, towards):
        """Flat clouds on a plane overhead, denser and thinner with noise, fading into the horizon's haze."""
        far = level / np.maximum(up, 0.04)
        field = _sample(noise((512, 512), 1.6, self.seed), 0.06 * far * np.cos(azimuth), 0.06 * far * np.sin(azimuth))
        low = np.quantile(field[up > 0.05], 1.0 - self.cover)
        share = _smooth(field, low - 0.08, low + 0.16) * _smooth(up, 0.03, 0.2)
        lit = np.array(linear(self.cloud)) * (0.9 + 0.6 * np.clip(towards, 0, 1)[..., None] ** 4)
        return picture + (0.9 * share)[..., None] * (lit - picture)

    def _hills(self, picture, azimuth, up):
        """Two ranges of hills along the horizon, their feet in haze."""
        haze = np.array(linear(self.horizon))
        for i, (height, nearness) in enumerate(((0.13, 0.4), (0.07, 0.75))):
            ridge = noise((1, azimuth.shape[1]), 1.4, self.seed + 20 + i)[0] * height + 0.005
            depth = nearness * (0.55 + 0.45 * np.clip(up / ridge, 0.0, 1.0))[..., None]
            tone = haze + depth * (np.array(linear(self.hills)) - haze)
            picture = picture + _smooth(ridge - up, -0.003, 0.003)[..., None] * (tone - picture)
        return picture

    def _ground(self, picture, azimuth, up, level):
        """A patchwork of fields far below, paler towards the horizon."""
        far = level / np.maximum(-up, 0.02)
        x, y = far * np.cos(azimuth), far * np.sin(azimuth)
        wander = noise((512, 512), 1.6, self.seed + 9)
        x, y = (
            x * 2.2 + 2.5 * _sample(wander, x * 0.03, y * 0.03),
            y * 1.3 + 2.5 * _sample(wander.T, y * 0.03, x * 0.03),
        )
        x = x + np.random.default_rng(self.seed).random(1024)[np.floor(y).astype(int) % 1024]  # staggered rows
        crop = np.random.default_rng(self.seed).integers(0, len(self.fields), (256, 256))
        crop = crop[np.floor(y).astype(int) % 256, np.floor(x).astype(int) % 256]
        hedge = np.minimum(0.5 - abs(x % 1 - 0.5), 0.5 - abs(y % 1 - 0.5))
        soil = np.array([linear(code) for code in self.fields])[crop] * (0.8 + 0.4 * _sample(wander, x, y))[..., None]
        soil = soil * (0.55 + 0.45 * _smooth(hedge, 0.01, 0.06 + 0.01 * far))[..., None]
        even = _smooth(far, 6.0, 22.0)[..., None]  # a field there is thinner than a texel
        soil = soil + even * (soil.mean(axis=(0, 1)) - soil)
        hazy = np.exp(-11.0 * np.clip(-up, 0, 1))[..., None]
        soil = soil + 0.6 * hazy * (np.array(linear(self.horizon)) - soil)
        return picture + _smooth(-up, -0.002, 0.002)[..., None] * (soil - picture)


def _smooth(value, low, high):
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def _sample(field: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A repeating (N, N) field, interpolated at coordinates of which 1.0 is a whole turn."""
    size = field.shape[0]
    x, y = x * size, y * size
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    along, up = x - column, y - row
    column, row, right, above = column % size, row % size, (column + 1) % size, (row + 1) % size
    below = field[row, column] * (1 - along) + field[row, right] * along
    return below * (1 - up) + (field[above, column] * (1 - along) + field[above, right] * along) * up
