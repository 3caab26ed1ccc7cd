"""Rough flat mirrors: the lobe of each pixel, followed through a mirrored picture."""

import math
from functools import partial

import moderngl
import numpy as np

from ..drawing import Clipping, Part, ScreenPass, Visibility, world_to_clip
from ..gl import set_uniforms
from ..parameters import Parameter
from ..progress import Progress
from ..scene import Material, Scene, mean_roughness
from .contract import View
from .glossy.depth_ranges import DepthRanges, levels_of
from .glossy.gloss import alpha_of_roughness, lobe_angle_of_roughness
from .glossy.plane_distances import PlaneDistances
from .mirrors import Mirror, Registration
from .planar import ANGLE, DEPTH, GAP, PICTURE_UNIT, Picture, Planar
from .rough import SHARED, Rough, give, sample_number

_LOBE_SHARE = 0.96
"""The share of a lobe that the margin has room for."""

_LARGE = 512
"""Pixels: a picture as wide may be drawn by coarser pictures; in a smaller one too little would be left of them."""

_COARSE = 12.0
"""Pixels: a mirror whose lobe is so wide, seen straight on, may be drawn by a coarser picture and fewer rays."""

RAYS = Parameter(
    "rays", "Rays", 3, "Directions of the lobe that each sample of a pixel looks along", minimum=1, maximum=256
)
COARSER = Parameter(
    "coarser",
    "Coarser by",
    2,
    "Where pixels share rays, lobes are many pixels wide and the picture at least 512, the mirrored picture has so "
    "much fewer pixels on a side, and only one pixel of every square of that side sends a ray; 1: never",
    minimum=1,
    maximum=2,
)
MARGIN = Parameter(
    "margin",
    "Margin",
    0.2,
    "How much more than the picture the mirrored camera sees on each side, for what blurs into it",
    unit="widths",
    minimum=0.0,
    maximum=1.0,
)


