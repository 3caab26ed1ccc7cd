"""What a key frame keeps of its mirrored rays."""

from dataclasses import dataclass

import moderngl
import numpy as np

from ...drawing import camera_uniforms, world_to_clip
from ...gl import clear, read_back, require, set_uniforms
from ...scene import Scene
from ..contract import View

UNITS = 2
"""Texture units that the buffers take."""

PIXEL_BYTES = 48
"""What a pixel takes of memory."""


@dataclass(frozen=True, eq=False)
class Sample:
    """One sample of a picture: a view, `offset` from the middles of the pixels, in pixels."""

    view: View
    offset: tuple[float, float]


class ReflectionBuffers:
    """The reflection buffers of one sample of a picture (Xie et al., 3.1). Lives on the GL thread.

    As gpu_shaders/reprojection/kept.glsl writes them: `geometry` holds the mirror's normal, the metres from the camera
    and to what is met, and which instance it is; `light` the radiance that arrives there and the metres that it came;
    `met` names the triangles where it came from. They are of `sample` and of `scene`, None while they are empty;
    `age` counts the pictures that took over from them.
    """

    def __init__(self, size: tuple[int, int], parts: moderngl.Renderbuffer | None = None) -> None:
        """Make room for a picture of `size`; `parts` as of `Visibility`, which spares passes all other pixels."""
        context = require()
        self.light = context.texture(size, 4, dtype="f4")
        self.geometry, self.met = (context.texture(size, 4, dtype="u4") for _ in range(2))
        self.geometry.filter = self.met.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.target = context.framebuffer([self.geometry, self.light, self.met], parts)
        self.target.depth_mask = False
        self.sample: Sample | None = None
        self.scene: Scene | None = None
        self.age = 0

    def begin(self, sample: Sample, scene: Scene) -> moderngl.Framebuffer:
        """Wipe everything, to be filled anew; what to draw it into."""
        self.sample, self.scene, self.age = sample, scene, 0
        clear(self.target)
        return self.target

    def bind(self, shader: moderngl.Program, unit: int) -> None:
        """Have a shader read them as gpu_shaders/reprojection/buffers.glsl does, from texture unit `unit` on."""
        textures = {"known_geometry": self.geometry, "known_met": self.met}
        for place, texture in enumerate(textures.values(), unit):
            texture.use(place)
        size = self.geometry.size
        clip = world_to_clip(self.sample.view.camera, *size, self.sample.offset)
        uniforms = {
            **{name: place for place, name in enumerate(textures, unit)},
            **known_camera(self.sample, size),
            "known_world_to_clip": tuple(clip.T.ravel()),
        }
        set_uniforms(shader, uniforms)

    def mask(self) -> np.ndarray:
        """(H, W) bool, row 0 at the bottom: the pixels that mirror."""
        texels = np.frombuffer(read_back(self.geometry), np.uint32).reshape(*self.geometry.size[::-1], 4)
        return texels[..., 3] > 0

    def release(self) -> None:
        """Give the memory back."""
        for part in (self.target, self.geometry, self.light, self.met):
            part.release()


def known_camera(sample: Sample, size: tuple[int, int]) -> dict[str, object]:
    """The uniforms that tell the rays of an earlier picture of `size` pixels; see gpu_shaders/common/camera.glsl."""
    placing = camera_uniforms(sample.view.camera, *size, sample.offset)
    return {
        "known_camera_to_world": placing["camera_to_world"],
        "known_window": placing["window"],
        "known_orthographic": placing["orthographic"],
    }
