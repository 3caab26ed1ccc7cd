"""What the methods share that warp a key frame's reflections into the view, as colours."""

from abc import abstractmethod
from dataclasses import replace
from weakref import WeakKeyDictionary

import moderngl

from ...drawing import FREE_UNIT, Part, ScreenPass, Visibility, camera_uniforms, world_to_clip
from ...gl import finish, program, render, require, sample_counter, set_uniforms, settle
from ...parameters import Parameter
from ...progress import Progress
from ..deferred import Clock
from ..tracers import TRACER
from .buffers import ReflectionBuffers, Sample
from .packed_buffers import UNITS, PackedBuffers
from .reprojecting import MEMORY, SCHEDULE, THRESHOLD, History, ReprojectingMethod

_FULL, _PACKED = "full", "packed"
_MISSING = (0.0, 0.0, 0.0, -1.0)
_WARPED_UNIT, _DEPTHS_UNIT = FREE_UNIT + 1, FREE_UNIT + 2
_IMAGE_UNIT = FREE_UNIT + 1
KNOWN_UNIT = FREE_UNIT + 2
MESH_UNIT = KNOWN_UNIT + UNITS
"""The first texture unit that neither the key frame nor the image to warp takes."""

PRECISION = Parameter(
    "precision",
    "Precision",
    _PACKED,
    "The reflection buffers' numbers: two textures of 16-bit floats, or of 32-bit ones",
    choices=(_PACKED, _FULL),
    section="Xie et al., 3.1",
)
CUT = Parameter(
    "cut",
    "Depth discontinuity",
    0.05,
    "Share of its depth by which a pixel must lie behind the next one to be another surface's",
    minimum=0.0,
    maximum=10.0,
    section="Xie et al., 3.2.2",
)
EPSILON = Parameter(
    "epsilon",
    "Epsilon",
    0.01,
    "Share of its depth by which what is warped may lie off the surface that the picture shows there",
    minimum=0.0,
    maximum=10.0,
    section="Xie et al., 3.2",
)
WARPING = (TRACER, THRESHOLD, replace(SCHEDULE, default=0), MEMORY, PRECISION, CUT, EPSILON)
"""The parameters of every method that warps; as published, no schedule begins a key frame."""


class WarpingMethod(ReprojectingMethod):
    """A method that keeps the colours of a key frame's reflections, and warps them into the view by depth.

    A subclass's `image` says what arrives at the key frame's surfaces now. Where what is warped does not lie on the
    surface that the picture shows, it is missing.
    """

    def bake(self, progress: Progress) -> None:
        """Get the passes ready."""
        super().bake(progress)
        self._pack = ScreenPass("reprojection_published/pack.frag", self.resident, Part.SURFACES)
        self._take = ScreenPass("reprojection_published/taken.frag", self.resident, Part.REFLECTORS)
        if not hasattr(self, "_warps"):
            self._known: WeakKeyDictionary[ReflectionBuffers, PackedBuffers] = WeakKeyDictionary()
            self._warps: WeakKeyDictionary[History, Warp] = WeakKeyDictionary()

    @property
    def dtype(self) -> str:
        """Of the numbers that are kept of reflections."""
        return "f2" if self.settings["precision"] == _PACKED else "f4"

    def keep(self, key: ReflectionBuffers, seen: Visibility) -> None:
        """Keep what the paper does of a key frame."""
        if key not in self._known:
            self._known[key] = PackedBuffers(seen.size, seen.parts, self.dtype)
        self._known[key].fill(self._pack, key, seen)

    @abstractmethod
    def image(self, clock: Clock, key: PackedBuffers, sample: Sample) -> moderngl.Texture:
        """What arrives at each pixel of the key frame for the camera of a sample; alpha is below 0 where unknown."""

    def reuse(self, clock: Clock, picture: ReflectionBuffers, history: History, seen: Visibility) -> int:
        """Warp the reflections of the key frame, and take over those that stay on their surface."""
        sample = picture.sample
        key = self._known[history.key_of(sample)]
        image = self.image(clock, key, sample)
        with clock("reflection warping"):
            if history not in self._warps:
                self._warps[history] = Warp(seen.size)
            self._warps[history].draw(image, key, sample, self.settings["cut"])
            self._warps[history].bind(self._take.shader)
            self._take.shader["epsilon"] = self.settings["epsilon"]
            with (counted := sample_counter()):
                self._take.draw(sample.view.camera, seen, picture.target, offset=sample.offset, blend=False)
        finish()
        return counted.samples

    def release(self) -> None:
        """Give everything back."""
        super().release()
        for kept in (getattr(self, "_known", {}), getattr(self, "_warps", {})):
            for part in kept.values():
                part.release()
            kept.clear()


class GridTarget:
    """Textures for a grid of two triangles a pixel of a key frame, and the depth between. Lives on the GL thread.

    The grid is that of Xie et al., 3.2.2; a geometry shader on gpu_shaders/reprojection_published/cells.glsl draws it.
    """

    def __init__(self, size: tuple[int, int], *textures: moderngl.Texture, **shaders: str) -> None:
        """For pictures of `size`; `shaders` gives the files for `geometry` and `fragment`."""
        context = require()
        self._size, self.textures = size, textures
        self._depth = context.depth_renderbuffer(size)
        self._target = context.framebuffer(textures, self._depth)
        self.shader = program("reprojection_published/cells.vert", **shaders)
        self._cells = context.vertex_array(self.shader, [])

    def draw(self, key: PackedBuffers, cut: float) -> None:
        """Draw the grid over nothing; `cut` is the share of a depth at which it is cut."""
        columns, rows = (side - 1 for side in self._size)
        key.bind(self.shader, KNOWN_UNIT)
        set_uniforms(self.shader, {"cut": cut, "columns": columns})
        self._target.clear(*_MISSING)
        self._target.use()
        context = require()
        context.viewport = (0, 0, *self._size)
        context.enable_only(moderngl.DEPTH_TEST)
        settle()
        render(self._cells, moderngl.POINTS, columns * rows)

    def release(self) -> None:
        """Give the memory back, that of the textures too."""
        for part in (self._cells, self._target, self._depth, *self.textures):
            part.release()


class Warp:
    """Depth-based warps for pictures of one size (Xie et al., 3.2.2)."""

    def __init__(self, size: tuple[int, int]) -> None:
        """Make room."""
        textures = (require().texture(size, components, dtype="f4") for components in (4, 1))
        shaders = {"geometry": "reprojection_published/warp.geom", "fragment": "reprojection_published/warp.frag"}
        self._grid = GridTarget(size, *textures, **shaders)

    def draw(self, image: moderngl.Texture, key: PackedBuffers, sample: Sample, cut: float) -> None:
        """Draw what is attached to a key frame's surfaces as a sample's camera sees it."""
        shader, camera = self._grid.shader, sample.view.camera
        clip = world_to_clip(camera, *image.size, sample.offset)
        image.use(_IMAGE_UNIT)
        placing = camera_uniforms(camera, *image.size, sample.offset)
        set_uniforms(shader, {**placing, "image": _IMAGE_UNIT, "world_to_clip": tuple(clip.T.ravel())})
        self._grid.draw(key, cut)

    def bind(self, shader: moderngl.Program) -> None:
        """Have gpu_shaders/reprojection_published/taken.frag read what was drawn."""
        for name, unit, texture in zip(
            ("warped", "warped_depths"), (_WARPED_UNIT, _DEPTHS_UNIT), self._grid.textures, strict=True
        ):
            texture.use(unit)
            shader[name] = unit

    def release(self) -> None:
        """Give the memory back."""
        self._grid.release()
