"""The demonstration scenes hold what their table promises, in whichever Blender is running."""

import re
from pathlib import Path

import bpy
import numpy as np
import pytest
import trimesh
from catoptric.addon.errors import UsageError
from catoptric.scenes import SCENES, path_of, sculptures

MEGABYTE = 1024**2
# Zhang et al., Table 1: the triangles of the meshes that ours stand in for.
PAPER = {
    ("two-balls", "Beach ball"): 1520,
    ("two-balls", "Marble"): 1520,
    ("hollow-box", "Hollow box"): 135,
    ("knotty-cup", "Knotty cup"): 10768,
    ("genus3", "Genus3"): 13312,
    ("three-genus3", "Genus3 left"): 13312,
    ("three-genus3", "Genus3 middle"): 13312,
    ("three-genus3", "Genus3 right"): 13312,
    ("statue", "Statue"): 129484,
}
# The Euler characteristic of a closed surface is 2 - 2 * genus; the hollow box has four openings.
EULER = {"Hollow box": -4, "Knotty cup": 0, "Genus3": -4, "Beach ball": 2}
KNOWN_NODES = {"OUTPUT_MATERIAL", "BSDF_PRINCIPLED", "TEX_IMAGE", "OUTPUT_WORLD", "BACKGROUND", "TEX_ENVIRONMENT"}


def opened(name: str):
    bpy.ops.wm.open_mainfile(filepath=str(path_of(name)))
    return bpy.context.scene


def evaluated(thing, world: bool = True) -> trimesh.Trimesh:
    """The object's triangles with its modifiers applied, in world or in its own space."""
    thing = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = thing.to_mesh()
    mesh.calc_loop_triangles()
    points = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    corners = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loop_triangles.foreach_get("vertices", corners)
    thing.to_mesh_clear()
    result = trimesh.Trimesh(points.reshape(-1, 3).astype(np.float64), corners.reshape(-1, 3), process=False)
    return result.apply_transform(np.array(thing.matrix_world)) if world else result


def meshes() -> list:
    return [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]


