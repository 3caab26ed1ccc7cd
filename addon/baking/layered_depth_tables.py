"""Layered depth textures on the GPU: memory follows the layers that there are, not their greatest number."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ..gl import DataTexture
from ..parameters import Parameter
from ..scene import Scene
from .layered_depth import RESOLUTION, LayeredDepth, face_shapes

MEMORY = Parameter(
    "memory",
    "Memory",
    256,
    "What all objects' textures may fill; where there are many, each gets fewer texels",
    unit="MiB",
    minimum=1,
    maximum=65536,
)

UNITS = 4
"""Texture units that the tables take."""


_BYTES_A_TEXEL = 40
"""Two numbers, and one layer of two colours with depth."""


class ResidentLayers:
    """The bakes of a scene's instances as gpu_shaders/layered_depth_published/search.glsl reads them.

    Each texel of a face holds its first layer and how many there are; each layer colour (RGB) and depth
    (alpha, as Zhang et al., 3.3, store them) of its entry, then of its exit. Opposite faces share them.
    Lives on the GL thread.
    """

    def __init__(self, bakes: Sequence[LayeredDepth | None]) -> None:
        """Upload `bakes`, one for each instance, each different one once; None for an instance without."""
        objects = np.zeros((max(1, len(bakes)), 4, 4), np.uint32)
        boxes = np.zeros((max(1, len(bakes)), 2, 4), np.float32)
        texels, layers = [np.zeros((1, 2), np.uint32)], [np.zeros((2, 4), np.float32)]
        placed: dict[int, np.ndarray] = {}
        for instance, bake in enumerate(bakes):
            if bake is None:
                continue
            if id(bake) not in placed:
                placed[id(bake)] = _append(bake, texels, layers)
            objects[instance, 0, 0] = 1
            objects[instance, 1:] = placed[id(bake)]
            boxes[instance, :, :3] = bake.low, bake.size
        self._tables = {
            "peeled_objects": DataTexture(objects.reshape(-1, 4)),
            "peeled_boxes": DataTexture(boxes.reshape(-1, 4)),
            "peeled_texels": DataTexture(np.concatenate(texels)),
            "peeled_layers": DataTexture(np.concatenate(layers)),
        }

    @property
    def size_bytes(self) -> int:
        """Memory on the GPU."""
        return sum(table.size_bytes for table in self._tables.values())

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Bind the tables to UNITS texture units from `unit` on."""
        for offset, (name, table) in enumerate(self._tables.items()):
            table.use(unit + offset)
            shader[name] = unit + offset

    def release(self) -> None:
        """Give the memory back."""
        for table in self._tables.values():
            table.release()


def fitting_resolution(scene: Scene, resolution: int, memory: int, without: frozenset[int] = frozenset()) -> int:
    """The most texels a side, up to `resolution`, with which one layer of every object fits in `memory` MiB.

    Instances `without`, or that reflections do not see, take none; those that share a bake take it once.
    """
    distinct = {
        (instance.mesh, instance.materials, instance.reflector)
        for index, instance in enumerate(scene.instances)
        if instance.in_reflections and index not in without and len(scene.meshes[instance.mesh].triangles)
    }
    shapes = [shape for mesh, _, _ in distinct for shape in face_shapes(scene.meshes[mesh], resolution)[2]]
    needed = _BYTES_A_TEXEL * sum(columns * rows for columns, rows in shapes)
    share = min(1.0, (memory * 2**20 / max(1, needed)) ** 0.5)
    return max(int(RESOLUTION.minimum), int(resolution * share))


def _append(bake: LayeredDepth, texels: list[np.ndarray], layers: list[np.ndarray]) -> np.ndarray:
    """Add a bake's rows; (3, 4) uint32 columns, rows and first texel of each axis."""
    faces = np.zeros((3, 4), np.uint32)
    for row, axis in zip(faces, bake.axes, strict=True):
        first_texel, first_layer = sum(map(len, texels)), sum(map(len, layers)) // 2
        row[:3] = *axis.counts.shape[::-1], first_texel
        texels.append(np.stack([axis.first.ravel() + first_layer, axis.counts.ravel()], axis=1).astype(np.uint32))
        sides = np.concatenate([axis.colors, axis.depths[..., None]], axis=2)
        layers.append(sides.reshape(-1, 4))
    return faces
