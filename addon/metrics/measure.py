"""How far a picture is from its reference, in figures."""

from dataclasses import dataclass
from math import log10

import numpy as np

from ..errors import CatoptricError
from .display import stepped, to_display
from .flip import Exposures, exposures_of, flip_map, hdr_flip_map

_SSIM_WINDOW = 11
_REACH = 10
"""Pixels that the widest filter reaches to each side: FLIP's, for an observer who sees 67 pixels a degree."""

_OF_EQUALS = {"ssim": 1.0}
_DARK = 0.01


class PictureError(CatoptricError):
    """A picture cannot be measured, read or written: wrong shape, not a number, a damaged file."""


@dataclass(frozen=True)
class Figures:
    """A picture's error over some pixels.

    `flip` and `flip_hdr` 0..1 (0 is equal); `psnr` in dB of the displayed picture; `ssim` up to 1
    (1 is equal); `mae_8bit` mean absolute difference in steps of a screen's 255; `rel_mse` mean
    squared difference of radiance over the reference's square. None where there is no number: all
    of them over no pixels, the PSNR of equal pictures, which is infinite, and the SSIM where
    scikit-image is not installed, as inside Blender.
    """

    pixels: int
    flip: float | None = None
    flip_hdr: float | None = None
    psnr: float | None = None
    ssim: float | None = None
    mae_8bit: float | None = None
    rel_mse: float | None = None


@dataclass(frozen=True, eq=False)
class ErrorMaps:
    """Every metric pixel by pixel, (H, W) each, so that any set of pixels can be averaged without new work.

    `flip`, `flip_hdr`, `ssim`, `mae_8bit` and `rel_mse` as in `Figures`; `mse` is of the displayed picture.
    """

    flip: np.ndarray
    flip_hdr: np.ndarray | None
    ssim: np.ndarray | None
    mae_8bit: np.ndarray
    mse: np.ndarray
    rel_mse: np.ndarray

    def over(self, mask: np.ndarray | None = None) -> Figures:
        """The figures over a mask (H, W) of weights 0..1, or over the whole picture.

        The reflectors' figures use `reflectors >= 0.5`. Raises `PictureError` if the mask's shape is wrong.
        """
        weights = np.ones(self.flip.shape) if mask is None else np.asarray(mask, np.float64)
        if weights.shape != self.flip.shape:
            raise PictureError(f"the mask is {weights.shape} and the picture {self.flip.shape}: give one of its size")
        pixels = int(np.count_nonzero(weights))
        if pixels == 0:
            return Figures(0)

        def mean(errors: np.ndarray) -> float:
            return float(np.average(errors, weights=weights))

        mse = mean(self.mse)
        return Figures(
            pixels=pixels,
            flip=mean(self.flip),
            flip_hdr=mean(self.flip_hdr) if self.flip_hdr is not None else None,
            psnr=-10.0 * log10(mse) if mse > 0.0 else None,
            ssim=mean(self.ssim) if self.ssim is not None else None,
            mae_8bit=mean(self.mae_8bit),
            rel_mse=mean(self.rel_mse),
        )


def error_maps(
    test: np.ndarray, reference: np.ndarray, exposures: Exposures | None = None, hdr: bool = True
) -> ErrorMaps:
    """Compare two pictures (H, W, 3) of scene-linear radiance.

    `exposures` are HDR-FLIP's, `exposures_of(reference)` unless given; methods of one scene share
    them. Without `hdr` it is left out, which takes longer than all the others. Display metrics see the
    pictures clamped to 0..1 and sRGB-encoded. Raises `PictureError` for shapes that differ and for
    pixels that are no finite number.
    """
    test, reference = _checked(test, "the method's picture"), _checked(reference, "the reference")
    if test.shape != reference.shape:
        sizes = " and ".join(f"{picture.shape[1]}x{picture.shape[0]}" for picture in (test, reference))
        raise PictureError(f"the method's picture and the reference differ in size ({sizes}): render both alike")
    if hdr and exposures is None:
        exposures = exposures_of(reference)
    rows, columns = near = _near_differences(test, reference)
    around = [(rows.start, test.shape[0] - rows.stop), (columns.start, test.shape[1] - columns.stop)]
    errors = _error_maps(test[near], reference[near], exposures if hdr else None)
    return ErrorMaps(
        **{
            name: values if values is None else np.pad(values, around, constant_values=_OF_EQUALS.get(name, 0.0))
            for name, values in vars(errors).items()
        }
    )


