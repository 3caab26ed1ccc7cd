"""The Scene on the GPU: laid out as tables, uploaded, rasterised and lit."""

from .resident import FREE_UNIT, Resident
from .tables import tables_of, world_box
from .visibility import Visibility, set_camera, world_to_clip

__all__ = ["FREE_UNIT", "Resident", "Visibility", "set_camera", "tables_of", "world_box", "world_to_clip"]
