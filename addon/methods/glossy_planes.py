"""Glossy floors as published: a small mirrored picture, dimmed by planes and blurred by one kernel."""

import math
from dataclasses import dataclass
from functools import lru_cache

import moderngl
import numpy as np

from ..drawing import Canvas, Clipping, Visibility
from ..parameters import Parameter
from ..progress import Progress
from ..scene import Camera, Fresnel, Lighting, mean_roughness
from .contract import View
from .glossy.attenuation_planes import AttenuationPlanes, parallel_planes, tilted_planes
from .glossy.darkroom import KERNEL_SPREAD, MOST_PLANES, Darkroom, Slab
from .glossy.gloss import lobe_angle_of_roughness
from .mirrors import Mirror, Registration
from .planar import ANGLE, DEPTH, GAP, PICTURE_UNIT, Picture, Planar
from .situation import placed

_PAPER = "Glossy planar reflections, section"
_SLABS = 8
_MOST_SCALE = 16
_SPARE = (3, 3)
"""Texels around the picture, for the kernel and the filter of the look-up."""

_NARROWEST, _WIDEST = 0.05, 44.0
"""Degrees: a lobe that counts as one, and the widest whose cone stays above the floor."""

_LEAST_IOR = 1.001
_ORDINARY_LENS = 50.0 / 36.0
"""How far from a thing an ordinary lens is, in widths of its picture."""

ATTENUATION = Parameter(
    "attenuation",
    "Planes are",
    "tilted",
    "Tilted planes fade with height and angle, parallel ones with height alone, without Fresnel on what is no metal",
    choices=("tilted", "parallel", "none"),
    section=f"{_PAPER} 3, figures 13 and 14",
)
PLANES = Parameter(
    "planes",
    "Planes",
    64,
    "How many attenuation planes; fewer show as steps",
    minimum=0,
    maximum=MOST_PLANES,
    section=f"{_PAPER} 3",
)
BLUR = Parameter(
    "blur",
    "Blur",
    "constant",
    "One blur for all and fading with height; or slabs, each blurred by its own radius, without that fading",
    choices=("constant", "slabs", "none"),
    section=f"{_PAPER} 3, figure 8",
)
SCALE = Parameter(
    "scale",
    "Smaller by",
    0,
    "The mirrored picture is smaller by this factor, which blurs it; 0 for what the lobe asks",
    minimum=0,
    maximum=_MOST_SCALE,
    section=f"{_PAPER} 4",
)
LOBE = Parameter(
    "lobe",
    "Lobe",
    0.0,
    "Largest deviation of the facets' normals; 0 for what the material's roughness stands for",
    unit="degrees",
    minimum=0.0,
    maximum=_WIDEST,
    section=f"{_PAPER} 2, figure 3",
)

_tilted, _parallel = lru_cache(256)(tilted_planes), lru_cache(256)(parallel_planes)


@dataclass(frozen=True)
class Gloss:
    """What a mirror's blur and planes come from.

    `lobe` radians, 0 for a perfect mirror; `ior` None for what has no Fresnel term of a dielectric; `farthest` and
    `highest` metres along the mirror and above it, within which anything is.
    """

    lobe: float
    ior: float | None
    farthest: float
    highest: float


