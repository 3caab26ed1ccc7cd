"""Takes the manual's pictures from the programs themselves: python -m catoptric.docs.take_pictures [NAME ...]

Names are those of `PICTURES`; all of them unless given. Blender's own window needs what `tests/gui` needs: Xvfb,
xdotool, ImageMagick and Blender, or root to make a Debian with them. The report needs Chromium.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from ..addon.methods.techniques import TECHNIQUES
from ..addon.metrics import to_bytes
from ..batch.cli import main as catoptric
from ..batch.pictures import load_picture
from ..batch.results import Results
from .blender_pictures import take_in_blender
from .picture_files import save, strip

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")


def take_mirror_ball(folder: Path) -> None:
    """What the README begins with: a mirror ball in light that Cycles has baked, by layered-depth."""
    shot = folder / "mirror-ball.png"
    if (
        catoptric(["render", "mirror-ball", "--method", "layered-depth", "--lighting", "cycles", "--out", str(shot)])
        != 0
    ):
        raise SystemExit("mirror-ball could not be rendered")
    save(load_picture(shot), "mirror-ball.jpg")


def take_methods(folder: Path) -> None:
    """A mirror ball by Cycles, and by every method that does not choose among the others."""
    _compare(folder, "mirror-ball", "--methods", ",".join(TECHNIQUES))
    results = Results.load(folder).results
    shown = {"Cycles": _ball(folder / results[0].images.reference)}
    for result in results:
        shown[f"{result.method}: FLIP {result.over_reflectors.flip:.3f}"] = _ball(folder / result.images.method)
    save(strip(shown, columns=3, width=1100), "methods.jpg")


def take_report(folder: Path) -> None:
    """The page that `compare` writes, in a browser."""
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if browser is None:
        raise SystemExit("report: install Chromium first")
    _compare(folder, "hollow-box", "--resolution", "384x256")
    shot = folder / "report.png"
    address = (folder / "report.html").as_uri() + "#mode=wipe&show=5&against=1"
    switches = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--virtual-time-budget=9000")
    files = (f"--user-data-dir={folder / 'profile'}", f"--screenshot={shot}", "--window-size=1200,1470")
    # The browser's clock does not wait for the pictures to be unpacked: until then their stage is grey.
    for _ in range(8):
        subprocess.run([browser, *switches, *files, address], check=True, capture_output=True, timeout=120)
        pixels = load_picture(shot)
        if (pixels == 128).all(axis=-1).mean() < 0.05:
            break
    save(pixels, "report.jpg")


def _compare(folder: Path, scene: str, *arguments: str) -> None:
    if catoptric(["compare", scene, "--out", str(folder), *arguments]) != 0:
        raise SystemExit(f"{scene} could not be compared")


def _ball(path: Path) -> np.ndarray:
    """The part of a picture of `mirror-ball` that the ball fills, as a screen shows it."""
    return to_bytes(load_picture(path))[42:432, 189:579]


PICTURES = {"mirror-ball": take_mirror_ball, "methods": take_methods, "report": take_report, "blender": take_in_blender}


def main(names: list[str]) -> None:
    """Take some pictures, or all."""
    for name in names or PICTURES:
        if name not in PICTURES:
            raise SystemExit(f"no picture {name!r}; there are: {', '.join(PICTURES)}")
        with tempfile.TemporaryDirectory() as folder:
            PICTURES[name](Path(folder))


if __name__ == "__main__":
    main(sys.argv[1:])
