"""What a preview shows, beside where its camera stands."""

from dataclasses import dataclass

from ...addon.scene import Lighting
from .prepared import Choice
from .views import STANDARD


@dataclass(frozen=True)
class Look:
    """A method, or two side by side.

    `right` is None for one picture; else it begins at `split`, 0..1 of the width. `exposure` in stops; `view` is
    one of `views.names`.
    """

    left: Choice
    right: Choice | None = None
    split: float = 0.5
    exposure: float = 0.0
    view: str = STANDARD

    @property
    def choices(self) -> tuple[Choice, ...]:
        """What has to be prepared, left to right."""
        return (self.left,) if self.right is None else (self.left, self.right)

    @property
    def lighting(self) -> Lighting:
        """The light of both."""
        return self.left.lighting
