"""Light that Cycles has baked: where it is kept, and how viewports get it."""

import tempfile
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import bpy
import numpy as np

from ..baking.light import Keys, Standing, dressed, standing
from ..cache import Cache, key_of
from ..errors import CatoptricError
from ..scene import Lighting, Scene
from ..scene.archive import EXTENSION, load
from . import work
from .leaving import forgetting_factory

_KIND = "light"
_POLL = 0.1


@dataclass(frozen=True, eq=False)
class Light:
    """A scene as it was lit, how things stood when it was, its bytes on disk, and when it was made."""

    scene: Scene
    before: Standing
    size: int
    written: float


_lights: dict[int, Light | None] = {}
_loading: dict[int, Future] = {}
_reader = ThreadPoolExecutor(1, thread_name_prefix="catoptric-light")
_keys = Keys()


def when_read() -> None:
    """Called whenever light was read; stages put themselves in its place."""


def key(scene: bpy.types.Scene) -> str:
    """What the light of a scene is kept under: its file's place, or this session as long as there is none."""
    return key_of(bpy.data.filepath or f"session {bpy.app.tempdir} {scene.session_uid}", scene.name)


def known(scene: bpy.types.Scene) -> Light | None:
    """The light of a scene, fresh or stale; None if there is none, or as long as it is being read."""
    uid = scene.session_uid
    if uid not in _lights and uid not in _loading:
        _loading[uid] = _reader.submit(_read, key(scene))
        _wake()
    return _lights.get(uid)


def shown(bpy_scene: bpy.types.Scene, scene: Scene, wait: bool = False) -> tuple[Scene, Lighting]:
    """`scene`, just extracted, with what baked light there is, and the light to show it in.

    Where baked light is asked for and there is none yet, lamps stand in for it. With `wait`, light that is
    being read counts as well; passes on the `CatoptricError` that reading it raises.
    """
    lighting = Lighting(bpy_scene.catoptric.lighting)
    if lighting is not Lighting.CYCLES:
        return scene, lighting
    light = known(bpy_scene)
    reading = _loading.get(bpy_scene.session_uid)
    if wait and reading is not None:
        light = reading.result()
    if light is None:
        return scene, Lighting.DIRECT
    _keys.sweep(scene)
    meshes = _keys.of(scene.meshes)
    fitting = {one.name for one in scene.instances if light.before.meshes.get(one.name) == meshes[one.mesh]}
    return dressed(scene, light.scene, fitting), lighting


def keep(uid: int, kept_as: str, archive: Path, read: Scene) -> None:
    """Take in the light that was baked into `archive` while the scene stood as `read`; it is there soon."""
    content = archive.read_bytes()
    _lights.pop(uid, None)
    _loading[uid] = _reader.submit(_write, kept_as, content, read)
    _wake()


def forget(scene: bpy.types.Scene) -> None:
    """Remove a scene's light."""
    Cache().remove(_KIND, key(scene))
    _lights[scene.session_uid] = None


def busy() -> bool:
    """Whether any is being read or written."""
    return bool(_loading)


def _write(kept_as: str, content: bytes, read: Scene) -> Light:
    meta = {"standing": asdict(standing(read, Keys()))}
    Cache().put(_KIND, kept_as, {"archive": np.frombuffer(content, np.uint8)}, meta)
    return _read(kept_as)


def _read(kept_as: str) -> Light | None:
    cache = Cache()
    kept, entry = cache.look(_KIND, kept_as), cache.get(_KIND, kept_as)
    if kept is None or entry is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        archive = Path(folder, f"light{EXTENSION}")
        archive.write_bytes(entry.arrays["archive"])
        scene = load(archive)
    return Light(scene, Standing(**entry.meta["standing"]), kept.size, kept.written)


def _wake() -> None:
    if not bpy.app.timers.is_registered(poll):
        bpy.app.timers.register(poll, first_interval=_POLL)


def poll() -> float | None:
    """A timer of Blender's: take in what has been read, and have the scenes drawn with it."""
    for uid, future in list(_loading.items()):
        if not future.done():
            continue
        del _loading[uid]
        try:
            _lights[uid] = future.result()
        except CatoptricError as problem:
            _lights[uid] = None
            work.tell(str(problem))
        when_read()
        work.redraw_panels()
    return _POLL if _loading else None


def wait(seconds: float = 60.0) -> None:
    """Until nothing is being read, where there is no window to keep alive."""
    end = time.monotonic() + seconds
    while _loading and time.monotonic() < end:
        time.sleep(0.01)
        poll()


def _forget_all() -> None:
    _lights.clear()
    _loading.clear()


register, unregister = forgetting_factory(_forget_all, poll)
