"""Passes over the pixels that nothing is known of, and no others."""

from enum import Enum

import moderngl
import numpy as np

from ...drawing import FREE_UNIT, Resident, Visibility, camera_uniforms
from ...gl import feedback, finish, primitive_counter, program, read_back, render, require, screen, set_uniforms, settle
from .buffers import ReflectionBuffers

_LIST = {"vertex_shader": "reprojection/missing.vert", "geometry_shader": "reprojection/missing.geom"}
_PIXEL_BYTES = 8

LISTED_UNIT = FREE_UNIT + 1


class Missing(Enum):
    """Up to what alpha light is missing, for which reason: as in gpu_shaders/reprojection/kept.glsl."""

    AGAIN = -1.0
    UNSEEN = -2.0
    ALL = -np.inf


class Gathering:
    """Pixels of a picture that lie side by side, wherever they come from. Lives on the GL thread.

    Shaders on gpu_shaders/reprojection/kept.glsl, compiled with LISTED of 1, then work on these alone.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        """Make room for all pixels of a picture of `size`."""
        self._size = size
        context = require()
        self._list = feedback(_LIST, ("pixel",))
        self._points = context.vertex_array(self._list, [])
        self._scatter = program("reprojection/scatter.vert", "reprojection/scatter.frag")
        self._pixels = context.buffer(reserve=_PIXEL_BYTES * size[0] * size[1])
        self._back = context.vertex_array(self._scatter, [(self._pixels, "2u4", "pixel")])
        self._names = context.texture(size, 2, dtype="u4")
        self._names.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._found = ReflectionBuffers(size)
        self.count = 0

    def gather(self, picture: ReflectionBuffers, missing: Missing = Missing.ALL) -> int:
        """List what is missing of a picture; how many pixels that is."""
        picture.light.use(LISTED_UNIT)
        self._list["lights"], self._list["least"] = LISTED_UNIT, missing.value
        settle()
        counted = primitive_counter()
        with counted:
            self._points.transform(self._pixels, moderngl.POINTS, vertices=self._size[0] * self._size[1])
        finish()
        self.count = counted.primitives
        if self.count:
            self._names.write(self._pixels, viewport=(0, 0, self._size[0], self._rows))
        return self.count

    @property
    def _rows(self) -> int:
        return -(-self.count // self._size[0])

    def listed(self) -> np.ndarray:
        """(N, 2) uint32 columns and rows, from the lower left, of the pixels listed last."""
        texels = read_back(self._pixels, size=_PIXEL_BYTES * self.count) if self.count else b""
        return np.frombuffer(texels, np.uint32).reshape(-1, 2)

    def fill(self, picture: ReflectionBuffers, shader: moderngl.Program, resident: Resident, seen: Visibility):
        """Have a shader fill what is listed of a picture of the resident scene."""
        if not self.count:
            return
        seen.texture.use(FREE_UNIT)
        self._names.use(LISTED_UNIT)
        resident.bind(shader)
        sample = picture.sample
        uniforms = {"visibility": FREE_UNIT, "listed": LISTED_UNIT, "count": self.count, "corner": (0, 0)}
        set_uniforms(shader, {**uniforms, **camera_uniforms(sample.view.camera, *self._size, sample.offset)})
        self._found.target.use()
        require().viewport = (0, 0, self._size[0], self._rows)
        require().enable_only(moderngl.NOTHING)
        settle()
        screen(shader).render(vertices=3)
        self._put_back(picture.target)

    def _put_back(self, target: moderngl.Framebuffer) -> None:
        textures = {"geometries": self._found.geometry, "lights": self._found.light, "mets": self._found.met}
        for unit, (name, texture) in enumerate(textures.items(), LISTED_UNIT):
            texture.use(unit)
            self._scatter[name] = unit
        self._scatter["size"] = self._size
        target.use()
        require().viewport = (0, 0, *self._size)
        require().enable_only(moderngl.PROGRAM_POINT_SIZE)
        settle()
        render(self._back, moderngl.POINTS, self.count)

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._found, self._names, self._back, self._pixels, self._points):
            part.release()