def _near_differences(test: np.ndarray, reference: np.ndarray) -> tuple[slice, slice]:
    """Rows and columns outside of which no metric finds an error, nor looks at one: at least one pixel.

    The filters of FLIP and SSIM are slow, and frames of a film often differ in their mirrors alone.
    """
    differ = (test != reference).any(axis=-1)
    return tuple(_span(differ.any(axis=axis)) for axis in (1, 0))


def _span(differ: np.ndarray) -> slice:
    found = np.flatnonzero(differ)
    # Errors reach as far as a filter does from a difference; they are themselves made from as far around.
    first, last = (found[0], found[-1]) if len(found) else (0, 0)
    return slice(max(0, int(first) - 2 * _REACH), min(len(differ), int(last) + 2 * _REACH + 1))


def _error_maps(test: np.ndarray, reference: np.ndarray, exposures: Exposures | None) -> ErrorMaps:
    shown, expected = to_display(test), to_display(reference)
    steps = np.abs(np.subtract(stepped(shown), stepped(expected), dtype=np.float32))
    # The constant keeps dark pixels from ruling the mean, as is usual in rendering. The square of a
    # bright sun needs more than 32 bits.
    relative = (test.astype(np.float64) - reference) ** 2 / (reference.astype(np.float64) ** 2 + _DARK)
    return ErrorMaps(
        flip=flip_map(test, reference),
        flip_hdr=hdr_flip_map(test, reference, exposures) if exposures else None,
        ssim=_ssim_map(shown, expected),
        mae_8bit=steps.mean(axis=-1),
        mse=((shown - expected) ** 2).mean(axis=-1),
        rel_mse=relative.mean(axis=-1),
    )


def measure(
    test: np.ndarray, reference: np.ndarray, mask: np.ndarray | None = None, exposures: Exposures | None = None
) -> Figures:
    """`error_maps(test, reference, exposures).over(mask)`; use those two to average over several masks."""
    return error_maps(test, reference, exposures).over(mask)


def noise_maps(
    first_half: np.ndarray, second_half: np.ndarray, exposures: Exposures | None = None, hdr: bool = True
) -> ErrorMaps:
    """What a perfect method would measure, because the reference itself is noisy.

    The halves (H, W, 3) are two references of half the samples and different seeds; their mean is
    the reference. One half differs from that mean by half the difference of two independent
    pictures of variance 2v, which has the variance v of the mean around the truth. So the error of
    a half against the mean is the mean's own. A difference below it is none.
    """
    first, second = _checked(first_half, "the first half"), _checked(second_half, "the second half")
    return error_maps(first, 0.5 * (first + second), exposures, hdr)


def _checked(picture: np.ndarray, name: str) -> np.ndarray:
    picture = np.asarray(picture, dtype=np.float32)
    if picture.ndim != 3 or picture.shape[-1] != 3 or picture.size == 0:
        raise PictureError(f"{name} has the shape {picture.shape}: it must be height x width x 3")
    bad = ~np.isfinite(picture).all(axis=-1)
    if bad.any():
        y, x = np.argwhere(bad)[0]
        raise PictureError(f"{name} has {bad.sum()} pixels that are no finite number, the first at x {x}, y {y}")
    return picture


def _ssim_map(test: np.ndarray, reference: np.ndarray) -> np.ndarray | None:
    """SSIM (Wang et al. 2004: Gaussian window of 1.5 pixels), mean of the channels; None without scikit-image."""
    try:
        from skimage.metrics import structural_similarity
    except ImportError:
        return None
    height, width = test.shape[:2]
    missing = [(0, max(0, _SSIM_WINDOW - side)) for side in (height, width)]
    # A picture smaller than the window goes on mirrored, as the filter has it beyond the edge.
    grown = (np.pad(picture, [*missing, (0, 0)], mode="symmetric") for picture in (test, reference))
    _, similarity = structural_similarity(
        *grown, channel_axis=-1, data_range=1.0, gaussian_weights=True, use_sample_covariance=False, full=True
    )
    return similarity[:height, :width].mean(axis=-1)
