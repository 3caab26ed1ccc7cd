"""The Scene on the GPU: laid out as tables, uploaded, rasterised and lit."""

from .passes import ScreenPass
from .resident import FREE_UNIT, Resident
from .tables import tables_of, world_box
from .visibility import Part, Visibility, world_to_clip

__all__ = [
    "FREE_UNIT",
    "Part",
    "Resident",
    "ScreenPass",
    "Visibility",
    "tables_of",
    "world_box",
    "world_to_clip",
]
