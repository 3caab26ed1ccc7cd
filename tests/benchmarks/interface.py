"""What the extension costs Blender's window: stalls, the copy to the screen, idleness, memory.

Run: python tests/benchmarks/interface.py [--part stalls|copy|idle|bakes|redraws ...] [--pictures FOLDER]

It opens Blender on a screen that nobody sees, with the zip as it is packed now, on the scene mirror-ball; it needs what
`tests/gui` needs. `stalls` has a timer tick every 10 ms while the view turns or an object moves, in a viewport of
960 × 540, with Blender's own overlays and without: Rendered by an engine that draws nothing, which is what Blender
alone takes, then by Catoptric, with the longest that each of our functions held the main thread. `copy` turns the
camera of a viewport of that size. `idle` is the processor's time over 10 s at rest. `bakes` and `redraws` are what the
process holds in memory while it bakes 200 times by the panel's own operator, and while it draws 1,000 views. At the end
it says what Blender printed.
"""

import argparse
import json
import re
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from catoptric.batch.package import ROOT, package
from catoptric.scenes import path_of
from catoptric.tests.gui.machine import find
from catoptric.tests.gui.window import Window

SCENE, MOVED = "mirror-ball", "Suzanne left"
VIEWPORT = (960, 540)
TICKS, TURNS = 500, 100
STALL_MS = 100.0
BAKES, REDRAWS, EVERY = 200, 1000, 50
IDLE_S = 10.0

MODE = "view3d()[1].spaces.active.shading.type = {!r}"
ENGINE = "bpy.context.scene.render.engine = {!r}"
OVERLAYS = "view3d()[1].spaces.active.overlay.show_overlays = {!r}"
NOTHING = """
class Nothing(bpy.types.RenderEngine):
    bl_idname, bl_label = "NOTHING", "Nothing"

    def view_update(self, context, depsgraph):
        pass

    def view_draw(self, context, depsgraph):
        pass

bpy.utils.register_class(Nothing)
"""
EYE = "probe.look_at('Ball', 4.0)"
WHOLE = """
window, area, regions = view3d()
with bpy.context.temp_override(window=window, area=area, region=regions["WINDOW"]):
    bpy.ops.screen.screen_full_area(use_hide_panels=True)
"""
ONE_SAMPLE = "bpy.context.scene.catoptric.samples = '1'"
SIZE = "region = view3d()[2]['WINDOW']; print(region.width, '×', region.height)"
RENDERER = """
from importlib import import_module
gl = import_module(probe.MODULE + ".addon.gl")
name = gl.call(lambda: gl.require().info["GL_RENDERER"])
print(name, "software rendering" if gl.is_software(name) else "GPU", sep=": ")
"""
SMALL = """
settings = bpy.context.scene.catoptric
settings.scale, settings.samples = "2", "1"
settings.methods.layered_depth_published.resolution = 32
"""
CLEAR = """
probe.ours("bakes").wait_for(bpy.context.scene, probe.stage())
bpy.ops.catoptric.clear()
"""
BAKE = """
window, area, regions = view3d()
with bpy.context.temp_override(window=window, area=area, region=regions["WINDOW"]):
    bpy.ops.catoptric.bake("INVOKE_DEFAULT")
"""
NOTHING_UNDER_WAY = "probe.ours('work').current() is None"


class Bench:
    """One machine, one freshly packed zip, and what Blender has printed in its windows."""

    def __init__(self, folder: Path, pictures: Path | None) -> None:
        self.machine, self.pictures = find(folder), pictures
        (self.zip,) = package(folder, print, ["linux-x64"], [Window(self.machine).version()], ROOT)
        self.printed: Counter[str] = Counter()

    @contextmanager
    def window(self, name: str, width: int = 1280, height: int = 800) -> Iterator[Window]:
        """A window on a copy of the scene, with the engine chosen and the mode Solid."""
        window = Window(self.machine, width, height, name=name)
        window.install(self.zip)
        scene = self.machine.share / f"{SCENE}.blend"
        shutil.copy(path_of(SCENE), scene)
        with window:
            window.python(f"bpy.ops.wm.open_mainfile(filepath={str(scene)!r})")
            window.settle(2.0)
            window.python(ENGINE.format("CATOPTRIC"))
            window.python(EYE)
            yield window
            if self.pictures:
                window.picture(self.pictures / f"{name}.png")
        lines = window.log.read_text(errors="replace").splitlines()
        self.printed.update(re.sub(r"^[\d:.]+ +", "", line.replace(str(self.machine.share), "")) for line in lines)


def rendered(window: Window, engine: str = "CATOPTRIC") -> None:
    """Have the engine draw; wait until Catoptric has."""
    window.python(MODE.format("RENDERED"))
    window.settle(1.0)
    if engine == "CATOPTRIC":
        window.until("probe.at_rest()")


def spread(values: Sequence[float]) -> str:
    """Median, 95 % and longest, in milliseconds."""
    median, most, longest = np.percentile(values, (50, 95, 100))
    return f"median {median:6.1f} ms, 95 % {most:6.1f} ms, longest {longest:6.1f} ms"


