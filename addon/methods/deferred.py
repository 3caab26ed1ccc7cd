"""The frame that every method shares: see, light, then add the reflections."""

from abc import abstractmethod
from collections.abc import Callable, Hashable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from typing import ClassVar

import moderngl

from ..drawing import Canvas, Part, Resident, ScreenPass, Visibility, world_to_clip
from ..gl import Stopwatch, on_gl_thread
from ..progress import Progress, part_of, silent
from ..scene import Lighting, Scene
from .contract import Method, Reuse, View

_PREPARATION, _MARKING, _REFLECTION = _UNNAMED = "preparation", "marking", "reflection"

Clock = Callable[[str], AbstractContextManager]
"""Times what is drawn inside, as a stage of that name."""

_TIMED = 3
"""How often what a frame prepares is timed, where a picture has several samples."""


Bind = Callable[[moderngl.Program], None]
"""Sets what a shader reads besides the scene."""


class EnsembleMethod(Method):
    """A method that says which reflectors are drawn by what; an ensemble of one or several paints them."""

    _ensemble: "Ensemble | None" = None

    @abstractmethod
    def cast(self, scene: Scene) -> "Cast":
        """Who draws which reflectors."""

    @on_gl_thread
    def prepare(self, scene: Scene, lighting: Lighting, progress: Progress = silent) -> None:
        """Upload the scene, compile the shaders, bake what is needed."""
        self._ensemble = Ensemble(scene, lighting)
        self._ensemble.assign(self.cast(scene), progress)

    @on_gl_thread
    def update(self, scene: Scene, progress: Progress = silent) -> None:
        """Upload what has changed; bake again unless nothing but the camera has."""
        if self._ensemble.update(scene):
            self._ensemble.assign(self.cast(scene), progress)
        else:
            self._ensemble.complete(progress)

    @on_gl_thread
    def paint(self, view: View, canvas: Canvas, progress: Progress = silent) -> dict[str, float]:
        """See, light, reflect, once for each sample of the pixel."""
        return self._ensemble.paint(view, canvas, progress)

    def reused(self, canvas: Canvas) -> Reuse | None:
        """What the method took over, or the one of several that takes over at all."""
        return self._ensemble.reused(canvas)

    @on_gl_thread
    def release(self) -> None:
        """Give the GPU memory back, however far `prepare` came."""
        super().release()
        if self._ensemble is not None:
            self._ensemble.release()


