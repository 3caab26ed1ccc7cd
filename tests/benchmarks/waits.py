"""How long drawing keeps an interface waiting: the longest times in which no other Python thread runs.

Run: python tests/benchmarks/waits.py [--scenes a,b] [--methods a,b] [--resolution 960x540]

A studio prepares a scene and draws it from several places on the GL thread, as for Blender's viewport, while this
thread wants to run every 2 ms. What the system's scheduler kept it waiting for, with other programs or more threads
than cores, is told by Linux and left out; elsewhere it counts. A first run builds shaders, which no call can be
interrupted in: the second of two runs tells of everything else.
"""

import argparse
import sys
import time
import traceback
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from threading import get_ident, get_native_id

from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.gl import call, is_software, require
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.methods.studio import Act, Studio
from catoptric.addon.scene import Camera, Lighting, Scene
from catoptric.scenes import path_of

SCENES = "mirror-ball", "living-room"
TICK_S, LONG_S, STEP = 0.002, 0.1, 0.02
MOVES = 4
SCHEDULER = Path(f"/proc/self/task/{get_native_id()}/schedstat")


def delayed_s() -> float:
    """For how long the scheduler has kept this thread waiting for a core, as far as it tells."""
    try:
        return int(SCHEDULER.read_text().split()[1]) / 1e9
    except OSError:
        return 0.0


def place_of(thread: int) -> str:
    """Where in our code any other thread than `thread` stands."""
    for other, frame in sys._current_frames().items():
        ours = [line for line in traceback.extract_stack(frame) if "catoptric" in line.filename]
        if other != thread and ours:
            return f"{Path(ours[-1].filename).name}:{ours[-1].lineno}"
    return "elsewhere"


def waits(studio: Studio) -> Iterator[tuple[float, str]]:
    """Seconds that each tick came late, and what held it up, until the studio has nothing left to do."""
    while studio.busy:
        start, delayed = time.perf_counter(), delayed_s()
        time.sleep(TICK_S)
        late = time.perf_counter() - start - TICK_S - (delayed_s() - delayed)
        yield late, place_of(get_ident()) if late > LONG_S / 2 else ""


def report(stage: str, studio: Studio) -> None:
    """Print the longest wait of a stage."""
    start = time.perf_counter()
    late, place = max(waits(studio), default=(0.0, ""))
    over = "  over 100 ms" if late > LONG_S else ""
    print(
        f"    {stage:14} {time.perf_counter() - start:6.1f} s, longest {1e3 * late:6.0f} ms  {place}{over}", flush=True
    )
    if studio.problem:
        print(f"    {studio.problem}")


def aside(camera: Camera, metres: float) -> Camera:
    """The camera moved along the world's X axis."""
    matrix = camera.matrix.copy()
    matrix[0, 3] += metres
    return replace(camera, matrix=matrix)


def moved(scene: Scene) -> Scene:
    """The scene with its first object that is no mirror moved a little."""
    index = next(index for index in range(len(scene.instances)) if index not in scene.reflectors)
    instances = list(scene.instances)
    instances[index] = replace(instances[index], matrix=aside(instances[index], STEP).matrix)
    return replace(scene, instances=tuple(instances))


def measure(scene: Scene, method: str, size: tuple[int, int]) -> None:
    """All stages of one method."""
    assignment = {scene.instances[index].name: (method, {}) for index in scene.reflectors}
    studio = Studio(lambda: None)

    def look(metres: float) -> None:
        camera = aside(scene.camera, metres)
        studio.look("viewer", View(camera, *size, 1), lambda canvas, method, view: canvas.rows(canvas.color))

    try:
        studio.show(Act(scene, Lighting.UNLIT, assignment))
        report("preparation", studio)
        look(0.0)
        report("first picture", studio)
        for number in range(MOVES):
            look(STEP * (number + 1))
            report("camera moves", studio)
        studio.show(Act(moved(scene), Lighting.UNLIT, assignment))
        look(0.0)
        report("object moves", studio)
    finally:
        studio.close()


def main() -> None:
    """Parse the arguments, and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--resolution", default="960x540")
    options = parser.parse_args()
    renderer = call(lambda: require().info["GL_RENDERER"])
    print(f"{renderer}: {'software rendering' if is_software(renderer) else 'GPU'}")
    for name in options.scenes.split(","):
        scene = extract(open_blend(path_of(name)))
        for method in options.methods.split(","):
            print(f"{name}  {method}")
            measure(scene, method, tuple(map(int, options.resolution.split("x"))))


if __name__ == "__main__":
    main()