def stalls(bench: Bench) -> None:
    """How far apart the ticks of a timer are, and who held the main thread."""
    held: dict[str, list[float]] = {}
    with bench.window("stalls", *VIEWPORT) as window:
        window.python(WHOLE)
        window.python(NOTHING)
        for overlays in (True, False):
            window.python(OVERLAYS.format(overlays))
            for engine in ("NOTHING", "CATOPTRIC"):
                window.python(ENGINE.format(engine))
                rendered(window, engine)
                for name, step in {"orbit": "probe.orbit", "object moves": f"probe.shift({MOVED!r})"}.items():
                    found = moved(window, step)
                    gaps = found["gaps"]
                    print(
                        f"{'with' if overlays else 'without'} overlays, {engine.lower():9} {name:13} {spread(gaps)}, "
                        f"over {STALL_MS:.0f} ms: {sum(gap > STALL_MS for gap in gaps)} of {len(gaps)}, "
                        f"pictures a second: {found['pictures']:.1f}"
                    )
                    for function, own in found["held"].items():
                        held.setdefault(function, []).extend(own)
                if bench.pictures:
                    window.picture(bench.pictures / f"stalls-{engine.lower()}-{overlays}.png")
    print("the main thread, held by our own functions:")
    for function, times in sorted(held.items(), key=lambda item: -max(item[1])):
        print(f"  {function:44} {len(times):5} calls, {spread(times)}")


def moved(window: Window, step: str) -> dict:
    """While something moves: milliseconds between the ticks of a timer, those that our functions took, and pictures
    a second.
    """
    window.settle(2.0)
    window.python(f"probe.motion = probe.Motion({step}, {TICKS})")
    window.until("probe.motion.over", 300.0)
    result = json.loads(window.python("print(probe.motion.result())"))
    result["pictures"] /= 1e-3 * sum(result["gaps"])
    return {**result, "gaps": result["gaps"][TICKS // 10 :]}


def copy(bench: Bench) -> None:
    """What the way to the screen takes of a frame."""
    with bench.window("copy", *VIEWPORT) as window:
        window.python(WHOLE)
        window.python(ONE_SAMPLE)
        rendered(window)
        print("viewport", window.python(SIZE).strip())
        records, _ = turn(window, TURNS)
        window.until("probe.at_rest()")
        back = json.loads(window.python(f"print(probe.read_back_ms({TURNS}))"))
    names = ("first", "total", "copy", "frame")
    first, total, sent, drawn = (np.array([record[name] for record in records]) for name in names)
    print(f"from a camera move to the screen {spread(first)}")
    print(f"  in whole                       {spread(total)}")
    print(f"  drawing                        {spread(drawn)}")
    print(f"  reading back                   {spread(back)}")
    print(f"  to the screen                  {spread(sent)}")
    way = sent + np.median(back)
    shares = way / (drawn + way)
    print(f"the way to the screen is {np.median(shares):.1%} of a frame, at most {np.max(shares):.1%}")


def turn(window: Window, count: int) -> tuple[list[dict[str, float]], list[float]]:
    """Turn the camera, one picture at a time: times of each, and resident megabytes after it."""
    window.python(f"probe.redraws = probe.Redraws({count})")
    window.until("probe.redraws.over", 1800.0)
    result = json.loads(window.python("print(probe.redraws.result())"))
    return result["records"], result["memory"]


def idle(bench: Bench) -> None:
    """Processor time of a window that nobody touches."""
    with bench.window("idle") as window:
        for mode in ("SOLID", "RENDERED", "SOLID", "RENDERED"):
            window.python(MODE.format(mode)) if mode == "SOLID" else rendered(window)
            window.settle(3.0)
            window.python("probe.held = probe.Held().__enter__()")
            before, start = processor_s(window.pid), time.monotonic()
            time.sleep(IDLE_S)
            used, lasted = processor_s(window.pid) - before, time.monotonic() - start
            window.python("probe.held.__exit__()")
            calls = window.python("print({name: len(times) for name, times in probe.held.times.items()})").strip()
            print(f"{mode.lower():9} {used:5.2f} s of processor time in {lasted:.1f} s; calls of ours: {calls}")


def processor_s(pid: int) -> float:
    """Seconds that a process and all its threads have used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100.0


def bakes(bench: Bench) -> None:
    """Resident memory over many bakes."""
    with bench.window("bakes") as window:
        window.python(SMALL)
        rendered(window)
        sizes = []
        for number in range(BAKES):
            if number > 0:
                window.python(CLEAR)
            window.python(BAKE)
            window.until(NOTHING_UNDER_WAY)
            sizes.append(float(window.python("print(probe.resident_mb())")))
        print(window.python("print(probe.ours('work').last())").strip())
    print_trend("bakes", sizes)


def redraws(bench: Bench) -> None:
    """Resident memory over many pictures."""
    with bench.window("redraws") as window:
        window.python(SMALL)
        rendered(window)
        _, sizes = turn(window, REDRAWS)
    print_trend("redraws", sizes)


def print_trend(what: str, sizes: Sequence[float]) -> None:
    """Every so manyth size, and how fast the second half grows."""
    shown = {number: sizes[number - 1] for number in (1, *range(EVERY, len(sizes) + 1, EVERY))}
    print(f"megabytes after {what}: " + ", ".join(f"{number}: {size:.0f}" for number, size in shown.items()))
    half = np.asarray(sizes[len(sizes) // 2 :])
    slope = np.polyfit(np.arange(len(half)), half, 1)[0]
    print(f"  the second half grows by {1e3 * slope:+.1f} kB each")


PARTS = {"stalls": stalls, "copy": copy, "idle": idle, "bakes": bakes, "redraws": redraws}


def main() -> None:
    """Print the parts asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", nargs="+", default=list(PARTS), choices=PARTS)
    parser.add_argument("--pictures", type=Path, help="a folder for pictures of the screen")
    given = parser.parse_args()
    if given.pictures:
        given.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(Path(folder), given.pictures)
        with bench.window("renderer") as window:
            print(window.python(RENDERER).strip())
        for part in given.part:
            print(f"\n{part}", flush=True)
            PARTS[part](bench)
        print("\nBlender printed:")
        for line, count in sorted(bench.printed.items()):
            print(f"  {count} times: {line}")


if __name__ == "__main__":
    main()
