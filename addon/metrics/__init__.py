"""How far a picture is from the truth: FLIP, PSNR, SSIM, absolute and relative differences."""

from .display import MAGMA, magma, to_bytes, to_display
from .enough import Enough
from .flip import Exposures, exposures_of, flip_map, hdr_flip_map
from .measure import ErrorMaps, Figures, PictureError, error_maps, measure, noise_maps

__all__ = [
    "MAGMA",
    "Enough",
    "ErrorMaps",
    "Exposures",
    "Figures",
    "PictureError",
    "error_maps",
    "exposures_of",
    "flip_map",
    "hdr_flip_map",
    "magma",
    "measure",
    "noise_maps",
    "to_bytes",
    "to_display",
]
