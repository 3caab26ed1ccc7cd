"""One reflection of a picture's rays, and what they meet."""

import moderngl
import numpy as np

from ..baking.reflector_maps_tables import ResidentMaps
from ..drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility
from ..gl import program, require, screen
from .contract import View
from .virtual_bundles import bundles_of
from .virtual_images import Images
from .virtual_scene import VirtualScene

_MAPS_UNIT = FREE_UNIT + 1
_RAYS_UNIT = FREE_UNIT + 3
MET_UNIT = FREE_UNIT + 5
"""What the rays of order n meet is on the n-th texture unit from here on."""


_STRIDES = 16, 8, 4, 2, 1, 1
"""Pixels from which each pixel learns what it may meet as well; an even number, so that the last is where it began."""


class Bounce:
    """The rays that are mirrored for the `order`-th time in a picture. Lives on the GL thread.

    What they meet is a picture of (instance + 1, triangle), or of gpu_shaders/virtual/seen.glsl.
    """

    def __init__(self, resident: Resident, maps: ResidentMaps, scene: VirtualScene, order: int, settings: dict) -> None:
        """Compile; `fit` makes the targets."""
        self._maps, self._order = maps, order
        name = "virtual/rays.frag" if order == 1 else "virtual/rays_again.frag"
        self._rays = ScreenPass(name, resident, Part.REFLECTORS)
        self._resident, self._spread = resident, program(None, "virtual/spread.frag")
        self._spread_screen = screen(self._spread)
        self._images = Images(resident, maps, scene, order, settings)

    def fit(self, seen: Visibility) -> None:
        """Make targets of the size of what is seen, and only for the reflectors there."""
        context = require()
        self._textures = [context.texture(seen.size, 4, dtype="f4") for _ in range(2)]
        self._target = context.framebuffer(self._textures, seen.parts)
        self._target.depth_mask = False
        self._met = [context.texture(seen.size, 2, dtype="u4") for _ in range(2)]
        for texture in self._met:
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._depth = context.depth_renderbuffer(seen.size)
        self._met_target = context.framebuffer([self._met[0]], self._depth)
        self._spread_targets = [context.framebuffer([texture]) for texture in self._met]

    def draw(self, view: View, seen: Visibility, offset: tuple[float, float], anew: bool, before: "Bounce | None"):
        """Find what the rays of one sample meet; `anew` where the view is another than in the last call."""
        self._target.clear()
        self._maps.bind(self._rays.shader, _MAPS_UNIT)
        if before:
            before.bind(self._rays.shader)
        self._rays.draw(view.camera, seen, self._target, offset=offset, blend=False)
        if anew:
            origins, directions = (_read(part) for part in self._textures)
            bundles = bundles_of(origins, directions, _read(before._textures[0]) if before else None)
            self._images.find(view, seen.size, bundles)
        self._met_target.clear()
        for unit, texture in enumerate(self._textures):
            texture.use(_RAYS_UNIT + unit)
        self._images.draw(self._met_target, offset, _RAYS_UNIT)
        if self._images.in_patches:
            self._spread_out()

    def _spread_out(self) -> None:
        """Ask of each pixel whether it meets what those around it do."""
        self._resident.bind(self._spread)
        self.bind(self._spread)
        for number, stride in enumerate(_STRIDES):
            source, target = self._met[number % 2], self._spread_targets[1 - number % 2]
            target.clear()
            target.use()
            require().enable_only(moderngl.NOTHING)
            source.use(MET_UNIT)
            self._spread["virtual_objects"], self._spread["stride"] = MET_UNIT, stride
            self._spread_screen.render(vertices=3)

    def bind(self, shader: moderngl.Program) -> None:
        """Have a shader go on from these rays."""
        for unit, (name, texture) in enumerate(zip(("ray_origins", "ray_directions"), self._textures, strict=True)):
            texture.use(_RAYS_UNIT + unit)
            shader[name] = _RAYS_UNIT + unit
        self.show()
        shader["virtual_objects"] = MET_UNIT + self._order - 1

    def show(self) -> None:
        """Bind what the rays have met."""
        self._met[0].use(MET_UNIT + self._order - 1)

    def release(self) -> None:
        """Give the memory back."""
        targets = self._target, self._met_target, *self._spread_targets
        for part in (*targets, *self._met, self._depth, *self._textures, self._images):
            part.release()


def _read(texture: moderngl.Texture) -> np.ndarray:
    return np.frombuffer(texture.read(), np.float32).reshape(texture.height, texture.width, 4)
