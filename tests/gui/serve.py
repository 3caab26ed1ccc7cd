"""Runs inside Blender's window: takes Python from a socket, runs it between two of Blender's events, answers.

Usage: blender --python serve.py -- SOCKET MODULE, with the extension's module. A request is a text; the answer is
(what it printed, traceback or None).
The code finds `bpy`, `probe` and its `view3d()`.
"""

import contextlib
import io
import os
import queue
import sys
import threading
import traceback
from multiprocessing.connection import Connection, Listener

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import probe  # it lies beside this file

REQUESTS: queue.SimpleQueue = queue.SimpleQueue()


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
            exec(compile(code, "<request>", "exec"), {"bpy": bpy, "probe": probe, "view3d": probe.view3d})
        except Exception:
            failure = traceback.format_exc()
    connection.send((said.getvalue(), failure))


def serve() -> float:
    """A timer of Blender's: run what has arrived."""
    while not REQUESTS.empty():
        answer(*REQUESTS.get())
    return 0.02


bpy.context.preferences.view.show_splash = False
threading.Thread(target=listen, args=(sys.argv[-2],), daemon=True).start()
# Persistent, so that opening a file does not end it.
bpy.app.timers.register(serve, first_interval=0.5, persistent=True)
