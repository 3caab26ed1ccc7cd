"""Reading a viewport again: what has not changed is the same object, what has is read anew."""

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.blender.extract_memo import Memo
from catoptric.addon.scene import Camera


@pytest.fixture
def scene():
    """Two cubes that share a mesh, a sphere, an image on it; no camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.name = "cube"
    twin = bpy.data.objects.new("twin", cube.data)
    twin.location.x = 3.0
    scene.collection.objects.link(twin)
    bpy.ops.mesh.primitive_uv_sphere_add(location=(0, 3, 0))
    bpy.context.object.name = "sphere"
    image = bpy.data.images.new("paint", 4, 4)
    material = bpy.data.materials.new("painted")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.links.new(node.outputs[0], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    bpy.context.object.data.materials.append(material)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    return scene


class Viewport:
    """Reads as a viewport does: told of each update, between two looks."""

    def __init__(self, scene):
        self.scene, self.memo = scene, Memo()
        bpy.app.handlers.depsgraph_update_post.append(self.told)

    def told(self, scene, depsgraph):
        self.memo.forget(depsgraph)

    def read(self):
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found = extract(self.scene, depsgraph, camera=Camera(np.eye(4)), memo=self.memo)
        return {instance.name: (instance, found.meshes[instance.mesh]) for instance in found.instances}, found


@pytest.fixture
def viewport(scene):
    made = Viewport(scene)
    yield made
    bpy.app.handlers.depsgraph_update_post.remove(made.told)


def test_nothing_is_read_twice(viewport):
    before, scene = viewport.read()
    after, again = viewport.read()
    assert before["cube"][1] is before["twin"][1]
    assert all(after[name][1] is before[name][1] for name in before)
    assert again.images[0] is scene.images[0]
    assert again.world is scene.world


def test_a_move_costs_no_mesh(viewport):
    before, _ = viewport.read()
    bpy.data.objects["cube"].location.z = 2.0
    after, _ = viewport.read()
    assert after["cube"][1] is before["cube"][1]
    assert after["cube"][0].matrix[2, 3] == 2.0


def test_a_changed_mesh_is_read_for_all_that_share_it(viewport):
    before, _ = viewport.read()
    mesh = bpy.data.objects["cube"].data
    mesh.vertices[0].co.x -= 1.0
    mesh.update()
    after, _ = viewport.read()
    assert after["cube"][1] is after["twin"][1]
    assert after["cube"][1].positions[:, 0].min() == -2.0
    assert after["sphere"][1] is before["sphere"][1]


def test_a_modifier_changes_one_object(viewport):
    before, _ = viewport.read()
    bpy.data.objects["sphere"].modifiers.new("thinner", "DECIMATE").ratio = 0.3
    after, _ = viewport.read()
    assert len(after["sphere"][1].triangles) < len(before["sphere"][1].triangles)
    assert after["cube"][1] is before["cube"][1]


def test_a_removed_object_is_forgotten(viewport):
    viewport.read()
    bpy.data.objects.remove(bpy.data.objects["sphere"])
    after, _ = viewport.read()
    assert set(after) == {"cube", "twin"}
    assert len(viewport.memo.meshes) == 1


def test_a_world_is_read_again_when_it_changes(viewport):
    _, before = viewport.read()
    viewport.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.0, 0.0, 1.0)
    _, after = viewport.read()
    assert after.world is not before.world
    assert after.world.color == pytest.approx((0.5, 0.0, 0.0))
