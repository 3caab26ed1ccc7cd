"""The mouse while the view is dragged: its cursor is hidden, and no border ends its way."""

import pyglet
from moderngl_window.context.base import BaseWindow


class Capture:
    """Holds the mouse of a window, from `begin` to `end`; the cursor is then where it was before."""

    def __init__(self, window: BaseWindow) -> None:
        """Begin with a free mouse."""
        self._window = window
        self._place: tuple[float, float] | None = None
        self._is_fresh = False

    @property
    def holds(self) -> bool:
        """Whether the mouse is held."""
        return self._place is not None

    def begin(self, x: float, y: float) -> None:
        """Hold it, from that place on."""
        self._place, self._is_fresh = (x, y), True
        self._window.mouse_exclusivity = True

    def moved(self, dx: float, dy: float) -> tuple[float, float]:
        """How far the hand has moved it; what comes first may be the system's own way to the window's middle."""
        if self._is_fresh:
            self._is_fresh = False
            return 0.0, 0.0
        return dx, dy

    def end(self) -> None:
        """Let it go."""
        if self._place is None:
            return
        (x, y), self._place = self._place, None
        self._window.mouse_exclusivity = False
        for ours in pyglet.app.windows:  # moderngl-window has no word for it
            ours.set_mouse_position(round(x), round(ours.height - y))
