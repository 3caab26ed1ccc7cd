"""From the command line to a window or a film."""

import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from ...addon.errors import SceneError, UsageError
from ...addon.gl import call
from ...addon.parameters import Value
from ...addon.scene import Lighting, Scene
from ...addon.scene.archive import EXTENSION
from ..footage import require_reflectors
from ..machine import check_size
from ..progress import Terminal
from ..sources import Archive, Source
from .darkroom import film
from .look import Look
from .path import CameraPath
from .prepared import Choice, Prepared
from .views import STANDARD, names
from .watch import Watch

_SCREEN = 1280, 720
"""What a window is fitted into that nobody gave a size."""

_EXPORT = "import sys; from {package}.batch.cli import main; sys.exit(main(sys.argv[1:]))"


@dataclass(frozen=True)
class Wishes:
    """What is to be shown. `settings` holds every method's values; None for `versus`: one picture alone.

    Raises `UsageError` for a `view` that there is not; None is the scene's own.
    """

    method: str
    versus: str | None
    settings: Mapping[str, Mapping[str, Value]]
    lighting: Lighting
    resolution: tuple[int, int] | None = None
    frame: int | None = None
    view: str | None = None

    def __post_init__(self) -> None:
        if self.view is not None and self.view not in names():
            raise UsageError(f"--view: no view transform {self.view!r}; there are: {', '.join(names())}")

    def look(self, scene: Scene) -> Look:
        """The look to begin with: by the view transform that was asked for, or the scene's own where it is known."""
        left, right = (
            Choice.of(name, self.settings[name], self.lighting) if name else None for name in (self.method, self.versus)
        )
        own = scene.view if scene.view in names() else STANDARD
        return Look(left, right, exposure=scene.exposure, view=self.view or own)


def show(source: Source, wishes: Wishes, stem: Path, path: CameraPath | None, rate: int) -> None:
    """Open a window on the scene, and return once it is closed. Files are written as `stem` with a number."""
    from .window import Preview, Session, open_window  # only here is there a screen

    watch = Watch(source.path, lambda: _scene(replace(source), wishes))  # another source: one remembers what it read
    scene = _scene(source, wishes)
    window = open_window(f"{source.name} – Catoptric", wishes.resolution or _fitted(scene.resolution))
    Preview(window, Session(scene, wishes.look(scene), wishes.settings, stem, path, rate), watch).run()


def shoot(source: Source, wishes: Wishes, path: CameraPath, rate: int, out: Path, terminal: Terminal) -> None:
    """Write a film of the flight along `path`, without a window."""
    scene = _scene(source, wishes)
    size = wishes.resolution or scene.resolution
    check_size(*size)
    bar = terminal.bar(source.name)
    prepared = Prepared(scene)
    try:
        film(prepared, wishes.look(scene), scene.camera, path, size, rate, out, bar.step("film", 0.0, 1.0))
    finally:
        call(prepared.release)
    bar.finish()
    terminal.say(str(out))


def _scene(source: Source, wishes: Wishes) -> Scene:
    """The scene; a .blend file's by way of an archive, so that Blender and a window never share a process."""
    with tempfile.TemporaryDirectory() as folder:
        if source.needs_blender:
            source = _exported(source, wishes, Path(folder))
        scene = source.scene(wishes.frame)
    require_reflectors(scene)
    if wishes.lighting is Lighting.CYCLES and not any(instance.lightmap is not None for instance in scene.instances):
        raise SceneError(f"{source.name} holds no lightmaps: export it with --lighting cycles")
    return scene


def _exported(source: Source, wishes: Wishes, folder: Path) -> Archive:
    """What another process makes of a .blend file. It says itself what goes wrong."""
    archive = folder / f"{source.name}{EXTENSION}"
    command = ["export", str(source.path), "--out", str(archive), "--lighting", wishes.lighting]
    if wishes.frame is not None:
        command += ["--frame", str(wishes.frame)]
    program = _EXPORT.format(package=__package__.removesuffix(".batch.preview"))
    done = subprocess.run([sys.executable, "-c", program, *command], stdout=subprocess.DEVNULL)
    if done.returncode:
        raise SceneError(f"{source.name} could not be read, for the reason above")
    return Archive(archive)


def _fitted(resolution: tuple[int, int]) -> tuple[int, int]:
    """As large as fits a screen, in the proportions of the scene's pictures."""
    scale = min(most / side for most, side in zip(_SCREEN, resolution, strict=True))
    return tuple(max(1, round(side * scale)) for side in resolution)
