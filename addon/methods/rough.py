"""Rough mirrors: how many rays each pixel sends, and pixels that look along the rays of others."""

from functools import partial
from weakref import WeakKeyDictionary

import moderngl

from ..drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility
from ..gl import require, set_uniforms, unbind
from ..parameters import Parameter
from ..progress import Progress
from .contract import View
from .deferred import Bind, DeferredMethod

SHARED = Parameter(
    "shared",
    "Shared by",
    4,
    "Where a picture has one sample a pixel, a rough mirror's pixel sends one ray and looks along those of this many "
    "pixels on each side of a square; 1: only along its own",
    minimum=1,
    maximum=8,
    unit="pixels",
    section="Stachowiak and Uludag, Stochastic screen-space reflections, 2015",
)


class Rough(DeferredMethod):
    """Adds roughness to a method whose shader is built on gpu_shaders/common/rough.glsl; stands before it as a base.

    The method has the parameters `rays`, of each sample of a pixel, and `shared`.
    """

    @property
    def defines(self) -> dict[str, int]:
        """Whether anything is rough."""
        return {**super().defines, "ROUGH": int(self.resident.rough)}

    def join(self, ensemble, reflectors: tuple[int, ...], progress: Progress) -> None:
        """Get ready; see `DeferredMethod`."""
        super().join(ensemble, reflectors, progress)
        self._shared = SharedRays(self.shader, self.resident, self.settings["shared"], self.defines)

    def bind_sample(self, shader: moderngl.Program, view: View, offset: tuple[float, float]) -> None:
        """Which of the pixel's rays are this sample's."""
        rays = self.settings["rays"]
        uniforms = {"rays": rays, "all_rays": rays * view.samples**2, "first_ray": rays * _number(view, offset)}
        set_uniforms(shader, uniforms)

    def draw_pass(self, bind: Bind, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Draw the reflections, by the rays of neighbours too where there are few."""
        few = view.samples == 1 and self.settings["rays"] < self.settings["shared"] ** 2
        if not few or view.mirrored or not self.resident.rough:
            super().draw_pass(bind, view, seen, target, **sample)
            return

        def bind_all(shader: moderngl.Program) -> None:
            bind(shader)
            self.bind_sample(shader, view, sample["offset"])

        self._shared.draw(bind_all, view, seen, target, **sample)

    def free(self) -> None:
        """Give the rays back; see `DeferredMethod`."""
        super().free()
        self._shared.release()


class _Kept:
    """What shared rays of a picture bring, and what pixels see by them: framebuffers of its size."""

    def __init__(self, seen: Visibility) -> None:
        self.arrived, self.ends, *self.looked = (require().texture(seen.size, 4, dtype="f4") for _ in range(5))
        self.rays = require().framebuffer([self.arrived, self.ends], seen.parts)
        self.looks = require().framebuffer(self.looked, seen.parts)
        self.rays.depth_mask = self.looks.depth_mask = False

    def release(self) -> None:
        for part in (self.rays, self.looks, self.arrived, self.ends, *self.looked):
            part.release()


class SharedRays:
    """One ray of each pixel of a rough mirror, which its neighbours look along too. Lives on the GL thread."""

    def __init__(self, shader: str, resident: Resident, side: int, defines: dict[str, int]) -> None:
        """`shader` as `Rough` has it, `side` of the square of neighbours; compiled when something is drawn."""
        part, square = Part.REFLECTORS, {"SIDE": side}
        self._send = partial(ScreenPass, shader, resident, part, {**defines, "SHARED": side})
        self._look = partial(ScreenPass, "rough/shared.frag", resident, part, {**square, "SHARED": side})
        self._even = partial(ScreenPass, "rough/even.frag", resident, part, square)
        self._kept: WeakKeyDictionary[Visibility, _Kept] = WeakKeyDictionary()

    def draw(self, bind: Bind, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Send the rays, then add what they show to `target`; `bind` sets what the method's shader reads."""
        if seen not in self._kept:
            self._kept[seen] = _Kept(seen)
        kept = self._kept[seen]
        apart = {**sample, "blend": False}
        send, look, even = self._send(), self._look(), self._even()
        bind(send.shader)
        kept.rays.scissor = kept.looks.scissor = target.scissor
        kept.rays.clear()
        send.draw(view.camera, seen, kept.rays, **apart)
        _give(look, arrived=kept.arrived, ends=kept.ends)
        look.draw(view.camera, seen, kept.looks, **apart)
        _give(even, ends=kept.ends, **dict(zip(("light", "kept", "beside"), kept.looked, strict=True)))
        even.draw(view.camera, seen, target, **sample)

    def release(self) -> None:
        """Give the rays back."""
        unbind()
        for kept in self._kept.values():
            kept.release()
        self._kept.clear()


def _give(drawn: ScreenPass, **textures: moderngl.Texture) -> None:
    for unit, (name, texture) in enumerate(textures.items(), FREE_UNIT + 1):
        texture.use(unit)
        drawn.shader[name] = unit


def _number(view: View, offset: tuple[float, float]) -> int:
    """Of a sample among those of a pixel, row by row."""
    column, row = (view.samples * (0.5 + shift) - 0.5 for shift in offset)
    return round(row) * view.samples + round(column)
