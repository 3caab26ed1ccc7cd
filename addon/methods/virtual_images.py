"""Where the triangles of a scene are seen in its reflectors."""

from collections.abc import Sequence
from typing import NamedTuple

import moderngl
import numpy as np

from ..baking.reflector_maps_tables import UNITS, ResidentMaps
from ..drawing import FREE_UNIT, Resident, world_to_clip
from ..gl import capture, feedback, program, require, screen
from .contract import View
from .virtual_bundles import Bundle
from .virtual_scene import VirtualScene, runs_of

_ROW = 4096
"""Results a row, as gpu_shaders/common/data.glsl has it."""

_EMIT = {"vertex_shader": "virtual/emit.vert", "geometry_shader": "virtual/emit.geom"}
_BYTES = 16
_FIRST_CAPACITY = 1 << 18
_MAPS_UNIT = FREE_UNIT + 1
_RESULTS_UNIT = _MAPS_UNIT + UNITS
_SOURCES_UNIT = _RESULTS_UNIT + 3


_BEHIND_ALL = 0.99999
"""Before the far end, -1 to 1."""


class _Search(NamedTuple):
    """A path, and the run of chunks that it may show: its points' results begin at `result`."""

    bundle: Bundle
    first: int
    end: int
    result: int


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
        self._searched: list[Bundle] = []
        self._target = self._corners = self._rectangles = None
        self._results: list[moderngl.Texture] = []
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
        """Search the images in a view of `size` pixels that may be seen by these paths."""
        searches = self._plan(bundles)
        self._set_up(view, size)
        self._search_points(searches)
        while (made := self._emit_rectangles(self._searched, searches)) > self._capacity:
            self._reserve(2 * made)

    def _plan(self, bundles: Sequence[Bundle]) -> list[_Search]:
        """What to search, all culled that no ray of a path can meet, and paths that are not worth it."""
        searches, result = [], 0
        self._searched = []
        for bundle in bundles:
            runs = runs_of(bundle.reaches(self._scene.centres, self._scene.radii))
            points = [int(self._scene.points[end] - self._scene.points[first]) for first, end in runs]
            if sum(points) > self._worth * bundle.count:
                continue
            self._searched.append(bundle)
            for (first, end), count in zip(runs, points, strict=True):
                searches.append(_Search(bundle, first, end, result))
                result += count
        height = -(-max(1, result) // _ROW)
        if self._target is None or self._target.height < height:
            if self._target:
                self._target.release()
                for texture in self._results:
                    texture.release()
            self._results = [require().texture((_ROW, height), 4, dtype="f4") for _ in range(3)]
            self._target = require().framebuffer(self._results)
        return searches

    def _set_up(self, view: View, size: tuple[int, int]) -> None:
        camera = view.camera
        ortho = camera.ortho_scale is not None
        uniforms = {
            "eye": (*camera.matrix[:3, 2], 0.0) if ortho else (*camera.position, 1.0),
            "steps": self._steps,
            "screen": size,
            "world_to_clip": tuple(world_to_clip(camera, *size).T.ravel()),
            "margin": 1.0,
            "results_height": self._target.height,
            "results": _RESULTS_UNIT,
            "results_shown": _RESULTS_UNIT + 1,
            "results_again": _RESULTS_UNIT + 2,
        }
        for shader in (self._search, self._emit):
            self._maps.bind(shader, _MAPS_UNIT)
            for name, value in uniforms.items():
                if name in shader:
                    shader[name] = value

    def _search_points(self, searches: Sequence[_Search]) -> None:
        context = require()
        self._target.use()
        context.enable_only(moderngl.NOTHING)
        chosen = None
        for bundle, first, end, result in searches:
            if bundle is not chosen:
                self._choose(self._search, bundle)
                chosen = bundle
            begin, count = self._scene.points[first], self._scene.points[end] - self._scene.points[first]
            self._search["result_shift"] = int(result - begin)
            self._points.render(moderngl.POINTS, vertices=int(count), first=int(begin))

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

    def _emit_rectangles(self, bundles: Sequence[Bundle], searches: Sequence[_Search]) -> int:
        """Write what was found as rectangles; how many corners they would have, given room."""
        for unit, texture in enumerate(self._results):
            texture.use(_RESULTS_UNIT + unit)
        self._scene.bind(self._emit, _SOURCES_UNIT)
        while len(self._counters) < len(bundles):
            self._counters.append(require().query(primitives=True))
        by_bundle: dict[int, list[_Search]] = {}
        for search in searches:
            by_bundle.setdefault(id(search.bundle), []).append(search)
        with capture(self._emit, self._corners):
            for bundle, counter in zip(bundles, self._counters, strict=False):
                with counter:
                    self._emit_path(bundle, by_bundle.get(id(bundle), ()))
        counts = [3 * counter.primitives for counter in self._counters[: len(bundles)]]
        first = np.concatenate([[0], np.cumsum(counts)]).astype(int)
        self._drawn = [(bundle, int(at), count) for bundle, at, count in zip(bundles, first, counts, strict=False)]
        return int(first[-1])

    def _emit_path(self, bundle: Bundle, searches: Sequence[_Search]) -> None:
        self._choose(self._emit, bundle)
        self._emit["bounds"] = bundle.bounds
        self._emit["left_out"] = self._maps.left_out(bundle.path[-1])
        for _, first, end, result in searches:
            begin, count = self._scene.triangles[first], self._scene.triangles[end] - self._scene.triangles[first]
            self._emit["result_shift"] = int(result - self._scene.points[first])
            self._emit["first_triangle"] = int(begin)
            self._triangles.render(moderngl.TRIANGLES, vertices=3 * int(count), first=3 * int(begin))

    def draw(self, target: moderngl.Framebuffer, offset: tuple[float, float], rays_unit: int) -> None:
        """Draw (instance + 1, triangle) of what the mirrored rays, on two units, meet first into `target`.

        The first is all ones where that is the world, and 0 where a path was not searched. `offset` of the sample
        within the pixel.
        """
        shader = self._draw
        self._resident.bind(shader)
        shader["ray_origins"], shader["ray_directions"] = rays_unit, rays_unit + 1
        shader["shift"] = -2.0 * offset[0] / target.width, -2.0 * offset[1] / target.height
        target.use()
        require().enable_only(moderngl.DEPTH_TEST)
        self._world["ray_origins"], self._world["ray_directions"] = rays_unit, rays_unit + 1
        self._world["depth"] = _BEHIND_ALL
        for bundle, first, count in self._drawn:
            left, bottom, right, top = bundle.bounds
            target.scissor = left, bottom, right - left, top - bottom
            shader["path"] = self._world["path"] = (*bundle.path[::-1], 0)[:2]
            screen(self._world).render(vertices=3)
            self._rectangles.render(moderngl.TRIANGLES, vertices=count, first=first)
        target.scissor = None

    @property
    def in_patches(self) -> bool:
        """Whether any path was searched that is not reflected at whole bodies alone, whose images never come apart."""
        maps = self._maps.maps
        return any(not maps[part - 1].is_whole for bundle in self._searched for part in bundle.path)

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, *self._results, self._rectangles, self._corners, self._points, self._triangles):
            if part:
                part.release()
