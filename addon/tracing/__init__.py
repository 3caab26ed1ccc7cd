"""Where rays meet the scene: acceleration structures built from plain triangles, with NumPy alone."""

from .convexity import is_convex
from .flat_parts import FlatParts, flat_parts
from .hierarchy import OCTANTS
from .hierarchy import build as build_hierarchy
from .layers import Layers
from .layers import build as build_layers

__all__ = ["OCTANTS", "FlatParts", "Layers", "build_hierarchy", "build_layers", "flat_parts", "is_convex"]
