"""The panels over the picture, in Dear ImGui."""

import math

from imgui_bundle import imgui

from ...addon.methods.registry import METHODS
from ...addon.parameters import Parameter, Value
from ...addon.scene import Lighting
from .keys import BINDINGS
from .prepared import Choice
from .session import Session
from .views import names

_MARGIN = 10.0
_SIDES = "Left", "Right"
_FIXED = (
    imgui.WindowFlags_.always_auto_resize
    | imgui.WindowFlags_.no_saved_settings
    | imgui.WindowFlags_.no_focus_on_appearing
    | imgui.WindowFlags_.no_nav
)
_BARE = _FIXED | imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
_DIM = imgui.ImVec4(0.65, 0.65, 0.65, 1.0)
_RED = imgui.ImVec4(1.0, 0.35, 0.3, 1.0)


def draw(session: Session, drawn: float | None, interval: float) -> None:
    """Ask for all panels.

    `drawn` is the distance that the method under the cursor draws, as `Painted` has it; `interval` the seconds
    from picture to picture.
    """
    imgui.set_next_window_bg_alpha(0.8)
    if session.panel:
        _panel(session, drawn, interval)
    if session.help:
        _help()
    if session.workshop.busy:
        _busy(session)
    _status(session)


def _panel(session: Session, drawn: float | None, interval: float) -> None:
    imgui.set_next_window_pos(imgui.ImVec2(_MARGIN, _MARGIN), imgui.Cond_.first_use_ever)
    imgui.begin(session.title + "###panel", None, _FIXED)
    imgui.push_item_width(190.0)
    for right, choice in enumerate(session.look.choices):
        imgui.push_id(right)
        _method(session, bool(right), choice)
        imgui.pop_id()
    imgui.separator()
    _light(session)
    changed, stops = imgui.slider_float("exposure, stops", session.look.exposure, -8.0, 8.0, "%.1f")
    if changed:
        session.expose(stops)
    changed, number = imgui.combo("view", names().index(session.look.view), list(names()))
    if changed:
        session.view(names()[number])
    imgui.separator()
    _times(session, interval)
    imgui.separator()
    _sight(session, drawn)
    imgui.pop_item_width()
    imgui.end()


def _method(session: Session, right: bool, choice: Choice) -> None:
    names = tuple(METHODS)
    label = _SIDES[right] if session.look.right else "Method"
    changed, number = imgui.combo(
        label, names.index(choice.method), [f"{n}  {name}" for n, name in enumerate(names, 1)]
    )
    if changed:
        session.choose(number, right)
    imgui.set_item_tooltip(METHODS[choice.method].source)
    values = dict(choice.settings)
    for parameter in METHODS[choice.method].parameters:
        changed, value = _widget(parameter, values[parameter.name])
        imgui.set_item_tooltip(_explained(parameter))
        if changed:
            session.set(right, {parameter.name: parameter.parse(value)})


def _widget(parameter: Parameter, value: Value) -> tuple[bool, Value]:
    """The widget that fits a parameter; (whether it was changed, its value)."""
    label = f"{parameter.label}, {parameter.unit}" if parameter.unit else parameter.label
    if isinstance(parameter.default, bool):
        return imgui.checkbox(label, value)
    if parameter.choices:
        changed, number = imgui.combo(label, parameter.choices.index(value), list(parameter.choices))
        return changed, parameter.choices[number]
    if isinstance(parameter.default, str):
        return imgui.input_text(label, value)
    least, most = parameter.minimum, parameter.maximum
    clamped = imgui.SliderFlags_.always_clamp
    if isinstance(parameter.default, int):
        low, high = (-(2**31) if least is None else math.ceil(least)), (2**31 - 1 if most is None else math.floor(most))
        return imgui.drag_int(label, value, max(0.2, abs(value) / 100), low, high, "%d", clamped)
    low, high = (-3e38 if least is None else least), (3e38 if most is None else most)
    return imgui.drag_float(label, value, max(1e-3, abs(value) / 100), low, high, "%.4g", clamped)


def _explained(parameter: Parameter) -> str:
    return f"{parameter.help} ({parameter.section})" if parameter.section else parameter.help


def _light(session: Session) -> None:
    for lighting in Lighting:
        imgui.begin_disabled(lighting not in session.lightings)
        if imgui.radio_button(lighting, session.look.lighting is lighting):
            session.light(lighting)
        imgui.end_disabled()
        imgui.same_line()
    imgui.text_colored(_DIM, "light")


