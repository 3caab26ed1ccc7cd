"""Methods that are ready to paint a scene, so that switching between them costs nothing. Lives on the GL thread."""

from collections.abc import Mapping
from dataclasses import dataclass

from ...addon.errors import Cancelled
from ...addon.methods.contract import Method
from ...addon.methods.mixed import Mixed
from ...addon.methods.registry import named
from ...addon.parameters import Value
from ...addon.progress import Progress
from ...addon.scene import Lighting, Scene

_KEPT = 4
_REMARKS = 3


@dataclass(frozen=True)
class Choice:
    """A method with its parameters' values, under a light."""

    method: str
    settings: tuple[tuple[str, Value], ...]
    lighting: Lighting

    @classmethod
    def of(cls, method: str, settings: Mapping[str, Value], lighting: Lighting) -> "Choice":
        """The choice with these settings, all of the method's."""
        return cls(method, tuple(settings.items()), lighting)


class Prepared:
    """The methods that were prepared last."""

    def __init__(self, scene: Scene) -> None:
        """Begin with none."""
        self._scene = scene
        self._methods: dict[Choice, Method] = {}

    def get(self, choice: Choice, progress: Progress) -> Method:
        """The method of `choice`, prepared now unless it is.

        Of those prepared, the four used last are kept. Raises what `Method.prepare` does.
        """
        method = self._methods.pop(choice, None)
        if method is None:
            method = named(choice.method)(dict(choice.settings))
            try:
                method.prepare(self._scene, choice.lighting, progress)
            except Cancelled:
                method.release()
                raise
        self._methods[choice] = method
        while len(self._methods) > _KEPT:
            self._methods.pop(next(iter(self._methods))).release()
        return method

    def __contains__(self, choice: Choice) -> bool:
        """Whether `get` would cost nothing."""
        return choice in self._methods

    def remarks(self, choice: Choice) -> str:
        """What is to be said of a prepared method here: which reflectors it cannot draw, or draws by which method."""
        method = self._methods[choice]
        reflectors = [self._scene.instances[index] for index in self._scene.reflectors]
        remarks = [method.applies_to(self._scene, reflector, method.settings) for reflector in reflectors]
        if isinstance(method, Mixed):
            remarks = [f"{name} by {chosen.method}: {chosen.reason}" for name, chosen in method.choices.items()]
        said = list(dict.fromkeys(filter(None, remarks)))
        return "\n".join([*said[:_REMARKS], *(["…"] if len(said) > _REMARKS else [])])

    def release(self) -> None:
        """Give the GPU memory back."""
        while self._methods:
            self._methods.popitem()[1].release()
