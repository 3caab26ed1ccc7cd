"""Give the reference and its peers the same light, materials and objects as the real-time side."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import bpy

from ..scene import ColorSource, Lighting, Material, Scene
from .names import object_name
from .override_shader import unlit_material
from .render_settings import changed

_SHAPED = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL", "GPENCIL"}
_NO_MATERIAL = Material("no material", ColorSource((0.8, 0.8, 0.8)))


@contextmanager
def same_light(bpy_scene: bpy.types.Scene, scene: Scene, lighting: Lighting) -> Iterator[None]:
    """Make Blender render what `scene` holds, lit by `lighting`; afterwards everything is as it was.

    Objects that extraction left out are hidden. UNLIT: every material shows itself as emission,
    reflectors are perfect mirrors, no lamp shines. Else the materials are the artist's own, and the
    shapes of the lamps are seen neither by the camera nor in reflections.
    """
    with ExitStack() as stack:
        _hide_absent(stack, scene)
        _dim_lamps(stack, lighting)
        if lighting is Lighting.UNLIT:
            _replace_materials(stack, scene)
        yield


def _hide_absent(stack: ExitStack, scene: Scene) -> None:
    """Hide what extraction left out: whole objects, unless they are there for what they instance, and hair."""
    shown = {object_name(instance.name) for instance in scene.instances}
    for shaped in bpy.data.objects:
        carries = shaped.is_instancer or any(modifier.type == "NODES" for modifier in shaped.modifiers)
        if shaped.type in _SHAPED and shaped.name not in shown and not carries:
            stack.enter_context(changed(shaped, hide_render=True))
        for system in shaped.particle_systems:
            if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                stack.enter_context(changed(system.settings, render_type="NONE"))


def _dim_lamps(stack: ExitStack, lighting: Lighting) -> None:
    for lamp in bpy.data.objects:
        if lamp.type != "LIGHT":
            continue
        if lighting is Lighting.UNLIT:
            stack.enter_context(changed(lamp, hide_render=True))
        else:
            stack.enter_context(changed(lamp, visible_camera=False, visible_glossy=False))


def _replace_materials(stack: ExitStack, scene: Scene) -> None:
    """Swap every material for its unlit stand-in, wherever Blender refers to it."""
    mirrored, plain = _uses(scene)
    _fill_empty_slots(stack, stack.enter_context(unlit_material(None, _NO_MATERIAL, mirror=False)))
    for material in [found for found in bpy.data.materials if found.name in mirrored | plain]:
        stand_ins = [
            stack.enter_context(unlit_material(material, described[material.name], described is mirrored))
            for described in (mirrored, plain)
            if material.name in described
        ]
        if len(stand_ins) == 2:
            _give_to_objects(stack, scene, material, stand_ins[1])
        _remap(stack, material, stand_ins[0])


def _uses(scene: Scene) -> tuple[dict[str, Material], dict[str, Material]]:
    """The materials that mirror on some instance, and those that do not on some, by name."""
    mirrored, plain = {}, {}
    for instance in scene.instances:
        for index in instance.materials:
            material = scene.materials[index]
            (mirrored if instance.reflector and material.mirrors else plain)[material.name] = material
    return mirrored, plain


def _remap(stack: ExitStack, material: bpy.types.Material, stand_in: bpy.types.Material) -> None:
    material.user_remap(stand_in)
    stack.callback(stand_in.user_remap, material)
    for data in _data_with_materials():  # remapping leaves out what a library brings
        for index, used in enumerate(data.materials):
            if used == material:
                _assign(stack, data, index, stand_in)


def _assign(stack: ExitStack, data: bpy.types.ID, index: int, material: bpy.types.Material) -> None:
    stack.callback(data.materials.__setitem__, index, data.materials[index])
    data.materials[index] = material


def _data_with_materials() -> Iterator[bpy.types.ID]:
    seen = set()
    for shaped in bpy.data.objects:
        data = shaped.data
        if hasattr(data, "materials") and data.name_full not in seen:
            seen.add(data.name_full)
            yield data


def _fill_empty_slots(stack: ExitStack, material: bpy.types.Material) -> None:
    for data in _data_with_materials():
        if not len(data.materials):
            data.materials.append(material)
            stack.callback(data.materials.clear)
        for index, used in enumerate(data.materials):
            if used is None:
                _assign(stack, data, index, material)
    for shaped in bpy.data.objects:
        for slot in shaped.material_slots:
            if slot.link == "OBJECT" and slot.material is None and shaped.library is None:
                stack.enter_context(changed(slot, material=material))


def _give_to_objects(
    stack: ExitStack, scene: Scene, material: bpy.types.Material, stand_in: bpy.types.Material
) -> None:
    """Where one material is a mirror here and none there, the objects that do not mirror get their own."""
    plain = {object_name(instance.name) for instance in scene.instances if not instance.reflector}
    for shaped in bpy.data.objects:
        if shaped.name not in plain or shaped.library is not None:
            continue
        for slot in shaped.material_slots:
            if slot.material == material:
                before = slot.link, slot.material
                stack.callback(_restore_slot, slot, *before)
                slot.link = "OBJECT"
                slot.material = stand_in


def _restore_slot(slot: bpy.types.MaterialSlot, link: str, material: bpy.types.Material) -> None:
    if link == "DATA":
        slot.material = None
    slot.link = link
    if link == "OBJECT":
        slot.material = material
