"""The frame that every method shares: see, light, then add the reflections."""

from abc import abstractmethod
from typing import ClassVar

import moderngl
import numpy as np

from ..drawing import Part, Resident, ScreenPass, Visibility, world_to_clip
from ..errors import MachineError, UsageError
from ..gl import median_ms, on_gl_thread, require
from ..progress import Progress, silent
from ..scene import Lighting, Scene
from .contract import Frame, Method, View

_TIMED_FRAMES = 5


class DeferredMethod(Method):
    """A method whose reflections are one full-screen pass, a shader that defines `mirrored_light`.

    A subclass names the shader's file and binds what it reads besides the scene.
    """

    shader: ClassVar[str]

    @on_gl_thread
    def prepare(self, scene: Scene, lighting: Lighting, progress: Progress = silent) -> None:
        """Upload the scene, bake what the method needs, compile its shader."""
        self.scene = scene
        self.resident = Resident(scene, lighting)
        self.bake(progress)
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
    def render(self, view: View, progress: Progress = silent) -> Frame:
        """The picture, `view.samples` squared samples a pixel; times are of one sample a pixel."""
        _check_size(view)
        size = (view.width, view.height)
        visibility = Visibility(*size)
        sums, once = (require().texture(size, 4, dtype="f4") for _ in range(2))
        distance = require().texture(size, 1, dtype="f4")
        picture = require().framebuffer([sums], visibility.parts)
        probe = require().framebuffer([once, distance], visibility.parts)
        picture.depth_mask = probe.depth_mask = False  # neither a pass nor a clear may wipe the parts
        try:
            progress("timing", 0.0)
            time_ms = self._time(view, visibility, picture)
            probe.clear(np.nan, np.nan, np.nan, np.nan)
            self._reflect(view, visibility, probe, blend=False)
            picture.clear()
            side = view.samples
            for index in range(side * side):
                progress("rendering", index / side**2)
                offset = ((index % side + 0.5) / side - 0.5, (index // side + 0.5) / side - 0.5)
                self._see(view, visibility, picture, offset=offset, weight=1.0 / side**2)
                self._reflect(view, visibility, picture, offset=offset, weight=1.0 / side**2)
            return _frame(picture, probe, time_ms)
        finally:
            for part in (picture, probe, sums, once, distance, visibility):
                part.release()

    def _time(self, view: View, visibility: Visibility, target: moderngl.Framebuffer) -> dict[str, float]:
        def reflect() -> None:
            self.before_frame(view)
            self._reflect(view, visibility, target)

        scene = median_ms(lambda: self._see(view, visibility, target), _TIMED_FRAMES)
        reflection = median_ms(reflect, _TIMED_FRAMES)
        return {"reflection": reflection, "frame": scene + reflection}

    def _see(self, view, visibility, target, offset=(0.0, 0.0), weight=1.0) -> None:
        """The scene without reflections."""
        visibility.draw(self.resident, world_to_clip(view.camera, view.width, view.height, offset))
        visibility.mark_parts(self.resident)
        for drawn in (self._world, self._lit):
            drawn.draw(view.camera, visibility, target, offset=offset, weight=weight)

    def _reflect(self, view, visibility, target, **sample) -> None:
        self.bind_reflection(self._reflection.shader, view)
        self._reflection.draw(view.camera, visibility, target, **sample)

    def free(self) -> None:
        """Give back what `bake` took; on the GL thread."""

    @on_gl_thread
    def release(self) -> None:
        """Give the GPU memory back."""
        self.free()
        self.resident.release()


def _check_size(view: View) -> None:
    limit = require().info["GL_MAX_TEXTURE_SIZE"]
    if min(view.width, view.height) < 1:
        raise UsageError(f"a picture of {view.width}×{view.height} pixels: give a width and height of at least 1")
    if max(view.width, view.height) > limit:
        raise MachineError(f"a picture of {view.width}×{view.height} pixels: this GPU draws at most {limit} a side")


def _frame(accumulated: moderngl.Framebuffer, probe: moderngl.Framebuffer, time_ms: dict[str, float]) -> Frame:
    width, height = accumulated.size
    sums = np.frombuffer(accumulated.read(components=4, dtype="f4"), np.float32).reshape(height, width, 4)
    distance = np.frombuffer(probe.read(components=1, attachment=1, dtype="f4"), np.float32).reshape(height, width)
    distance = np.where(distance > 1e29, np.inf, distance)
    return Frame(sums[::-1, :, :3].copy(), sums[::-1, :, 3].copy(), distance[::-1].copy(), time_ms)
