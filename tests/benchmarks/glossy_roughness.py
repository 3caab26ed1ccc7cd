"""Floors of one roughness after another, by both glossy methods against Cycles.

Run by reflections.py --part roughness.
"""

import bpy
import numpy as np
from catoptric.addon.blender.reference import Reference, render_reference
from catoptric.addon.cache import Cache
from catoptric.addon.methods.contract import Frame, View
from catoptric.addon.methods.registry import METHODS
from catoptric.addon.metrics import error_maps, noise_maps
from catoptric.addon.scene import Lighting, Scene
from catoptric.batch.footage import lit
from catoptric.batch.judging import supersampling
from catoptric.batch.sources import locate

SIZE = (768, 512)
FLOORS = {"cathedral": "Floor", "wet-street": "Setts"}
"""The material whose roughness is set, by scene; an image of it is taken out."""

ROUGHNESS = (0.05, 0.1, 0.2, 0.3)
COMPARED = ("glossy-planes", "glossy-planar")


def roughness(names: list[str] | None = None, values: tuple[float, ...] = ROUGHNESS, samples: int = 256) -> None:
    """FLIP over the floor's pixels, `cycles` light; `noise` is what the reference's own noise alone measures."""
    header = "".join(f"{name:>16}" for name in COMPARED)
    print(f"{SIZE[0]} × {SIZE[1]} pixels, {samples} samples of Cycles")
    print(f"{'scene':14}{'roughness':>10}{header}{'ratio':>8}{'noise':>8}")
    for name in names or FLOORS:
        for value in values:
            scene, reference = _judged(name, value, samples)
            side = supersampling(samples)
            frames = [frame_of(scene, method, side, Lighting.CYCLES) for method in COMPARED]
            floor = frames[0].reflectors >= 0.5
            errors = [error_maps(frame.color, reference.color, hdr=False).over(floor).flip for frame in frames]
            noise = _noise(reference, floor)
            cells = "".join(f"{error:16.4f}" for error in errors)
            print(f"{name:14}{value:10.2f}{cells}{errors[1] / errors[0]:8.2f}{noise:8.4f}", flush=True)


def _judged(name: str, value: float, samples: int) -> tuple[Scene, Reference]:
    """The scene with a floor of that roughness, lit, and Cycles' picture of it."""
    source, cache = locate(name), Cache()
    _polish(source.bpy_scene, FLOORS[name], value)
    scene = lit(source, source.scene(), Lighting.CYCLES, cache, samples=samples)
    return scene, render_reference(source.bpy_scene, scene, Lighting.CYCLES, *SIZE, samples, cache)


def _polish(bpy_scene: bpy.types.Scene, material: str, value: float) -> None:
    """Make a material of the open file evenly rough."""
    tree = bpy.data.materials[material].node_tree
    socket = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Roughness"]
    for link in socket.links:
        tree.links.remove(link)
    socket.default_value = value
    bpy_scene.view_layers[0].update()


def frame_of(scene: Scene, method: str, samples: int = 3, lighting: Lighting = Lighting.UNLIT) -> Frame:
    """A method's picture and times, of SIZE, `samples` squared a pixel."""
    drawn = METHODS[method]()
    drawn.prepare(scene, lighting)
    try:
        return drawn.render(View(scene.camera, *SIZE, samples))
    finally:
        drawn.release()


def _noise(reference: Reference, floor: np.ndarray) -> float:
    other = 2.0 * reference.color - reference.half
    return noise_maps(reference.half, other, hdr=False).over(floor).flip
