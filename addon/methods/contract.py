"""What a real-time method is, and what it gives."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..drawing import Canvas, Opening
from ..gl import on_gl_thread
from ..parameters import Parameter, Value, resolve
from ..progress import Progress, silent
from ..scene import Camera, Instance, Lighting, Scene


@dataclass(frozen=True)
class View:
    """A picture to render: `width` × `height` pixels, `samples` per side of a pixel (4 is 16 a pixel, in a box).

    `mirrored` counts the mirrors that the camera has been put behind, `opening` is what it then looks through.
    """

    camera: Camera
    width: int
    height: int
    samples: int = 4
    mirrored: int = 0
    opening: Opening | None = None

    def shows_the_same(self, other: "View") -> bool:
        """Whether pictures of the two may be held against each other, pixel by pixel, whatever their samples."""
        a, b = self.camera, other.camera
        lenses = [(camera.lens, camera.shift, camera.ortho_scale, camera.pixel_aspect) for camera in (a, b)]
        sizes = [(view.width, view.height) for view in (self, other)]
        return sizes[0] == sizes[1] and lenses[0] == lenses[1] and np.array_equal(a.matrix, b.matrix)


@dataclass(frozen=True, eq=False)
class Reuse:
    """What a picture took over from an earlier one, the key frame.

    `retraced` (H, W) bool, row 0 the top: its reflectors' pixels whose centre was traced anew; `share` of these
    reflectors' pixels that they are; `is_key`: the picture was traced whole, for those that follow.
    """

    retraced: np.ndarray
    share: float
    is_key: bool


@dataclass(eq=False)
class Frame:
    """A rendered picture; row 0 is the top.

    `color` (H, W, 3) float32 scene-linear radiance; `reflectors` (H, W) float32 in 0..1, the share
    of the pixel that shows a reflector; `distance` (H, W) float32 metres from the reflector to what
    the pixel's centre sees in it, infinite where that is the world, NaN off the reflectors;
    `time_ms` GPU milliseconds by stage for one sample a pixel, the median over the samples; "frame" is
    all of them, "reflection" what the reflections take of it. Where several methods draw, each has its share
    of "reflection" under its name; a method that draws alone may name stages of "reflection" besides. `reuse` is
    of a method that takes over from earlier pictures.
    """

    color: np.ndarray
    reflectors: np.ndarray
    distance: np.ndarray
    time_ms: dict[str, float] = field(default_factory=dict)
    reuse: Reuse | None = None


class Method(ABC):
    """A way to draw reflections in real time.

    A subclass's docstring gives source, parameters, outputs and *limitations*; `catoptric methods`
    and the manual print it. `source` names paper and section in one line; `takes_over` says that pictures are made
    of earlier ones, so that one alone says nothing of the method.
    """

    name: ClassVar[str]
    source: ClassVar[str]
    parameters: ClassVar[Sequence[Parameter]] = ()
    takes_over: ClassVar[bool] = False

    def __init__(self, settings: Mapping[str, Value] | None = None) -> None:
        """`settings` maps names of `parameters` to values; raises `UsageError` for one that is wrong."""
        self.settings = resolve(self.parameters, settings or {})
        self._canvas: Canvas | None = None  # kept from picture to picture, as what is known of them hangs on it

    @classmethod
    def applies_to(cls, scene: Scene, reflector: Instance, settings: Mapping[str, Value] | None = None) -> str | None:
        """None if the method can draw this reflector, else the reason, as a sentence a person can act on.

        `settings` as of the method; some say how much it takes.
        """
        return None

    @abstractmethod
    def prepare(self, scene: Scene, lighting: Lighting, progress: Progress = silent) -> None:
        """Bake what the scene needs; called once for a scene before any `render`."""

    @abstractmethod
    def update(self, scene: Scene, progress: Progress = silent) -> None:
        """Go on with another state of the scene; costs only what has changed.

        What is the same object in memory, a mesh or an image, is taken to be unchanged.
        """

    @abstractmethod
    def paint(self, view: View, canvas: Canvas, progress: Progress = silent) -> dict[str, float]:
        """Draw the prepared scene on a canvas of the view's size, on the GL thread; `time_ms` as of a `Frame`."""

    @on_gl_thread
    def render(self, view: View, progress: Progress = silent) -> Frame:
        """The picture of the prepared scene, `view.samples` squared samples a pixel."""
        if self._canvas is None or self._canvas.size != (view.width, view.height):
            self._drop_canvas()
            self._canvas = Canvas(view.width, view.height)
        time_ms = self.paint(view, self._canvas, progress)
        return Frame(*self._canvas.read(), time_ms, self.reused(self._canvas))

    def reused(self, canvas: Canvas) -> Reuse | None:
        """What the picture just painted on a canvas took over from earlier ones; on the GL thread."""
        return None

    @on_gl_thread
    def release(self) -> None:
        """Give back the GPU memory that the method took."""
        self._drop_canvas()

    def _drop_canvas(self) -> None:
        if self._canvas is not None:
            self._canvas.release()
            self._canvas = None
