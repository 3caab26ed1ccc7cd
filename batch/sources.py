"""SCENE on the command line: a .blend file, an exported archive, or the name of a demonstration scene."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from ..addon.errors import SceneError, UsageError
from ..addon.progress import Progress, silent
from ..addon.scene import Scene
from ..addon.scene.archive import EXTENSION, load
from ..addon.scene.soundness import sound
from ..scenes import SCENES, path_of


@dataclass(frozen=True)
class Archive:
    """A scene that was exported: one frame, no Blender."""

    path: Path

    needs_blender = False

    @property
    def name(self) -> str:
        """The file's name without its ending."""
        return self.path.stem

    @cached_property
    def _scene(self) -> Scene:
        return sound(load(self.path))

    @property
    def frame(self) -> int:
        """The frame that was exported."""
        return self._scene.frame

    @property
    def span(self) -> tuple[int, int]:
        """The first and the last frame."""
        return self.frame, self.frame

    def scene(self, frame: int | None = None, progress: Progress = silent, before: Scene | None = None) -> Scene:
        """The scene; raises `SceneError` for a frame that the archive does not hold."""
        if frame not in (None, self._scene.frame):
            raise SceneError(f"{self.path.name} holds frame {self._scene.frame} alone; export frame {frame} as well")
        return self._scene


@dataclass(frozen=True)
class BlendFile:
    """A .blend file. It is open in Blender after `open`, one at a time."""

    path: Path

    needs_blender = True

    @property
    def name(self) -> str:
        """The file's name without its ending."""
        return self.path.stem

    @cached_property
    def bpy_scene(self):
        """The file's active `bpy.types.Scene`; opens the file."""
        from ..addon.blender.files import open_blend

        return open_blend(self.path)

    @property
    def frame(self) -> int:
        """The frame the file was saved at."""
        return self.bpy_scene.frame_current

    @property
    def span(self) -> tuple[int, int]:
        """The first and the last frame of its timeline."""
        return self.bpy_scene.frame_start, self.bpy_scene.frame_end

    def scene(self, frame: int | None = None, progress: Progress = silent, before: Scene | None = None) -> Scene:
        """What Blender shows at `frame`, the file's own if None; the open file stays at that frame.

        What is as in `before`, the scene at the frame that was asked for last, is the same object.
        """
        from ..addon.blender.extract_frames import extract_at

        return extract_at(self.bpy_scene, self.frame if frame is None else frame, before, progress)


Source = Archive | BlendFile

_KINDS: dict[str, Callable[[Path], Source]] = {".blend": BlendFile, EXTENSION: Archive}


def locate(text: str) -> Source:
    """The source that `text` names; raises `UsageError` where there is none. Opens nothing yet."""
    if text in SCENES:
        return BlendFile(path_of(text))
    path = Path(text).expanduser()
    kind = _KINDS.get(path.suffix.lower())
    if kind is None:
        raise UsageError(f"{text}: neither a .blend file, nor a {EXTENSION} archive, nor one of {', '.join(SCENES)}")
    if not path.is_file():
        raise UsageError(f"{path}: there is no such file")
    return kind(path)
