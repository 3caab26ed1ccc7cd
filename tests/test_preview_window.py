"""The preview's real window, on a virtual X server: keys and mouse go in, pictures of the screen come out."""

import json
import os
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import named
from catoptric.addon.metrics import to_bytes
from catoptric.addon.scene import Lighting
from catoptric.addon.scene.archive import save

from .preview_stage import stage

pytestmark = pytest.mark.slow

SIZE = (480, 320)
PROGRAM = "import sys; from catoptric.batch.cli import main; sys.exit(main(sys.argv[1:]))"
PANEL = 250  # rows from the top in which only the picture is, once the panel is hidden


def picture_of(path: Path) -> np.ndarray:
    return oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8)[..., :3].astype(int)


def wait_until(condition, seconds=30.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.1)


@pytest.fixture
def screen(monkeypatch):
    """A virtual screen of its own."""
    missing = [tool for tool in ("Xvfb", "xdotool", "import") if not shutil.which(tool)]
    if missing:
        pytest.skip(f"{', '.join(missing)} not installed (on Debian: xvfb, xdotool, imagemagick)")
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x600x24", "+extension", "GLX", "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as answer:
        monkeypatch.setenv("DISPLAY", f":{answer.readline().strip()}")
    monkeypatch.setenv("LIBGL_ALWAYS_SOFTWARE", "1")
    yield
    server.terminate()
    server.wait(10)


class Desk:
    """Somebody at the screen, with a preview of `stage` in front of them."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.folder = folder
        save(stage(), folder / "stage.catoptric")
        size = f"{SIZE[0]}x{SIZE[1]}"
        command = [sys.executable, "-c", PROGRAM, "preview", str(folder / "stage.catoptric"), "--resolution", size]
        self.process = subprocess.Popen([*command, *options], stderr=subprocess.PIPE, text=True)
        wait_until(lambda: self.find() or self.process.poll() is not None)
        self.rest()

    def find(self) -> str:
        return subprocess.run(["xdotool", "search", "--name", "Catoptric"], capture_output=True, text=True).stdout

    def do(self, *arguments: str) -> None:
        subprocess.run(["xdotool", *arguments], check=True)
        time.sleep(0.3)

    def shot(self) -> np.ndarray:
        path = self.folder / "shot.png"
        subprocess.run(["import", "-window", "root", str(path)], check=True)
        return picture_of(path)[: SIZE[1], : SIZE[0]]

    def rest(self) -> np.ndarray:
        """The screen, once it has not changed for a second."""
        shots = [self.shot()]

        def still():
            time.sleep(1.0)
            shots.append(self.shot())
            return shots[-1].any() and np.array_equal(*shots[-2:])

        wait_until(still)
        return shots[-1]

    def ticks(self) -> int:
        """Hundredths of a second of processor time so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return int(fields[11]) + int(fields[12])


@pytest.fixture
def desk(screen, tmp_path):
    made = Desk(tmp_path)
    yield made
    made.process.kill()
    made.process.communicate()


def expected(method):
    drawing = named(method)()
    scene = stage()
    drawing.prepare(scene, Lighting.UNLIT)
    try:
        return to_bytes(drawing.render(View(scene.camera, *SIZE, 4)).color).astype(int)
    finally:
        drawing.release()


def test_a_visit(desk):
    desk.do("key", "h")
    shot = desk.rest()
    assert np.abs(shot - expected("layered-depth"))[:PANEL].max() <= 1

    before = desk.ticks()
    time.sleep(3.0)
    assert desk.ticks() - before <= 15  # 5 % of a core; a picture a second would be several times that

    desk.do("key", "1")
    assert np.abs(desk.rest() - expected("environment-map"))[:PANEL].max() <= 1
    desk.do("key", "p")
    picture = desk.folder / "stage-001.png"
    wait_until(picture.exists)
    assert np.abs(picture_of(picture) - expected("environment-map")).max() <= 1

    desk.do("key", "ctrl+5")
    halves = desk.rest()[:PANEL]
    middle = SIZE[0] // 2
    assert np.abs(halves - expected("environment-map")[:PANEL])[:, : middle - 1].max() <= 1
    assert np.abs(halves - expected("layered-depth")[:PANEL])[:, middle + 1 :].max() <= 1
    assert (halves[:, middle - 1 : middle + 1] == 255).all()

    desk.do("mousemove", str(middle), "100", "mousedown", "1")
    desk.do("mousemove", str(middle + 60), "100")
    desk.do("mousemove", str(middle + 100), "100", "mouseup", "1")
    assert (desk.rest()[:PANEL, middle + 99 : middle + 101] == 255).all()

    desk.do("key", "v", "key", "r", "keydown", "w")
    desk.do("keyup", "w", "key", "r")
    wait_until((desk.folder / "stage-001.path.json").exists)
    assert np.abs(desk.rest() - expected("environment-map"))[:PANEL].mean() > 3

    desk.do("key", "Home")
    desk.do("mousemove", "300", "100", "mousedown", "3", "mousemove", "330", "100", "mousemove", "360", "100")
    desk.do("mouseup", "3")
    assert np.abs(desk.rest() - expected("environment-map"))[:PANEL].mean() > 3

    desk.do("key", "ctrl+q")
    assert desk.process.wait(20) == 0
    assert desk.process.stderr.read() == ""


def test_the_mouse_turns_the_view_beyond_any_border_and_comes_back(desk):
    place = subprocess.run(["xdotool", "search", "--name", "Catoptric"], capture_output=True, text=True).stdout.split()
    desk.do("windowfocus", place[0], "mousemove", "300", "150")
    desk.do("key", "h")
    desk.do("key", "r")
    desk.do("mousedown", "1")
    for _ in range(40):
        desk.do("mousemove_relative", "60", "0")
    desk.do("mouseup", "1")
    desk.do("key", "r")
    saved = desk.folder / "stage-001.path.json"
    wait_until(saved.exists)
    first, *_, last = json.loads(saved.read_text())["keys"]
    turned = abs(last["yaw"] - first["yaw"])
    pixel = np.degrees(36.0 / 50.0 / SIZE[0])
    assert 36 * 60 * pixel < turned <= 41 * 60 * pixel  # 2400 pixels on a screen of 1024
    assert last["pitch"] == pytest.approx(first["pitch"], abs=3 * pixel)
    said = subprocess.run(["xdotool", "getmouselocation"], capture_output=True, text=True).stdout
    assert [int(part[2:]) for part in said.split()[:2]] == [pytest.approx(300, abs=1), pytest.approx(150, abs=1)]


def test_a_file_that_is_saved_again_is_shown_again(desk):
    desk.do("key", "h", "mousemove", "900", "500")
    before = desk.rest()
    bare = stage()
    save(replace(bare, instances=(bare.instances[0], bare.instances[2])), desk.folder / "stage.catoptric")
    time.sleep(2.0)
    after = desk.rest()
    assert np.abs(after - before)[:PANEL].mean() > 2
    assert desk.process.poll() is None


@pytest.mark.parametrize("lack", [{"MESA_GL_VERSION_OVERRIDE": "3.3"}, {"DISPLAY": ""}], ids=["OpenGL", "screen"])
def test_what_is_missing_is_told_in_a_line(screen, tmp_path, monkeypatch, lack):
    for name, value in lack.items():
        monkeypatch.setenv(name, value)
    save(stage(), tmp_path / "stage.catoptric")
    command = [sys.executable, "-c", PROGRAM, "preview", str(tmp_path / "stage.catoptric")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith("catoptric: cannot open a window here")
