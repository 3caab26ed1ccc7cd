"""The preview's window: the only place that knows moderngl-window."""

import logging
import time
from collections.abc import Callable

import moderngl_window
import pyglet
from moderngl_window.context.base import BaseWindow

from ...addon.errors import Cancelled, CatoptricError, MachineError
from ...addon.gl import adopt
from . import hud
from .capture import Capture
from .darkroom import shown_as
from .display import Display
from .interface import Interface
from .pilot import turn_per_pixel
from .session import Session
from .watch import Watch

_BACKEND = "pyglet"
_FRAME = 1 / 60  # seconds between two pictures of a progress bar, and between two looks for events
_NAP = 1 / 20  # seconds between two looks for events, when there have been none for a second
_LONGEST_STEP = 0.25  # seconds that a flight goes on for at once
_AFTERGLOW = 3  # frames after an event: Dear ImGui shows some of its changes a frame late
_GRIP = 8.0  # pixels around the line of the split view

_KEYS = {
    "escape": "ESCAPE", "space": "SPACE", "tab": "TAB", "home": "HOME", "end": "END", "f1": "F1",
    "backspace": "BACKSPACE", "delete": "DELETE", "enter": "ENTER", "-": "MINUS", "=": "EQUAL",
    "left": "LEFT", "right": "RIGHT", "up": "UP", "down": "DOWN",
    **{letter: letter.upper() for letter in "abcdefghijklmnopqrstuvwxyz"},
    **{digit: f"NUMBER_{digit}" for digit in "123456789"},
}  # fmt: skip


def open_window(title: str, size: tuple[int, int]) -> BaseWindow:
    """A window of `size`, whose context is the process' one from now on.

    Raises `MachineError` where there is no screen or no OpenGL 4.1.
    """
    logging.getLogger("moderngl_window").setLevel(logging.WARNING)
    try:
        kind = moderngl_window.get_local_window_cls(_BACKEND)
        window = kind(title=title, size=size, gl_version=(4, 1), vsync=True, resizable=True, cursor=True)
    except Exception as reason:  # each system has exceptions of its own for a missing display or driver
        raise MachineError(
            f"cannot open a window here ({reason or type(reason).__name__}): "
            "with --path and --video a film is made without one"
        ) from None
    adopt(window.ctx)
    window.exit_key = None
    return window