def _times(session: Session, interval: float) -> None:
    """A row for each stage, a column for each picture."""
    shop = session.workshop
    times = shop.painter.shown.times
    if not times:
        return
    stages = sorted(dict.fromkeys(stage for side in times for stage in side), key=lambda stage: stage == "frame")
    if imgui.begin_table("times", 1 + len(times), imgui.TableFlags_.sizing_fixed_fit):
        for name in ("milliseconds", *(_SIDES if len(times) > 1 else ("",))):
            imgui.table_next_column()
            imgui.text_colored(_DIM, name)
        for stage in stages:
            imgui.table_next_column()
            imgui.text(f"    {stage}" if stage in METHODS else stage)
            for side in times:
                imgui.table_next_column()
                imgui.text(f"{side.get(stage, math.nan):8.2f}")
        imgui.end_table()
    if session.pilot.is_moving:
        detail = "" if shop.scale == 1 else f", at 1/{shop.scale} of the resolution"
        imgui.text(f"{1.0 / max(interval, 1e-4):.0f} pictures a second{detail}")
    else:
        imgui.text(f"at rest, {shop.samples**2} samples a pixel")


def _sight(session: Session, drawn: float | None) -> None:
    """What lies under the cursor: two lines always, so that the panel keeps its size."""
    sight = session.sight
    if sight is None:
        lines = "point at something to learn what it is", ""
    elif sight.name is None:
        lines = "the world", ""
    elif not sight.reflects:
        lines = f"{sight.name}, {sight.distance:.2f} m away", "not a reflector"
    else:
        shown = f"{sight.mirrored}, {sight.path:.2f} m from it" if sight.mirrored else "the world"
        lines = f"reflector {sight.name}, {sight.distance:.2f} m away", f"mirrors {shown}{_as_drawn(drawn)}"
    imgui.text(lines[0])
    imgui.text_colored(_DIM, lines[1])


def _as_drawn(drawn: float | None) -> str:
    if drawn is None or math.isnan(drawn):
        return ""
    return "; drawn infinitely far away" if math.isinf(drawn) else f"; drawn at {drawn:.2f} m"


def _help() -> None:
    width, _ = imgui.get_io().display_size
    imgui.set_next_window_pos(imgui.ImVec2(width - _MARGIN, _MARGIN), imgui.Cond_.always, imgui.ImVec2(1.0, 0.0))
    imgui.set_next_window_bg_alpha(0.85)
    imgui.begin("Keys", None, _BARE)
    if imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit):
        for binding in BINDINGS:
            imgui.table_next_column()
            imgui.text(binding.shown)
            imgui.table_next_column()
            imgui.text_colored(_DIM, binding.help)
        imgui.end_table()
    imgui.end()


def _busy(session: Session) -> None:
    busy = session.workshop.busy
    width, height = imgui.get_io().display_size
    imgui.set_next_window_pos(imgui.ImVec2(width / 2, height / 2), imgui.Cond_.always, imgui.ImVec2(0.5, 0.5))
    imgui.begin("Busy", None, _BARE)
    imgui.text(busy.title)
    imgui.progress_bar(busy.fraction, imgui.ImVec2(320.0, 0.0))
    imgui.text_colored(_DIM, f"{busy.stage}; Esc stops" if busy.stage else "Esc stops")
    imgui.end()


def _status(session: Session) -> None:
    """One line at the bottom: what was said last, and what is being recorded or played."""
    pilot = session.pilot
    width, height = imgui.get_io().display_size
    imgui.set_next_window_pos(imgui.ImVec2(_MARGIN, height - _MARGIN), imgui.Cond_.always, imgui.ImVec2(0.0, 1.0))
    imgui.set_next_window_size_constraints(imgui.ImVec2(0, 0), imgui.ImVec2(width - 2 * _MARGIN, height))
    imgui.set_next_window_bg_alpha(0.7)
    imgui.begin("Status", None, _BARE)
    if pilot.recorder is not None:
        imgui.text_colored(_RED, f"recording {pilot.recorder.seconds:.1f} s")
        imgui.same_line()
    if pilot.played is not None:
        imgui.text(f"playing {pilot.played:.1f} of {pilot.path.duration:.1f} s")
        imgui.same_line()
    imgui.text(session.message or "F1 shows the keys")
    imgui.end()
