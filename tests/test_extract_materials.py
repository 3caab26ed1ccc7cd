"""Shader trees become what an artist would call them; the rest is named once."""

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.scene import Fresnel
from catoptric.tests import blender_stage as stage
from catoptric.tests import extract_stage as plain


class Shader:
    """A plane with one material, built node by node."""

    def __init__(self):
        self.scene, self.plane = plain.plane_scene()
        self.material = bpy.data.materials.new("Material")
        self.material.use_nodes = True
        self.material.diffuse_color = (0.11, 0.22, 0.33, 1.0)
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.add("OutputMaterial")
        self.plane.data.materials.append(self.material)

    def add(self, kind, tree=None, **inputs):
        node = (tree or self.tree).nodes.new(f"ShaderNode{kind}")
        for name, value in inputs.items():
            socket = node.inputs[name.replace("_", " ")]
            socket.default_value = (*value, 1.0) if isinstance(value, tuple) and len(value) == 3 else value
        return node

    def link(self, node, socket=None, output=0):
        (socket or self.output.inputs["Surface"]).id_data.links.new(
            node.outputs[output], socket or self.output.inputs["Surface"]
        )
        return node

    def read(self):
        found = extract(self.scene)
        return found.materials[0], found

    def mixed(self, first, second, factor=0.5, kind="MixShader"):
        mix = self.link(self.add(kind))
        if kind == "MixShader":
            mix.inputs[0].default_value = factor
        self.link(first, mix.inputs[-2])
        self.link(second, mix.inputs[-1])
        return mix


@pytest.fixture
def shader():
    return Shader()


def near(value):
    return pytest.approx(value, abs=1e-5)


def test_principled_as_blender_makes_it_is_no_mirror(shader):
    shader.link(shader.add("BsdfPrincipled"))
    material, found = shader.read()
    assert material.base.color == near((0.8, 0.8, 0.8))
    assert material.diffuse == 1.0
    assert not material.mirrors
    assert not material.emits
    assert not found.reflectors
    assert not found.warnings


def test_a_metal(shader):
    shader.link(shader.add("BsdfPrincipled", Base_Color=(0.9, 0.6, 0.3), Metallic=1.0, Roughness=0.1))
    material, found = shader.read()
    assert material.reflection.color == near((0.9, 0.6, 0.3))
    assert material.fresnel is Fresnel.SCHLICK
    assert (material.diffuse, material.roughness.color[0]) == (0.0, near(0.1))
    assert found.reflectors == (0,)


@pytest.mark.parametrize(
    ("inputs", "reflects"),
    [
        ({"Metallic": 1.0, "Roughness": 0.2}, True),
        ({"Metallic": 1.0, "Roughness": 0.3}, False),
        ({"Metallic": 0.0, "Roughness": 0.1}, True),
        ({"Metallic": 0.0, "Roughness": 0.15}, False),
        ({"Metallic": 0.0, "Roughness": 0.0, "Specular_IOR_Level": 0.0}, False),
        ({"Metallic": 0.0, "Roughness": 0.0, "IOR": 1.05}, False),
        ({"Metallic": 0.0, "Roughness": 0.0, "IOR": 1.33}, True),
    ],
)
def test_who_is_a_reflector(shader, inputs, reflects):
    shader.link(shader.add("BsdfPrincipled", **inputs))
    assert bool(shader.read()[1].reflectors) == reflects


def test_varnish_is_a_dielectric_over_its_base(shader):
    shader.link(shader.add("BsdfPrincipled", Base_Color=(0.5, 0.2, 0.1), Roughness=0.05, IOR=1.45))
    material, _ = shader.read()
    assert material.fresnel is Fresnel.DIELECTRIC
    assert material.reflection.color == (1.0, 1.0, 1.0)
    assert material.ior == near(1.45)
    assert material.base.color == near((0.5, 0.2, 0.1))


def test_specular_level_scales_what_is_reflected_head_on(shader):
    shader.link(shader.add("BsdfPrincipled", Roughness=0.0, IOR=1.5, Specular_IOR_Level=1.0))
    ior = shader.read()[0].ior
    assert ((ior - 1) / (ior + 1)) ** 2 == near(0.08)


