"""A method of its own for each reflector."""

from collections.abc import Mapping
from typing import ClassVar

from ..drawing import Resident
from ..errors import UsageError
from ..gl import on_gl_thread
from ..parameters import Value, resolve
from ..progress import Progress, silent
from ..scene import Instance, Scene
from .auto import TOLERANCE, Choice, choose
from .contract import Method
from .deferred import Cast, DeferredMethod, EnsembleMethod
from .layered_depth import LayeredDepth
from .techniques import TECHNIQUES

AUTO = "auto"
"""The name that leaves the choice to `choose`."""

Assignment = Mapping[str, tuple[str, Mapping[str, Value]]]
"""By an instance's name: the method that draws it (or AUTO), and settings, defaults where they are not given."""


class Mixed(EnsembleMethod):
    """Each reflector by the method that it is given, in one frame.

    Reflectors of equal method and settings share one method; all share the scene on the GPU and one pass
    that sees and lights it. `choices` says, by reflector's name, which method draws it and why, if it is not
    the one asked for: because AUTO chose it, or because the other does not apply.

    Source: none; games mix techniques by object.

    Limitations: a method bakes again when it gains or loses a reflector; AUTO chooses when the scene or the
    assignment changes, not when the camera alone moves.
    """

    name: ClassVar[str] = "mixed"
    source: ClassVar[str] = "each reflector by the method that it is given"

    def __init__(self, assignment: Assignment | None = None) -> None:
        """Reflectors without an entry are drawn by layered-depth; raises `UsageError` for a wrong name or value."""
        super().__init__()
        self.choices: dict[str, Choice] = {}
        self._otherwise = _wanted(LayeredDepth.name, {})
        self._wanted = _all_wanted(assignment or {})
        self._methods: dict[tuple, DeferredMethod] = {}

    @property
    def resident(self) -> Resident:
        """The scene on the GPU."""
        return self._ensemble.resident

    @on_gl_thread
    def assign(self, assignment: Assignment, progress: Progress = silent) -> None:
        """Go on with another assignment; what is new is baked, what has not changed is kept."""
        self._wanted = _all_wanted(assignment)
        self._ensemble.assign(self.cast(self.resident.scene), progress)

    def cast(self, scene: Scene) -> Cast:
        """Choose, and gather the reflectors of equal method and settings."""
        reflectors: dict[tuple, list[int]] = {}
        self.choices = {}
        for index in scene.reflectors:
            reflector = scene.instances[index]
            choice, settings = self._settle(scene, reflector)
            self.choices[reflector.name] = choice
            reflectors.setdefault((choice.method, tuple(settings.items())), []).append(index)
        self._methods = {key: self._methods.get(key) or TECHNIQUES[key[0]](dict(key[1])) for key in reflectors}
        return {self._methods[key]: tuple(indices) for key, indices in reflectors.items()}

    def _settle(self, scene: Scene, reflector: Instance) -> tuple[Choice, Mapping[str, Value]]:
        """Which method draws a reflector, with all of its settings."""
        name, settings = self._wanted.get(reflector.name, self._otherwise)
        choice = Choice(name, "")
        if name == AUTO:
            choice = choose(scene, reflector, **settings)
            settings = resolve(TECHNIQUES[choice.method].parameters, {})
        refusal = TECHNIQUES[choice.method].applies_to(scene, reflector, settings)
        if refusal:
            return Choice(LayeredDepth.name, refusal), resolve(LayeredDepth.parameters, {})
        return choice, settings


class Auto(Mixed):
    """Each reflector by the cheapest method that its surroundings allow, with the reason.

    What is so rough that it blurs what is far away by more than `tolerance` pixels is drawn by glossy-planar where it
    is flat, and by layered-depth where it is not.

    An environment map shows everything as if it lay infinitely far away. How far that puts the nearest
    object out of place on the screen follows from its distance, the reflector's size and curvature, and the
    camera. Where it is more than `tolerance` pixels, the map projected onto the scene's box is tried, which
    suits an empty room; where that is too far out as well, or the reflector is small, or shows in itself,
    layered-depth draws it.

    Source: the thin-mirror equation, for the size of a virtual image (any textbook of optics).

    Limitations: it measures by boxes, so that layered-depth is chosen more often than need be; it looks from
    the scene's camera, as it was when anything else changed last; it knows nothing of light.
    """

    name = AUTO
    source = "the thin-mirror equation bounds each method's error on the screen; the cheapest that stays within it"
    parameters = (TOLERANCE,)

    def __init__(self, settings: Mapping[str, Value] | None = None) -> None:
        """`settings` as of any method."""
        super().__init__()
        self.settings = resolve(self.parameters, settings or {})
        self._otherwise = AUTO, self.settings


def _all_wanted(assignment: Assignment) -> dict[str, tuple[str, dict[str, Value]]]:
    return {reflector: _wanted(*method) for reflector, method in assignment.items()}


def _wanted(name: str, settings: Mapping[str, Value]) -> tuple[str, dict[str, Value]]:
    """Checked, and with every setting's value."""
    declared: dict[str, type[Method]] = {**TECHNIQUES, AUTO: Auto}
    if name not in declared:
        raise UsageError(f"no method {name!r}; there are: {', '.join(declared)}")
    return name, resolve(declared[name].parameters, settings)
