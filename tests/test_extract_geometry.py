"""Geometry: what a final render shows, each evaluated mesh once."""

import time

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.names import object_name
from catoptric.tests import blender_stage as stage
from catoptric.tests import extract_stage as plain


@pytest.fixture
def scene():
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 5), (0, 0, 0))
    return scene


def placed(scene, name, data):
    shaped = bpy.data.objects.new(name, data)
    scene.collection.objects.link(shaped)
    return shaped


def by_name(found):
    return {instance.name: instance for instance in found.instances}


def bounds(found, instance):
    corners = found.meshes[instance.mesh].corners.reshape(-1, 3)
    world = corners @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
    return world.min(axis=0), world.max(axis=0)


def test_a_box(scene):
    stage.add_box(scene, "Box", 2.0, location=(1, 2, 3))
    found = extract(scene)
    assert not found.warnings
    mesh = found.meshes[0]
    assert mesh.triangles.shape == (12, 3)
    assert mesh.triangles.dtype == np.int32
    assert mesh.positions.dtype == mesh.normals.dtype == mesh.uvs.dtype == np.float32
    np.testing.assert_allclose(bounds(found, found.instances[0]), ((0, 1, 2), (2, 3, 4)))
    # A box's outward normals, and windings that agree with them.
    corners = mesh.corners
    centres = corners.mean(axis=1)
    outward = np.sign(np.where(np.abs(centres) > 0.99, centres, 0.0))
    np.testing.assert_allclose(mesh.normals, np.repeat(outward[:, None], 3, axis=1), atol=1e-6)
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", crosses, outward) > 0).all()


def test_modifiers_stand_at_their_render_levels(scene):
    box = stage.add_box(scene, "Box", 2.0)
    subdivision = box.modifiers.new("Subdivision", "SUBSURF")
    subdivision.subdivision_type, subdivision.levels, subdivision.render_levels = "SIMPLE", 0, 2
    array = box.modifiers.new("Array", "ARRAY")
    array.count, array.show_viewport = 3, False
    assert len(extract(scene).meshes[0].triangles) == 12 * 16 * 3
    seen = extract(scene, bpy.context.evaluated_depsgraph_get())
    assert len(seen.meshes[0].triangles) == 12


def test_linked_duplicates_share_a_mesh(scene):
    box = stage.add_box(scene, "Box", 2.0)
    for number in range(3):
        placed(scene, f"Copy {number}", box.data).location.x = 3.0 * number
    found = extract(scene)
    assert len(found.meshes) == 1
    assert [instance.mesh for instance in found.instances] == [0] * 4


def test_collection_instances(scene):
    box = stage.add_box(scene, "Box", 2.0)
    collection = bpy.data.collections.new("Kit")
    scene.collection.objects.unlink(box)
    collection.objects.link(box)
    for number in range(3):
        holder = placed(scene, f"Holder {number}", None)
        holder.instance_type, holder.instance_collection = "COLLECTION", collection
        holder.location.z = 10.0 * number
        holder.scale.x = -1.0 if number == 2 else 1.0
    found = extract(scene)
    assert len(found.meshes) == 1
    assert [instance.name for instance in found.instances] == ["Box", "Box [2]", "Box [3]"]
    assert {object_name(instance.name) for instance in found.instances} == {"Box"}
    assert sorted(instance.matrix[2, 3] for instance in found.instances) == [0.0, 10.0, 20.0]