def test_principled_emission(shader):
    shader.link(shader.add("BsdfPrincipled", Emission_Color=(1.0, 0.5, 0.25), Emission_Strength=4.0))
    material, _ = shader.read()
    assert material.emission.color == near((4.0, 2.0, 1.0))
    assert material.emits


def test_the_simple_shaders(shader):
    shader.link(shader.add("BsdfDiffuse", Color=(0.1, 0.2, 0.3)))
    material, _ = shader.read()
    assert (material.base.color, material.diffuse, material.mirrors) == (near((0.1, 0.2, 0.3)), 1.0, False)
    shader.link(shader.add("BsdfGlossy", Color=(0.4, 0.5, 0.6), Roughness=0.1))
    material, found = shader.read()
    assert material.reflection.color == near((0.4, 0.5, 0.6))
    assert (material.fresnel, material.diffuse, found.reflectors) == (Fresnel.CONSTANT, 0.0, (0,))
    shader.link(shader.add("Emission", Color=(0.5, 1.0, 0.0), Strength=3.0))
    material, _ = shader.read()
    assert (material.emission.color, material.diffuse) == (near((1.5, 3.0, 0.0)), 0.0)


def test_diffuse_and_glossy_mixed(shader):
    shader.mixed(
        shader.add("BsdfDiffuse", Color=(0.8, 0.4, 0.2)), shader.add("BsdfGlossy", Color=(1.0, 0.5, 0.0)), 0.25
    )
    material, found = shader.read()
    assert material.base.color == near((0.8, 0.4, 0.2))
    assert material.diffuse == near(0.75)
    assert material.reflection.color == near((0.25, 0.125, 0.0))
    assert not found.warnings


def test_two_diffuses_mixed_and_added(shader):
    first, second = shader.add("BsdfDiffuse", Color=(1.0, 0.0, 0.0)), shader.add("BsdfDiffuse", Color=(0.0, 1.0, 0.0))
    shader.mixed(first, second, 0.25)
    material, _ = shader.read()
    assert np.array(material.base.color) * material.diffuse == near((0.75, 0.25, 0.0))
    shader.mixed(first, second, kind="AddShader")
    material, _ = shader.read()
    assert np.array(material.base.color) * material.diffuse == near((1.0, 1.0, 0.0))


@pytest.mark.parametrize("kind", ["BsdfPrincipled", "BsdfGlossy", "BsdfMetallic", "BsdfGlass"])
@pytest.mark.parametrize("facets", ["MULTI_GGX", "GGX"])
def test_light_between_facets_counts_where_the_node_says_so(shader, kind, facets):
    node = shader.link(shader.add(kind))
    node.distribution = facets
    material, _ = shader.read()
    assert material.multiscatter == (facets == "MULTI_GGX")


def test_other_facets_than_those_of_ggx_are_named(shader):
    shader.link(shader.add("BsdfGlossy")).distribution = "BECKMANN"
    material, found = shader.read()
    assert not material.multiscatter
    assert any("Beckmann" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("kind", "inputs", "ior"), [("Fresnel", {"IOR": 1.7}, 1.7), ("LayerWeight", {"Blend": 0.5}, 2.0)]
)
def test_a_fresnel_mix_is_a_dielectric(shader, kind, inputs, ior):
    mix = shader.mixed(shader.add("BsdfDiffuse", Color=(0.8, 0.4, 0.2)), shader.add("BsdfGlossy", Roughness=0.05))
    shader.link(shader.add(kind, **inputs), mix.inputs[0])
    material, found = shader.read()
    assert material.fresnel is Fresnel.DIELECTRIC
    assert (material.ior, material.diffuse, material.roughness.color[0]) == (near(ior), 1.0, near(0.05))
    assert found.reflectors == (0,)
    assert not found.warnings