class GlossyPlanar(Rough, Planar):
    """Flat mirrors of any roughness: rays of the material's own lobe, followed through the mirrored picture.

    Each pixel draws facets from the GGX distribution that its roughness stands for (a texture's value there, if
    there is one), and follows the rays that they mirror through the depth of the picture that `planar` draws. So
    the blur grows with the distance to what is hit, stretches at grazing angles, and ends at silhouettes. Fresnel
    and shadowing are taken by facet.

    Few rays are enough: the samples of a pixel share one even sequence of facets, and a ray shows the mean of the
    part of the lobe that it stands for, unless there is a silhouette in it. A pyramid of depth ranges tells between
    which distances a ray must end, so that few steps find the place. In a picture of few samples a pixel, each pixel
    sends one ray and shows those of its neighbours too, as far as they are likely rays of its own. Where a lobe is
    many pixels wide, the mirrored picture is then half as fine, and one pixel of every four sends a ray: the light
    between them is evened, the mirror's own colour and Fresnel are each pixel's own.

    Source: the aim is that of the paper on glossy planar reflections; facets as in Dupuy and Benyoub 2023, rays in
    screen space as in McGuire and Mara 2014, means as in Krivanek and Colbert 2008, neighbours' rays as in Stachowiak
    and Uludag 2015.

    Outputs: as every method; `distance` is that of one ray of the lobe.

    Limitations: what no mirrored camera sees is not there for a rough ray either, which shows its surroundings
    instead; few `rays` are noisy where a lobe is wide, and blotchy around small lamps where they are shared; what
    touches a coarser mirror is mirrored two pixels soft. Roughness above 0.5 outgrows the margin.
    """

    name = "glossy-planar"
    source = "GGX rays through the mirrored picture's depth; after McGuire and Mara 2014, Dupuy and Benyoub 2023"
    parameters = (RAYS, SHARED, COARSER, MARGIN, DEPTH, ANGLE, GAP)
    shader = "glossy/glossy_planar.frag"
    few = 3

    clipping = Clipping.PROJECTIVE_TEXTURE

    def bake(self, progress: Progress) -> None:
        """Find the flat parts."""
        super().bake(progress)
        self._depths, self._ranges = PlaneDistances(self.resident), DepthRanges()

    def registration(self, mirror: Mirror, view: View, screen: tuple[int, int]) -> Registration:
        """With a margin as wide as lobes reach, unless it is a mirror in a mirror."""
        if view.mirrored:
            return Registration(screen)
        materials = [self.scene.materials[index] for index in self.scene.instances[mirror.instance].materials]
        shown = [material for material in materials if material.mirrors]
        margin = min(self.settings["margin"], max(_widths_reached(self.scene, material, view) for material in shown))
        blurred = all(_pixels_wide(self.scene, material, view) >= _COARSE for material in shown)
        scale = self.settings["coarser"] if blurred and self.shares(view) and view.width >= _LARGE else 1
        return Registration(screen, scale, tuple(round(margin * side / scale) for side in screen))

    def offset_within(self, lies: Registration, offset: tuple[float, float]) -> tuple[float, float]:
        """All over its pixels, however large: a rough ray finds its place by the mirrored camera."""
        return offset

    def show(self, picture: Picture, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Add what a mirror shows: where its picture is coarser, by rays that are as far apart as its pixels are."""
        scale = picture.lies.scale
        if scale == 1:
            super().show(picture, view, seen, target, **sample)
            return
        bind = self.with_sample(partial(self.bind_shown, picture), view, sample["offset"])
        sent = self.shared.send(bind, view, seen, target.scissor, scale, **sample)
        finer = ScreenPass("glossy/finer.frag", self.resident, Part.REFLECTORS, {"SQUARE": scale})
        self.bind_mirror(finer.shader, picture.mirror.instance, picture.mirror.part)
        set_uniforms(finer.shader, {"number": sample_number(view, sample["offset"])})
        give(finer, PICTURE_UNIT, evened=sent.evened, beside=sent.looked[2], ends=sent.ends)
        finer.draw(view.camera, seen, target, **sample)

    def bind_picture(self, shader: moderngl.Program, picture: Picture) -> None:
        """The mirrored picture, its depth, and how to find a place in them."""
        view, canvas = picture.view, picture.canvas
        ahead = -view.camera.matrix[:3, 2]
        axis = np.array([*ahead, -float(ahead @ view.camera.position)])
        canvas.color.build_mipmaps(0, levels_of(canvas.size))
        depths = self._depths.of(picture, axis)
        ranges = self._ranges.of(canvas, view.opening.bounds, depths)
        for unit, texture in enumerate((canvas.color, depths, *ranges), PICTURE_UNIT):
            texture.use(unit)
        uniforms = {
            "mirrored": PICTURE_UNIT,
            "mirrored_depth": PICTURE_UNIT + 1,
            "even_ranges": PICTURE_UNIT + 2,
            "odd_ranges": PICTURE_UNIT + 3,
            "levels": levels_of(canvas.size),
            "world_to_mirrored": tuple(world_to_clip(view.camera, *canvas.size, picture.offset).T.ravel()),
            "mirrored_axis": tuple(axis),
            "reach": view.camera.far,
            "focus": 0.5 * canvas.size[0] * float(view.camera.projection(*canvas.size)[0, 0]),
        }
        set_uniforms(shader, uniforms)

    def free(self) -> None:
        """Give the pictures and their depths back."""
        super().free()
        self._depths.release()
        self._ranges.release()


def _pixels_wide(scene: Scene, material: Material, view: View) -> float:
    """How many pixels of the picture a lobe covers, seen straight on; 0 where that is not known."""
    if material.roughness.image is not None or view.camera.ortho_scale is not None:
        return 0.0
    turned = 2.0 * alpha_of_roughness(mean_roughness(scene, material))
    return float(turned * 0.5 * view.width * view.camera.projection(view.width, view.height)[0, 0])


def _widths_reached(scene: Scene, material: Material, view: View) -> float:
    """How much of the picture's width a lobe covers to each side, at most; infinite where that is not known."""
    if material.roughness.image is not None or view.camera.ortho_scale is not None:
        return math.inf
    turned = 2.0 * float(lobe_angle_of_roughness(mean_roughness(scene, material), _LOBE_SHARE))
    return 0.5 * view.camera.projection(view.width, view.height)[0, 0] * math.tan(turned) if turned < 1.5 else math.inf
