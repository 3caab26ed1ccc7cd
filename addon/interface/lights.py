"""Light that Cycles has baked: where it is kept, and how viewports get it.

It is kept under a key of all that it depends on, so that a file finds it under any name. The scene remembers the
key of its last light, which a change makes stale, but not lost.
"""

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
_VERSION = 1
"""Goes up when the same scene is lit otherwise."""

_POLL = 0.1


@dataclass(frozen=True, eq=False)
class Light:
    """A scene as it was lit, how things stood when it was, its bytes on disk, and when it was made; its key."""

    key: str
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


def known(scene: bpy.types.Scene) -> Light | None:
    """The light of a scene, fresh or stale; None if there is none, or as long as it is being read."""
    return _lights.get(scene.session_uid)


def missing(scene: bpy.types.Scene) -> bool:
    """Whether it was looked for, and there is none."""
    return scene.session_uid in _lights and _lights[scene.session_uid] is None


def shown(bpy_scene: bpy.types.Scene, scene: Scene, wait: bool = False) -> tuple[Scene, Lighting]:
    """`scene`, just extracted, with what baked light there is, and the light to show it in.

    Where baked light is asked for and there is none yet, lamps stand in for it. With `wait`, light that is
    being read counts as well; passes on the `CatoptricError` that reading it raises.
    """
    lighting = Lighting(bpy_scene.catoptric.lighting)
    if lighting is not Lighting.CYCLES:
        return scene, lighting
    uid = bpy_scene.session_uid
    if uid not in _lights and uid not in _loading:
        _loading[uid] = _reader.submit(_find, scene, bpy_scene.catoptric.light)
        _wake()
    light = _loading[uid].result() if wait and uid in _loading else known(bpy_scene)
    if light is None:
        return scene, Lighting.DIRECT
    _keys.sweep(scene)
    meshes = _keys.of(scene.meshes)
    fitting = {one.name for one in scene.instances if light.before.meshes.get(one.name) == meshes[one.mesh]}
    return dressed(scene, light.scene, fitting), lighting


def keep(uid: int, archive: Path, read: Scene) -> None:
    """Take in the light that was baked into `archive` while the scene stood as `read`; it is there soon."""
    content = archive.read_bytes()
    _lights.pop(uid, None)
    _loading[uid] = _reader.submit(_write, content, read)
    _wake()


def forget(scene: bpy.types.Scene) -> None:
    """Remove a scene's light."""
    light = known(scene)
    if light is not None:
        Cache().remove(_KIND, light.key)
    _lights[scene.session_uid] = None
    _remember(scene.session_uid, "")


def busy() -> bool:
    """Whether any is being read or written."""
    return bool(_loading)


def _write(content: bytes, read: Scene) -> Light | None:
    stood = standing(read, Keys())
    key = key_of(_VERSION, stood)
    Cache().put(_KIND, key, {"archive": np.frombuffer(content, np.uint8)}, {"standing": asdict(stood)})
    return _read(key)


def _find(scene: Scene, remembered: str) -> Light | None:
    """The light of a scene that stands like this one, else the one that it remembers."""
    return _read(key_of(_VERSION, standing(scene, Keys()))) or (_read(remembered) if remembered else None)


def _read(key: str) -> Light | None:
    cache = Cache()
    kept, entry = cache.look(_KIND, key), cache.get(_KIND, key)
    if kept is None or entry is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        archive = Path(folder, f"light{EXTENSION}")
        archive.write_bytes(entry.arrays["archive"])
        scene = load(archive)
    return Light(key, scene, Standing(**entry.meta["standing"]), kept.size, kept.written)


def _remember(uid: int, key: str) -> None:
    """Have a scene keep the key of its light, in its file as well."""
    scene = next((scene for scene in bpy.data.scenes if scene.session_uid == uid), None)
    if scene is not None and scene.library is None and scene.catoptric.light != key:
        scene.catoptric.light = key


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
            light = _lights[uid] = future.result()
            if light is not None:
                _remember(uid, light.key)
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
