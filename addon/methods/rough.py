"""Rough mirrors: how many rays each pixel sends, and pixels that look along the rays of others."""

from weakref import WeakKeyDictionary

import moderngl

from ..drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility
from ..gl import require, set_uniforms, unbind
from ..parameters import Parameter
from ..progress import Progress
from .contract import View
from .deferred import Bind, DeferredMethod
from .mirrors import Bounds

SHARED = Parameter(
    "shared",
    "Shared by",
    4,
    "Where a picture has few samples a pixel, a rough mirror's pixel sends one ray for each and looks along those of "
    "this many pixels on each side of a square; 1: only along its own",
    minimum=1,
    maximum=8,
    unit="pixels",
    section="Stachowiak and Uludag, Stochastic screen-space reflections, 2015",
)


class Rough(DeferredMethod):
    """Adds roughness to a method whose shader is built on gpu_shaders/common/rough.glsl; stands before it as a base.

    The method has the parameters `rays`, of each sample of a pixel, and `shared`.
    """

    few = 1
    """Samples on a side of a pixel up to which pixels share rays."""

    @property
    def defines(self) -> dict[str, int]:
        """Whether anything is rough."""
        return {**super().defines, "ROUGH": int(self.resident.rough)}

    def join(self, ensemble, reflectors: tuple[int, ...], progress: Progress) -> None:
        """Get ready; see `DeferredMethod`."""
        super().join(ensemble, reflectors, progress)
        self.shared = SharedRays(self.shader, self.resident, self.settings["shared"], self.defines)

    def shares(self, view: View) -> bool:
        """Whether pixels look along each other's rays: a picture of so few samples would be noisy."""
        needed = max(view.samples**2, self.settings["rays"]) < self.settings["shared"] ** 2
        return needed and view.samples <= self.few and not view.mirrored and self.resident.rough

    def bind_sample(self, shader: moderngl.Program, view: View, offset: tuple[float, float]) -> None:
        """Which of the pixel's rays are this sample's."""
        rays, number = self.settings["rays"], sample_number(view, offset)
        uniforms = {"rays": rays, "all_rays": rays * view.samples**2, "first_ray": rays * number}
        set_uniforms(shader, uniforms)

    def draw_pass(self, bind: Bind, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Draw the reflections, by the rays of neighbours too where there are few."""
        if self.shares(view):
            self.shared.draw(self.with_sample(bind, view, sample["offset"]), view, seen, target, **sample)
        else:
            super().draw_pass(bind, view, seen, target, **sample)

    def with_sample(self, bind: Bind, view: View, offset: tuple[float, float]) -> Bind:
        """What `bind` sets, and what `bind_sample` does."""

        def bind_all(shader: moderngl.Program) -> None:
            bind(shader)
            self.bind_sample(shader, view, offset)

        return bind_all

    def free(self) -> None:
        """Give the rays back; see `DeferredMethod`."""
        super().free()
        self.shared.release()


class SentRays:
    """What shared rays of a picture bring, and what pixels see by them: framebuffers of its size, or `stride` smaller.

    `evened`, what they see without steps, is kept only where that is smaller.
    """

    def __init__(self, seen: Visibility, stride: int) -> None:
        """Empty."""
        size, parts = tuple(-(-side // stride) for side in seen.size), seen.parts if stride == 1 else None
        self.textures = [require().texture(size, 4, dtype="f4") for _ in range(5 + (stride > 1))]
        self.arrived, self.ends, *self.looked = self.textures[:5]
        self.evened = self.textures[-1]
        self.rays, self.looks, self.evens = (
            require().framebuffer(into, parts) for into in ([self.arrived, self.ends], self.looked, [self.evened])
        )
        for target in (self.rays, self.looks, self.evens):
            target.depth_mask = False

    def release(self) -> None:
        """Give the memory back."""
        for part in (self.rays, self.looks, self.evens, *self.textures):
            part.release()


class SharedRays:
    """One ray of each pixel of a rough mirror, which its neighbours look along too. Lives on the GL thread."""

    def __init__(self, shader: str, resident: Resident, side: int, defines: dict[str, int]) -> None:
        """`shader` as `Rough` has it, `side` of the square of neighbours; compiled when something is drawn."""
        part, square = Part.REFLECTORS, {"SIDE": side, "SHARED": side}
        self._send = lambda stride: ScreenPass(shader, resident, part, {**defines, "SHARED": side, "STRIDE": stride})
        self._look = lambda stride: ScreenPass("rough/shared.frag", resident, part, {**square, "STRIDE": stride})
        self._even = lambda stride: ScreenPass(
            "rough/even.frag", resident, part, {"SIDE": side - (stride > 1), "STRIDE": stride}
        )
        self._side = side
        self._kept: WeakKeyDictionary[Visibility, dict[int, SentRays]] = WeakKeyDictionary()

    def draw(self, bind: Bind, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Send the rays, then add what they show to `target`; `bind` sets what the method's shader reads."""
        self._look_along(bind, view, seen, target.scissor, 1, sample)
        self._draw_even(view, seen, target, 1, sample)

    def send(self, bind: Bind, view: View, seen: Visibility, bounds: Bounds, stride: int, **sample) -> "SentRays":
        """Send rays for one pixel of every square of `stride` by `stride` alone; it is left to others to show them."""
        sent = self._look_along(bind, view, seen, bounds, stride, sample)
        sent.evens.scissor = _scaled(bounds, stride, 1)
        sent.evens.clear()
        sent.evens.scissor = sent.rays.scissor
        self._draw_even(view, seen, sent.evens, stride, {**sample, "blend": False})
        return sent

    def _look_along(self, bind, view: View, seen: Visibility, bounds: Bounds, stride: int, sample: dict) -> "SentRays":
        sent = self._sent(seen, stride)
        apart = {**sample, "blend": False}
        send, look = self._send(stride), self._look(stride)
        bind(send.shader)
        sent.rays.scissor = _scaled(bounds, stride, self._side**2)  # as far as neighbours are looked for
        sent.rays.clear()
        sent.rays.scissor = sent.looks.scissor = _scaled(bounds, stride)
        send.draw(view.camera, seen, sent.rays, **apart)
        give(look, arrived=sent.arrived, ends=sent.ends)
        look.draw(view.camera, seen, sent.looks, **apart)
        return sent

    def _draw_even(self, view: View, seen: Visibility, target: moderngl.Framebuffer, stride: int, sample: dict) -> None:
        sent, even = self._sent(seen, stride), self._even(stride)
        give(even, ends=sent.ends, **dict(zip(("light", "kept", "beside"), sent.looked, strict=True)))
        even.draw(view.camera, seen, target, **sample)

    def _sent(self, seen: Visibility, stride: int) -> "SentRays":
        kept = self._kept.setdefault(seen, {})
        if stride not in kept:
            kept[stride] = SentRays(seen, stride)
        return kept[stride]

    def release(self) -> None:
        """Give the rays back."""
        unbind()
        for sent in (sent for kept in self._kept.values() for sent in kept.values()):
            sent.release()
        self._kept.clear()


def give(drawn: ScreenPass, first: int = FREE_UNIT + 1, **textures: moderngl.Texture) -> None:
    """Have a pass read these, by the names of its uniforms, from texture unit `first` on."""
    for unit, texture in enumerate(textures.values(), first):
        texture.use(unit)
    set_uniforms(drawn.shader, {name: unit for unit, name in enumerate(textures, first)})


def _scaled(bounds: Bounds | None, stride: int, spare: int = 0) -> Bounds | None:
    """Bounds on a target that is smaller by `stride`, with `spare` texels around; None for all of it."""
    if bounds is None:
        return None
    x, y, width, height = bounds
    left, low = max(0, x // stride - spare), max(0, y // stride - spare)
    return left, low, -(-(x + width) // stride) + spare - left, -(-(y + height) // stride) + spare - low


def sample_number(view: View, offset: tuple[float, float]) -> int:
    """Of a sample among those of a pixel, row by row."""
    column, row = (view.samples * (0.5 + shift) - 0.5 for shift in offset)
    return round(row) * view.samples + round(column)
