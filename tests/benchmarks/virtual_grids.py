"""Grids of virtual objects against every vertex searched, and how near the searches come step by step.

Run by reflections.py --part virtual.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from time import perf_counter

import numpy as np
from catoptric.addon.baking.reflector_maps import FINER, SPREAD
from catoptric.addon.baking.reflector_maps import SIZE as MAP_SIZE
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.cache import Cache
from catoptric.addon.gl import require
from catoptric.addon.methods.contract import Frame, View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.methods.virtual.convergence import convergence
from catoptric.addon.methods.virtual.pictures import VirtualPicture
from catoptric.addon.metrics import error_maps
from catoptric.addon.scene import Lighting, Scene
from catoptric.scenes import path_of

GRIDS = {4.1: 12.5, 5.5: 10.5, 9.6: 7.8, 14.3: 6.4}
"""Per cent of the vertices that a grid has, and what the paper gains by it: its frames a second over 1.3."""

REFINED = (0.5, 1.0, 2.0)
"""Pixels that the level-of-detail grid is refined to."""

SIZE = (768, 512)

REPEATS = 3
"""Searches of which the fastest counts: the first has caches to fill."""

MIRRORED = (
    ("mirror-ball", 0.0, 0),
    ("mirror-ball", 0.2, 0),
    ("mirror-ball", 0.0, 500),
    ("kitchen", 0.0, 0),
    ("kitchen", 0.35, 0),
    ("kitchen", 0.0, 500),
)
"""Scenes, into what pieces what they show is cut, and how many vertices it must have to show at all."""


def kettle_alone(scene: Scene, fineness: int) -> Scene:
    """A scene that mirrors meshes of so many vertices; the kitchen in its kettle alone, where section 7 looks."""
    instances = []
    for one in scene.instances:
        mirrors = one.reflector and (scene.name != "kitchen" or one.name == "Kettle")
        shows = len(scene.meshes[one.mesh].positions) >= fineness
        instances.append(replace(one, reflector=mirrors, in_reflections=one.in_reflections and shows))
    return replace(scene, instances=tuple(instances))


def virtual(size: tuple[int, int] = (384, 256), rounds: int = 4) -> None:
    """What grids gain and lose against every vertex, and the steps that both searches take."""
    loaded = {name: replace(extract(open_blend(path_of(name))), name=name) for name, _, _ in MIRRORED}
    for name, cut, fineness in MIRRORED:
        scene = kettle_alone(loaded[name], fineness)
        settings = {f"{grid:g} %": {"grid": grid} for grid in (0.0, *GRIDS)}
        settings |= {f"{within:g} pixels": {"refine": within} for within in REFINED}
        drawn = {name: METHODS["virtual-objects-published"]({"cut": cut, **own}) for name, own in settings.items()}
        try:
            for method in drawn.values():
                method.prepare(scene, Lighting.UNLIT)
            print(f"{name}, pieces of {cut:g}, meshes of {fineness} vertices and more")
            view = View(scene.camera, *size, 1)
            print_grids(*grids(drawn, view, rounds), pictures(drawn, view), truth(scene, view))
        finally:
            for method in drawn.values():
                method.release()
    settings = {parameter.name: parameter.default for parameter in (FINER, MAP_SIZE, SPREAD)}
    for name, scene in loaded.items():
        for search, curve in convergence(scene, SIZE, settings, Cache()).items():
            shares = " ".join(f"{100 * share:6.2f}" for share in curve.within)
            print(f"{name:12} {search:10} within a pixel, %, by step: {shares}; 99 % after {curve.exact_after}")


def truth(scene: Scene, view: View) -> Frame:
    """What rays meet."""
    drawn = METHODS["layered-depth"]()
    drawn.prepare(scene, Lighting.UNLIT)
    try:
        return drawn.render(replace(view, samples=4))
    finally:
        drawn.release()


def pictures(drawn: dict, view: View) -> dict[str, Frame]:
    """Pictures by grid, of 16 samples a pixel, as pictures are compared."""
    return {name: method.render(replace(view, samples=4)) for name, method in drawn.items()}


def grids(drawn: dict, view: View, rounds: int) -> tuple[dict, dict]:
    """How many points are searched by grid, and the least milliseconds of search and reflection over rounds of all."""
    counts, times = {}, {grid: [np.inf, np.inf] for grid in drawn}
    for _ in range(rounds):
        for grid, method in drawn.items():
            with searching() as spent:
                frame = method.render(view)
            times[grid] = np.minimum(times[grid], (sum(time for time, _ in spent), frame.time_ms["reflection"]))
            counts[grid] = sum(count for _, count in spent)
    return counts, times


@contextmanager
def searching() -> Iterator[list[tuple[float, int]]]:
    """The milliseconds that each search inside takes, and how many points it has."""
    spent, find = [], VirtualPicture.find

    def timed(picture: VirtualPicture, *arguments) -> None:
        context = require()
        context.finish()
        least = np.inf
        for _ in range(REPEATS):
            start = perf_counter()
            find(picture, *arguments)
            context.finish()
            least = min(least, 1e3 * (perf_counter() - start))
        spent.append((least, picture.searches))

    VirtualPicture.find = timed
    try:
        yield spent
    finally:
        VirtualPicture.find = find


def print_grids(counts: dict, times: dict, frames: dict[str, Frame], truth: Frame) -> None:
    """A row for each grid, against every vertex; the ideal gain is that of the searches."""
    every, mask = frames["0 %"], frames["0 %"].reflectors >= 0.5
    away = error_maps(every.color, truth.color).over(mask).flip
    print(
        f"  every vertex: {counts['0 %']:,} searched in {times['0 %'][0]:.0f} ms, reflected in {times['0 %'][1]:.0f} ms"
    )
    papers = dict(zip([f"{grid:g} %" for grid in GRIDS], GRIDS.values(), strict=True))
    for grid, frame in list(frames.items())[1:]:
        search, whole = times["0 %"] / times[grid]
        share = counts[grid] / counts["0 %"]
        flip = error_maps(frame.color, every.color).over(mask).flip
        farther = error_maps(frame.color, truth.color).over(mask).flip - away
        print(
            f"  {grid:10}: {share:5.1%} searched, {search:5.1f}× ({search * share:4.0%} of the ideal), "
            f"reflection {whole:5.1f}×, the paper's frame {papers.get(grid, '-'):>4}×; "
            f"FLIP {flip:.4f} from every vertex, {farther:+.4f} against rays"
        )