def test_nested_groups_reroutes_and_muted_nodes(shader):
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    inner.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
    inner.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    start, end = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
    diffuse, gamma = shader.add("BsdfDiffuse", inner), shader.add("Gamma", inner, Gamma=3.0)
    gamma.mute = True
    inner.links.new(start.outputs["Tint"], gamma.inputs["Color"])
    inner.links.new(gamma.outputs["Color"], diffuse.inputs["Color"])
    inner.links.new(diffuse.outputs[0], end.inputs["Shader"])
    outer = bpy.data.node_groups.new("Outer", "ShaderNodeTree")
    outer.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
    outer.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    start, end, nested = (
        outer.nodes.new("NodeGroupInput"),
        outer.nodes.new("NodeGroupOutput"),
        shader.add("Group", outer),
    )
    nested.node_tree = inner
    outer.links.new(start.outputs["Tint"], nested.inputs["Tint"])
    outer.links.new(nested.outputs["Shader"], end.inputs["Shader"])
    group, reroute = shader.add("Group"), shader.tree.nodes.new("NodeReroute")
    group.node_tree = outer
    group.inputs["Tint"].default_value = (0.3, 0.6, 0.9, 1.0)
    shader.tree.links.new(group.outputs["Shader"], reroute.inputs[0])
    shader.tree.links.new(reroute.outputs[0], shader.output.inputs["Surface"])
    material, found = shader.read()
    assert material.base.color == near((0.3, 0.6, 0.9))
    assert not found.warnings
    rgb = shader.add("RGB")
    rgb.outputs[0].default_value = (0.1, 0.2, 0.3, 1.0)
    shader.link(rgb, group.inputs["Tint"])
    assert shader.read()[0].base.color == near((0.1, 0.2, 0.3))


def test_what_is_not_supported_is_named_once_and_shown_in_the_viewport_colour(shader):
    principled = shader.link(shader.add("BsdfPrincipled"))
    noise = shader.add("TexNoise")
    noise.name = "Marble"
    shader.link(noise, principled.inputs["Base Color"], output=1)
    for number in range(2):
        other = bpy.data.objects.new(f"Plane {number}", shader.plane.data)
        shader.scene.collection.objects.link(other)
    material, found = shader.read()
    assert material.base.color == near((0.11, 0.22, 0.33))
    assert found.warnings == (
        'object "Plane", material "Material", node "Marble": is not supported; the viewport colour stands in',
    )


@pytest.mark.parametrize("kind", ["BsdfToon", "BsdfTranslucent", "SubsurfaceScattering", "Holdout"])
def test_shaders_without_counterpart(shader, kind):
    shader.link(shader.add(kind))
    material, found = shader.read()
    assert material.base.color == near((0.11, 0.22, 0.33))
    assert len(found.warnings) == 1


def test_glass_is_the_viewport_colour_under_gloss(shader):
    shader.link(shader.add("BsdfGlass", IOR=1.6, Roughness=0.0))
    material, found = shader.read()
    assert (material.fresnel, material.ior) == (Fresnel.DIELECTRIC, near(1.6))
    assert material.base.color == near((0.11, 0.22, 0.33))
    assert found.reflectors == (0,)
    assert "lets light through" in found.warnings[0]


def test_a_cut_out_is_drawn_opaque(shader):
    shader.mixed(shader.add("BsdfTransparent"), shader.add("BsdfDiffuse", Color=(0.2, 0.7, 0.1)), 0.3)
    material, found = shader.read()
    assert (material.base.color, material.diffuse) == (near((0.2, 0.7, 0.1)), 1.0)
    assert "opaque" in found.warnings[0]


@pytest.mark.parametrize(("brightest", "mirrors"), [(0.3, True), (0.6, False)])
def test_roughness_is_read_from_an_image_and_its_average_says_what_mirrors(shader, brightest, mirrors):
    principled = shader.link(shader.add("BsdfPrincipled", Metallic=1.0))
    image = bpy.data.images.new("Scratches", 2, 1)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.array([0, 0, 0, 1, *(brightest,) * 3, 1], np.float32))
    texture = shader.add("TexImage")
    texture.image = image
    shader.link(texture, principled.inputs["Roughness"])
    material, found = shader.read()
    assert material.roughness.color == (1.0, 1.0, 1.0)
    assert found.images[material.roughness.image].name == "Scratches"
    assert found.reflectors == ((0,) if mirrors else ())
    assert not found.warnings


