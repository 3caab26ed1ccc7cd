"""The pyramid of depth ranges against its definition: the nearest and the farthest of a neighbourhood."""

import numpy as np
import pytest
from catoptric.addon.drawing import Canvas
from catoptric.addon.gl import call, require
from catoptric.addon.methods.glossy.depth_ranges import LEVELS, DepthRanges, levels_of
from hypothesis import given, settings
from hypothesis import strategies as st

FAR = np.float32(1e30)


def pyramid(depths: np.ndarray, bounds) -> dict[int, np.ndarray]:
    """Each level, (H, W, 2), drawn from (H, W) depths."""

    def drawn():
        while require().error != "GL_NO_ERROR":
            pass  # what was left behind before is not asked for here
        height, width = depths.shape
        canvas, ranges = Canvas(width, height), DepthRanges()
        texture = require().texture((width, height), 1, np.ascontiguousarray(depths), dtype="f4")
        try:
            textures = ranges.of(canvas, bounds, texture)
            halves = [np.frombuffer(half.read(), np.float32).reshape(half.height, half.width, 2) for half in textures]
            assert require().error == "GL_NO_ERROR"
        finally:
            for part in (canvas, ranges, texture):
                part.release()
        corners = {level: (width >> level, height >> level) for level in range(1, levels_of((width, height)) + 1)}
        return {level: halves[level % 2][:high, wide : 2 * wide] for level, (wide, high) in corners.items()}

    return call(drawn)


def some_depths(rng, width: int, height: int) -> np.ndarray:
    """Metres, and the world here and there."""
    depths = rng.uniform(0.1, 50.0, (height, width)).astype(np.float32)
    depths[rng.random(depths.shape) < 0.05] = FAR
    return depths


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 150), st.integers(2, 150))
def test_a_texel_holds_all_that_is_near(seed, width, height):
    """Whatever is within 2**n - 1 texels of a place is in the range of the texel that has the place."""
    rng = np.random.default_rng(seed)
    depths = some_depths(rng, width, height)
    for level, ranges in pyramid(depths, (0, 0, width, height)).items():
        around = 2**level - 1
        for x, y in rng.integers(0, (width, height), (10, 2)):
            row, column = min(y >> level, ranges.shape[0] - 1), min(x >> level, ranges.shape[1] - 1)
            near = depths[max(0, y - around) : y + around + 1, max(0, x - around) : x + around + 1]
            low, high = ranges[row, column]
            assert low <= near.min()
            assert high >= near.max()


@pytest.mark.parametrize("level", [1, 2, 4])
def test_a_texel_holds_no_more_than_it_says(level):
    """Of one near texel among far ones, none knows that is farther away than three times its size."""
    depths = np.full((64, 96), 9.0, np.float32)
    depths[30, 41] = 1.0
    ranges = pyramid(depths, (0, 0, 96, 64))[level]
    rows, columns = np.nonzero(ranges[..., 0] == 1.0)
    first, last = (np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]]) << level) - (41, 30)
    assert (first > -3 * 2**level).all()
    assert (last < 3 * 2**level + 1).all()
    assert (ranges[..., 1] == 9.0).all()


def test_beside_the_bounds_anything_may_be():
    depths = some_depths(np.random.default_rng(1), 64, 64)
    ranges = pyramid(depths, (0, 0, 16, 16))
    np.testing.assert_array_equal(ranges[1][20, 20], (0.0, FAR))
    assert ranges[1][2, 2, 0] > 0.0


@pytest.mark.parametrize(("size", "levels"), [((1, 40), 0), ((2, 2), 1), ((640, 480), 8), ((8192, 8192), LEVELS)])
def test_levels(size, levels):
    assert levels_of(size) == levels
