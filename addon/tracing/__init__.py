"""Where rays meet the scene: acceleration structures built from plain triangles, with NumPy alone."""

from .boxes import placed_box
from .cell_tree import EDGES, MIDDLES, CellTree, cell_tree
from .convexity import is_convex
from .curvature import Curvature
from .cutting import Near, cut_near
from .flat_parts import FlatParts, flat_parts
from .hierarchy import OCTANTS
from .hierarchy import build as build_hierarchy
from .interpolation_grid import InterpolationGrid, interpolation_grid
from .layers import Layers, depth_axis, padded_box
from .layers import build as build_layers
from .neighbours import across_edges
from .star_parts import StarPart, star_parts
from .trees import Tree
from .trees import build as build_tree

__all__ = [
    "EDGES",
    "MIDDLES",
    "OCTANTS",
    "CellTree",
    "Curvature",
    "FlatParts",
    "InterpolationGrid",
    "Layers",
    "Near",
    "StarPart",
    "Tree",
    "across_edges",
    "build_hierarchy",
    "build_layers",
    "build_tree",
    "cell_tree",
    "cut_near",
    "depth_axis",
    "flat_parts",
    "interpolation_grid",
    "is_convex",
    "padded_box",
    "placed_box",
    "star_parts",
]