def test_geometry_nodes_instances(scene):
    material = stage.principled("Given by nodes", (1, 0, 0))
    tree = bpy.data.node_groups.new("Grid of balls", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    grid, ball, painted, instanced, end = (
        tree.nodes.new(name)
        for name in (
            "GeometryNodeMeshGrid",
            "GeometryNodeMeshIcoSphere",
            "GeometryNodeSetMaterial",
            "GeometryNodeInstanceOnPoints",
            "NodeGroupOutput",
        )
    )
    painted.inputs["Material"].default_value = material
    tree.links.new(grid.outputs["Mesh"], instanced.inputs["Points"])
    tree.links.new(ball.outputs["Mesh"], painted.inputs["Geometry"])
    tree.links.new(painted.outputs["Geometry"], instanced.inputs["Instance"])
    tree.links.new(instanced.outputs["Instances"], end.inputs["Geometry"])
    holder = placed(scene, "Balls", bpy.data.meshes.new("Nothing"))
    holder.modifiers.new("Nodes", "NODES").node_group = tree
    found = extract(scene)
    assert not found.warnings
    assert len(found.meshes) == 1
    assert len(found.instances) == 9
    used = found.meshes[0].slots[0]
    assert found.materials[found.instances[0].materials[used]].name == "Given by nodes"


def test_particles(scene):
    leaf = stage.add_plane(scene, "Leaf", 0.1)
    ground = stage.add_plane(scene, "Ground", 4.0)
    system = ground.modifiers.new("Leaves", "PARTICLE_SYSTEM").particle_system.settings
    system.count, system.frame_start, system.frame_end, system.lifetime = 20, 1, 1, 100
    system.render_type, system.instance_object, system.physics_type = "OBJECT", leaf, "NO"
    leaf.hide_render = True
    found = extract(scene, frame=2)
    names = [object_name(instance.name) for instance in found.instances]
    assert names.count("Leaf") == 20
    assert names.count("Ground") == 1
    assert len(found.meshes) == 2


def test_text_curves_surfaces_and_metaballs(scene):
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.1
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.1
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    bpy.ops.object.metaball_add()
    bpy.ops.object.metaball_add(location=(1, 0, 0))
    found = extract(scene)
    assert not found.warnings
    assert sorted(by_name(found)) == sorted(["Text", "BézierCircle", "SurfSphere", "Mball"])
    assert all(len(mesh.triangles) > 50 for mesh in found.meshes)
    low, high = bounds(found, by_name(found)["Mball"])
    assert high[0] - low[0] > high[1] - low[1] + 0.5, "both balls are in the mother's mesh"


def test_a_mirrored_object_keeps_its_matrix(scene):
    box = stage.add_box(scene, "Box", 2.0)
    box.scale = (-1.0, 2.0, 1.0)
    assert np.linalg.det(extract(scene).instances[0].matrix[:3, :3]) == pytest.approx(-2.0)


def bent_quad(scene, shading):
    shaped = stage.add_mesh(
        scene,
        "Bent",
        [(-1, -1, 0), (0, -1, 0.5), (1, -1, 0), (1, 1, 0.6), (0, 1, 0), (-1, 1, 0.4)],
        [(0, 1, 4, 5), (1, 2, 3, 4)],
    )
    data = shaped.data
    data.polygons.foreach_set(
        "use_smooth", {"flat": [0, 0], "mixed": [1, 0], "custom, mixed": [1, 0]}.get(shading, [1, 1])
    )
    if "custom" in shading:
        leaning = np.random.default_rng(0).normal((0, 0, 3), 1, (8, 3))
        data.normals_split_custom_set((leaning / np.linalg.norm(leaning, axis=1, keepdims=True)).tolist())
    data.update()
    return shaped


@pytest.mark.parametrize("shading", ["flat", "smooth", "sharp", "mixed", "mixed, sharp", "custom", "custom, mixed"])
def test_shading_normals_are_those_of_cycles(tmp_path, shading):
    scene = plain.plane_scene()[0]
    bpy.data.objects.remove(bpy.data.objects["Plane"])
    shaped = bent_quad(scene, shading)
    material, emission = plain.emissive()
    shaped.data.materials.append(material)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    # Emission cannot be negative: show the normal, halved and moved to 0..1.
    geometry, halved = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
    halved.operation = "MULTIPLY_ADD"
    halved.inputs[1].default_value = halved.inputs[2].default_value = (0.5, 0.5, 0.5)
    links.new(geometry.outputs["Normal"], halved.inputs[0])
    links.new(halved.outputs[0], emission.inputs["Color"])
    expected = plain.cycles_picture(scene, tmp_path) * 2.0 - 1.0
    compared = 0
    for inside, weights, _, mesh, number in plain.under_pixels(extract(scene), margin=0.01):
        shown = weights @ mesh.normals[number]
        shown /= np.linalg.norm(shown, axis=1, keepdims=True)
        np.testing.assert_allclose(shown, expected.reshape(-1, 3)[inside], atol=2e-3)
        compared += inside.sum()
    assert compared > 100


def test_materials_of_object_and_data(scene):
    first, second = stage.add_plane(scene, "First", 1.0), None
    first.data.materials.append(stage.principled("Of the mesh", (1, 0, 0)))
    first.data.materials.append(stage.principled("Second slot", (0, 1, 0)))
    second = placed(scene, "Second", first.data)
    second.material_slots[0].link = "OBJECT"
    second.material_slots[0].material = stage.principled("Of the object", (0, 0, 1))
    found = extract(scene)
    names = {
        name: [found.materials[index].name for index in instance.materials] for name, instance in by_name(found).items()
    }
    assert names == {"First": ["Of the mesh", "Second slot"], "Second": ["Of the object", "Second slot"]}
    assert len(found.meshes) == 1


def test_slots_beyond_the_last_are_the_last(scene):
    shaped = stage.add_box(scene, "Box", 1.0, stage.principled("Only", (1, 0, 0)))
    shaped.data.polygons.foreach_set("material_index", [0, 1, 2, 3, 4, 5])
    assert not extract(scene).meshes[0].slots.any()


def test_visibility(scene):
    for name in ("Seen", "Hidden", "Excluded", "In hidden collection", "Not by camera", "Not in mirrors"):
        stage.add_plane(scene, name, 1.0)
    bpy.data.objects["Hidden"].hide_render = True
    bpy.data.objects["Not by camera"].visible_camera = False
    bpy.data.objects["Not in mirrors"].visible_glossy = False
    bpy.data.objects["Seen"].hide_viewport = True
    for name in ("Excluded", "In hidden collection"):
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        scene.collection.objects.unlink(bpy.data.objects[name])
        collection.objects.link(bpy.data.objects[name])
    bpy.data.collections["In hidden collection"].hide_render = True
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    found = by_name(extract(scene))
    assert set(found) == {"Seen", "Not by camera", "Not in mirrors"}
    assert (found["Seen"].in_camera, found["Seen"].in_reflections) == (True, True)
    assert (found["Not by camera"].in_camera, found["Not by camera"].in_reflections) == (False, True)
    assert (found["Not in mirrors"].in_camera, found["Not in mirrors"].in_reflections) == (True, False)


def test_an_instancer_hides_its_instances(scene):
    box = stage.add_box(scene, "Box", 2.0)
    collection = bpy.data.collections.new("Kit")
    scene.collection.objects.unlink(box)
    collection.objects.link(box)
    holder = placed(scene, "Holder", None)
    holder.instance_type, holder.instance_collection, holder.visible_camera = "COLLECTION", collection, False
    assert not extract(scene).instances[0].in_camera


def test_what_cannot_be_drawn_is_left_out_and_named(scene):
    stage.add_plane(scene, "Sound", 1.0)
    placed(scene, "Empty", bpy.data.meshes.new("Empty"))
    stage.add_mesh(scene, "Line", [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)])
    broken = stage.add_plane(scene, "Not a number", 1.0)
    broken.data.vertices[0].co.x = float("nan")
    stage.add_plane(scene, "Flattened", 1.0).scale = (0.0, 0.0, 0.0)
    placed(scene, "Hair", bpy.data.hair_curves.new("Hair"))
    found = extract(scene)
    assert set(by_name(found)) == {"Sound"}
    assert sorted(found.warnings) == [
        'object "Empty": has no faces; it is left out',
        'object "Flattened": has a scale of zero; it is left out',
        'object "Hair": hair curves cannot be drawn; it is left out',
        'object "Line": has only faces without area; it is left out',
        'object "Not a number": has vertices that are not numbers (NaN or infinite); it is left out',
    ]


