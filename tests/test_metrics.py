"""Metrics against closed forms, against the libraries' own answers, and against what must hold for any picture."""

import math

import flip_evaluator
import numpy as np
import pytest
from catoptric.addon.metrics import (
    MAGMA,
    Exposures,
    Figures,
    PictureError,
    error_maps,
    exposures_of,
    hdr_flip_map,
    magma,
    measure,
    noise_maps,
    to_bytes,
    to_display,
)
from hypothesis import given, settings
from hypothesis import strategies as st

LINEAR_OF_188 = ((188 / 255 + 0.055) / 1.055) ** 2.4


def constant(value, height=16, width=24):
    return np.full((height, width, 3), value, np.float32)


def random_picture(seed, height=16, width=24, scale=2.0):
    return (np.random.default_rng(seed).random((height, width, 3)) ** 2 * scale).astype(np.float32)


pictures = st.builds(
    random_picture,
    seed=st.integers(0, 2**32 - 1),
    height=st.integers(1, 20),
    width=st.integers(1, 20),
    scale=st.sampled_from([0.0, 0.01, 1.0, 30.0, 65504.0]),
)


def test_display_transform_is_srgb_clamped():
    linear = np.array([-1.0, 0.0, 0.002, LINEAR_OF_188, 1.0, 7.0])
    assert to_display(linear) == pytest.approx([0.0, 0.0, 0.02584, 188 / 255, 1.0, 1.0], abs=1e-6)
    assert to_bytes(linear).tolist() == [0, 0, 7, 188, 255, 255]


def test_figures_of_a_constant_offset_have_closed_forms():
    figures = measure(constant(LINEAR_OF_188), constant(0.0))
    assert figures.pixels == 16 * 24
    assert figures.psnr == pytest.approx(-20 * math.log10(188 / 255), abs=1e-4)
    assert figures.mae_8bit == 188
    assert figures.rel_mse == pytest.approx(LINEAR_OF_188**2 / 0.01, rel=1e-5)
    # SSIM of two constants is its luminance term alone.
    c1 = 0.01**2
    assert figures.ssim == pytest.approx(c1 / ((188 / 255) ** 2 + c1), rel=1e-3)


def test_black_against_white_is_nearly_the_largest_flip():
    assert 0.9 < measure(constant(1.0), constant(0.0)).flip <= 1.0


def test_flip_agrees_with_the_evaluators_own_mean():
    test, reference = random_picture(1, 40, 50), random_picture(2, 40, 50)
    _, low, _ = flip_evaluator.evaluate(to_display(reference), to_display(test), "LDR")
    _, high, used = flip_evaluator.evaluate(reference, test, "HDR")
    figures = measure(test, reference)
    assert figures.flip == pytest.approx(low, abs=1e-5)
    assert figures.flip_hdr == pytest.approx(high, abs=1e-4)
    ours = exposures_of(reference)
    assert (ours.start, ours.stop) == pytest.approx((used["startExposure"], used["stopExposure"]), abs=0.01)
    assert ours.count == used["numExposures"]


def test_relative_error_is_relative_to_the_reference():
    """FLIP is symmetric and would not notice test and reference swapped."""
    assert measure(constant(2.0), constant(1.0)).rel_mse == pytest.approx(1.0 / 1.01, rel=1e-5)
    assert measure(constant(1.0), constant(2.0)).rel_mse == pytest.approx(1.0 / 4.01, rel=1e-5)


def test_equal_pictures_have_no_error():
    picture = random_picture(3)
    assert measure(picture, picture) == Figures(16 * 24, 0.0, 0.0, None, pytest.approx(1.0), 0.0, 0.0)


def test_hdr_flip_sees_what_the_display_clips():
    test, reference = constant(8.0), constant(2.0)
    figures = measure(test, reference)
    assert figures.flip == 0.0
    assert figures.flip_hdr > 0.1


def test_shared_exposures_are_used():
    test, reference = random_picture(4), random_picture(5)
    dark = Exposures(-12.0, -11.0, 2)
    assert measure(test, reference, exposures=dark).flip_hdr < 0.5 * measure(test, reference).flip_hdr


@pytest.mark.parametrize("lit", [0.0, 0.1])
def test_black_pictures_do_not_end_the_process(lit):
    reference = constant(0.0)
    reference[:5, :5] = lit * 10
    assert measure(constant(0.5), reference).flip_hdr > 0.1


def test_a_sun_does_not_ask_for_dozens_of_exposures():
    reference = constant(0.001)
    reference[0, 0] = 60000.0
    assert exposures_of(reference).count == 10


