"""What a viewport's stage tells of itself, and whom it lets go first."""

import os
import subprocess
import sys
from collections.abc import Callable

import pytest
from catoptric.addon.interface import stages

from .interface_stage import found, registered, small_scene, until

LATER = """
import os, threading
from catoptric.addon.gl import call, give_way, require

def policies(tasks):
    for task in tasks:
        try:
            if "llvmpipe" in open(f"/proc/self/task/{task}/comm").read():
                yield os.sched_getscheduler(int(task))
        except OSError:
            pass  # it has ended since

before = set(os.listdir("/proc/self/task"))
give_way()
gl = call(threading.get_native_id)
call(require)
started = set(os.listdir("/proc/self/task")) - before - {str(gl)}
print(os.getpriority(os.PRIO_PROCESS, 0), os.getpriority(os.PRIO_PROCESS, gl), os.sched_getscheduler(gl))
print(*set(policies(started)))
print(call(lambda: require().buffer(b"drawn").read().decode()))
"""


def test_what_panels_say_is_new_when_a_choice_or_a_problem_is_and_only_then():
    with registered():
        scene = small_scene()
        scene.catoptric.method = "environment-map"
        stage = found()
        said = [stage.said]

        def after(change: Callable[[], None]) -> bool:
            change()
            until(lambda: not stage.studio.busy)
            said.append(stage.said)
            return said[-1] != said[-2]

        def fail() -> None:
            stage.studio.problem = "out of memory"

        def choose() -> None:
            scene.catoptric.method = "layered-depth"
            stage.read()

        after(stage.read)
        assert not after(stage.read)
        assert after(choose)
        assert after(fail)
        assert after(stage.read)  # the problem is over
        assert not after(stage.read)  # a scene that reads as before


def test_panels_are_drawn_again_when_what_they_say_is_new(monkeypatch):
    drawn = []
    monkeypatch.setattr(stages, "redraw_panels", lambda: drawn.append(True))
    with registered():
        small_scene()
        stage = found()
        until(lambda: not stage.studio.busy)
        stages._poll()
        drawn.clear()
        stages._poll()
        assert not drawn
        stage.studio.problem = "out of memory"
        stages._poll()
        assert len(drawn) == 1
        stages._poll()
        assert len(drawn) == 1


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux counts priorities by thread")
def test_the_gl_thread_gives_way_and_the_threads_of_its_driver_do_even_more():
    said = subprocess.run([sys.executable, "-c", LATER], capture_output=True, text=True, check=True).stdout
    own = os.getpriority(os.PRIO_PROCESS, 0)
    threads, driver, drawn = said.splitlines()
    assert threads.split() == [str(own), "19", str(os.SCHED_OTHER)]
    assert driver in ("", str(os.SCHED_IDLE))  # a GPU's driver has no threads of that name
    assert drawn == "drawn"
