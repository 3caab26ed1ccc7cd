"""Runs inside Blender's window: takes Python from a socket, runs it between two of Blender's events, answers.

Usage: blender --python serve.py -- SOCKET. A request is a text; the answer is (what it printed, traceback or None).
The code finds `bpy` and `view3d()`.
"""

import contextlib
import io
import queue
import sys
import threading
import traceback
from multiprocessing.connection import Connection, Listener

import bpy

REQUESTS: queue.SimpleQueue = queue.SimpleQueue()


def view3d() -> tuple:
    """The first window and its 3D viewport: window, area, and its regions by type."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return window, area, {region.type: region for region in area.regions}


def listen(address: str) -> None:
    """On a thread of its own: hand each request to the main thread."""
    with Listener(address, "AF_UNIX") as listener:
        while True:
            connection = listener.accept()
            with contextlib.suppress(EOFError):
                while True:
                    REQUESTS.put((connection, connection.recv()))


def answer(connection: Connection, code: str) -> None:
    """Run `code` and say what came of it."""
    said, failure = io.StringIO(), None
    with contextlib.redirect_stdout(said):
        try:
            exec(compile(code, "<request>", "exec"), {"bpy": bpy, "view3d": view3d})
        except Exception:
            failure = traceback.format_exc()
    connection.send((said.getvalue(), failure))


def serve() -> float:
    """A timer of Blender's: run what has arrived."""
    while not REQUESTS.empty():
        answer(*REQUESTS.get())
    return 0.02


bpy.context.preferences.view.show_splash = False
threading.Thread(target=listen, args=(sys.argv[-1],), daemon=True).start()
# Persistent, so that opening a file does not end it.
bpy.app.timers.register(serve, first_interval=0.5, persistent=True)