class GlossyPlanes(Planar):
    """Glossy floors as published: the mirrored picture is drawn small, dimmed by planes, and blurred.

    Partially transparent planes are drawn into the picture that `planar` draws, in front of what they attenuate:
    parallel to the mirror, or tilted so that they carry the Fresnel term as well. A kernel of 4 × 4 texels blurs it,
    and it is added to the light of the floor. The planes are placed by `attenuation_planes`, for the height of the
    eye and the material's lobe.

    Source: the paper on glossy planar reflections, sections 3 and 4. It leaves open how wide the picture's texels
    are: here so that the blur is that of something as high as the eye. Roughness is the mean over its image.

    Outputs: as every method; `distance` is that of a perfect mirror.

    Limitations: those of the paper. The blur is the same where things touch the floor and far above it; light
    leaks over silhouettes; it is taken along the view, not around the eye, so that the floor at the picture's
    sides is too dark. On metals, planes are parallel, and the reflectance is multiplied by pixel; so it is for
    an orthographic camera, whose planes are those for an ordinary lens that sees as much. Under unlit light every
    mirror is perfect.
    """

    name = "glossy-planes"
    source = "Glossy planar reflections, sections 3 and 4: attenuation planes over a small, blurred mirrored picture"
    parameters = (ATTENUATION, PLANES, BLUR, SCALE, LOBE, DEPTH, ANGLE, GAP)
    shader = "glossy/glossy_planes.frag"

    clipping = Clipping.PROJECTIVE_TEXTURE

    def bake(self, progress: Progress) -> None:
        """Find the flat parts, and how glossy each is."""
        super().bake(progress)
        self._gloss = {_key(mirror): self._gloss_of(mirror) for mirror in self._mirrors}
        self._darkroom = Darkroom(self.resident)
        self._screen: tuple[int, int] | None = None

    def _gloss_of(self, mirror: Mirror) -> Gloss:
        material = self.scene.materials[mirror.material]
        degrees = self.settings["lobe"] or math.degrees(lobe_angle_of_roughness(mean_roughness(self.scene, material)))
        perfect = self.resident.lighting is Lighting.UNLIT or degrees < _NARROWEST
        ior = max(material.ior, _LEAST_IOR) if material.fresnel is Fresnel.DIELECTRIC else None
        at, up = placed(self.scene), mirror.plane[:3]
        reach = np.abs(at.middle @ up + mirror.plane[3]) + (at.half * np.abs(at.axes @ up)).sum(axis=1)
        farthest = max(float(np.linalg.norm(mirror.outline - corner, axis=1).max()) for corner in mirror.outline)
        return Gloss(
            0.0 if perfect else math.radians(min(degrees, _WIDEST)),
            ior,
            farthest,
            max(float(reach[at.shown].max(initial=0.0)), 1e-3 * farthest),
        )

    def reflect(self, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Draw what every mirror in sight shows, and put it there; then what is not flat."""
        if not view.mirrored and seen.size != self._screen:
            self._screen = seen.size
            self._give_back()
        super().reflect(view, seen, target, **sample)

    def registration(self, mirror: Mirror, view: View, screen: tuple[int, int]) -> Registration:
        """As small as the blur asks; a mirror in a mirror is as small as that one already."""
        if not self._blurs(mirror):
            return Registration(screen)
        return Registration(screen, 1 if view.mirrored else self._scale(mirror, view.camera, screen), _SPARE)

    def _blurs(self, mirror: Mirror) -> bool:
        return self.settings["blur"] != "none" and self._gloss[_key(mirror)].lobe > 0.0

    def _scale(self, mirror: Mirror, camera: Camera, screen: tuple[int, int]) -> int:
        if self.settings["scale"]:
            return self.settings["scale"]
        if self.settings["blur"] == "slabs":
            return 1
        # r/d tends to tan(2 lobe) height / (eye + height): here for something as high as the eye.
        radius = 0.5 * math.tan(2.0 * self._gloss[_key(mirror)].lobe) * _pixels(camera, screen)
        return min(max(1, round(0.5 * radius / KERNEL_SPREAD)), _MOST_SCALE)

    def bind_picture(self, shader: moderngl.Program, picture: Picture) -> None:
        """Dim and blur the picture, then have the mirror show it."""
        planes = self._planes(picture)
        if planes:
            self._darkroom.dim(picture, planes)
        super().bind_picture(shader, picture)
        shader["filtered"] = blurs = self._blurs(picture.mirror)
        shader["strength"] = planes.strength if planes else 1.0
        shader["by_angle"] = self._by_angle(picture.view.camera)
        shader["shift"] = 0.0, 0.0
        if blurs and self.settings["blur"] == "slabs":
            self._darkroom.blur_slabs(picture, self._slabs(picture)).use(PICTURE_UNIT)
        elif blurs:
            self._darkroom.convolve(picture).use(PICTURE_UNIT)
            shader["shift"] = tuple(-0.5 / np.array(picture.canvas.size))

    def _by_angle(self, camera: Camera) -> bool:
        """Whether dielectrics get their Fresnel term by pixel: the planes that would bring it cannot be drawn."""
        no_eye = camera.ortho_scale is not None and self.settings["attenuation"] == "tilted"
        return self.resident.lighting is Lighting.UNLIT or no_eye

    def _planes(self, picture: Picture) -> AttenuationPlanes | None:
        gloss, camera = self._gloss[_key(picture.mirror)], picture.view.camera
        kind, count = self.settings["attenuation"], self.settings["planes"]
        if self.resident.lighting is Lighting.UNLIT or kind == "none" or not count:
            return None
        lobe = 0.0 if self.settings["blur"] == "slabs" else gloss.lobe
        eye = _eye_height(picture.mirror, camera, gloss)
        if kind == "tilted" and gloss.ior is not None and camera.ortho_scale is None:
            return _tilted(count, lobe, gloss.ior, eye, gloss.farthest, gloss.highest)
        # As far away as figure 5 is nearly constant, in the proportions of its floor.
        fades = lobe > 0.0
        return _parallel(count, lobe, eye, gloss.highest, gloss.farthest / 4, gloss.farthest) if fades else None

    def _slabs(self, picture: Picture) -> list[Slab]:
        """From the highest on; equal steps of r/d, far away, part them."""
        gloss, camera = self._gloss[_key(picture.mirror)], picture.view.camera
        eye = _eye_height(picture.mirror, camera, gloss)
        ratios = gloss.highest / (eye + gloss.highest) * np.arange(_SLABS + 1) / _SLABS
        heights = eye * ratios / (1.0 - ratios)
        heights[-1] = np.inf
        wide = math.tan(2.0 * gloss.lobe) * _pixels(camera, picture.canvas.size)
        radii = wide * (ratios[1:] + ratios[:-1]) / 2.0
        return [Slab(*map(float, slab)) for slab in zip(heights[:-1], heights[1:], radii, strict=True)][::-1]

    def _canvas_of(self, level: int, size: tuple[int, int]) -> Canvas:
        """Kept until the screen changes: mirrors differ in what size they ask for."""
        if (level, size) not in self._canvases:
            self._canvases[level, size] = Canvas(*size)
        return self._canvases[level, size]

    def _give_back(self) -> None:
        for canvas in self._canvases.values():
            canvas.release()
        self._canvases.clear()
        self._darkroom.release()

    def free(self) -> None:
        """Give the pictures back."""
        self._darkroom.release()
        super().free()


def _key(mirror: Mirror) -> tuple[int, int]:
    return mirror.instance, mirror.part


def _pixels(camera: Camera, size: tuple[int, int]) -> float:
    """Pixels of something one unit wide at distance 1; for an orthographic camera, those of an ordinary lens."""
    left, right, _, _ = camera.window(*size)
    return size[0] * (_ORDINARY_LENS if camera.ortho_scale is not None else 1.0 / (right - left))


def _eye_height(mirror: Mirror, camera: Camera, gloss: Gloss) -> float:
    """Metres that the eye is over the mirror's plane, to three digits, so that planes are not placed ever anew."""
    if camera.ortho_scale is None:
        height = abs(float(mirror.plane[:3] @ camera.position + mirror.plane[3]))
    else:
        height = abs(float(mirror.plane[:3] @ camera.matrix[:3, 2])) * camera.ortho_scale * _ORDINARY_LENS
    return float(f"{max(height, 1e-3 * gloss.farthest):.3g}")