@given(pictures, st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_figures_stay_in_range_and_vanish_for_equal_pictures(reference, seed):
    test = random_picture(seed, *reference.shape[:2])
    figures = measure(test, reference)
    assert 0.0 <= figures.flip <= 1.0
    assert 0.0 <= figures.flip_hdr <= 1.0
    assert -1.0 <= figures.ssim <= 1.0 + 1e-6
    assert 0.0 <= figures.mae_8bit <= 255.0
    assert figures.rel_mse >= 0.0
    assert figures.psnr is None or figures.psnr >= 0.0
    same = measure(reference, reference)
    assert (same.flip, same.flip_hdr, same.mae_8bit, same.rel_mse, same.psnr) == (0.0, 0.0, 0.0, 0.0, None)


@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.95))
@settings(max_examples=25, deadline=None)
def test_figures_over_a_mask_are_means_over_its_pixels(seed, share):
    maps = error_maps(random_picture(seed), random_picture(seed + 1))
    mask = np.random.default_rng(seed).random((16, 24)) < share
    mask[0, 0], mask[-1, -1] = True, False
    inside, outside, whole = maps.over(mask), maps.over(~mask), maps.over()
    assert inside.pixels == mask.sum()
    assert inside.flip == pytest.approx(maps.flip[mask].mean(), rel=1e-5)
    assert inside.rel_mse == pytest.approx(maps.rel_mse[mask].mean(), rel=1e-5)
    for name in ("flip", "flip_hdr", "ssim", "mae_8bit", "rel_mse"):
        parts = inside.pixels * getattr(inside, name) + outside.pixels * getattr(outside, name)
        assert parts / whole.pixels == pytest.approx(getattr(whole, name), rel=1e-5)
    # Not the mean of the pixels' PSNR: the PSNR of their mean.
    assert inside.psnr == pytest.approx(-10 * math.log10(maps.mse[mask].mean()), rel=1e-5)


def test_an_empty_mask_gives_no_figures():
    assert measure(constant(1.0), constant(0.5), np.zeros((16, 24))) == Figures(0)


def test_weights_count():
    test, reference = constant(0.0), constant(0.0)
    test[:, :12] = LINEAR_OF_188
    mask = np.ones((16, 24))
    mask[:, :12] = 0.25
    assert measure(test, reference, mask).mae_8bit == pytest.approx(188 * 0.2)


def test_noise_of_halves_is_the_error_of_their_mean():
    rng = np.random.default_rng(6)
    truth = constant(0.5, 64, 64)
    first, second = (truth + rng.normal(0.0, 0.02, truth.shape).astype(np.float32) for _ in range(2))
    expected = measure(0.5 * (first + second), truth, exposures=exposures_of(truth))
    noise = noise_maps(first, second, exposures_of(truth)).over()
    assert noise.rel_mse == pytest.approx(expected.rel_mse, rel=0.05)
    assert noise.flip == pytest.approx(expected.flip, rel=0.05)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("side", [0, 1])
def test_a_pixel_that_is_no_number_is_named(bad, side):
    both = [constant(0.5), constant(0.5)]
    both[side][3, 7, 1] = bad
    with pytest.raises(PictureError, match=r"1 pixels .* x 7, y 3") as caught:
        measure(*both)
    assert ("reference" in str(caught.value)) == (side == 1)


@pytest.mark.parametrize(
    ("test", "reference", "mask", "said"),
    [
        (constant(0.5), constant(0.5, 16, 25), None, "24x16 and 25x16"),
        (constant(0.5)[..., :2], constant(0.5), None, "height x width x 3"),
        (np.zeros((0, 4, 3)), np.zeros((0, 4, 3)), None, "height x width x 3"),
        (constant(0.5), constant(0.5), np.ones((24, 16)), "mask"),
    ],
)
def test_wrong_shapes_are_named(test, reference, mask, said):
    with pytest.raises(PictureError, match=said):
        measure(test, reference, mask)


def test_inputs_are_left_as_they_were():
    test, reference = random_picture(8) - 0.5, random_picture(9) - 0.5
    kept = test.copy(), reference.copy()
    measure(test, reference)
    hdr_flip_map(test, reference, exposures_of(reference))
    assert np.array_equal(test, kept[0])
    assert np.array_equal(reference, kept[1])


def test_magma_is_the_evaluators_map_and_can_be_read_back():
    reference = constant(0.5, 64, 64)
    test = reference * np.linspace(0.0, 4.0, 64, dtype=np.float32)[:, None, None]
    values = flip_evaluator.evaluate(reference, test, "LDR", applyMagma=False)[0][..., 0]
    colors = flip_evaluator.evaluate(reference, test, "LDR", applyMagma=True)[0]
    assert np.abs(magma(values) / 255.0 - colors).max() < 5 / 255
    assert len(np.unique(MAGMA, axis=0)) == 256


@given(
    st.tuples(st.integers(1, 90), st.integers(1, 90)),
    st.tuples(st.floats(0, 1), st.floats(0, 1)),
    st.integers(1, 9),
    st.integers(0, 2**32 - 1),
)
@settings(max_examples=25, deadline=None)
def test_errors_are_those_of_the_whole_picture_wherever_it_differs(size, place, side, seed):
    """They are looked for around the differences alone."""
    reference = random_picture(seed, *size)
    test = reference.copy()
    row, column = (int(share * (length - 1)) for share, length in zip(place, size, strict=True))
    test[row : row + side, column : column + side] *= 0.7
    errors = error_maps(test, reference, hdr=False)
    shown = to_display(reference), to_display(test)
    expected = flip_evaluator.evaluate(*shown, "LDR", applyMagma=False, computeMeanError=False)[0][..., 0]
    np.testing.assert_allclose(errors.flip, expected, atol=1e-6)
    ys, xs = np.mgrid[: size[0], : size[1]]
    away = np.maximum(np.maximum(row - ys, ys - row - side + 1), np.maximum(column - xs, xs - column - side + 1))
    assert (errors.ssim[away > 5] == 1.0).all()
    assert errors.mae_8bit.shape == errors.ssim.shape == size
