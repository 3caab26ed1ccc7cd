"""Cubes of what surrounds each reflector, captured from its centre."""

from collections.abc import Sequence

import moderngl
import numpy as np

from ..drawing import FREE_UNIT, Part, Resident, ScreenPass, Visibility, world_boxes, world_to_clip
from ..errors import MachineError
from ..gl import DataTexture, read_back, require
from ..progress import Progress, silent
from ..scene import Camera, Scene

_PASSES = (
    ("environment_map/sky.frag", Part.WORLD),
    ("lit/lit.frag", Part.SURFACES),
    ("environment_map/world_only.frag", Part.REFLECTORS),
)

_SENSOR = 36.0
_LEAST = 16


class EnvironmentCubes:
    """One cube for each of some reflectors: the world and every other object, seen from its centre.

    The faces +X −X +Y −Y +Z −Z of a reflector lie in a row of one texture, `size` texels each, with a
    border of one texel. A reflector leaves itself out; others mirror the world alone, so that no
    capture waits for another. Lives on the GL thread.
    """

    def __init__(
        self,
        resident: Resident,
        size: int,
        without: frozenset[int] = frozenset(),
        reflectors: Sequence[int] | None = None,
        progress: Progress = silent,
        empty: bool = False,
    ) -> None:
        """Make and capture the cubes of `reflectors`, a group of the resident's; all of them unless given.

        `size` shrinks where the GPU's textures end; instances `without` are left out. `empty` cubes are captured later.
        """
        context = require()
        self._resident = resident
        self._without = without
        self._reflectors = reflectors = resident.scene.reflectors if reflectors is None else tuple(reflectors)
        self.size = min(size, context.info["GL_MAX_TEXTURE_SIZE"] // max(6, len(reflectors)))
        if self.size < _LEAST:
            raise MachineError(f"{len(reflectors)} reflectors are more cubes than this GPU's textures hold: mark fewer")
        self._texture = context.texture((6 * self.size, max(1, len(reflectors)) * self.size), 4, dtype="f4")
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._target = context.framebuffer([self._texture])
        self._visibility = Visibility(self.size, self.size)
        self._passes = [ScreenPass(name, resident, part) for name, part in _PASSES]
        boxes = _boxes(resident.scene, reflectors)
        self._captures = DataTexture(boxes.reshape(-1, 4) if len(boxes) else np.zeros((1, 4), np.float32))
        self._cameras = [face_cameras(box[0, :3], boxes, self.size) for box in boxes]
        if not empty:
            self._begin(progress)

    def _begin(self, progress: Progress) -> None:
        try:
            self.capture(progress)
        except BaseException:  # it was stopped: nobody else knows of the cubes yet
            self.release()
            raise

    def capture(self, progress: Progress = silent) -> None:
        """Draw all cubes anew."""
        self._target.clear()
        for row, (reflector, cameras) in enumerate(zip(self._reflectors, self._cameras, strict=True)):
            progress("capturing environment cubes", row / len(self._reflectors))
            for column, camera in enumerate(cameras):
                self._capture_face(camera, self._without | {reflector}, (column * self.size, row * self.size))

    def _capture_face(self, camera: Camera, hidden: frozenset[int], corner: tuple[int, int]) -> None:
        self._visibility.draw(self._resident, world_to_clip(camera, self.size, self.size), hidden)
        for drawn in self._passes:
            drawn.draw(camera, self._visibility, self._target, corner=corner)

    def bind(self, shader: moderngl.Program) -> None:
        """Set what gpu_shaders/common/environment.glsl reads, on the two texture units after FREE_UNIT."""
        for unit, (name, texture) in enumerate({"environment": self._texture, "captures": self._captures}.items()):
            if name in shader:
                texture.use(FREE_UNIT + 1 + unit)
                shader[name] = FREE_UNIT + 1 + unit
        shader["environment_size"] = self.size

    def read(self) -> np.ndarray:
        """(reflectors, 6, size, size, 3) float32 radiance, row 0 of a face at the bottom."""
        height = self._texture.height
        texels = np.frombuffer(read_back(self._texture), np.float32)
        rows = texels.reshape(height // self.size, self.size, 6, self.size, 4)
        return rows.transpose(0, 2, 1, 3, 4)[..., :3]

    def release(self) -> None:
        """Give the memory back."""
        for part in (self._target, self._texture, self._visibility, self._captures):
            part.release()


def face_cameras(centre: np.ndarray, boxes: np.ndarray, size: int) -> list[Camera]:
    """The cameras of the faces +X −X +Y −Y +Z −Z at `centre` (3,), each wider than 90° by the border."""
    reach = float(np.linalg.norm(boxes[..., :3].reshape(-1, 3) - centre, axis=1).max())
    half_width = size / (size - 2)
    cameras = []
    for axis in range(3):
        for side in (1.0, -1.0):
            matrix = np.eye(4)
            matrix[:3, :3] = 0.0
            matrix[(axis + 1) % 3, 0] = -side
            matrix[(axis + 2) % 3, 1] = 1.0
            matrix[axis, 2] = -side
            matrix[:3, 3] = centre
            lens = 0.5 * _SENSOR / half_width
            cameras.append(Camera(matrix, lens, (_SENSOR, _SENSOR), near=1e-4 * reach, far=2.0 * reach))
    return cameras


def _boxes(scene: Scene, reflectors: Sequence[int]) -> np.ndarray:
    """(reflectors, 3, 4) float32: centre of each reflector, and low and high corner of the box around the rest."""
    around = world_boxes(scene, range(len(scene.instances)))
    rows = np.zeros((len(reflectors), 3, 4), np.float32)
    for row, reflector in zip(rows, reflectors, strict=True):
        rest = np.delete(around, reflector, axis=0) if len(around) > 1 else around
        row[0, :3] = around[reflector].mean(axis=0)
        row[1, :3] = np.minimum(rest[:, 0].min(axis=0), around[reflector, 0])
        row[2, :3] = np.maximum(rest[:, 1].max(axis=0), around[reflector, 1])
    return rows
