"""The columns of a scene's meshes as common tables: what gpu_shaders/common/layers.glsl reads."""

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from ..progress import Progress, silent
from ..scene import Mesh, Scene
from ..tracing import Layers, build_layers
from .tables import first_triangles

_LAYERS: "WeakKeyDictionary[Mesh, Layers]" = WeakKeyDictionary()
_WIDTHS = {"layer_nodes": 3, "layer_spans": 2, "layer_entries": 1}


def raise_columns(meshes: Sequence[Mesh], progress: Progress = silent) -> list[Layers]:
    """The columns of each mesh; made once, and kept as long as the mesh lives."""
    missing = [mesh for mesh in meshes if mesh not in _LAYERS]
    for number, mesh in enumerate(missing):
        progress("raising columns", number / len(missing))
        _LAYERS[mesh] = build_layers(mesh.corners)
    return [_LAYERS[mesh] for mesh in meshes]


def column_tables(scene: Scene) -> dict[str, np.ndarray]:
    """By sampler name. `layer_nodes` begins with two texels a mesh: its columns along u and v, and levels; and where
    its coarsest node is."""
    layers = raise_columns(scene.meshes)
    head = np.zeros((max(1, len(layers)), 2, 3), np.uint32)
    offsets = {"layer_nodes": 2 * len(head), "layer_spans": 1, "layer_entries": 1}
    parts = {name: [np.zeros((1, width), np.uint32)] for name, width in _WIDTHS.items()}
    parts["layer_nodes"] = [head.reshape(-1, 3)]
    for row, mesh, first in zip(head, layers, first_triangles(scene), strict=False):
        placed = {
            "layer_nodes": mesh.nodes + np.array([0, 0, offsets["layer_spans"]], np.uint32),
            "layer_spans": mesh.spans + np.array([offsets["layer_entries"], 0], np.uint32),
            "layer_entries": mesh.entries[:, None] + np.uint32(first),
        }
        for name, part in placed.items():
            parts[name].append(part)
            offsets[name] += len(part)
        row[0] = *mesh.shape, mesh.levels
        row[1, 0] = offsets["layer_nodes"] - 1  # the coarsest is the last
    return {name: np.concatenate(part) for name, part in parts.items()}
