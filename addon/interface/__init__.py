"""What Blender shows of the add-on: a render engine, settings, a panel and the buttons in it."""

from . import background, bakes, engine, hud, lights, operators, panel, places, properties, stages, work

_PARTS = (properties, work, places, background, lights, stages, bakes, engine, hud, operators, panel)


def register() -> None:
    """Add the interface to Blender."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Take away what `register` added, and stop all work."""
    for part in reversed(_PARTS):
        part.unregister()
