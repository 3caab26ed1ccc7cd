"""The Scene on the GPU: laid out as tables, uploaded, rasterised and lit."""

from .canvas import Canvas
from .columns import raise_columns
from .layer_view import layer_view
from .opening import NEED_STENCIL, Clipping, Opening
from .passes import ScreenPass
from .rasteriser import MOST_CUTS
from .reflectors_seen import reflectors_seen
from .resident import FREE_UNIT, Resident
from .tables import first_triangles, world_boxes
from .trees import grow_trees
from .visibility import Part, Visibility, camera_uniforms, world_to_clip

__all__ = [
    "FREE_UNIT",
    "MOST_CUTS",
    "NEED_STENCIL",
    "Canvas",
    "Clipping",
    "Opening",
    "Part",
    "Resident",
    "ScreenPass",
    "Visibility",
    "camera_uniforms",
    "first_triangles",
    "grow_trees",
    "layer_view",
    "raise_columns",
    "reflectors_seen",
    "world_boxes",
    "world_to_clip",
]