def test_bump_and_displacement_are_named(shader):
    principled = shader.link(shader.add("BsdfPrincipled"))
    shader.link(shader.add("Bump"), principled.inputs["Normal"])
    shader.link(shader.add("Displacement"), shader.output.inputs["Displacement"])
    _, found = shader.read()
    assert len(found.warnings) == 2


def test_constants_are_computed(shader):
    principled = shader.link(shader.add("BsdfPrincipled"))
    math = shader.add("Math")
    math.operation = "MULTIPLY"
    math.inputs[0].default_value, math.inputs[1].default_value = 0.5, 0.25
    shader.link(math, principled.inputs["Roughness"])
    mix = shader.add("Mix")
    mix.data_type, mix.inputs[0].default_value = "RGBA", 0.25
    mix.inputs[6].default_value, mix.inputs[7].default_value = (1, 0, 0, 1), (0, 1, 0, 1)
    shader.link(mix, principled.inputs["Base Color"], output=2)
    material, found = shader.read()
    assert material.roughness.color == near((0.125,) * 3)
    assert material.base.color == near((0.75, 0.25, 0.0))
    assert not found.warnings


def test_no_material_is_cycles_grey(shader):
    shader.plane.data.materials.clear()
    material, found = shader.read()
    assert (material.base.color, material.diffuse, material.mirrors) == ((0.8, 0.8, 0.8), 1.0, False)
    assert not found.warnings


def test_nothing_linked_is_black(shader):
    material, _ = shader.read()
    assert (material.diffuse, material.emits, material.mirrors) == (0.0, False, False)


@pytest.mark.parametrize(("value", "reflects"), [(True, True), (False, False), (1, True), (0, False)])
def test_the_artist_decides(shader, value, reflects):
    rough = not value
    shader.link(shader.add("BsdfPrincipled", Metallic=1.0, Roughness=0.05 if rough else 0.9))
    shader.plane["catoptric_reflector"] = value
    assert bool(shader.read()[1].reflectors) == reflects


def test_the_artist_can_ask_for_a_rough_floors_gloss(shader):
    shader.link(shader.add("BsdfPrincipled", Roughness=0.4))
    other = bpy.data.objects.new("Left alone", shader.plane.data)
    shader.scene.collection.objects.link(other)
    shader.plane["catoptric_reflector"] = True
    found = extract(shader.scene)
    chosen, alone = (
        next(instance for instance in found.instances if instance.name == name) for name in ("Plane", "Left alone")
    )
    assert (chosen.reflector, alone.reflector) == (True, False)
    assert found.materials[chosen.materials[0]].mirrors
    assert not found.materials[alone.materials[0]].mirrors
    assert chosen.mesh == alone.mesh


def test_a_reflector_that_reflects_nothing_is_named(shader):
    shader.link(shader.add("BsdfDiffuse"))
    shader.plane["catoptric_reflector"] = True
    _, found = shader.read()
    assert not found.reflectors
    assert "no material of it reflects" in found.warnings[0]


def test_a_slot_that_no_face_uses_makes_no_reflector(shader):
    shader.link(shader.add("BsdfDiffuse"))
    shader.plane.data.materials.append(stage.principled("Chrome", (1, 1, 1), Metallic=1.0, Roughness=0.0))
    assert not shader.read()[1].reflectors


def test_a_view_layers_override_replaces_every_material(shader):
    shader.link(shader.add("BsdfDiffuse"))
    bpy.context.view_layer.material_override = stage.principled("Clay", (0.3, 0.3, 0.3))
    assert shader.read()[0].name == "Clay"


def test_animated_values_are_those_of_the_frame(shader):
    diffuse = shader.link(shader.add("BsdfDiffuse", Color=(0.0, 0.0, 0.0)))
    color = diffuse.inputs["Color"]
    color.keyframe_insert("default_value", frame=1)
    color.default_value = (1.0, 1.0, 1.0, 1.0)
    color.keyframe_insert("default_value", frame=11)
    assert extract(shader.scene, frame=1).materials[0].base.color == near((0.0, 0.0, 0.0))
    assert extract(shader.scene, frame=11).materials[0].base.color == near((1.0, 1.0, 1.0))
