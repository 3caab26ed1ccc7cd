"""What a viewport's stage tells of itself, and whom it lets go first."""

import subprocess
import sys
from collections.abc import Callable

import pytest
from catoptric.addon.interface import stages

from .interface_stage import found, registered, small_scene, until

LATER = """
import os, threading
from catoptric.addon.gl import call, give_way
give_way()
policies = [call(lambda: os.sched_getscheduler(threading.get_native_id())), os.sched_getscheduler(0)]
print(*(policy == os.SCHED_IDLE for policy in policies))
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
def test_the_gl_thread_gives_way_and_it_alone():
    said = subprocess.run([sys.executable, "-c", LATER], capture_output=True, text=True, check=True).stdout
    assert said.split() == ["True", "False"]
