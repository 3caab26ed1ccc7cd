"""Rough flat mirrors: the lobe of each pixel, followed through a mirrored picture."""

import moderngl
import numpy as np

from ..drawing import Clipping, world_to_clip
from ..parameters import Parameter
from ..progress import Progress
from .contract import View
from .mirrors import Mirror, Registration
from .planar import ANGLE, DEPTH, GAP, PICTURE_UNIT, Picture, Planar
from .plane_distances import PlaneDistances

_PATTERN = 1.7548776662, 2.2360679775

RAYS = Parameter(
    "rays", "Rays", 16, "Directions of the lobe that each sample of a pixel looks along", minimum=1, maximum=256
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


class GlossyPlanar(Planar):
    """Flat mirrors of any roughness: rays of the material's own lobe, followed through the mirrored picture.

    Each pixel draws facets from the GGX distribution that its roughness stands for (a texture's value there, if
    there is one), and follows the rays that they mirror through the depth of the picture that `planar` draws. So
    the blur grows with the distance to what is hit, stretches at grazing angles, and ends at silhouettes. Fresnel
    and shadowing are taken by facet.

    Source: the aim is that of the paper on glossy planar reflections; facets as in Dupuy and Benyoub 2023, rays in
    screen space as in McGuire and Mara 2014.

    Outputs: as every method; `distance` is that of one ray of the lobe.

    Limitations: what no mirrored camera sees is not there for a rough ray either, which shows its surroundings
    instead; few `rays` are noisy where a lobe is wide. Roughness above 0.5 outgrows the margin.
    """

    name = "glossy-planar"
    source = "GGX rays through the mirrored picture's depth; after McGuire and Mara 2014, Dupuy and Benyoub 2023"
    parameters = (RAYS, MARGIN, DEPTH, ANGLE, GAP)
    shader = "glossy/glossy_planar.frag"

    clipping = Clipping.PROJECTIVE_TEXTURE

    def bake(self, progress: Progress) -> None:
        """Find the flat parts."""
        super().bake(progress)
        self._depths = PlaneDistances(self.resident)

    def registration(self, mirror: Mirror, view: View, screen: tuple[int, int]) -> Registration:
        """With a margin, unless it is a mirror in a mirror."""
        if view.mirrored:
            return Registration(screen)
        return Registration(screen, 1, tuple(round(self.settings["margin"] * side) for side in screen))

    def bind_picture(self, shader: moderngl.Program, picture: Picture) -> None:
        """The mirrored picture, its depth, and how to find a place in them."""
        view, canvas = picture.view, picture.canvas
        canvas.color.use(PICTURE_UNIT)
        ahead = -view.camera.matrix[:3, 2]
        axis = np.array([*ahead, -float(ahead @ view.camera.position)])
        self._depths.of(picture, axis).use(PICTURE_UNIT + 1)
        uniforms = {
            "mirrored": PICTURE_UNIT,
            "mirrored_depth": PICTURE_UNIT + 1,
            "world_to_mirrored": tuple(world_to_clip(view.camera, *canvas.size, picture.offset).T.ravel()),
            "mirrored_axis": tuple(axis),
            "reach": view.camera.far,
            "rays": self.settings["rays"],
            "pattern": float(np.dot(picture.offset, _PATTERN) % 1.0),
        }
        for name, value in uniforms.items():
            if name in shader:  # what is never rough needs no ray
                shader[name] = value

    def free(self) -> None:
        """Give the pictures and their depths back."""
        super().free()
        self._depths.release()
