"""Virtual meshes as they show in the reflectors of a picture."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import moderngl
import numpy as np

from ...baking.reflector_maps_tables import ResidentMaps
from ...drawing import Resident, Visibility, world_to_clip
from ...gl import clear, program, require
from ...gl.textures import WIDTH as ROW
from ...scene import Camera, Scene
from ..contract import View
from ..situation import placed
from .bundles import Bundle, Run, bundles_of
from .meshes import TABLES, Grid, VirtualMeshes
from .rays import AFTER_RAYS, MAPS_UNIT, MirroredRays, eye_of, read
from .refining import TABLES as REFINED_TABLES
from .refining import Refining
from .scene import runs_of

_MOST_RESULTS = 1 << 22
"""Of one batch: 64 MiB."""

_RESULTS_UNIT = AFTER_RAYS
_MESHES_UNIT = _RESULTS_UNIT + REFINED_TABLES
MET_UNIT = _MESHES_UNIT + TABLES
"""What is seen in the reflectors is on this texture unit."""


class VirtualPicture:
    """What a picture's reflectors show of virtual meshes. Lives on the GL thread.

    `met` holds (instance + 1, triangle, barycentrics) a pixel, 0 where no virtual mesh is; `searches` counts the points
    of the last call of `find`.
    """

    def __init__(
        self, resident: Resident, maps: ResidentMaps, meshes: VirtualMeshes, within: float, seen: Visibility
    ) -> None:
        """Compile, and make targets of the size of what is `seen`, for the reflectors there.

        `within`: pixels that a refined grid's cells may be off in their middles.
        """
        self._maps, self._meshes, self._scene = maps, meshes, resident.scene
        self._rays = MirroredRays("virtual/rays.frag", resident, maps, seen)
        self._search = program("virtual_published/search.vert", "virtual_published/search.frag", {"ORDER": 1})
        self._draw = program(
            "virtual_published/mesh.vert",
            "virtual_published/mesh.frag",
            {"GRID": meshes.grid.value},
            geometry="virtual_published/mesh.geom",
        )
        self._points, self._triangles = meshes.by_point(self._search), meshes.by_triangle(self._draw)
        context = require()
        self.met = context.texture(seen.size, 4, dtype="u4")
        self.met.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._depth = context.depth_renderbuffer(seen.size)
        self._target = context.framebuffer([self.met], self._depth)
        self._results = self._results_target = None
        self.searches = 0
        self._refining = Refining(maps, meshes.forest, within) if meshes.grid is Grid.REFINED else None

    def draw(self, view: View, seen: Visibility, offset: tuple[float, float], steps: int, threshold: float) -> None:
        """Search and draw what the reflectors of one sample show; `offset` of it within the pixel."""
        self._rays.draw(view, seen, offset)
        bundles = bundles_of(read(self._rays.origins), read(self._rays.directions))
        clear(self._target)
        for runs in self._batches(bundles):
            self.find(view, runs, steps, threshold)
            self._show(view, runs, offset)

    def _batches(self, bundles: Sequence[Bundle]) -> Iterator[list[Run]]:
        """What is to be searched and drawn, all culled that no mirrored ray of a part can meet."""
        runs, result = [], 0
        for bundle in bundles:
            for first, end in runs_of(bundle.reaches(self._meshes.centres, self._meshes.radii)):
                count = int(self._meshes.points[end] - self._meshes.points[first])
                if runs and result + count > _MOST_RESULTS:
                    yield runs
                    runs, result = [], 0
                runs.append(Run(bundle, first, end, result))
                result += count
        if runs:
            yield runs

    def find(self, view: View, runs: Sequence[Run], steps: int, threshold: float) -> None:
        """Search the virtual vertices of some runs."""
        if self._refining:
            self._refining.find(view, runs, steps, threshold, _MESHES_UNIT)
            self.searches = self._refining.searches
            return
        last, shader = runs[-1], self._search
        self.searches = last.result + int(self._meshes.points[last.end] - self._meshes.points[last.first])
        self._make_room(-(-self.searches // ROW))
        self._maps.bind(shader, MAPS_UNIT)
        shader["eye"] = eye_of(view.camera)
        shader["steps"], shader["threshold"] = steps, threshold
        shader["results_height"] = self._results.height
        self._results_target.use()
        require().enable_only(moderngl.NOTHING)
        chosen = None
        for bundle, first, end, result in runs:
            if bundle is not chosen:
                (part,) = bundle.path
                self._maps.choose(shader, (part,))
                chosen = bundle
            begin, count = int(self._meshes.points[first]), int(self._meshes.points[end] - self._meshes.points[first])
            shader["result_shift"] = result - begin
            self._points.render(moderngl.POINTS, vertices=count, first=begin)

    def _make_room(self, height: int) -> None:
        if self._results is None or self._results.height < height:
            self._release_results()
            self._results = require().texture((ROW, height), 4, dtype="f4")
            self._results_target = require().framebuffer([self._results])

    def _show(self, view: View, runs: Sequence[Run], offset: tuple[float, float]) -> None:
        """Draw the virtual meshes of some runs, each where its part is seen."""
        shader = self._draw
        clip = world_to_clip(_far_sighted(view, self._scene), view.width, view.height, offset)
        shader["world_to_clip"] = tuple(clip.T.ravel())
        shader["eye"] = eye_of(view.camera)
        self._rays.bind(shader)
        self._meshes.bind(shader, _MESHES_UNIT)
        if self._refining:
            self._refining.bind(shader, _RESULTS_UNIT)
        else:
            self._results.use(_RESULTS_UNIT)
            shader["results"] = _RESULTS_UNIT
        self._target.use()
        require().enable_only(moderngl.DEPTH_TEST)
        for bundle, first, end, result in runs:
            left, bottom, right, top = bundle.bounds
            self._target.scissor = left, bottom, right - left, top - bottom
            shader["part"] = bundle.path[0]
            shader["result_shift"] = result - int(self._meshes.points[first])
            shader["first_triangle"] = begin = int(self._meshes.triangles[first])
            self._triangles.render(vertices=3 * (int(self._meshes.triangles[end]) - begin), first=3 * begin)
        self._target.scissor = None

    def _release_results(self) -> None:
        for part in (self._results, self._results_target):
            if part:
                part.release()

    def release(self) -> None:
        """Give the memory back."""
        self._release_results()
        for part in (self._rays, self._target, self.met, self._depth, self._refining):
            if part:
                part.release()
        for part in (self._points, self._triangles):
            part.release()


def _far_sighted(view: View, scene: Scene) -> Camera:
    """The view's camera, which sees images as far behind a reflector as what they are of is before it."""
    at = placed(scene)
    corners = np.maximum(np.abs(at.low - view.camera.position), np.abs(at.high - view.camera.position))
    farthest = 3.0 * float(np.linalg.norm(corners, axis=1).max())
    return replace(view.camera, far=max(view.camera.far, view.camera.near + farthest))
