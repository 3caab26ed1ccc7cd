"""What is baked and kept on disk for the objects of a scene, found out on a thread of its own."""

from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

import bpy

from ..baking.layered_depth import KIND, LAYERS, RESOLUTION, face_shapes
from ..baking.layered_depth_keys import keys_of
from ..baking.layered_depth_tables import fitting_resolution
from ..baking.light import Keys, Standing, changes, standing
from ..baking.surroundings import surroundings
from ..cache import Cache, Kept
from ..methods.layered_depth_published import MEMORY, LayeredDepthPublished
from ..parameters import Value
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


@dataclass(frozen=True, order=True)
class Asked:
    """Layered depth textures as a method asks for them; `memory` is what all of them may take, in MiB."""

    resolution: int
    layers: int
    memory: int


@dataclass(frozen=True)
class Settings:
    """What bakes depend on beside the scene; each object is baked for all that is asked."""

    lighting: Lighting
    asked: tuple[Asked, ...]


@dataclass(frozen=True, eq=False)
class Account:
    """How all bakes of a scene stand. `light` is None where the light setting bakes none.

    By object's name, `instances` are those that share its bakes, `kept` the keys these may lie under. `baked` is
    what is asked, at the resolution that fits in memory; `memory` a guess of what the bakes take of it, in bytes.
    """

    scene: Scene
    settings: Settings
    light: State | None
    objects: tuple[State, ...]
    instances: dict[str, frozenset[int]]
    kept: dict[str, frozenset[str]]
    baked: tuple[Asked, ...]
    memory: int

    @property
    def states(self) -> tuple[State, ...]:
        """Of the light, if any is baked, and of all objects."""
        return (*([self.light] if self.light else ()), *self.objects)

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return sum(state.size for state in self.states)


_worker = ThreadPoolExecutor(1, thread_name_prefix="catoptric-bakes")
_accounts: dict[int, Account] = {}
_pending: dict[int, Future] = {}
_seen: dict[tuple[int, str], tuple[frozenset[str], Settings, Standing]] = {}
"""By scene and object: keys and circumstances of the last bakes that were fresh."""
_keys = Keys()


def asked_by(scene: bpy.types.Scene) -> Asked:
    """What the scene's own settings ask for."""
    return _asked(scene.catoptric.methods.values(LayeredDepthPublished.name))


def settings_of(scene: bpy.types.Scene, found: Scene) -> Settings:
    """As its reflectors have it that are drawn from layered depth textures; if there are none, as an export does."""
    chosen = stages.assignment(scene, found).values()
    asked = {_asked(values) for method, values in chosen if method == LayeredDepthPublished.name}
    return Settings(Lighting(scene.catoptric.lighting), tuple(sorted(asked or {asked_by(scene)})))


def _asked(values: Mapping[str, Value]) -> Asked:
    return Asked(values[RESOLUTION.name], values[LAYERS.name], values[MEMORY.name])


def account_of(scene: bpy.types.Scene, stage: stages.Stage) -> Account | None:
    """The newest account; a newer one is asked for where things have changed since."""
    if stage.shown is None:
        return None
    uid = scene.session_uid
    account, settings = _accounts.get(uid), settings_of(scene, stage.found)
    if uid not in _pending and not _is_of(account, stage.shown, settings):
        light = lights.known(scene) if settings.lighting is Lighting.CYCLES else None
        _pending[uid] = _worker.submit(_account, uid, stage.found, stage.shown, settings, light)
        if not bpy.app.timers.is_registered(poll):
            bpy.app.timers.register(poll, first_interval=_POLL)
    return account


def current(scene: bpy.types.Scene, stage: stages.Stage) -> Account | None:
    """The account of things as they are, once it is there; nobody waits."""
    poll()
    account = account_of(scene, stage)
    return account if _is_of(account, stage.shown, settings_of(scene, stage.found)) else None


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
    while (account := current(scene, stage)) is None:
        if scene.session_uid in _pending:
            _pending[scene.session_uid].exception()
    return account


def _is_of(account: Account | None, scene: Scene, settings: Settings) -> bool:
    return account is not None and account.scene is scene and account.settings == settings


def _account(uid: int, found: Scene, shown: Scene, settings: Settings, light: lights.Light | None) -> Account:
    """On the worker."""
    _keys.sweep(found)
    now = standing(found, _keys)
    baked = tuple(dict.fromkeys(_fitting(shown, asked) for asked in settings.asked))
    named = _named(shown, settings.lighting, baked)
    states = [_state(uid, name, keys, settings, now) for name, (keys, _) in named.items()]
    firsts = [min(indices) for _, indices in named.values()]
    return Account(
        shown,
        settings,
        _light_state(light, now) if settings.lighting is Lighting.CYCLES else None,
        tuple(states),
        {name: indices for name, (_, indices) in named.items()},
        {name: keys | _seen.get((uid, name), (keys,))[0] for name, (keys, _) in named.items()},
        baked,
        sum(_memory(shown, first, asked.resolution) for first in firsts for asked in baked),
    )


def _fitting(scene: Scene, asked: Asked) -> Asked:
    resolution = fitting_resolution(scene, asked.resolution, asked.memory, without(scene))
    return replace(asked, resolution=resolution, memory=0)


def _named(
    scene: Scene, lighting: Lighting, baked: tuple[Asked, ...]
) -> dict[str, tuple[frozenset[str], frozenset[int]]]:
    """By the name of its first instance, the keys of what is baked once, and all instances that share it."""
    all_keys = zip(*(keys_of(scene, lighting, asked.resolution, asked.layers) for asked in baked), strict=True)
    groups: dict[tuple[str, ...], list[int]] = {}
    unsearched = without(scene)
    for index, keys in enumerate(all_keys):
        if None not in keys and index not in unsearched:
            groups.setdefault(keys, []).append(index)
    return {scene.instances[many[0]].name: (frozenset(keys), frozenset(many)) for keys, many in groups.items()}


def without(scene: Scene) -> frozenset[int]:
    """Instances that need no layered depth textures: what stands around a reflector, and a reflector alone."""
    reflectors = scene.reflectors
    return surroundings(scene) | frozenset(reflectors if len(reflectors) == 1 else ())


def _state(uid: int, name: str, keys: frozenset[str], settings: Settings, now: Standing) -> State:
    kept = _kept(keys)
    if len(kept) == len(keys):
        _seen[uid, name] = keys, settings, now
        return _summed(name, FRESH, "", kept)
    if (uid, name) not in _seen:
        return _summed(name, MISSING, "", kept)
    old, before, then = _seen[uid, name]
    left = _kept(old)
    if old == keys or not left:
        return _summed(name, MISSING, "cleared", kept)
    return _summed(name, STALE, _why(name, before, settings, then, now), left)


def _kept(keys: frozenset[str]) -> list[Kept]:
    return [kept for key in keys if (kept := Cache().look(KIND, key))]


def _summed(name: str, kind: str, why: str, kept: list[Kept]) -> State:
    return State(name, kind, why, sum(one.size for one in kept), max((one.written for one in kept), default=0.0))


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
