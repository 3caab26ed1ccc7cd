"""What a reflection costs: each method against `environment-map`, dense meshes against light ones, EEVEE.

Run: python tests/benchmarks/reflections.py [--part ratios|density|eevee|memory|glossy|roughness|planar|virtual|traced]
    [--scenes a,b]

`ratios` prints the reflection pass over that of `environment-map`, beside Zhang et al., Table 2
(reflection over reflector). `density` gives the same object 1,500 to 1,000,000 triangles. `eevee`
times a frame against EEVEE's sample, with the error of both. `memory` prints a process's peak. `glossy` prints
the columns of figure 9 of the paper on glossy planar reflections, for its scene at its 1280 × 1024 pixels,
and `planar` each way to clip a perfect mirror there and at 640 × 512. `roughness` prints the FLIP of both glossy
methods over floors of four roughnesses; Cycles takes an hour for their references of `--samples` the first time.
`virtual` prints the grids of section 7 of the paper on reflector cube maps, and how near its search and ours come
step by step. `traced` holds both tracers against Embree and each other, and builds the tree of 1,000,000 triangles.
Other times are medians of frames at 768 × 512, one sample a pixel.
"""

import argparse
import subprocess
import sys
import tempfile
from dataclasses import replace
from time import perf_counter, process_time

import numpy as np
import trimesh
from catoptric.addon.blender.eevee import render_eevee
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.files import open_blend
from catoptric.addon.blender.reference import render_reference
from catoptric.addon.cache import Cache
from catoptric.addon.drawing import Clipping
from catoptric.addon.gl import call, is_software, require
from catoptric.addon.methods.contract import View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.methods.tracers import TRACER
from catoptric.addon.metrics import error_maps
from catoptric.addon.scene import BLACK, Camera, ColorSource, Fresnel, Instance, Lighting, Material, Mesh, Scene, World
from catoptric.addon.tracing import build_tree
from catoptric.addon.tracing.layers import padded_box
from catoptric.batch.footage import lit
from catoptric.batch.sources import locate
from catoptric.scenes import path_of
from catoptric.tests.ray_stage import agreement
from glossy_roughness import frame_of, roughness
from virtual_grids import virtual

SIZE = (768, 512)
PAPER = {"two-balls": 1.54, "hollow-box": 1.58, "knotty-cup": 2.08, "statue": 2.13, "three-genus3": 5.30}
ROOM_SCENES = ("genus3", "mirror-ball", "mirror-room")
COMPARED = ("environment-map", "environment-map-parallax", "layered-depth-published", "layered-depth")
DENSITIES = (1_500, 100_000, 1_000_000)


def ratios(names: list[str]) -> None:
    """Reflection passes of the shipped scenes."""
    print(f"{'scene':14}" + "".join(f"{name.replace('environment', 'env'):>28}" for name in COMPARED) + "    paper")
    for name in names:
        scene = extract(open_blend(path_of(name)))
        times = [frame_of(scene, method).time_ms["reflection"] for method in COMPARED]
        cells = "".join(f"{time:14.1f} ms ({time / times[0]:6.2f}×)" for time in times)
        print(f"{name:14}{cells}  {PAPER.get(name, float('nan')):7.2f}")


def bumpy(triangles: int) -> trimesh.Trimesh:
    """The same wavy ball from about `triangles` triangles."""
    rings = round(np.sqrt(triangles / 4))
    ball = trimesh.creation.uv_sphere(1.0, count=[rings, rings])
    x, y, z = ball.vertices.T
    ball.vertices *= (1 + 0.2 * np.sin(5 * x) * np.sin(4 * y + 1) * np.sin(6 * z))[:, None]
    return ball


def mesh_of(name: str, shape: trimesh.Trimesh) -> Mesh:
    """Smooth, without textures."""
    faces = np.asarray(shape.faces, np.int32)
    normals = np.asarray(shape.vertex_normals, np.float32)[faces]
    uvs, slots = np.zeros((len(faces), 3, 2), np.float32), np.zeros(len(faces), np.int32)
    return Mesh(name, np.asarray(shape.vertices, np.float32), faces, normals, uvs, slots)


