"""The one GL context of the process, on a worker thread of its own.

Blender's context is current on the main thread; a standalone context made there silently draws
into it, or takes the thread away. On a thread of its own ours and Blender's never meet.

A program with a window of its own, and no Blender in it, has a context already: `adopt` makes that the one.
"""

import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import wraps
from typing import ParamSpec, TypeVar

import moderngl

from ..errors import MachineError

P = ParamSpec("P")
R = TypeVar("R")

_GL_VERSION = 410

_POLITENESS = 19
"""Of a GL thread that gives way: as `nice` counts, of which 19 is the most. It is not idle: Python would have every
thread wait while the one that holds its lock is never given a turn.
"""

_worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="catoptric-gl")
_local = threading.local()
_choosing = threading.Lock()
_is_owned = False
"""Whether the process has its context."""


def call(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
    """`function(*args)`, run on the GL thread; waits for its result and passes on what it raises."""
    if getattr(_local, "is_gl", False):
        return function(*args, **kwargs)
    return submit(function, *args, **kwargs).result()


def submit(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> "Future[R]":
    """Have the GL thread run `function(*args)` when it comes to it, and do not wait."""
    return _worker.submit(_enter, function, args, kwargs)


def on_gl_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function that touches GL: it runs on the GL thread, whoever calls it."""

    @wraps(function)
    def moved(*args: P.args, **kwargs: P.kwargs) -> R:
        return call(function, *args, **kwargs)

    return moved


def require() -> moderngl.Context:
    """The context, made at the first call; only for functions that run on the GL thread.

    Raises `MachineError` where the machine offers no OpenGL 4.1.
    """
    if not getattr(_local, "is_gl", False):
        raise RuntimeError("GL was touched outside its thread; use gl.call or gl.on_gl_thread")
    if getattr(_local, "context", None) is None:
        _own(_create_patiently if getattr(_local, "is_patient", False) else _create)
    _sweep(_local.context)
    return _local.context


def unbind() -> None:
    """Draw into no framebuffer any more; before one is released.

    moderngl binds the last one again when it has made another: an OpenGL error if that is gone.
    """
    require().detect_framebuffer(0).use()


def adopt(context: moderngl.Context) -> None:
    """Make `context`, which is current on this thread, the one context of the process, and this the GL thread.

    For a window's own context, so that what is drawn is shown without being read back. What other threads hand
    over to GL then fails. Raises `RuntimeError` where the process has a context already, `MachineError` for one
    that does not offer OpenGL 4.1.
    """
    if context.version_code < _GL_VERSION:
        raise MachineError(_advice([f"the window has {context.info['GL_VERSION']}"]))
    _own(lambda: context)
    _local.is_gl = True


@on_gl_thread
def give_way() -> None:
    """Let every other thread of this process go before the GL thread, and before those that its driver starts.

    For a program with an interface where OpenGL is software, before anything is drawn: it fills every core, and
    whoever moves the mouse would wait for it. Only Linux, where such machines are, counts priorities by thread.
    """
    if sys.platform.startswith("linux"):
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _POLITENESS)
        _local.is_patient = True


def _own(make: Callable[[], moderngl.Context]) -> None:
    """Take what `make` returns as the context, on this thread."""
    global _is_owned
    with _choosing:
        if _is_owned:
            raise RuntimeError("this process has its GL context already, on another thread or from a window")
        _local.context = make()
        _local.context.gc_mode = "context_gc"  # Python may let go of an object on any thread
        _is_owned = True


def _sweep(context: moderngl.Context) -> None:
    """Free what Python has let go of, here on the GL thread; `Context.gc` stumbles over what was released before."""
    while context.objects:
        lost = context.objects.popleft()
        if hasattr(lost, "release"):
            lost.release()


def _enter(function, args, kwargs):
    _local.is_gl = True
    return function(*args, **kwargs)


def _create() -> moderngl.Context:
    backends = [{"backend": "egl"}, {}] if sys.platform.startswith("linux") else [{}]
    reasons = []
    for backend in backends:
        try:
            context = moderngl.create_context(standalone=True, require=_GL_VERSION, **backend)
        except Exception as reason:  # glcontext raises bare Exception for a missing library or driver
            reasons.append(str(reason))
            continue
        return context
    raise MachineError(_advice(reasons))


def _create_patiently() -> moderngl.Context:
    """A context whose driver's threads run only where nothing else would.

    They take after the thread that makes it. Politeness would not do for them: the scheduler lets a polite thread
    end the milliseconds it has begun.
    """

    def make() -> moderngl.Context:
        os.sched_setscheduler(threading.get_native_id(), os.SCHED_IDLE, os.sched_param(0))
        context = _create()
        with context:
            pass  # from here on it is current on no thread
        return context

    with ThreadPoolExecutor(max_workers=1) as beside:
        context = beside.submit(make).result()
    context.__enter__()
    return context


def _advice(reasons: list[str]) -> str:
    cause = "; ".join(dict.fromkeys(reasons))
    if sys.platform.startswith("linux"):
        return f"no OpenGL 4.1 here ({cause}): install libegl1 and libgl1-mesa-dri, or a GPU driver"
    return f"no OpenGL 4.1 here ({cause}): update the graphics driver"
