"""What the interface remembers belongs to the open file, and goes with it."""

from collections.abc import Callable

import bpy


def forgetting_factory(forget: Callable[[], None], *timers: Callable) -> tuple[Callable[[], None], Callable[[], None]]:
    """A module's `register` and `unregister`: `forget` is called when another file is opened, and at the end.

    `timers` are the module's own, which are stopped with it.
    """

    @bpy.app.handlers.persistent
    def leave_file(*_: object) -> None:
        forget()

    def register() -> None:
        bpy.app.handlers.load_pre.append(leave_file)

    def unregister() -> None:
        bpy.app.handlers.load_pre.remove(leave_file)
        for timer in timers:
            if bpy.app.timers.is_registered(timer):
                bpy.app.timers.unregister(timer)
        forget()

    return register, unregister