def beside_a_ball(shape: trimesh.Trimesh) -> Scene:
    """A mirror ball that shows `shape`, twice."""
    white = ColorSource((0.9, 0.9, 0.9))
    chrome = Material("chrome", diffuse=0.0, reflection=white, fresnel=Fresnel.SCHLICK, roughness=BLACK)
    places = np.stack([np.eye(4)] * 3)
    places[1:, :3, 3] = (2.1, -0.4, 0.0), (-2.1, -0.4, 0.0)
    camera = np.eye(4)
    camera[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    camera[:3, 3] = (0.0, -4.5, 0.0)
    ball, beside = mesh_of("ball", trimesh.creation.icosphere(5)), mesh_of("beside", shape)
    instances = [Instance(f"object {i}", min(i, 1), places[i], (min(i, 1),), reflector=i == 0) for i in range(3)]
    return Scene("density", Camera(camera), (ball, beside), tuple(instances), (chrome, Material("grey")), world=World())


def density() -> None:
    """Reflection passes of one object, coarse to dense."""
    print(f"{'triangles':>10}" + "".join(f"{name:>28}" for name in COMPARED[2:]))
    first: list[float] = []
    for triangles in DENSITIES:
        shape = bumpy(triangles)
        times = [frame_of(beside_a_ball(shape), method).time_ms["reflection"] for method in COMPARED[2:]]
        first = first or times
        cells = "".join(f"{time:15.1f} ms ({time / start:5.2f}×)" for time, start in zip(times, first, strict=True))
        print(f"{len(shape.faces):10,}{cells}")


def eevee(names: list[str]) -> None:
    """A frame of ours against a sample of EEVEE's, and both errors over the reflectors."""
    for name in names:
        opened = open_blend(path_of(name))
        scene = replace(extract(opened), name=name)
        truth = render_reference(opened, scene, Lighting.UNLIT, *SIZE, samples=64, cache=Cache()).color
        ours = frame_of(scene, "layered-depth", samples=4)
        theirs = render_eevee(opened, scene, Lighting.UNLIT, *SIZE)
        mask = ours.reflectors >= 0.5
        errors = [error_maps(color, truth).over(mask).flip for color in (ours.color, theirs.color)]
        ratio = theirs.seconds_per_sample * 1e3 / ours.time_ms["frame"]
        print(
            f"{name:14} layered-depth {ours.time_ms['frame']:8.1f} ms a frame, FLIP {errors[0]:.4f}; EEVEE "
            f"{theirs.seconds_per_sample * 1e3:8.1f} ms a sample, FLIP {errors[1]:.4f}: {ratio:.1f} times faster"
        )


_PEAK = """
import sys
from pathlib import Path
from catoptric.batch.cli import main
main(["compare", sys.argv[1], "--samples", "16", "--out", sys.argv[2]])
status = Path("/proc/self/status").read_text()  # getrusage would tell of the process that started this one, too
print("peak", int(status.split("VmHWM:")[1].split()[0]) // 1024, "MiB")
"""


def memory(name: str = "statue") -> None:
    """Peak memory of a process that bakes and renders one scene by every method, Cycles beside it (Linux)."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", _PEAK, name, folder]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    print(name, done.stdout.strip().splitlines()[-1])


FIGURE_9 = (
    ("without mirror", "planar", {}),
    ("perfect mirror", "planar", {}),
    ("64 planes", "glossy-planes", {"planes": 64}),
    ("128 planes", "glossy-planes", {"planes": 128}),
    ("glossy-planar", "glossy-planar", {}),
)


def glossy(size: tuple[int, int] = (1280, 1024)) -> None:
    """Frames of the cathedral, lit by lightmaps, and how they compare with the perfect mirror's."""
    source = locate("cathedral")
    scene = lit(source, source.scene(), Lighting.CYCLES, Cache())
    dull = replace(scene, instances=tuple(replace(instance, reflector=False) for instance in scene.instances))
    times = []
    for label, method, settings in FIGURE_9:
        drawn = METHODS[method](settings)
        shown = dull if label == "without mirror" else scene
        drawn.prepare(shown, Lighting.CYCLES)
        try:
            times.append(drawn.render(View(shown.camera, *size, 3)).time_ms["frame"])
        finally:
            drawn.release()
    print(f"{size[0]} × {size[1]} pixels; the paper's glossy frames take 1.03 and 1.18 of its perfect one's time")
    for (label, _, _), time in zip(FIGURE_9, times, strict=True):
        print(f"{label:16}{time:10.1f} ms {1e3 / time:8.1f} fps {time / times[1]:8.2f} of the perfect mirror's time")


PLANAR = (
    *((way.value, {"clipping": way.value}) for way in Clipping),
    *((f"1 / {scale} texture", {"clipping": "projective-texture", "scale": scale}) for scale in (2, 4, 8)),
)


def planar(sizes: tuple[tuple[int, int], ...] = ((640, 512), (1280, 1024))) -> None:
    """Frames of the cathedral, unlit, without a mirror and with a perfect one by every way to clip its picture."""
    scene = extract(open_blend(path_of("cathedral")))
    dull = replace(scene, instances=tuple(replace(instance, reflector=False) for instance in scene.instances))
    for size in sizes:
        bare = frame_time(dull, {}, size)
        print(f"{size[0]} × {size[1]} pixels\n{'without mirror':20}{bare:10.1f} ms")
        for label, settings in PLANAR:
            time = frame_time(scene, settings, size)
            print(f"{label:20}{time:10.1f} ms {time / bare:8.2f} of the time without mirror")


def frame_time(scene: Scene, settings: dict, size: tuple[int, int]) -> float:
    """Milliseconds of a frame by `planar`, unlit."""
    drawn = METHODS["planar"](settings)
    drawn.prepare(scene, Lighting.UNLIT)
    try:
        return drawn.render(View(scene.camera, *size, 3)).time_ms["frame"]
    finally:
        drawn.release()


TRACED = ("mirror-ball", "genus3", "kitchen", "statue", "bathroom", "living-room")


def traced(rounds: int = 7) -> None:
    """How often both tracers meet Embree's triangle, what a reflection pass of each takes, and how long trees grow."""
    shape = mesh_of("bumpy", bumpy(1_000_000))
    started, worked = perf_counter(), process_time()
    tree = build_tree(shape.corners, *padded_box(shape.corners))
    took = f"{perf_counter() - started:.1f} s, {process_time() - worked:.1f} s of processor time"
    print(f"{len(shape.triangles):,} triangles: a tree of {len(tree.nodes):,} nodes, {tree.depth} deep, in {took}")
    for name in TRACED:
        scene = extract(open_blend(path_of(name)))
        methods = [METHODS[tracer]() for tracer in TRACER.choices]
        times = np.empty((rounds, len(methods)))
        for drawn in methods:
            drawn.prepare(scene, Lighting.UNLIT)
        for row in times:  # in turns: what else the machine does troubles both
            row[:] = [drawn.render(View(scene.camera, *SIZE, 1)).time_ms["reflection"] for drawn in methods]
        for tracer, drawn, time in zip(TRACER.choices, methods, np.median(times, axis=0), strict=True):
            drawn.release()
            found = agreement(scene, tracer, *SIZE)
            print(
                f"{name:14}{tracer:15}{time:8.1f} ms; of {found.rays:,} rays {found.same:.4%} meet Embree's triangle, "
                f"{found.same_or_tied:.4%} that or one as near"
            )


def main() -> None:
    """Print the parts asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--part", nargs="+", default=["ratios", "density", "eevee", "memory", "glossy", "planar", "virtual", "traced"]
    )
    parser.add_argument("--scenes", default=",".join((*PAPER, *ROOM_SCENES)))
    parser.add_argument("--samples", type=int, default=256, help="of Cycles, by the part roughness")
    given = parser.parse_args()
    renderer = call(lambda: require().info["GL_RENDERER"])
    print(f"{renderer}: {'software rendering, compare times with each other only' if is_software(renderer) else 'GPU'}")
    parts = {"ratios": lambda: ratios(given.scenes.split(",")), "density": density, "memory": memory, "glossy": glossy}
    parts |= {"planar": planar, "virtual": virtual, "traced": traced}
    parts["roughness"] = lambda: roughness(samples=given.samples)
    parts["eevee"] = lambda: eevee(["mirror-ball"])
    for part in given.part:
        print(f"\n{part}")
        parts[part]()


if __name__ == "__main__":
    main()
