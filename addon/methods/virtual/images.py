"""Where the triangles of a scene are seen in its reflectors."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ...baking.reflector_maps_tables import ResidentMaps
from ...drawing import Resident, world_to_clip
from ...gl import capture, feedback, finish, program, render, require, screen, set_uniforms, settle
from ..contract import View
from .bundles import Bundle, Run
from .rays import AFTER_RAYS, MAPS_UNIT, MirroredRays, eye_of
from .results import TEXTURES, Results, pieces
from .scene import VirtualScene, runs_of

_EMIT = {"vertex_shader": "virtual/emit.vert", "geometry_shader": "virtual/emit.geom"}
_BYTES = 16
_FIRST_CAPACITY = 1 << 18
_RESULTS_UNIT = AFTER_RAYS
_SOURCES_UNIT = _RESULTS_UNIT + TEXTURES

_BEHIND_ALL = 0.99999
"""Before the far end, -1 to 1."""

_AT_ONCE = 3 << 10
"""Points searched, or triangles looked at, in one call: in software it lasts as long as they take."""


class Images:
    """The images that a scene's triangles have by paths of one length, for one view at a time. On the GL thread.

    An image is kept as a rectangle on the screen that holds it. What is seen in a pixel is then found by the pixel's
    own ray, among the triangles whose rectangles cover it.
    """

    def __init__(self, resident: Resident, maps: ResidentMaps, scene: VirtualScene, order: int, settings: dict) -> None:
        """Compile for paths that are reflected `order` times; `settings` as of the method."""
        self._resident, self._maps, self._scene = resident, maps, scene
        self._steps, self._worth = settings["steps"], settings["worth"]
        defines = {"ORDER": order}
        self._search = program("virtual/search.vert", "virtual/search.frag", defines)
        self._emit = feedback(_EMIT, ("corner", "shown"), defines)
        self._draw = program("virtual/draw.vert", "virtual/draw.frag")
        self._world = program(None, "virtual/world.frag")
        self._points, self._triangles = scene.by_point(self._search), scene.by_triangle(self._emit)
        self._counters: list[moderngl.Query] = []
        self._drawn: list[tuple[Bundle, int, int]] = []
        self._paths: list[tuple[Bundle, list[Run]]] = []
        self._corners = self._rectangles = None
        self._results, self._last, self._view = Results(), Results(), None
        self._reserve(_FIRST_CAPACITY)

    def _reserve(self, corners: int) -> None:
        """Make room for so many corners of rectangles' triangles."""
        if self._corners:
            self._rectangles.release()
            self._corners.release()
        context = require()
        self._corners, self._capacity = context.buffer(reserve=corners * _BYTES), corners
        self._rectangles = context.vertex_array(self._draw, [(self._corners, "2f 2i", "corner", "triangle")])

    def find(self, view: View, size: tuple[int, int], bundles: Sequence[Bundle]) -> None:
        """Search the images in a view of `size` pixels that may be seen by these paths.

        Searches begin from what was found for the view before, where that had nearly the same rays.
        """
        if self._view is not None and not view.shows_the_same(self._view):
            self._results, self._last = self._last, self._results
        self._view = view
        self._paths = self._plan(bundles)
        self._set_up(view, size)
        self._search_points()
        while (made := self._emit_rectangles()) > self._capacity:
            self._reserve(2 * made)

    def _plan(self, bundles: Sequence[Bundle]) -> list[tuple[Bundle, list[Run]]]:
        """What to search, all culled that no ray of a path can meet, and paths that are not worth it."""
        paths, result, held = [], 0, np.diff(self._scene.points)
        for bundle in bundles:
            reached = bundle.reaches(self._scene.centres, self._scene.radii)
            if held @ reached > self._worth * bundle.count:
                continue
            runs = []
            for first, end in runs_of(reached):
                runs.append(Run(bundle, first, end, result))
                result += self._count(runs[-1])
            paths.append((bundle, runs))
        self._results.make_room(result, paths)
        return paths

    def _count(self, run: Run) -> int:
        return int(self._scene.points[run.end] - self._scene.points[run.first])

    def _set_up(self, view: View, size: tuple[int, int]) -> None:
        uniforms = {
            "eye": eye_of(view.camera),
            "steps": self._steps,
            "screen": size,
            "world_to_clip": tuple(world_to_clip(view.camera, *size).T.ravel()),
            "results_height": self._results.height,
            "results": _RESULTS_UNIT,
            "results_shown": _RESULTS_UNIT + 1,
            "results_again": _RESULTS_UNIT + 2,
        }
        for shader in (self._search, self._emit):
            self._maps.bind(shader, MAPS_UNIT)
            set_uniforms(shader, uniforms)

    def _search_points(self) -> None:
        self._results.target.use()
        require().enable_only(moderngl.NOTHING)
        self._bind(self._last)
        for bundle, runs in self._paths:
            self._choose(self._search, bundle)
            before = self._last.runs_like(bundle)
            for run in runs:
                self._search["result_shift"] = run.result - int(self._scene.points[run.first])
                for first, end, last in pieces(run, before):
                    self._search_piece(first, end, last)

    def _search_piece(self, first: int, end: int, last: Run | None) -> None:
        """The points of some chunks in a row, which were searched in the run `last` of the frame before, if in any."""
        points = self._scene.points
        begin = int(points[first])
        self._search["known"] = last is not None
        if last:
            self._search["last_shift"] = last.result - int(points[last.first])
        render(self._points, moderngl.POINTS, int(points[end]) - begin, begin, _AT_ONCE)

    @staticmethod
    def _bind(results: Results) -> None:
        for unit, texture in enumerate(results.textures, _RESULTS_UNIT):
            texture.use(unit)

    def _choose(self, shader: moderngl.Program, bundle: Bundle) -> None:
        """Have a shader search the path of a bundle."""
        self._maps.choose(shader, bundle.path)
        starts = [self._maps.directions_of(part, points) for part, points in zip(bundle.path, bundle.met, strict=True)]
        uniforms = {
            "sample_origins": bundle.samples[:, 0],
            "sample_directions": bundle.samples[:, 1],
            "sample_starts": np.concatenate(starts),
        }
        shader["concave"] = self._maps.is_concave(bundle.path)
        shader["bundle"] = *bundle.centre, bundle.radius
        shader["bundle_axis"] = *bundle.axis, bundle.spread
        for name, value in uniforms.items():
            if name in shader:
                shader[name].write(np.ascontiguousarray(value, np.float32).tobytes())

    def _emit_rectangles(self) -> int:
        """Write what was found as rectangles; how many corners they would have, given room."""
        self._bind(self._results)
        self._scene.bind(self._emit, _SOURCES_UNIT)
        while len(self._counters) < len(self._paths):
            self._counters.append(require().query(primitives=True))
        counters = self._counters[: len(self._paths)]
        settle()
        with capture(self._emit, self._corners):
            for (bundle, runs), counter in zip(self._paths, counters, strict=True):
                with counter:
                    self._emit_path(bundle, runs)
        finish()
        self._drawn, first = [], 0
        for (bundle, _), counter in zip(self._paths, counters, strict=True):
            self._drawn.append((bundle, first, 3 * counter.primitives))
            first += 3 * counter.primitives
        return first

    def _emit_path(self, bundle: Bundle, runs: Sequence[Run]) -> None:
        self._choose(self._emit, bundle)
        self._emit["bounds"] = bundle.bounds
        self._emit["left_out"] = self._maps.left_out(bundle.path[-1])
        for run in runs:
            begin, end = int(self._scene.triangles[run.first]), int(self._scene.triangles[run.end])
            self._emit["result_shift"] = run.result - int(self._scene.points[run.first])
            for first in range(begin, end, _AT_ONCE):
                self._emit["first_triangle"] = first
                self._triangles.render(moderngl.TRIANGLES, vertices=3 * min(_AT_ONCE, end - first), first=3 * first)

    def draw(self, target: moderngl.Framebuffer, offset: tuple[float, float], rays: MirroredRays) -> None:
        """Draw (instance + 1, triangle) of what the mirrored rays meet first into `target`.

        The first is all ones where that is the world, and 0 where a path was not searched. `offset` of the sample
        within the pixel.
        """
        shader = self._draw
        self._resident.bind(shader)
        rays.bind(shader)
        rays.bind(self._world)
        shader["shift"] = -2.0 * offset[0] / target.width, -2.0 * offset[1] / target.height
        target.use()
        require().enable_only(moderngl.DEPTH_TEST)
        self._world["depth"] = _BEHIND_ALL
        for bundle, first, count in self._drawn:
            left, bottom, right, top = bundle.bounds
            target.scissor = left, bottom, right - left, top - bottom
            shader["path"] = self._world["path"] = (*bundle.path[::-1], 0)[:2]
            settle()
            screen(self._world).render(vertices=3)
            render(self._rectangles, moderngl.TRIANGLES, count, first)
        target.scissor = None

    @property
    def in_patches(self) -> bool:
        """Whether any path was searched that is not reflected at whole bodies alone, whose images never come apart."""
        maps = self._maps.maps
        return any(not maps[part - 1].is_whole for bundle, _ in self._paths for part in bundle.path)

    def release(self) -> None:
        """Give the memory back."""
        parts = self._results, self._last, self._rectangles, self._corners, self._points, self._triangles
        for part in parts:
            part.release()