def principled(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def is_mirror(thing) -> bool:
    inputs = [principled(slot.material).inputs for slot in thing.material_slots]
    return any(i["Metallic"].default_value == 1.0 and i["Roughness"].default_value < 0.1 for i in inputs)


def camera_rays(scene, columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions (columns * rows, 3) through the centres of a grid over the picture."""
    matrix = np.array(scene.camera.matrix_world)
    right_top, right_bottom, _, left_top = (np.array(corner) for corner in scene.camera.data.view_frame(scene=scene))
    x, y = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    aims = left_top + x[..., None] * (right_top - left_top) + y[..., None] * (right_bottom - right_top)
    directions = aims.reshape(-1, 3) @ matrix[:3, :3].T
    return np.broadcast_to(matrix[:3, 3], directions.shape), directions


def readme_rows() -> dict[str, list[str]]:
    """The cells of every row of the table in scenes/README.md, by scene."""
    lines = Path(path_of(SCENES[0]).parent, "README.md").read_text(encoding="utf-8").splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| `")]
    return {row[0].strip("`"): row[1:] for row in rows}


def test_the_list_names_the_files_and_the_table() -> None:
    folder = path_of(SCENES[0]).parent
    assert sorted(SCENES) == sorted(file.stem for file in folder.glob("*.blend"))
    assert list(readme_rows()) == list(SCENES)


def test_an_unknown_scene_is_refused_in_one_line() -> None:
    with pytest.raises(UsageError, match=r"'mirror-bal'.*mirror-ball") as caught:
        path_of("mirror-bal")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_small_and_ready_to_render(name: str) -> None:
    assert path_of(name).stat().st_size < 2 * MEGABYTE
    scene = opened(name)
    assert scene.camera is not None
    assert (scene.render.resolution_x, scene.render.resolution_y) == (768, 512)
    assert scene.cycles.glossy_bounces == 4
    assert scene.world is not None
    assert any(thing.type == "LIGHT" for thing in scene.objects)
    assert any(is_mirror(thing) for thing in meshes())
    for thing in meshes():
        assert thing.data.uv_layers, f"{thing.name} has no texture coordinates"


@pytest.mark.parametrize("name", SCENES)
def test_materials_are_constants_and_packed_images(name: str) -> None:
    scene = opened(name)
    trees = [material.node_tree for material in bpy.data.materials] + [scene.world.node_tree]
    assert {node.type for tree in trees for node in tree.nodes} <= KNOWN_NODES
    pictures = [node.image for tree in trees for node in tree.nodes if node.type in {"TEX_IMAGE", "TEX_ENVIRONMENT"}]
    for image in pictures:
        assert image.packed_file is not None
        assert image.filepath == "", "a scene must not name a file of the machine that built it"
        assert image.has_data or image.size[0] > 0
    for thing in meshes():
        if not is_mirror(thing):
            assert principled(thing.material_slots[0].material).inputs["Specular IOR Level"].default_value == 0.0


@pytest.mark.parametrize("name", SCENES)
def test_reflectors_fill_a_quarter_to_half_of_the_picture(name: str) -> None:
    scene = opened(name)
    things = meshes()
    parts = [evaluated(thing) for thing in things]
    mirrors = np.repeat([is_mirror(thing) for thing in things], [len(part.faces) for part in parts])
    first = trimesh.util.concatenate(parts).ray.intersects_first(*camera_rays(scene, 192, 128))
    share = np.mean((first >= 0) & mirrors[first])
    assert 0.245 <= share <= 0.5, f"{share:.0%}"


@pytest.mark.parametrize("name", SCENES)
def test_the_table_counts_the_triangles(name: str) -> None:
    opened(name)
    reflectors, reflected = readme_rows()[name][1:3]
    for cell, mirrors in ((reflectors, True), (reflected, False)):
        total = sum(len(evaluated(thing).faces) for thing in meshes() if is_mirror(thing) == mirrors)
        written = int(re.search(r"([\d,]+) triangles", cell)[1].replace(",", ""))
        assert written == pytest.approx(total, rel=0.001)


@pytest.mark.parametrize(("name", "thing"), PAPER, ids=lambda value: value)
def test_stand_ins_are_closed_and_as_fine_as_the_originals(name: str, thing: str) -> None:
    opened(name)
    mesh = evaluated(bpy.data.objects[thing])
    assert len(mesh.faces) == pytest.approx(PAPER[name, thing], rel=0.05)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0.0
    for stem, euler in EULER.items():
        if thing.startswith(stem):
            assert mesh.euler_number == euler


@pytest.mark.parametrize("name", SCENES)
def test_reflectors_are_closed(name: str) -> None:
    opened(name)
    for thing in filter(is_mirror, meshes()):
        mesh = evaluated(thing)
        assert mesh.is_watertight
        assert mesh.volume > 0.0


def test_the_hollow_box_touches_the_ball() -> None:
    opened("hollow-box")
    ball, box = evaluated(bpy.data.objects["Reflector"]), evaluated(bpy.data.objects["Hollow box"])
    on_edges = [np.linspace(box.vertices[a], box.vertices[b], 401) for a, b in box.edges_unique]
    points = np.concatenate(on_edges)
    points = points[np.linalg.norm(points, axis=1) < 1.02]
    # The ball is convex: a point is outside by at least its height above the highest plane of a face.
    planes = np.einsum("fi,fi->f", ball.face_normals, ball.triangles[:, 0])
    outside = (points @ ball.face_normals.T - planes).max(axis=1)
    assert outside.min() > -0.0001
    assert np.linalg.norm(points[:, None] - ball.vertices[None], axis=-1).min() < 0.001


def test_the_statue_has_five_layers_along_an_axis() -> None:
    opened("statue")
    mesh = evaluated(bpy.data.objects["Statue"], world=False)
    low, high = mesh.bounds
    y, z = np.meshgrid(np.linspace(low[1], high[1], 40), np.linspace(low[2], high[2], 60))
    origins = np.stack([np.full(y.size, low[0] - 1.0), y.ravel(), z.ravel()], axis=-1)
    hits, ray, _ = mesh.ray.intersects_location(origins, np.broadcast_to([1.0, 0.0, 0.0], origins.shape))
    crossings = np.unique(np.stack([ray, np.round(hits[:, 0], 3) * 1000], axis=-1).astype(int), axis=0)
    assert np.bincount(crossings[:, 0]).max() >= 2 * 5


def test_the_strand_of_the_cup_does_not_run_into_itself() -> None:
    path = sculptures.knot_path()[:-1]
    apart = np.abs(np.subtract.outer(np.arange(len(path)), np.arange(len(path))))
    apart = np.minimum(apart, len(path) - apart)
    distance = np.linalg.norm(path[:, None] - path[None], axis=-1)
    assert distance[apart > 4].min() > 2 * sculptures.KNOT_RADIUS
