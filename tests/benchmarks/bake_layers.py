"""Bake times of layered depth textures by layers and triangles, beside Zhang et al., Table 1.

Run: python tests/benchmarks/bake_layers.py [MESH ...] [--resolution 512]; a MESH is any file that
trimesh reads. Table 1 fits 12.7 ms + 15.8 ms a layer + 12.4 ms per 100,000 triangles on a GeForce 7800.
"""

import argparse
import resource
import sys
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np
import trimesh
from catoptric.addon.baking.layered_depth import RESOLUTION, bake_instance
from catoptric.addon.drawing import Resident
from catoptric.addon.gl import call, is_software, require
from catoptric.addon.scene import Camera, ColorSource, Instance, Lighting, Material, Mesh, Scene

_REPEATS = 3


def nested_shells(layers: int, triangles: int) -> trimesh.Trimesh:
    """Separate closed shells within each other, `layers` walls deep, of about `triangles` in all."""
    walls = -(-layers // 2)
    subdivisions = max(1, round(np.log(triangles / (40 * walls)) / np.log(4)))
    shells = []
    for wall in range(walls):
        outer = 1.0 - wall / walls
        shells.append(trimesh.creation.icosphere(subdivisions, radius=outer))
        if 2 * wall + 1 < layers:
            inner = trimesh.creation.icosphere(subdivisions, radius=outer - 0.5 / walls)
            inner.invert()
            shells.append(inner)
    return trimesh.util.concatenate(shells)


def scene_of(shape: trimesh.Trimesh) -> Scene:
    """A scene of one plain object."""
    faces = np.asarray(shape.faces, np.int32)
    normals = np.asarray(shape.vertex_normals, np.float32)[faces]
    uvs, slots = np.zeros((len(faces), 3, 2), np.float32), np.zeros(len(faces), np.int32)
    shown = Mesh("shape", np.asarray(shape.vertices, np.float32), faces, normals, uvs, slots)
    grey = Material("grey", ColorSource((0.5, 0.5, 0.5)))
    return Scene("bench", Camera(np.eye(4)), (shown,), (Instance("shape", 0, np.eye(4), (0,)),), (grey,))


def measure(name: str, shape: trimesh.Trimesh, resolution: int) -> tuple[int, int, float]:
    """Print one row; returns layers, triangles and milliseconds."""
    resident = call(Resident, scene_of(shape), Lighting.UNLIT)
    times = []
    for _ in range(_REPEATS):
        start = perf_counter()
        bake = call(bake_instance, resident, 0, resolution)
        times.append(1e3 * (perf_counter() - start))
    call(resident.release)
    rows, deepest = sum(len(axis.depths) for axis in bake.axes), bake.layers
    typical = int(np.ceil(np.quantile(np.concatenate([axis.counts[axis.counts > 0] for axis in bake.axes]), 0.999)))
    fit = 12.7 + 15.8 * typical + 12.4 * len(shape.faces) / 1e5
    print(
        f"{name[:24]:24} {len(shape.faces):>10,} {typical:>7} {deepest:>8} {median(times):>10.0f} {fit:>9.0f}"
        f" {rows:>11,} {bake.size_bytes / 2**20:>8.1f}"
    )
    return typical, len(shape.faces), median(times)


def main() -> None:
    """Print the table and a fit like the paper's."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", nargs="*", type=Path)
    parser.add_argument("--resolution", type=int, default=RESOLUTION.default)
    options = parser.parse_args()
    renderer = call(lambda: require().info["GL_RENDERER"])
    print(f"{renderer}{': software rendering, no GPU' if is_software(renderer) else ''}; {options.resolution} texels")
    heads = ("triangles", 10), ("layers", 7), ("deepest", 8), ("bake ms", 10), ("Table 1", 9), ("rows", 11), ("MiB", 8)
    print("object".ljust(24), *(head.rjust(width) for head, width in heads))
    measured = [
        measure(f"shells {layers} × {triangles:,}", nested_shells(layers, triangles), options.resolution)
        for layers in (1, 2, 3, 5)
        for triangles in (2_000, 30_000, 130_000)
    ]
    measured += [
        measure(path.name, trimesh.load(path, process=False, force="mesh"), options.resolution)
        for path in options.meshes
    ]
    layers, triangles, milliseconds = np.array(measured).T
    terms = np.stack([np.ones(len(layers)), layers, triangles / 1e5], axis=1)
    base, each, per = np.linalg.lstsq(terms, milliseconds, rcond=None)[0]
    print(f"fit: {base:.1f} ms + {each:.1f} ms a layer + {per:.1f} ms per 100,000 triangles")
    print("Table 1: 12.7 ms + 15.8 ms a layer + 12.4 ms per 100,000 triangles")
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:,.0f} MiB")


if __name__ == "__main__":
    sys.exit(main())