def test_triangles_without_area_go(scene):
    stage.add_mesh(
        scene, "Mixed", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0), (3, 0, 0)], [(0, 1, 2), (0, 1, 3), (1, 3, 4)]
    )
    mesh = extract(scene).meshes[0]
    assert len(mesh.triangles) == len(mesh.normals) == len(mesh.uvs) == len(mesh.slots) == 1
    np.testing.assert_allclose(mesh.normals, np.tile((0, 0, 1), (1, 3, 1)))


def test_polygons_become_their_triangles(scene):
    turns = np.linspace(0, 2 * np.pi, 9)[:-1]
    radii = np.where(np.arange(8) % 2, 0.4, 1.0)
    star = np.column_stack([np.cos(turns) * radii, np.sin(turns) * radii, np.zeros(8)])
    stage.add_mesh(scene, "Star", star, [tuple(range(8))])
    corners = extract(scene).meshes[0].corners
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2.0
    x, y = star[:, 0], star[:, 1]
    assert areas.sum() == pytest.approx(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)), rel=1e-5)
    assert (areas > 0).all()


def test_a_million_triangles_take_seconds(scene):
    count = 708
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=count, y_subdivisions=count)
    bpy.context.object.data.shade_smooth()
    start = time.perf_counter()
    found = extract(scene)
    assert len(found.meshes[0].triangles) == 2 * count**2 > 1_000_000
    assert time.perf_counter() - start < 20.0, "a few seconds, and room for a busy machine"
