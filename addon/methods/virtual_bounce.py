"""One reflection of a picture's rays, and what they meet."""

import moderngl
import numpy as np

from ..baking.reflector_maps_tables import ResidentMaps
from ..drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility
from ..gl import require
from .contract import View
from .virtual_bundles import bundles_of
from .virtual_images import Images
from .virtual_scene import VirtualScene

_MAPS_UNIT = FREE_UNIT + 1
_RAYS_UNIT = FREE_UNIT + 3
MET_UNIT = FREE_UNIT + 5
"""What the rays of order n meet is on the n-th texture unit from here on."""


class Bounce:
    """The rays that are mirrored for the `order`-th time in a picture. Lives on the GL thread.

    `met` holds (instance + 1, triangle) of what they meet, 0 where that is the world.
    """

    def __init__(self, resident: Resident, maps: ResidentMaps, scene: VirtualScene, order: int, steps: int) -> None:
        """Compile; `fit` makes the targets."""
        self._maps, self._order = maps, order
        name = "virtual/rays.frag" if order == 1 else "virtual/rays_again.frag"
        self._rays = ScreenPass(name, resident, Part.REFLECTORS)
        self._images = Images(resident, maps, scene, order, steps)

    def fit(self, seen: Visibility) -> None:
        """Make targets of the size of what is seen, and only for the reflectors there."""
        context = require()
        self._textures = [context.texture(seen.size, 4, dtype="f4") for _ in range(2)]
        self._target = context.framebuffer(self._textures, seen.parts)
        self._target.depth_mask = False
        self.met = context.texture(seen.size, 2, dtype="u4")
        self.met.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._depth = context.depth_renderbuffer(seen.size)
        self._met_target = context.framebuffer([self.met], self._depth)

    def draw(self, view: View, seen: Visibility, offset: tuple[float, float], anew: bool, before: "Bounce | None"):
        """Find what the rays of one sample meet; `anew` where the view is another than in the last call."""
        self._target.clear()
        self._maps.bind(self._rays.shader, _MAPS_UNIT)
        if before:
            before.bind(self._rays.shader)
        self._rays.draw(view.camera, seen, self._target, offset=offset, blend=False)
        if anew:
            self._images.find(view, seen.size, bundles_of(*self._read(seen.size), self._order))
        self._met_target.clear()
        for unit, texture in enumerate(self._textures):
            texture.use(_RAYS_UNIT + unit)
        self._images.draw(self._met_target, offset, _RAYS_UNIT)

    def bind(self, shader: moderngl.Program) -> None:
        """Have a shader go on from these rays."""
        for unit, (name, texture) in enumerate(zip(("ray_origins", "ray_directions"), self._textures, strict=True)):
            texture.use(_RAYS_UNIT + unit)
            shader[name] = _RAYS_UNIT + unit
        self.show()
        shader["virtual_objects"] = MET_UNIT + self._order - 1

    def show(self) -> None:
        """Bind what the rays have met."""
        self.met.use(MET_UNIT + self._order - 1)

    def _read(self, size: tuple[int, int]) -> list[np.ndarray]:
        return [np.frombuffer(part.read(), np.float32).reshape(size[1], size[0], 4) for part in self._textures]

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self._met_target, self.met, self._depth, *self._textures, self._images):
            part.release()
