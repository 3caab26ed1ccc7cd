"""Which method suits a reflector, and why."""

from collections.abc import Callable
from dataclasses import dataclass

from ..parameters import Parameter
from ..scene import Instance, Scene
from .environment_map import CUBE_SIZE, EnvironmentMap, EnvironmentMapParallax
from .glossy_planar import GlossyPlanar
from .layered_depth import LayeredDepth
from .situation import Situation

TOLERANCE = Parameter(
    "tolerance",
    "Tolerance",
    0.5,
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


Rule = Callable[[Situation], Choice | None]
"""What a method says of a reflector; None if it has nothing to say."""


def choose(scene: Scene, reflector: Instance, tolerance: float = TOLERANCE.default) -> Choice:
    """The method for one of the scene's reflectors, by geometry: the first of RULES that answers.

    `tolerance` in pixels at the scene's resolution, seen from its camera.
    """
    situation = Situation(scene, reflector, tolerance)
    answers = (rule(situation) for rule in RULES)
    return next((answer for answer in answers if answer), None) or _near(situation)


def _rough(situation: Situation) -> Choice | None:
    if situation.blur <= situation.tolerance:
        return None
    shape, method = "flat", GlossyPlanar
    if GlossyPlanar.applies_to(situation.scene, situation.reflector):
        shape, method = "not flat", LayeredDepth
    return Choice(
        method.name,
        f"it is {shape}, and so rough that what is far away blurs by {_pixels(situation.blur)}: this method shows that",
    )


def _small(situation: Situation) -> Choice | None:
    if situation.extent >= _SMALL:
        return None
    across = max(1, round(2 * situation.extent))
    return Choice(
        LayeredDepth.name, f"it is only {across} pixels across: drawing it exactly costs less than a cube of its own"
    )


def _shows_itself(situation: Situation) -> Choice | None:
    if situation.alone:
        return None
    return Choice(
        LayeredDepth.name, "it is neither flat nor a closed convex body: parts of it may show in others, exactly drawn"
    )


def _blurred(situation: Situation) -> Choice | None:
    size = situation.texel_on_screen(CUBE_SIZE.default)
    misplaced = min(situation.parallax.max(initial=0.0), situation.room_error)
    # Where things would be out of place as well, that is the reason that a person expects.
    if size <= situation.tolerance or misplaced > situation.tolerance:
        return None
    return Choice(
        LayeredDepth.name,
        f"it is so flat or so near that a texel of an environment map would be {_pixels(size)} wide in it",
    )


def _environment_map(situation: Situation) -> Choice | None:
    error = situation.parallax.max(initial=0.0)
    if error > situation.tolerance:
        return None
    if not len(situation.others):
        return Choice(EnvironmentMap.name, "nothing but the world shows in it, which an environment map holds")
    away = situation.distances.min() / (2.0 * situation.radius)
    why = f"everything is over {int(away)} of its sizes away" if away >= 1.0 else "what is near shows tiny in it"
    return Choice(EnvironmentMap.name, f"{why}: an environment map is off by {_pixels(error)} at most")


def _room(situation: Situation) -> Choice | None:
    error = situation.room_error
    if error > situation.tolerance:
        return None
    return Choice(
        EnvironmentMapParallax.name,
        "it stands in a closed room with nothing large in it: an environment map projected onto the walls is off by "
        f"{_pixels(error)} at most",
    )


def _near(situation: Situation) -> Choice:
    worst = situation.worst
    name, distance = situation.scene.instances[situation.others[worst]].name, situation.distances[worst]
    away = f"{_number(distance)} m away" if distance > 0.0 else "beside or around it"
    return Choice(
        LayeredDepth.name,
        f"{name} is {away} and it is {_number(2 * situation.radius)} m across: an environment map could be off by "
        f"{_pixels(situation.parallax[worst])}, layered-depth shows things where they are",
    )


def _number(value: float) -> str:
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"


def _pixels(value: float) -> str:
    return "less than 0.1 pixels" if value < 0.1 else f"{_number(value)} pixels"


RULES: list[Rule] = [_rough, _small, _shows_itself, _blurred, _environment_map, _room]
"""Asked in this order; a new method adds its own, before those that would answer for it."""
