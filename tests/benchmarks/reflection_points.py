"""How near both searches come to the closed form (Alhazen) on a ball, by where vertices are.

Run: python tests/benchmarks/reflection_points.py [--count 10000] [--size 512]

Errors are distances between points of a ball of radius 1, for vertices that it does not hide, with an eye from 0.01
radii above it to infinitely far away. Our search is given 4 and 6 steps, the published one 9 and 32. The last lines
time our search.
"""

import argparse
from time import process_time

import numpy as np
from catoptric.addon.baking.reflector_maps import ReflectorMap
from catoptric.addon.baking.reflector_maps_tables import ResidentMaps
from catoptric.addon.gl import call
from catoptric.addon.methods.virtual.convergence import reflection_points
from catoptric.addon.scene import Scene
from catoptric.tests.search_stage import PLACES, Search, alhazen, around, maps_of, pairs, sphere
from catoptric.tests.stage import looking, scene_of

SEED = 17
SEARCHES = {"ours": (4, 6), "published": (9, 32)}
LIMIT = 1e-4
TIMED = 500_000


def errors(tables: ResidentMaps, place: str, count: int, search: str, steps: int) -> np.ndarray:
    """(N,) radii, of `count` pairs or more."""
    parts = []
    for eye, vertices in pairs(place, count, SEED):
        found = call(reflection_points, tables, 1, eye, vertices, steps, search == "published")[:, :3]
        parts.append(np.linalg.norm(found - alhazen(eye, vertices), axis=1))
    return np.concatenate(parts)


def print_errors(scene: Scene, maps: list[ReflectorMap], count: int) -> None:
    """A row for each search and place."""
    tables = call(ResidentMaps, scene, {0: maps})
    print(
        f"{'search':10}{'steps':>6}  {'vertices':40}{'pairs':>7}{'median':>9}{'99 %':>9}{'worst':>9}  beyond {LIMIT:g}"
    )
    for search, each in SEARCHES.items():
        for steps in each:
            for place in PLACES:
                off = errors(tables, place, count, search, steps)
                told = "".join(f"{value:9.1e}" for value in (np.median(off), np.quantile(off, 0.99), off.max()))
                print(f"{search:10}{steps:6}  {place:40}{len(off):7}{told}  {100 * (off > LIMIT).mean():.2f} %")
    call(tables.release)


def print_time(scene: Scene, maps: list[ReflectorMap], repeats: int = 5) -> None:
    """Processor time of our search, the fastest of some."""
    search, vertices = Search(scene, {0: maps}, (1,)), around(TIMED, np.random.default_rng(SEED))
    for steps in SEARCHES["ours"]:
        times = []
        for _ in range(repeats):
            start = process_time()
            search.find((3.0, 0.0, 0.0, 1.0), vertices, steps)
            times.append(process_time() - start)
        print(f"{TIMED} vertices, {steps} steps: {min(times):.2f} s of processor time")


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000, help="pairs in each place")
    parser.add_argument("--size", type=int, default=512, help="texels along a face of the maps")
    given = parser.parse_args()
    ball = sphere(6)
    scene, maps = scene_of([(ball, np.eye(4), True)], looking((0, -5, 0))), maps_of(ball, given.size, 2)
    print_errors(scene, maps, given.count)
    print_time(scene, maps)


if __name__ == "__main__":
    main()