class Preview:
    """Shows a session in a window until it is closed."""

    def __init__(self, window: BaseWindow, session: Session, watch: Watch | None = None) -> None:
        """Connect the two; `watch` tells when the scene's file was saved again."""
        self._window, self._session = window, session
        self._display, self._interface = Display(), Interface(window)
        self._watch, self._capture = watch, Capture(window)
        self._names = {getattr(window.keys, theirs): ours for ours, theirs in _KEYS.items()}
        self._shift = (window.keys.LEFT_SHIFT, window.keys.RIGHT_SHIFT)
        self._cursor: tuple[float, float] | None = None
        self._pressed = (0.0, 0.0)
        self._grip: Callable[[float, float, float, float], None] | None = None
        self._fresh = _AFTERGLOW
        self._drawn_at = time.perf_counter()
        self._interval = _FRAME
        self._seen_at: object = None
        self._hit: float | None = None
        session.workshop.pump = self._pump
        self._connect()

    def _connect(self) -> None:
        window = self._window
        window.key_event_func = self._on_key
        window.unicode_char_entered_func = self._woken(self._interface.type)
        window.mouse_position_event_func = self._on_move
        window.mouse_drag_event_func = self._on_drag
        window.mouse_press_event_func = self._on_press
        window.mouse_release_event_func = self._on_release
        window.mouse_scroll_event_func = self._on_scroll
        window.resize_func = self._woken(lambda width, height: None)
        window.iconify_func = self._woken(lambda iconified: None)
        for ours in pyglet.app.windows:  # moderngl-window does not tell
            ours.push_handlers(on_deactivate=self._let_go)

    def run(self) -> None:
        """Live until the window closes."""
        before = time.perf_counter()
        try:
            while not self._window.is_closing:
                now = time.perf_counter()
                self._live(min(now - before, _LONGEST_STEP))
                before = now
        finally:
            self._session.workshop.release()
            self._window.close()
            if self._watch:
                self._watch.close()

    def _live(self, seconds: float) -> None:
        session = self._session
        session.size = tuple(max(1, side) for side in self._window.buffer_size)
        moved = session.pilot.is_moving or session.pilot.recorder is not None
        session.pilot.advance(seconds)
        self._look_for_news()
        if session.work() or moved:
            self._fresh = _AFTERGLOW
        else:
            self._see()
        if self._fresh:
            self._draw()
        else:
            time.sleep(_FRAME if time.perf_counter() - self._drawn_at < 1.0 else _NAP)
            for window in pyglet.app.windows:
                window.dispatch_events()

    def _look_for_news(self) -> None:
        """Take in the scene where its file was saved again."""
        if self._watch is None:
            return
        was_reading = self._watch.is_reading
        try:
            scene = self._watch.news()
            if scene is not None:
                self._session.take(scene)
        except CatoptricError as problem:
            self._session.message = str(problem)
        if self._watch.is_reading and not was_reading:
            self._session.message = "the file was saved again; reading it"
        if self._watch.is_reading != was_reading:
            self._fresh = _AFTERGLOW

    def _pump(self) -> None:
        """The window's life while something takes long. Raises `Cancelled` once it is closed."""
        if self._window.is_closing:
            raise Cancelled
        if time.perf_counter() - self._drawn_at > _FRAME:
            self._draw()

    def _draw(self) -> None:
        """Show the newest picture and the panels, and take in what happened meanwhile."""
        session, now = self._session, time.perf_counter()
        self._fresh = max(0, self._fresh - 1)
        screen, size = self._window.ctx.screen, self._window.buffer_size
        shown = session.workshop.painter.shown.canvases
        if shown:
            self._display.draw(screen, size, *shown, **shown_as(session.look))
        else:
            screen.use()
            screen.clear()
        self._interval += 0.2 * (now - self._drawn_at - self._interval)
        self._interface.begin(now - self._drawn_at)
        hud.draw(session, self._hit, self._interval)
        self._interface.end()
        self._drawn_at = now
        self._window.swap_buffers()

    def _see(self) -> None:
        """Look at what lies under the cursor, if anything there has changed."""
        session = self._session
        place = None if self._interface.wants_mouse else self._cursor
        shop = session.workshop
        now = (place, session.pilot.camera, shop.settled, shop.scale, shop.samples, session.look.split)
        if now == self._seen_at:
            return
        self._seen_at, self._fresh = now, _AFTERGLOW
        session.see(place)
        shown = shop.painter.shown
        if place and shown.canvases:
            self._hit = shown.distance_at(place, int(len(shown.canvases) > 1 and place[0] >= session.look.split))

    # Events

    def _woken(self, function: Callable) -> Callable:
        """`function`, after which the window is drawn anew."""

        def woken(*arguments) -> None:
            self._fresh = _AFTERGLOW
            function(*arguments)

        return woken

    def _on_key(self, key, action, modifiers) -> None:
        self._fresh = _AFTERGLOW
        down = action == self._window.keys.ACTION_PRESS
        name = "shift" if key in self._shift else self._names.get(key)
        if name is None:
            return
        self._interface.press(name, down)
        if not down:
            self._session.release(name)
        elif name == "q" and modifiers.ctrl:
            self._window.is_closing = True  # closed only when nobody draws in it any more
        elif not self._interface.wants_text:
            self._session.press(name, modifiers.ctrl)

    def _on_move(self, x, y, dx, dy) -> None:
        self._fresh = _AFTERGLOW
        width, height = self._window.size
        self._cursor = (x / width, y / height) if 0 <= x < width and 0 <= y < height else None
        self._interface.point(x, y)

    def _on_drag(self, x, y, dx, dy) -> None:
        if self._capture.holds:
            self._fresh = _AFTERGLOW
            self._turn(*self._capture.moved(dx, dy))
            return
        self._on_move(x, y, dx, dy)
        if self._grip:
            self._grip(x, y, dx, dy)

    def _on_press(self, x, y, button) -> None:
        self._on_move(x, y, 0, 0)
        self._interface.click(button, True)
        if not self._interface.wants_mouse:
            self._pressed = x, y
            line = self._session.look.split * self._window.width
            on_line = self._session.look.right is not None and abs(x - line) <= _GRIP
            self._grip = self._drag_line if on_line else self._drag_view

    def _on_release(self, x, y, button) -> None:
        if not self._capture.holds:
            self._on_move(x, y, 0, 0)
        self._interface.click(button, False)
        self._grip = None
        self._capture.end()

    def _let_go(self) -> None:
        """Another window has the keys and the mouse now."""
        self._session.pilot.held.clear()
        self._grip = None
        self._capture.end()

    def _on_scroll(self, x, y) -> None:
        self._fresh = _AFTERGLOW
        if self._interface.wants_mouse:
            self._interface.scroll(x, y)
        else:
            self._session.pilot.change_speed(y)
            self._session.message = f"flies at {self._session.pilot.speed:.2f} m/s"

    def _drag_line(self, x, y, dx, dy) -> None:
        self._session.divide(x / self._window.width)

    def _drag_view(self, x, y, dx, dy) -> None:
        self._capture.begin(*self._pressed)
        self._turn(dx, dy)

    def _turn(self, dx, dy) -> None:
        radians = turn_per_pixel(self._session.pilot.camera, self._window.size)
        self._session.pilot.turn(dx * radians, dy * radians)
