"""Flat mirrors by a second picture of the scene."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial

import moderngl
import numpy as np

from ..drawing import (
    FREE_UNIT,
    NEED_STENCIL,
    Canvas,
    Clipping,
    Opening,
    Part,
    ScreenPass,
    Visibility,
    first_triangles,
)
from ..gl import DataTexture, program, screen
from ..parameters import Parameter, Value, resolve
from ..progress import Progress
from ..scene import Instance, Scene
from .contract import View
from .deferred import Cast, DeferredMethod
from .layered_depth import LayeredDepth
from .mirrors import (
    Bounds,
    Mirror,
    Registration,
    before,
    clipped_by,
    cut_at,
    mirrored,
    mirrors_of,
    parts_of,
    reached,
    seen_within,
    towards,
    why_not_flat,
)
from .traced import reflections_left

_SECTION = "Advanced Graphics Programming Using OpenGL, 17.1.2"
_PARTS_UNIT = FREE_UNIT + 1
_FAR_END = 1.0
PICTURE_UNIT = FREE_UNIT + 2

ANGLE = Parameter(
    "angle",
    "Flat within",
    0.5,
    "How far a flat mirror's triangles and normals may turn",
    unit="degrees",
    minimum=0.0,
    maximum=45.0,
)
GAP = Parameter(
    "gap",
    "Even within",
    0.001,
    "How far a flat mirror's corners may lie from its plane",
    unit="metres",
    minimum=0.0,
    maximum=10.0,
)
CLIPPING = Parameter(
    "clipping",
    "Clipping",
    Clipping.STENCIL.value,
    "How mirrored geometry is kept to the mirror; the picture is the same, the cost is not",
    choices=tuple(way.value for way in Clipping),
    section=_SECTION,
)
SCALE = Parameter(
    "scale",
    "Smaller by",
    1,
    "A projective texture is smaller than the picture by this factor",
    minimum=1,
    maximum=8,
    section=_SECTION,
)
DEPTH = Parameter(
    "depth",
    "Mirrors in mirrors",
    8,
    "How often light may be mirrored; the scene's glossy bounces may end it earlier",
    minimum=1,
    maximum=16,
    section=_SECTION,
)


@dataclass(frozen=True, eq=False)
class Picture:
    """What a mirror shows: `canvas`, drawn for `view`, whose camera is behind the mirror, at `offset` in its pixels."""

    mirror: Mirror
    view: View
    canvas: Canvas
    lies: Registration
    offset: tuple[float, float]


class Planar(DeferredMethod):
    """Flat mirrors: the scene is drawn once more for each, by a camera behind it.

    Every flat part of a reflector is a mirror of its own. What a mirrored camera sees is lit and reflected as any
    view is, so that mirrors in mirrors, and curved ones in flat ones, come by themselves; only what the mirror's
    outline leaves of the screen is drawn, and only the objects that reach into it. Light and highlights fall where
    they do in the scene, since it is the camera that is mirrored, not the geometry.

    Source: *Advanced Graphics Programming Using OpenGL*, 17.1.1 and 17.1.2, with each of its ways to clip. Curved
    reflectors, and what is curved of a flat one, are drawn by layered-depth.

    Limitations: roughness counts as 0; a picture of the scene for every mirror that is seen, in mirrors too;
    `clip-planes` leaves outlines of more than 7 edges to the picture's edge; a smaller projective texture is
    soft, and bleeds a little over its own silhouettes.
    """

    name = "planar"
    source = "Advanced Graphics Programming Using OpenGL, 17.1.2: the scene drawn again by a mirrored camera"
    parameters = (CLIPPING, SCALE, DEPTH, ANGLE, GAP)
    shader = "planar/planar.frag"

    def __init__(self, settings: Mapping[str, Value] | None = None) -> None:
        """As any method's; raises `UsageError` for a setting that is wrong."""
        super().__init__(settings)
        self._canvases: dict[int, Canvas] = {}

    @property
    def clipping(self) -> Clipping:
        """How mirrored geometry is kept to the mirror."""
        return Clipping(self.settings["clipping"])

    @classmethod
    def applies_to(cls, scene: Scene, reflector: Instance, settings: Mapping[str, Value] | None = None) -> str | None:
        """Whether at least half of the reflector is flat."""
        given = resolve(cls.parameters, settings or {})
        return why_not_flat(scene, reflector, given["angle"], given["gap"])

    def cast(self, scene: Scene) -> Cast:
        """The flat reflectors; layered-depth takes those that are curved."""
        instances = scene.instances
        flat = tuple(i for i in scene.reflectors if self.applies_to(scene, instances[i], self.settings) is None)
        curved = tuple(index for index in scene.reflectors if index not in flat)
        return {self: flat, **({LayeredDepth(): curved} if curved else {})}

    def bake(self, progress: Progress) -> None:
        """Find the flat parts."""
        progress("finding flat mirrors", 0.0)
        self._mirrors: list[Mirror] = []
        self._first: dict[int, int] = {}
        self._rests: list[int] = []
        numbers = [np.zeros((1, 1), np.uint32)]
        first_triangle = first_triangles(self.scene)
        for index in self.reflectors:
            parts = parts_of(self.scene, self.scene.instances[index], self.settings["angle"], self.settings["gap"])
            self._mirrors += mirrors_of(self.scene, index, parts)
            self._first[index] = sum(map(len, numbers)) - int(first_triangle[self.scene.instances[index].mesh])
            self._rests += [index] * (parts.share < 1.0)
            numbers.append((parts.part[:, None] + 1).astype(np.uint32))
        self._parts = DataTexture(np.concatenate(numbers))
        self._mark = program(None, "planar/mark.frag")
        self._rest = ScreenPass("planar/rest.frag", self.resident, Part.REFLECTORS, self.defines)

    def reflect(self, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Draw what every mirror in sight shows, and put it there; then what is not flat."""
        whole = target.scissor
        for mirror, bounds in self._in_sight(view, seen.size):
            if seen.shows(partial(self._draw_mark, mirror, seen)):
                picture = self._look_into(mirror, bounds, view, seen, sample["offset"])
                target.scissor = bounds
                self.show(picture, view, seen, target, **sample)
        target.scissor = whole
        for index in self._rests:
            self.bind_mirror(self._rest.shader, index, 0)
            self._rest.shader["reflections"] = reflections_left(self.scene, view)
            self.bind_sample(self._rest.shader, view, sample["offset"])
            self._rest.draw(view.camera, seen, target, **sample)

    def show(self, picture: Picture, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Add to `target` what a mirror shows."""
        self.draw_pass(partial(self.bind_shown, picture), view, seen, target, **sample)

    def _in_sight(self, view: View, size: tuple[int, int]) -> Iterator[tuple[Mirror, Bounds]]:
        """The mirrors that may be seen, facing the camera, and where on the screen."""
        if view.mirrored >= self.settings["depth"]:
            return
        for mirror in self._mirrors:
            plane = towards(mirror.plane, view.camera)
            if plane is None or (view.opening and not before(view.opening.cuts[0], mirror)):
                continue
            bounds = seen_within(view.camera, mirror, size, view.opening.bounds if view.opening else (0, 0, *size))
            if bounds:
                yield replace(mirror, plane=plane), bounds

    def _draw_mark(self, mirror: Mirror, seen: Visibility) -> None:
        seen.texture.use(FREE_UNIT)
        self._mark["visibility"], self._mark["depth"] = FREE_UNIT, _FAR_END
        self.bind_mirror(self._mark, mirror.instance, mirror.part)
        screen(self._mark).render(vertices=3)

    def registration(self, mirror: Mirror, view: View, screen: tuple[int, int]) -> Registration:
        """How large a mirror's picture is in a view, and how it lies on its screen."""
        softened = self.clipping is Clipping.PROJECTIVE_TEXTURE and not view.mirrored
        return Registration(screen, self.settings["scale"] if softened else 1)

    def offset_within(self, lies: Registration, offset: tuple[float, float]) -> tuple[float, float]:
        """Where in its own pixels a mirror's picture is sampled: where the screen's pixels are."""
        return offset[0] / lies.scale, offset[1] / lies.scale

    def _look_into(self, mirror: Mirror, bounds: Bounds, view: View, seen: Visibility, offset) -> "Picture":
        """What the mirror shows, at its place on the screen."""
        lies = self.registration(mirror, view, seen.size)
        canvas = self._canvas_of(view.mirrored, lies.size)
        camera = lies.camera(mirrored(view.camera, mirror, self.scene))
        bounds = lies.bounds(bounds)
        cut = cut_at(mirror, self.scene)
        opening = Opening(
            bounds,
            clipped_by(self.clipping, mirror, camera, cut),
            reached(camera, cut, canvas.size, bounds, self.scene),
            self.clipping,
            partial(self._draw_mark, mirror, seen),
        )
        through = View(camera, *canvas.size, view.samples, view.mirrored + 1, opening)
        offset = self.offset_within(lies, offset)
        self.ensemble.paint_mirrored(through, canvas, offset)
        return Picture(mirror, through, canvas, lies, offset)

    def _canvas_of(self, level: int, size: tuple[int, int]) -> Canvas:
        """Kept from frame to frame, one for each mirror in a mirror."""
        if level in self._canvases and self._canvases[level].size != size:
            self._canvases.pop(level).release()
        if level not in self._canvases:
            self._canvases[level] = Canvas(*size, stencil=self.clipping in NEED_STENCIL)
        return self._canvases[level]

    def bind_mirror(self, shader: moderngl.Program, index: int, part: int) -> None:
        """Tell a shader which mirror is meant: a flat part of an instance, 0 for what is not flat of it."""
        self._parts.use(_PARTS_UNIT)
        shader["mirror_parts"] = _PARTS_UNIT
        shader["mirror"] = index, part, self._first[index]

    def bind_shown(self, picture: "Picture", shader: moderngl.Program) -> None:
        """Tell a shader which mirror is meant, and what it shows."""
        self.bind_mirror(shader, picture.mirror.instance, picture.mirror.part)
        self.bind_picture(shader, picture)

    def bind_picture(self, shader: moderngl.Program, picture: "Picture") -> None:
        """Have the mirror show this; texture units from PICTURE_UNIT on are free."""
        picture.canvas.color.use(PICTURE_UNIT)
        picture.canvas.visibility.texture.use(PICTURE_UNIT + 1)
        shader["mirrored"], shader["mirrored_visibility"] = PICTURE_UNIT, PICTURE_UNIT + 1
        shader["extent"] = picture.lies.extent
        shader["filtered"] = picture.lies.scale > 1

    def free(self) -> None:
        """Give the pictures back."""
        for canvas in self._canvases.values():
            canvas.release()
        self._canvases.clear()
        self._parts.release()
