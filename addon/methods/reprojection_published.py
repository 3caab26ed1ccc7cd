"""Reflection reprojection by temporal coherence, as it was published."""

from weakref import WeakKeyDictionary

import moderngl

from ..gl import program, require, screen, set_uniforms
from ..parameters import Parameter
from ..progress import Progress
from ..scene import Camera
from .deferred import Clock
from .reuse.buffers import Sample
from .reuse.packed_buffers import PackedBuffers
from .reuse.warping import KNOWN_UNIT, MESH_UNIT, WARPING, GridTarget, WarpingMethod

_PREVIOUS_UNIT = _OFFSETS_UNIT = MESH_UNIT


class ReprojectionPublished(WarpingMethod):
    """Reflections shift on their mirrors as the camera moves, and are warped with the mirrors into the view.

    A key frame is traced, and keeps normal, depth and specular factor of what it shows, and for its mirrors what
    arrives there and from how far. For the camera of now each of its pixels is searched for the one that reflects the
    same point: the distance function is how far the ray from the point, mirrored in a pixel's tangent plane, through
    the pixel's surface passes by the camera, and the search goes from neighbour to neighbour while it falls. The
    reflections are drawn where their pixels have moved to, as a grid of two triangles a pixel, and the mirrors, with
    these on them, as the camera now sees them. What is not covered then, or not where the mirror is, is traced.

    Source: Xie, Wang and Dutré, *Reflection reprojection using temporal coherence*, 2017: reflection buffers (3.1),
    matching by Algorithm 2 (3.2.1), shifting and warping (3.2.2), composition (3.3), reuse (4.3). Algorithm 2
    back-projects by the view's depth (its line 3 says the mirrored ray's), and a search ends on a plateau, too. The
    grid is cut where the mirrors' depth jumps, not where that of what they show does: that is what fills the gaps of
    figure 9. For the weights of 3.3 the picture's own surfaces are asked.

    Outputs: as every method; `Frame.reuse` says what was traced.

    Limitations: those that the paper names: a search can end in a local optimum, where the distance function does not
    fall all the way; reflections are sampled once, by the key frame's pixels, so that they blur and edges are off by
    up to a pixel; what emerges behind something in the mirror is not noticed, but painted over by what was seen beside
    it (figure 9), up to the magnification allowed; the first reflection alone is followed, of what is mirrored twice
    the second stays as the key frame saw it; static scenes: an object that moves begins a key frame. Where mirrors
    are thin or finely curved, pixels or triangles of facets, little is found and most is traced. Mirror-like
    materials only (roughness counts as 0).
    """

    name = "reprojection-published"
    source = "Xie et al., 3: colours of a key frame, shifted to the best matched pixels and warped"
    parameters = (
        *WARPING,
        Parameter(
            "magnification",
            "Magnification",
            16.0,
            "Times by which a shifted triangle's area may grow; what grows more is traced",
            minimum=1.0,
            maximum=1e6,
            section="Xie et al., 4.1",
        ),
        Parameter(
            "steps",
            "Most steps",
            4096,
            "Steps after which a search gives up, and its pixel is traced; no search should get there",
            minimum=1,
            maximum=100_000,
            section="Xie et al., 3.2.1",
        ),
    )

    def bake(self, progress: Progress) -> None:
        """Get the passes ready."""
        super().bake(progress)
        if not hasattr(self, "_matchings"):
            self._matchings: WeakKeyDictionary[PackedBuffers, Matching] = WeakKeyDictionary()

    def image(self, clock: Clock, key: PackedBuffers, sample: Sample) -> moderngl.Texture:
        """What the key frame saw, at the pixels where that has moved to."""
        if key not in self._matchings:
            self._matchings[key] = Matching(key.light.size, self.dtype)
        matching = self._matchings[key]
        with clock("pixel searching"):
            matching.search(key, sample, cut=self.settings["cut"], most_steps=self.settings["steps"])
        with clock("reflection shifting"):
            return matching.shift(key, self.settings["cut"], self.settings["magnification"])

    def release(self) -> None:
        """Give everything back."""
        super().release()
        matchings = getattr(self, "_matchings", {})
        for matching in matchings.values():
            matching.release()
        matchings.clear()


class Matching:
    """Where the reflections of a key frame have moved to. Lives on the GL thread."""

    def __init__(self, size: tuple[int, int], dtype: str) -> None:
        """Make room for key frames of `size`; `dtype` as of the buffers."""
        context = require()
        self._search = program(None, "reprojection_published/search.frag")
        offsets = [context.texture(size, 2, dtype="i2") for _ in range(2)]
        for texture in offsets:
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._now, self._before = ((texture, context.framebuffer([texture])) for texture in offsets)
        shaders = {"geometry": "reprojection_published/shift.geom", "fragment": "reprojection_published/shift.frag"}
        self._grid = GridTarget(size, context.texture(size, 4, dtype=dtype), **shaders)
        self._key: Sample | None = None

    @property
    def offsets(self) -> moderngl.Texture:
        """What was found last: columns and rows from each pixel to the best matched one, or INVALID."""
        return self._now[0]

    def search(self, key: PackedBuffers, sample: Sample, cut: float, most_steps: int) -> None:
        """Find the best matched pixels for the camera of a sample, from those of the last call on."""
        self._now, self._before = self._before, self._now
        self._before[0].use(_PREVIOUS_UNIT)
        key.bind(self._search, KNOWN_UNIT)
        uniforms = {
            "previous": _PREVIOUS_UNIT,
            "is_first": self._key is not key.sample,
            "eye": _eye_of(sample.view.camera),
            "cut": cut,
            "most_steps": most_steps,
        }
        set_uniforms(self._search, uniforms)
        context = require()
        self._now[1].use()
        context.viewport = (0, 0, *key.light.size)
        context.enable_only(moderngl.NOTHING)
        screen(self._search).render(vertices=3)
        self._key = key.sample

    def shift(self, key: PackedBuffers, cut: float, magnification: float) -> moderngl.Texture:
        """The intermediate reflection image: what arrives at the key frame's surfaces now."""
        self.offsets.use(_OFFSETS_UNIT)
        set_uniforms(self._grid.shader, {"offsets": _OFFSETS_UNIT, "magnification": magnification})
        self._grid.draw(key, cut)
        return self._grid.textures[0]

    def release(self) -> None:
        """Give the memory back."""
        for texture, target in (self._now, self._before):
            target.release()
            texture.release()
        self._grid.release()


def _eye_of(camera: Camera) -> tuple[float, float, float, float]:
    """Where a camera is, and 1; the direction to it and 0 where its rays are parallel."""
    is_point = camera.ortho_scale is None
    return (*camera.matrix[:3, 3 if is_point else 2], float(is_point))
