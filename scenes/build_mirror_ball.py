"""mirror-ball: a mirror ball between two Suzannes on a tiled terrace, in the sun."""

import bmesh
import bpy

from . import pictures, shapes, stage


def build() -> None:
    """Build the scene into the open, empty file."""
    stage.put("Ball", shapes.sphere(1.0, 128, 64), stage.mirror("Silver", "#fafafa"), (0.0, 0.0, 1.0))
    tiles = stage.matte("Tiles", picture=pictures.star_tiles())
    stage.put("Terrace", shapes.disc(20.0, 96, repeat=0.8), tiles, smooth=False)
    _suzanne("Suzanne left", stage.matte("Coral", "#e0684b"), (-1.35, -1.15, 0.415), (-20.0, 0.0, 40.0))
    _suzanne("Suzanne right", stage.matte("Turquoise", "#2fa3a0"), (1.36, -1.1, 0.415), (-20.0, 0.0, -46.0))
    stage.sky(pictures.Sky(azimuth=222.0, elevation=34.0, cover=0.45, seed=4), sun=3.4, strength=0.9)
    stage.camera((0.18, -7.2, 1.7), (0.0, 0.0, 0.9), 60.2)


def _suzanne(name: str, material, location, turned) -> None:
    mesh = bpy.data.meshes.new(name)
    monkey = bmesh.new()
    layer = monkey.loops.layers.uv.new("UVMap")
    bmesh.ops.create_monkey(monkey, calc_uvs=bool(layer))
    bmesh.ops.scale(monkey, vec=(0.54, 0.54, 0.54), verts=monkey.verts)
    monkey.to_mesh(mesh)
    monkey.free()
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    stage.subdivide(stage.place(name, mesh, material, location, turned), 2)
