"""How far a picture is from its reference, in figures."""

from dataclasses import dataclass
from functools import cached_property
from math import log10

import numpy as np

from ..errors import CatoptricError
from .display import stepped, to_display
from .flip import Exposures, exposures_of, hdr_flip_map, planes_of
from .ldr_flip import Seen, flip, seen
from .ssim import ssim, statistics

_DARK = 0.01


class PictureError(CatoptricError):
    """A picture cannot be measured, read or written: wrong shape, not a number, a damaged file."""


@dataclass(frozen=True)
class Figures:
    """A picture's error over some pixels.

    `flip` and `flip_hdr` 0..1 (0 is equal); `psnr` in dB of the displayed picture; `ssim` up to 1
    (1 is equal); `mae_8bit` mean absolute difference in steps of a screen's 255; `rel_mse` mean
    squared difference of radiance over the reference's square. None where there is no number: all
    of them over no pixels, and the PSNR of equal pictures, which is infinite.
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
    ssim: np.ndarray
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
            ssim=mean(self.ssim),
            mae_8bit=mean(self.mae_8bit),
            rel_mse=mean(self.rel_mse),
        )


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture (H, W, 3) float32 of scene-linear radiance, and what the metrics make of it, each worked out once.

    Hold many pictures against one of these, and the work on the reference is not done again for each.
    """

    linear: np.ndarray

    @cached_property
    def planes(self) -> np.ndarray:
        """(3, H, W): channel by channel."""
        return planes_of(self.linear)

    @cached_property
    def shown(self) -> np.ndarray:
        """(3, H, W) in 0..1: as a screen shows it."""
        return to_display(self.planes)

    @cached_property
    def steps(self) -> np.ndarray:
        """(3, H, W) uint8: in a screen's steps."""
        return stepped(self.shown)

    @cached_property
    def seen(self) -> Seen:
        """What FLIP's observer sees."""
        return seen(np.clip(self.planes, 0.0, 1.0))

    @cached_property
    def statistics(self) -> tuple[np.ndarray, np.ndarray]:
        """What SSIM needs to know."""
        return statistics(self.shown)


def error_maps(
    test: np.ndarray, reference: np.ndarray | Picture, exposures: Exposures | None = None, hdr: bool = True
) -> ErrorMaps:
    """Compare two pictures (H, W, 3) of scene-linear radiance.

    `exposures` are HDR-FLIP's, `exposures_of(reference)` unless given; methods of one scene share
    them. Without `hdr` it is left out, which takes longer than all the others. Display metrics see the
    pictures clamped to 0..1 and sRGB-encoded. Raises `PictureError` for shapes that differ and for
    pixels that are no finite number.
    """
    judge = reference if isinstance(reference, Picture) else Picture(reference)
    test, reference = _checked(test, "the method's picture"), _checked(judge.linear, "the reference")
    if test.shape != reference.shape:
        sizes = " and ".join(f"{picture.shape[1]}x{picture.shape[0]}" for picture in (test, reference))
        raise PictureError(f"the method's picture and the reference differ in size ({sizes}): render both alike")
    picture = Picture(test)
    return ErrorMaps(
        flip=flip(picture.seen, judge.seen),
        flip_hdr=hdr_flip_map(test, reference, exposures or exposures_of(reference)) if hdr else None,
        ssim=ssim(picture.shown, judge.shown, picture.statistics, judge.statistics),
        mae_8bit=_mean(np.abs(np.subtract(picture.steps, judge.steps, dtype=np.float32))),
        mse=_mean((picture.shown - judge.shown) ** 2),
        rel_mse=_relative(picture.planes, judge.planes),
    )


def _relative(test: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """The squared difference over the reference's square. That of a bright sun needs more than 32 bits.

    The constant keeps dark pixels from ruling the mean, as is usual in rendering.
    """
    expected = reference.astype(np.float64)
    return _mean((test - expected) ** 2 / (expected**2 + _DARK))


def _mean(planes: np.ndarray) -> np.ndarray:
    """The mean of three planes: adding them up is much faster than `np.mean` over so short an axis."""
    return (planes[0] + planes[1] + planes[2]) / 3


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
    finite = np.isfinite(picture)
    if not finite.all():
        bad = ~finite.all(axis=-1)
        y, x = np.argwhere(bad)[0]
        raise PictureError(f"{name} has {bad.sum()} pixels that are no finite number, the first at x {x}, y {y}")
    return picture