class DeferredMethod(EnsembleMethod):
    """A method whose reflections are one full-screen pass, a shader that defines `mirrored_light`.

    A subclass names the shader's file, bakes for `self.reflectors` (instances) of `self.scene`, which lies
    on the GPU as `self.resident`, and binds what it reads besides the scene.
    """

    shader: ClassVar[str]

    searched = 0
    """How often `reflect` has done what it does once for all samples of a view."""

    @property
    def defines(self) -> dict[str, int]:
        """What the shader is compiled with besides what the scene's materials ask for."""
        return {}

    def bake(self, progress: Progress) -> None:
        """Bake what the reflections need; on the GL thread."""

    def before_frame(self, view: View) -> None:
        """What the method draws anew for every frame, before the reflections; counted in their time."""

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """Set the uniforms and textures (from unit FREE_UNIT + 1 on) of the reflection pass."""

    def free(self) -> None:
        """Give back what `bake` took; on the GL thread."""

    @property
    def scene(self) -> Scene:
        """What is drawn."""
        return self.resident.scene

    def cast(self, scene: Scene) -> "Cast":
        """Alone on the stage, the method draws every reflector."""
        return {self: scene.reflectors}

    def join(self, ensemble: "Ensemble", reflectors: tuple[int, ...], progress: Progress) -> None:
        """Get ready to draw these reflectors of the ensemble's scene, until `free`; on the GL thread."""
        self.ensemble, self.resident, self.reflectors = ensemble, ensemble.resident, reflectors
        self._pass = ScreenPass(self.shader, self.resident, Part.REFLECTORS, self.defines)
        self.bake(progress)

    def forget(self) -> None:
        """Have the next sample do again what `reflect` does once for all samples of a view."""

    def reflect(self, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Add the reflections of the marked reflectors; `sample` as `ScreenPass.draw` takes it."""
        self.draw_pass(lambda shader: self.bind_reflection(shader, view), view, seen, target, **sample)

    def draw_pass(self, bind: Bind, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Draw the method's shader, for which `bind` sets what it reads besides the scene."""
        bind(self._pass.shader)
        self.bind_sample(self._pass.shader, view, sample["offset"])
        self._pass.draw(view.camera, seen, target, **sample)

    def bind_sample(self, shader: moderngl.Program, view: View, offset: tuple[float, float]) -> None:
        """Set what differs from sample to sample of a pixel; `offset` as `ScreenPass.draw` takes it."""

    def reflect_in_stages(self, clock: Clock, view: View, seen: Visibility, target, **sample) -> None:
        """The same for the camera's own picture, timed: in one stage, unless a method names several."""
        with clock(_REFLECTION):
            self.reflect(view, seen, target, **sample)

    def reused_on(self, seen: Visibility) -> Reuse | None:
        """What the last picture there took over from earlier ones, where a method does so."""
        return None


Cast = Mapping[DeferredMethod, tuple[int, ...]]
"""The methods of a frame, and the instances whose reflections each draws."""


class Ensemble:
    """A scene on the GPU, and the methods that draw its reflectors in one frame. Lives on the GL thread."""

    def __init__(self, scene: Scene, lighting: Lighting) -> None:
        """Upload the scene; `assign` brings the methods in."""
        self.resident = Resident(scene, lighting)
        self._cast: dict[DeferredMethod, tuple[int, ...]] = {}
        self._ready: set[DeferredMethod] = set()
        self._compile()

    def _compile(self) -> None:
        self._world = ScreenPass("world/world.frag", self.resident, Part.WORLD)
        self._lit = ScreenPass("lit/lit.frag", self.resident, Part.SURFACES)

    def update(self, scene: Scene) -> bool:
        """Upload what has changed; whether anything but the camera has: then every method must bake again."""
        changed = self.resident.update(scene)
        if changed:
            self._compile()
            self._dismiss(self._cast)
        return changed

    def assign(self, cast: Cast, progress: Progress = silent) -> None:
        """Let these draw from now on; a method that keeps its reflectors keeps what it baked."""
        self._dismiss([method for method, reflectors in self._cast.items() if cast.get(method) != reflectors])
        self._cast = dict(cast)
        self.resident.group(tuple(cast.values()))
        self.complete(progress)

    def complete(self, progress: Progress = silent) -> None:
        """Bake for the methods that have not baked yet, be it because an earlier call was stopped."""
        missing = [method for method in self._cast if method not in self._ready]
        for number, method in enumerate(missing):
            share = part_of(progress, number / len(missing), (number + 1) / len(missing))
            method.join(self, self._cast[method], share)
            self._ready.add(method)

    def _dismiss(self, methods: Iterable[DeferredMethod]) -> None:
        for method in self._ready.intersection(methods):
            self._ready.remove(method)
            method.free()

    def paint(self, view: View, canvas: Canvas, progress: Progress = silent) -> dict[str, float]:
        """See, light, reflect, once for each sample of the pixel; `time_ms` as of a `Frame`.

        A search that serves all samples belongs to the time of each picture. The first sample's is a warm-up, as all
        first times are: so that sample is drawn once more, and the reflections of later ones are not timed.
        """
        watch = Stopwatch()
        for _ in range(1 if view.samples == 1 else _TIMED):
            for group, method in self._drawing():
                with watch.stage((group, _PREPARATION)):
                    method.before_frame(view)
        canvas.clear()
        first, *others = _samples(view.samples)
        before = self._searched()
        progress("rendering", 0.0)
        self._paint_sample(view, canvas, watch, *first, timed=True)
        searched = self._searched() > before
        if searched and others:
            for _, method in self._drawing():
                method.forget()
            canvas.clear()
            self._paint_sample(view, canvas, watch, *first, timed=True)
        for number, sample in enumerate(others, 1):
            progress("rendering", number / (len(others) + 1))
            self._paint_sample(view, canvas, watch, *sample, timed=not searched)
        return self._times(watch.medians())

    def _searched(self) -> int:
        return sum(method.searched for _, method in self._drawing())

    def _drawing(self) -> list[tuple[int, DeferredMethod]]:
        """The methods that have baked, each with its group."""
        return [(group, method) for group, method in enumerate(self._cast) if method in self._ready]

    def reused(self, canvas: Canvas) -> Reuse | None:
        """What the one method among those that draw took over that takes over at all."""
        taken = [reuse for _, method in self._drawing() if (reuse := method.reused_on(canvas.visibility))]
        return taken[0] if len(taken) == 1 else None

    def _times(self, stages: dict[Hashable, float]) -> dict[str, float]:
        """`time_ms` of a `Frame`: each method's own time, if there are several, else its stages; and their sum."""
        methods: dict[str, float] = {}
        details: dict[str, float] = {}
        for group, method in self._drawing():
            own = {stage[1]: stages.pop(stage) for stage in list(stages) if stage[0] == group}
            methods[method.name] = methods.get(method.name, 0.0) + sum(own.values())
            details = {stage: time for stage, time in own.items() if stage not in _UNNAMED}
        reflection = sum(methods.values())
        shares = methods if len(methods) > 1 else details
        return {**stages, "reflection": reflection, **shares, "frame": sum(stages.values()) + reflection}

    def _paint_sample(
        self, view: View, canvas: Canvas, watch: Stopwatch, offset: tuple[float, float], weight: float, timed: bool
    ) -> None:
        target = canvas.picture if any(offset) else canvas.centre
        with watch.stage("visibility"):
            canvas.visibility.draw(self.resident, world_to_clip(view.camera, *canvas.size, offset))
            canvas.visibility.mark_parts(self.resident)
        with watch.stage("light"):
            self._light(view, canvas, offset=offset, weight=weight)
        for group, method in self._drawing():
            clock = partial(_stage_of, watch, group) if timed else nullcontext
            if group:
                with clock(_MARKING):
                    canvas.visibility.mark_parts(self.resident, group)
            method.reflect_in_stages(clock, view, canvas.visibility, target, offset=offset, weight=weight)

    def paint_mirrored(self, view: View, canvas: Canvas, offset: tuple[float, float]) -> None:
        """Wipe a canvas and draw one sample of what a mirrored camera sees through the view's opening."""
        canvas.keep_to(view.opening.bounds)
        canvas.clear()
        clip = world_to_clip(view.camera, *canvas.size, offset)
        canvas.visibility.draw_through(self.resident, clip, view.opening)
        canvas.visibility.mark_parts(self.resident)
        self._light(view, canvas, offset=offset)
        if view.mirrored <= self.resident.scene.glossy_bounces:
            for group, method in self._drawing():
                if group:
                    canvas.visibility.mark_parts(self.resident, group)
                method.reflect(view, canvas.visibility, canvas.centre, offset=offset, weight=1.0)

    def _light(self, view: View, canvas: Canvas, **sample) -> None:
        for drawn in (self._world, self._lit):
            drawn.draw(view.camera, canvas.visibility, canvas.light, **sample)

    def release(self) -> None:
        """Give the GPU memory back."""
        self._dismiss(self._cast)
        self.resident.release()


def _stage_of(watch: Stopwatch, group: int, name: str) -> AbstractContextManager:
    return watch.stage((group, name))


def _samples(side: int) -> list[tuple[tuple[float, float], float]]:
    """Offsets from the pixel's centre, in pixels, and weights; the centre comes first, if with no weight."""
    steps = [(index + 0.5) / side - 0.5 for index in range(side)]
    around = [((x, y), 1.0 / side**2) for y in steps for x in steps if x or y]
    return [((0.0, 0.0), (side % 2) / side**2), *around]
