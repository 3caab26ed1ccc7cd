"""What it takes to go on after an object has moved: tables made anew and uploaded, before anything is drawn.

Run: python tests/benchmarks/moves.py [--scenes a,b] [--crowd 1000] [--method layered-depth]

A viewport does this at every step of a drag. `crowd` is a ball among so many others, each an instance of one mesh.
"""

import argparse
from dataclasses import replace
from statistics import median
from time import perf_counter

import numpy as np
import trimesh
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.gl import call, require
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.scene import Lighting, Scene
from catoptric.scenes import path_of
from reflections import beside_a_ball

SIZE = (960, 540)
STEPS = 9


def crowd(count: int) -> Scene:
    """A mirror ball among `count` small ones of 5,120 triangles."""
    scene, random = beside_a_ball(trimesh.creation.icosphere(4)), np.random.default_rng(0)
    mirror, first, *_ = scene.instances
    others = []
    for number in range(count):
        matrix = trimesh.transformations.random_rotation_matrix(random.random(3))
        matrix[:3, :3] *= 0.1
        matrix[:3, 3] = random.uniform(-5.0, 5.0, 3)
        others.append(replace(first, name=f"ball {number}", matrix=matrix))
    return replace(scene, instances=(mirror, *others))


def moved(scene: Scene) -> Scene:
    """The first object that is no reflector a little farther on; every instance is read anew, as from Blender."""
    index = next(index for index, one in enumerate(scene.instances) if not one.reflector)
    instances = [replace(one, matrix=one.matrix.copy()) for one in scene.instances]
    instances[index].matrix[0, 3] += 0.01
    return replace(scene, instances=tuple(instances))


def updates(scene: Scene, method: str) -> float:
    """Median milliseconds of an update."""
    drawn, times = METHODS[method](), []
    drawn.prepare(scene, Lighting.UNLIT)
    try:
        for _ in range(STEPS):
            drawn.render(View(scene.camera, *SIZE, 1))
            scene = moved(scene)
            start = perf_counter()
            drawn.update(scene)
            times.append(1e3 * (perf_counter() - start))
    finally:
        drawn.release()
    return median(times)


def main() -> None:
    """Print a row a scene."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="mirror-ball,living-room")
    parser.add_argument("--crowd", type=int, default=1000)
    parser.add_argument("--method", choices=METHODS, default="layered-depth")
    given = parser.parse_args()
    print(call(lambda: require().info["GL_RENDERER"]))
    scenes = {name: extract(open_blend(path_of(name))) for name in given.scenes.split(",")}
    for name, scene in (*scenes.items(), ("crowd", crowd(given.crowd))):
        took = updates(scene, given.method)
        print(f"{name:14}{len(scene.instances):6,} instances, an update after one has moved: {took:7.1f} ms")


if __name__ == "__main__":
    main()
