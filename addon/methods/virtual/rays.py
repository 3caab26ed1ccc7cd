"""The mirrored rays of a picture, which say what of a reflector shows and where it looks."""

from collections.abc import Iterator

import moderngl
import numpy as np

from ...baking.reflector_maps_tables import UNITS, ResidentMaps
from ...drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility
from ...gl import read_back, require
from ...scene import Camera
from ..contract import View

MAPS_UNIT = FREE_UNIT + 1
"""The maps are on UNITS texture units from here on."""

_RAYS_UNIT = MAPS_UNIT + UNITS
AFTER_RAYS = _RAYS_UNIT + 2
"""The first texture unit that maps and rays leave."""


class MirroredRays:
    """A ray for each pixel that shows a reflector, as gpu_shaders/virtual/rays.glsl writes it. Lives on the GL thread.

    `origins` and `directions` are textures of the picture's size, 0 where no ray is.
    """

    def __init__(self, fragment: str, resident: Resident, maps: ResidentMaps, seen: Visibility) -> None:
        """Compile `fragment`, a file below gpu_shaders/, for pictures of what is `seen`."""
        self._maps = maps
        self._pass = ScreenPass(fragment, resident, Part.REFLECTORS)
        context = require()
        self.origins, self.directions = (context.texture(seen.size, 4, dtype="f4") for _ in range(2))
        self._target = context.framebuffer([self.origins, self.directions], seen.parts)
        self._target.depth_mask = False

    @property
    def shader(self) -> moderngl.Program:
        """What draws them, for what else it reads."""
        return self._pass.shader

    def draw(self, view: View, seen: Visibility, offset: tuple[float, float]) -> None:
        """Find the rays of one sample, at `offset` within the pixel."""
        self._target.clear()
        self._maps.bind(self.shader, MAPS_UNIT)
        self._pass.draw(view.camera, seen, self._target, offset=offset, blend=False)

    def bind(self, shader: moderngl.Program) -> None:
        """Have a shader read them."""
        for unit, (name, texture) in enumerate(self._textures(), _RAYS_UNIT):
            texture.use(unit)
            shader[name] = unit

    def _textures(self) -> Iterator[tuple[str, moderngl.Texture]]:
        yield "ray_origins", self.origins
        yield "ray_directions", self.directions

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self.origins, self.directions):
            part.release()


def read(texture: moderngl.Texture) -> np.ndarray:
    """(H, W, 4) float32 of origins or directions."""
    return np.frombuffer(read_back(texture), np.float32).reshape(texture.height, texture.width, 4)


def eye_of(camera: Camera) -> tuple[float, float, float, float]:
    """Where rays come from, as the searches have it: w is 0 for a direction."""
    return (*camera.position, 1.0) if camera.ortho_scale is None else (*camera.matrix[:3, 2], 0.0)
