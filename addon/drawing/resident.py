"""A Scene that lies on the GPU."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ..gl import DataTexture, set_uniforms
from ..scene import Lighting, Material, Scene
from .columns import column_tables
from .lamps import world_light
from .rasteriser import Rasteriser
from .tables import geometry_tables, material_defines, record_table
from .trees import tree_table

_LIGHTING = {Lighting.UNLIT: 0, Lighting.CYCLES: 1, Lighting.DIRECT: 2}

_UNITS = {
    name: unit
    for unit, name in enumerate(
        (
            "positions",
            "corners",
            "vertex_colors",
            "images",
            "byte_texels",
            "float_texels",
            "layer_nodes",
            "layer_spans",
            "layer_entries",
            "records",
        )
    )
}
_UNITS["tree_nodes"] = _UNITS["layer_nodes"]  # no program searches both

_ASKED_FOR = {"layer_nodes": column_tables, "tree_nodes": tree_table}
"""By the sampler that tells whether a program reads them; the tables of one come together."""

FREE_UNIT = 10
"""The first texture unit that a method may use for itself."""


class Resident:
    """Tables and vertex buffers of a scene under one light; made, used and released on the GL thread."""

    def __init__(self, scene: Scene, lighting: Lighting) -> None:
        """Upload everything; raises `MachineError` where the GPU cannot hold it."""
        self.lighting = lighting
        self._textures: dict[str, DataTexture] = {}
        self.rasteriser = Rasteriser()
        self._groups: dict[int, int] = {}
        self._upload(geometry_tables(scene))
        self._take(scene)

    def update(self, scene: Scene) -> bool:
        """Upload what differs from the scene before; whether anything but the camera did.

        What is the same object in memory is taken to be unchanged.
        """
        before = self.scene
        if not _same(_geometry(scene), _geometry(before)):
            self._upload(geometry_tables(scene))
            for name in _ASKED_FOR:
                self._drop(name)
        elif _same(_placement(scene), _placement(before)):
            self.scene = scene
            return False
        self._take(scene)
        return True

    def group(self, groups: Sequence[Sequence[int]]) -> None:
        """Say which reflectors' images are drawn together: instances, by group; at first all are of group 0."""
        numbers = {index: number for number, group in enumerate(groups) for index in group if number}
        if numbers != self._groups:
            self._groups = numbers
            self._upload_records(self.scene)

    def _upload_records(self, scene: Scene) -> None:
        records, self._numbers = record_table(scene, self._groups)
        self._upload({"records": records})

    def _take(self, scene: Scene) -> None:
        """Upload what there is little of."""
        self._upload_records(scene)
        self.scene = scene
        self._material_defines = material_defines(scene)
        self._world_light = world_light(scene.world)
        self.rasteriser.take(scene)

    def _upload(self, tables: dict[str, np.ndarray]) -> None:
        for name, table in tables.items():
            self._drop(name)
            self._textures[name] = DataTexture(table)

    def _drop(self, name: str) -> None:
        if name in self._textures:
            self._textures.pop(name).release()

    @property
    def defines(self) -> dict[str, int]:
        """What a program that lights surfaces is compiled with: the light, and what the materials use."""
        return {"LIGHTING": _LIGHTING[self.lighting], **self._material_defines}

    @property
    def rough(self) -> bool:
        """Whether any material mirrors other than perfectly in this light."""
        return self.lighting is not Lighting.UNLIT and any(map(_is_rough, self.scene.materials))

    def bind(self, shader: moderngl.Program) -> None:
        """Bind every table that `shader` reads, and set the uniforms that belong to the scene.

        What rays are searched for in is built and uploaded when a shader first asks for it.
        """
        for name, tables in _ASKED_FOR.items():
            if name in shader and name not in self._textures:
                self._upload(tables(self.scene))
        for name, texture in self._textures.items():
            if name in shader:
                texture.use(_UNITS[name])
                shader[name] = _UNITS[name]
        uniforms = {
            "world_color": self.scene.world.color,
            **self._numbers,
            "world_light_sh": [tuple(row) for row in self._world_light],
        }
        set_uniforms(shader, uniforms)

    def release(self) -> None:
        """Give the GPU memory back."""
        for texture in self._textures.values():
            texture.release()
        self.rasteriser.release()


def _is_rough(material: Material) -> bool:
    roughness = material.roughness
    return material.mirrors and (roughness.image is not None or any(channel > 0.0 for channel in roughness.color))


def _geometry(scene: Scene) -> tuple:
    """What `geometry_tables` are made of."""
    return (*scene.meshes, None, *scene.images, None, scene.world.panorama)


def _placement(scene: Scene) -> tuple:
    """What `record_table` is made of besides, and the uniforms."""
    return (*scene.instances, None, *scene.materials, None, *scene.lamps, None, scene.world)


def _same(some: tuple, others: tuple) -> bool:
    return len(some) == len(others) and all(one is other for one, other in zip(some, others, strict=True))
