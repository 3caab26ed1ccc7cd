"""Which method suits a reflector, and why."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..parameters import Parameter
from ..scene import Instance, Scene
from .environment_map import CUBE_SIZE, EnvironmentMap, EnvironmentMapParallax
from .layered_depth import LayeredDepth
from .situation import Situation

TOLERANCE = Parameter(
    "tolerance",
    "Tolerance",
    1.0,
    "How far from its place a cheaper method may show anything, in a picture of the scene's size",
    unit="pixels",
    minimum=0.0,
    maximum=1000.0,
)

_SMALL = 40.0
"""Pixels. A cube is six pictures of 512 × 512 and 25 MB; a reflector of less radius is cheaper drawn exactly."""


@dataclass(frozen=True)
class Choice:
    """A method's name, and one sentence that says why."""

    method: str
    reason: str


Rule = Callable[[Situation, float], Choice | None]
"""What a method says of a reflector, given the tolerance in pixels; None if it has nothing to say."""


def choose(scene: Scene, reflector: Instance, tolerance: float = TOLERANCE.default) -> Choice:
    """The method for one of the scene's reflectors, by geometry: the first of RULES that answers.

    `tolerance` in pixels at the scene's resolution, seen from its camera.
    """
    situation = Situation(scene, reflector)
    answers = (rule(situation, tolerance) for rule in RULES)
    return next((answer for answer in answers if answer), None) or _near(situation)


def _small(situation: Situation, tolerance: float) -> Choice | None:
    if situation.extent >= _SMALL:
        return None
    across = max(1, round(2 * situation.extent))
    return Choice(
        LayeredDepth.name, f"it is only {across} pixels across: drawing it exactly costs less than a cube of its own"
    )


def _shows_itself(situation: Situation, tolerance: float) -> Choice | None:
    if situation.alone:
        return None
    return Choice(LayeredDepth.name, "it is not convex, so that parts of it may show in others, as only this draws it")


def _blurred(situation: Situation, tolerance: float) -> Choice | None:
    size = situation.texel_on_screen(CUBE_SIZE.default)
    if size <= tolerance:
        return None
    return Choice(
        LayeredDepth.name,
        f"it is so flat or so near that a texel of an environment map would be {size:.2g} pixels wide in it",
    )


def _environment_map(situation: Situation, tolerance: float) -> Choice | None:
    error = situation.parallax.max(initial=0.0)
    if error > tolerance:
        return None
    if not len(situation.others):
        return Choice(EnvironmentMap.name, "nothing but the world shows in it, which an environment map holds")
    away = situation.distances.min() / (2.0 * situation.radius)
    return Choice(
        EnvironmentMap.name,
        f"everything is at least {away:.0f} of its sizes away: an environment map is off by {error:.2g} pixels",
    )


def _room(situation: Situation, tolerance: float) -> Choice | None:
    error = situation.room_error(tolerance)
    if error > tolerance:
        return None
    return Choice(
        EnvironmentMapParallax.name,
        f"it stands in a closed room with nothing in it: an environment map projected onto the walls is off by "
        f"{error:.2g} pixels at most",
    )


def _near(situation: Situation) -> Choice:
    worst = int(np.argmax(situation.parallax))
    name = situation.scene.instances[situation.others[worst]].name
    distance, error = situation.distances[worst], situation.parallax[worst]
    away = f"{distance:.2g} m away" if distance > 0.0 else "beside or around it"
    return Choice(
        LayeredDepth.name,
        f"{name} is {away} and it is {2 * situation.radius:.2g} m across: an environment map would be off by "
        f"{error:.0f} pixels, layered-depth shows things where they are",
    )


RULES: list[Rule] = [_small, _shows_itself, _blurred, _environment_map, _room]
"""Asked in this order; a new method adds its own, before those that would answer for it."""
