"""One reflection of a picture's rays, and what they meet."""

import moderngl

from ...baking.reflector_maps_tables import ResidentMaps
from ...drawing import Resident, Visibility
from ...gl import clear, program, require, screen
from ..contract import View
from .bundles import bundles_of
from .images import Images
from .rays import AFTER_RAYS, MirroredRays, read
from .scene import VirtualScene

MET_UNIT = AFTER_RAYS
"""What the rays of order n meet is on the n-th texture unit from here on."""

_STRIDES = 16, 8, 4, 2, 1, 1
"""Pixels from which each pixel learns what it may meet as well; an even number, so that the last is where it began."""


class Bounce:
    """The rays that are mirrored for the `order`-th time in a picture. Lives on the GL thread.

    What they meet is a picture of (instance + 1, triangle), or of gpu_shaders/virtual/seen.glsl.
    """

    def __init__(
        self, resident: Resident, maps: ResidentMaps, scene: VirtualScene, order: int, settings: dict, seen: Visibility
    ) -> None:
        """Compile, and make targets of the size of what is `seen`, for the reflectors there."""
        self._resident, self._order = resident, order
        name = "virtual/rays.frag" if order == 1 else "virtual/rays_again.frag"
        self.rays = MirroredRays(name, resident, maps, seen)
        self._spread = program(None, "virtual/spread.frag")
        self._images = Images(resident, maps, scene, order, settings)
        context = require()
        self._met = [context.texture(seen.size, 2, dtype="u4") for _ in range(2)]
        for texture in self._met:
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._depth = context.depth_renderbuffer(seen.size)
        self._met_target = context.framebuffer([self._met[0]], self._depth)
        self._spread_targets = [context.framebuffer([texture]) for texture in self._met]

    def draw(self, view: View, seen: Visibility, offset: tuple[float, float], anew: bool, before: "Bounce | None"):
        """Find what the rays of one sample meet; `anew` where the view is another than in the last call."""
        if before:
            before.bind(self.rays.shader)
        self.rays.draw(view, seen, offset)
        if anew:
            start = read(before.rays.origins) if before else None
            self._images.find(view, seen.size, bundles_of(read(self.rays.origins), read(self.rays.directions), start))
        clear(self._met_target)
        self._images.draw(self._met_target, offset, self.rays)
        if self._images.in_patches:
            self._spread_out()

    def _spread_out(self) -> None:
        """Ask of each pixel whether it meets what those around it do."""
        self._resident.bind(self._spread)
        self.bind(self._spread)
        for number, stride in enumerate(_STRIDES):
            source, target = self._met[number % 2], self._spread_targets[1 - number % 2]
            clear(target)
            target.use()
            require().enable_only(moderngl.NOTHING)
            source.use(MET_UNIT)
            self._spread["virtual_objects"], self._spread["stride"] = MET_UNIT, stride
            screen(self._spread).render(vertices=3)

    def bind(self, shader: moderngl.Program) -> None:
        """Have a shader go on from these rays."""
        self.rays.bind(shader)
        self.show()
        shader["virtual_objects"] = MET_UNIT + self._order - 1

    def show(self) -> None:
        """Bind what the rays have met."""
        self._met[0].use(MET_UNIT + self._order - 1)

    def release(self) -> None:
        """Give the memory back."""
        targets = self._met_target, *self._spread_targets
        for part in (*targets, *self._met, self._depth, self.rays, self._images):
            part.release()
