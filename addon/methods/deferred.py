"""The frame that every method shares: see, light, then add the reflections."""

from abc import abstractmethod
from typing import ClassVar

import moderngl

from ..drawing import Canvas, Part, Resident, ScreenPass, world_to_clip
from ..gl import Stopwatch, on_gl_thread
from ..progress import Progress, silent
from ..scene import Lighting, Scene
from .contract import Method, View

_TIMED = 3
"""How often what a frame prepares is timed, where a picture has several samples."""


class DeferredMethod(Method):
    """A method whose reflections are one full-screen pass, a shader that defines `mirrored_light`.

    A subclass names the shader's file and binds what it reads besides the scene.
    """

    shader: ClassVar[str]

    @on_gl_thread
    def prepare(self, scene: Scene, lighting: Lighting, progress: Progress = silent) -> None:
        """Upload the scene, compile the shaders, bake what the method needs."""
        self.scene = scene
        self.resident = Resident(scene, lighting)
        self._compile()
        self.bake(progress)

    def _compile(self) -> None:
        self._world = ScreenPass("world/world.frag", self.resident, Part.WORLD)
        self._lit = ScreenPass("lit/lit.frag", self.resident, Part.SURFACES)
        self._reflection = ScreenPass(self.shader, self.resident, Part.REFLECTORS)

    def bake(self, progress: Progress) -> None:
        """Bake what the reflections need; on the GL thread, with `self.resident` at hand."""

    @abstractmethod
    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """Set the uniforms and textures (from unit FREE_UNIT + 1 on) of the reflection pass."""

    def before_frame(self, view: View) -> None:
        """What the method draws anew for every frame, before the reflections; counted in their time."""

    @on_gl_thread
    def update(self, scene: Scene, progress: Progress = silent) -> None:
        """Upload what has changed; bake again unless nothing but the camera has."""
        self.scene = scene
        if self.resident.update(scene):
            self._compile()
            self.free()
            self.bake(progress)

    @on_gl_thread
    def paint(self, view: View, canvas: Canvas, progress: Progress = silent) -> dict[str, float]:
        """See, light, reflect, once for each sample of the pixel."""
        watch = Stopwatch()
        for _ in range(1 if view.samples == 1 else _TIMED):
            with watch.stage("preparation"):
                self.before_frame(view)
        canvas.clear()
        for number, (offset, weight) in enumerate(samples := _samples(view.samples)):
            progress("rendering", number / len(samples))
            self._paint_sample(view, canvas, watch, offset, weight)
        time_ms = watch.medians()
        reflection = time_ms.pop("preparation") + time_ms.pop("reflection")
        return {**time_ms, "reflection": reflection, "frame": sum(time_ms.values()) + reflection}

    def _paint_sample(self, view: View, canvas: Canvas, watch: Stopwatch, offset, weight: float) -> None:
        seen, target = canvas.visibility, canvas.picture if any(offset) else canvas.centre
        with watch.stage("visibility"):
            seen.draw(self.resident, world_to_clip(view.camera, *canvas.size, offset))
            seen.mark_parts(self.resident)
        with watch.stage("light"):
            for drawn in (self._world, self._lit):
                drawn.draw(view.camera, seen, canvas.picture, offset=offset, weight=weight)
        with watch.stage("reflection"):
            self.bind_reflection(self._reflection.shader, view)
            self._reflection.draw(view.camera, seen, target, offset=offset, weight=weight)

    def free(self) -> None:
        """Give back what `bake` took; on the GL thread."""

    @on_gl_thread
    def release(self) -> None:
        """Give the GPU memory back."""
        self.free()
        self.resident.release()


def _samples(side: int) -> list[tuple[tuple[float, float], float]]:
    """Offsets from the pixel's centre, in pixels, and weights; the centre is always there, if with no weight."""
    steps = [(index + 0.5) / side - 0.5 for index in range(side)]
    samples = [((x, y), 1.0 / side**2) for y in steps for x in steps]
    return samples if side % 2 else [((0.0, 0.0), 0.0), *samples]
