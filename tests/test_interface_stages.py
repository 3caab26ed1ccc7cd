"""What a viewport's stage tells of itself, and whom it lets go first."""

import os
import subprocess
import sys

import pytest

from .interface_stage import found, registered, small_scene, until

LATER = """
import os, threading
from catoptric.addon.gl import call, give_way
give_way()
print(call(lambda: os.getpriority(os.PRIO_PROCESS, threading.get_native_id())), os.getpriority(os.PRIO_PROCESS, 0))
"""


def test_panels_have_news_when_a_choice_or_a_problem_is_new_and_only_then():
    with registered():
        scene = small_scene()
        scene.catoptric.method = "environment-map"
        stage = found()
        until(lambda: not stage.studio.busy)
        assert stage.has_news_for_panels()
        assert not stage.has_news_for_panels()
        scene.catoptric.method = "layered-depth"
        stage.read()
        until(lambda: not stage.studio.busy)
        assert stage.has_news_for_panels()
        stage.studio.problem = "out of memory"
        assert stage.has_news_for_panels()
        stage.read()  # a scene that reads as before
        until(lambda: not stage.studio.busy)
        assert stage.has_news_for_panels()  # the problem is over
        stage.read()
        until(lambda: not stage.studio.busy)
        assert not stage.has_news_for_panels()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux counts priorities by thread")
def test_the_gl_thread_gives_way_and_it_alone():
    said = subprocess.run([sys.executable, "-c", LATER], capture_output=True, text=True, check=True).stdout
    own = os.getpriority(os.PRIO_PROCESS, 0)
    assert said.split() == ["19", str(own)]
