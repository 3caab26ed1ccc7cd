"""What is baked and kept on disk for the objects of a scene, found out on a thread of its own."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import bpy

from ..baking.layered_depth import KIND, LAYERS, RESOLUTION, face_shapes
from ..baking.layered_depth_keys import keys_of
from ..baking.layered_depth_tables import fitting_resolution
from ..baking.light import Keys, Standing, changes, standing
from ..baking.surroundings import surroundings
from ..cache import Cache
from ..methods.layered_depth_published import MEMORY, LayeredDepthPublished
from ..scene import Lighting, Scene
from . import lights, stages, work
from .leaving import forgetting_factory

_POLL = 0.1
_BYTES_A_LAYER = 64
_LAYERS_GUESSED = 2


FRESH, STALE, MISSING = "fresh", "stale", "missing"


@dataclass(frozen=True)
class State:
    """How the bake of `name` stands (FRESH, STALE or MISSING), and why; its bytes on disk, and when it was made."""

    name: str
    kind: str
    why: str = ""
    size: int = 0
    written: float = 0.0


@dataclass(frozen=True)
class Settings:
    """What a bake depends on beside the scene."""

    lighting: Lighting
    resolution: int
    layers: int


@dataclass(frozen=True, eq=False)
class Account:
    """How all bakes of a scene stand. `light` is None where the light setting bakes none.

    By object's name, `instances` are those that share its bake, `kept` the keys it may lie under. `resolution` is
    the one that fits in memory, `memory` a guess of what the bakes take of it, in bytes.
    """

    scene: Scene
    settings: Settings
    light: State | None
    objects: tuple[State, ...]
    instances: dict[str, frozenset[int]]
    kept: dict[str, tuple[str, ...]]
    resolution: int
    memory: int

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return sum(state.size for state in (*self.objects, *([self.light] if self.light else ())))


_worker = ThreadPoolExecutor(1, thread_name_prefix="catoptric-bakes")
_accounts: dict[int, Account] = {}
_pending: dict[int, Future] = {}
_seen: dict[tuple[int, str], tuple[str, Settings, Standing]] = {}
"""By scene and object: key and circumstances of the last bake that was fresh."""
_keys = Keys()


def settings_of(scene: bpy.types.Scene) -> Settings:
    """As the scene's settings have it."""
    values = scene.catoptric.methods.values(LayeredDepthPublished.name)
    return Settings(Lighting(scene.catoptric.lighting), values[RESOLUTION.name], values[LAYERS.name])


def account_of(scene: bpy.types.Scene, stage: stages.Stage) -> Account | None:
    """The newest account; a newer one is asked for where things have changed since."""
    uid = scene.session_uid
    account, settings = _accounts.get(uid), settings_of(scene)
    if stage.shown is not None and uid not in _pending and not _is_of(account, stage.shown, settings):
        memory = scene.catoptric.methods.values(LayeredDepthPublished.name)[MEMORY.name]
        light = lights.known(scene) if settings.lighting is Lighting.CYCLES else None
        _pending[uid] = _worker.submit(_account, uid, stage.found, stage.shown, settings, memory, light)
        if not bpy.app.timers.is_registered(poll):
            bpy.app.timers.register(poll, first_interval=_POLL)
    return account


def forget_account(uid: int) -> None:
    """Have the bakes looked at again."""
    _accounts.pop(uid, None)


def poll() -> float | None:
    """A timer of Blender's: take in the accounts that are done."""
    for uid, future in list(_pending.items()):
        if future.done():
            del _pending[uid]
            _accounts[uid] = future.result()
            work.redraw_panels()
    return _POLL if _pending else None


def wait_for(scene: bpy.types.Scene, stage: stages.Stage) -> Account:
    """The account of things as they are; stays until it is there."""
    while not _is_of(account := account_of(scene, stage), stage.shown, settings_of(scene)):
        if scene.session_uid in _pending:
            _pending[scene.session_uid].exception()
        poll()
    return account


def _is_of(account: Account | None, scene: Scene, settings: Settings) -> bool:
    return account is not None and account.scene is scene and account.settings == settings


def _account(uid: int, found: Scene, shown: Scene, settings: Settings, memory: int, light: object) -> Account:
    """On the worker."""
    _keys.sweep(found)
    now = standing(found, _keys)
    unsearched = without(shown)
    resolution = fitting_resolution(shown, settings.resolution, memory, unsearched)
    keys = keys_of(shown, settings.lighting, resolution, settings.layers)
    groups: dict[str, list[int]] = {}
    for index, key in enumerate(keys):
        if key is not None and index not in unsearched:
            groups.setdefault(key, []).append(index)
    named = {shown.instances[indices[0]].name: (key, frozenset(indices)) for key, indices in groups.items()}
    states = [_state(uid, name, key, settings, now) for name, (key, _) in named.items()]
    return Account(
        shown,
        settings,
        _light_state(light, now) if settings.lighting is Lighting.CYCLES else None,
        tuple(states),
        {name: indices for name, (_, indices) in named.items()},
        {name: tuple({key, _seen[uid, name][0] if (uid, name) in _seen else key}) for name, (key, _) in named.items()},
        resolution,
        sum(_memory(shown, min(indices), resolution) for _, indices in named.values()),
    )


def without(scene: Scene) -> frozenset[int]:
    """Instances that need no layered depth textures: what stands around a reflector, and a reflector alone."""
    reflectors = scene.reflectors
    return surroundings(scene) | frozenset(reflectors if len(reflectors) == 1 else ())


def _state(uid: int, name: str, key: str, settings: Settings, now: Standing) -> State:
    kept = Cache().look(KIND, key)
    if kept:
        _seen[uid, name] = key, settings, now
        return State(name, FRESH, "", *kept)
    if (uid, name) not in _seen:
        return State(name, MISSING)
    old, before, then = _seen[uid, name]
    left = Cache().look(KIND, old)
    if left is None or old == key:
        return State(name, MISSING, "cleared")
    return State(name, STALE, _why(name, before, settings, then, now), *left)


def _why(name: str, before: Settings, settings: Settings, then: Standing, now: Standing) -> str:
    if before.lighting != settings.lighting:
        return "another light was chosen"
    if before != settings:
        return "the settings have changed"
    phrases = changes(then, now)
    own = [phrase for phrase in phrases if phrase.startswith(f'"{name}"')]
    return (own or phrases or ["the light has changed"])[0]


def _light_state(light: lights.Light | None, now: Standing) -> State:
    if light is None:
        return State("Light", MISSING, "never baked")
    phrases = changes(light.before, now)
    kind = STALE if phrases else FRESH
    return State("Light", kind, "; ".join(phrases[:2]), light.size, light.written)


def _memory(scene: Scene, index: int, resolution: int) -> int:
    shapes = face_shapes(scene.meshes[scene.instances[index].mesh], resolution)[2]
    return _BYTES_A_LAYER * _LAYERS_GUESSED * sum(columns * rows for columns, rows in shapes)


def _forget_all() -> None:
    _accounts.clear()
    _pending.clear()
    _seen.clear()


register, unregister = forgetting_factory(_forget_all, poll)
