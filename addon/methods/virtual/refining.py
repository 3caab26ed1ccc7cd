"""The level-of-detail grid of a picture on the GPU."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ...baking.reflector_maps_tables import ResidentMaps
from ...drawing import world_to_clip
from ...gl import DataTexture, feedback, read_back, require
from ..contract import View
from .bundles import Bundle, Run
from .cells import Forest, Refined, refined
from .rays import MAPS_UNIT, eye_of

TABLES = 4
"""Texture units that the tables take."""

_VERTEX = np.dtype([("position", np.float32, 3), ("part", np.int32)])


class Refining:
    """Searches what a view needs of virtual meshes in trees of cells. Lives on the GL thread."""

    def __init__(self, maps: ResidentMaps, forest: Forest, within: float) -> None:
        """Compile; `within` so many pixels the middle of a cell is right."""
        self._maps, self._forest, self._within = maps, forest, within
        stages = {"vertex_shader": "virtual_published/scattered.vert"}
        self._shader = feedback(stages, ("image",), {"ORDER": 1, "MANY_PARTS": 1})
        self._nothing = require().simple_framebuffer((1, 1))  # OpenGL draws, even to nowhere, only where there is one
        self._tables: dict[str, DataTexture] = {}
        self.searches = 0

    def find(self, view: View, runs: Sequence[Run], steps: int, threshold: float, unit: int) -> None:
        """Search for some runs; `unit` is a texture unit to do it with. `searches` says how many points there were."""
        shader = self._shader
        self._maps.bind(shader, MAPS_UNIT)
        self._maps.bind_rows(shader, unit)
        shader["eye"], shader["steps"], shader["threshold"] = eye_of(view.camera), steps, threshold
        bundles = list(dict.fromkeys(run.bundle for run in runs))
        row = {bundle: number for number, bundle in enumerate(bundles)}
        pairs = [(row[run.bundle], mesh) for run in runs for mesh in range(run.first, run.end)]
        clip = world_to_clip(view.camera, view.width, view.height)
        half = np.array([view.width, view.height]) / 2.0
        found = refined(
            self._forest,
            bundles,
            np.array(pairs),
            lambda rows, points: self._search(bundles, rows, points),
            lambda points: _pixels(clip, half, points),
            self._within,
        )
        self.searches = len(found.results) - 1
        self._upload(found)

    def _search(self, bundles: Sequence[Bundle], rows: np.ndarray, points: np.ndarray) -> np.ndarray:
        told = np.empty(len(rows), _VERTEX)
        told["position"], told["part"] = points, np.array([bundle.path[0] for bundle in bundles])[rows]
        context = require()
        vertices, images = context.buffer(told), context.buffer(reserve=16 * len(rows))
        array = context.vertex_array(self._shader, [(vertices, "3f 1i", "position", "part")])
        try:
            self._nothing.use()
            array.transform(images, moderngl.POINTS, vertices=len(rows))
            return np.frombuffer(read_back(images), np.float32).reshape(-1, 4)
        finally:
            for part in (array, vertices, images):
                part.release()

    def _upload(self, found: Refined) -> None:
        self._release_tables()
        results = found.results.copy()
        results[1:, 3] = np.minimum(results[1:, 3], 1.0)
        self._tables = {
            "results": DataTexture(results),
            "vertex_cells": DataTexture(found.of_vertex[:, None]),
            "cells": DataTexture(found.corners.reshape(-1, 4)),
            "cell_boxes": DataTexture(np.pad(found.boxes.reshape(-1, 3), ((0, 0), (0, 1)))),
        }

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Bind what was found to TABLES texture units from `unit` on."""
        for offset, (name, table) in enumerate(self._tables.items()):
            table.use(unit + offset)
            shader[name] = unit + offset

    def _release_tables(self) -> None:
        for table in self._tables.values():
            table.release()

    def release(self) -> None:
        """Give the memory back."""
        self._release_tables()
        self._nothing.release()


def _pixels(clip: np.ndarray, half: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Where points (..., 3) are on the screen, in pixels from its middle; infinite behind the camera."""
    x, y, w = (points @ clip[row, :3].T + clip[row, 3] for row in (0, 1, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((w > 0.0)[..., None], np.stack([x, y], axis=-1) / w[..., None] * half, np.inf)
