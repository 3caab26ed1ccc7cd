"""What every demonstration scene is put together from: meshes, materials, lamps, sky, camera, file."""

import os
import shutil
import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
from mathutils import Vector

from . import pictures, shapes

QUALITY = 88  # of JPEGs
SUN_ANGLE = 0.03  # radians: wider than the real sun, so that shadows have a soft rim


def clear() -> None:
    """Begin an empty file with the render settings that all scenes share."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = 768, 512
    scene.render.filepath = "//"
    scene.view_settings.view_transform = "Standard"
    scene.cycles.samples = 64
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.seed = 0


def bounces(count: int) -> None:
    """Cycles' glossy bounces: a path is mirrored at most `count` + 1 times."""
    bpy.context.scene.cycles.glossy_bounces = count


def save(path: Path) -> None:
    """Save the file, compressed, at `path`: written beside it first, so that an old one stays whole."""
    bpy.data.orphans_purge(do_recursive=True)
    with tempfile.TemporaryDirectory() as folder:  # the file keeps the path it was saved at
        draft = Path(folder, path.name)
        bpy.ops.wm.save_as_mainfile(filepath=str(draft), compress=True, check_existing=False)
        beside = path.with_suffix(".part")
        shutil.copyfile(draft, beside)
    os.replace(beside, path)


def put(name: str, shape: shapes.Shape, material, location=(0, 0, 0), turned=(0, 0, 0), smooth=True):
    """An object of `shape`, rotated by XYZ Euler angles in degrees. Returns it."""
    faces = [[corner for corner in face if corner >= 0] for face in shape.faces.tolist()]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(shape.points.tolist(), [], faces)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", shape.uvs[shape.faces >= 0].astype(np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.full(len(faces), smooth))
    mesh.update()
    if mesh.validate(verbose=False):
        raise ValueError(f"the faces of '{name}' are not a proper mesh")
    return place(name, mesh, material, location, turned)


def assemble(name: str, parts, location=(0, 0, 0), turned=(0, 0, 0), crease: float | None = 35.0):
    """One object of several parts: pairs of a shape and its material. Returns it.

    It is shaded smooth but for edges of more than `crease` degrees; None shades every face flat.
    """
    materials = list(dict.fromkeys(material for _, material in parts))
    thing = put(name, shapes.joined([shape for shape, _ in parts]), materials[0], location, turned, crease is not None)
    for material in materials[1:]:
        thing.data.materials.append(material)
    slots = np.repeat([materials.index(material) for _, material in parts], [len(shape.faces) for shape, _ in parts])
    thing.data.polygons.foreach_set("material_index", slots.astype(np.int32))
    if crease is not None:
        thing.data.set_sharp_from_angle(angle=np.radians(crease))
    return thing


def again(thing, location, turned=(0, 0, 0)):
    """Another object of the same mesh. Returns it."""
    return place(thing.name, thing.data, thing.data.materials[0], location, turned)


def place(name: str, mesh, material, location=(0, 0, 0), turned=(0, 0, 0)):
    """An object of a Blender mesh, given `material`. Returns it."""
    if material.name not in mesh.materials:
        mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    thing.location = location
    thing.rotation_euler = np.radians(turned)
    bpy.context.collection.objects.link(thing)
    return thing


def subdivide(thing, levels: int) -> None:
    """Catmull-Clark subdivision, the same in the viewport and in renders."""
    modifier = thing.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = levels


def _material(name: str, code: str):
    """A new material and its Principled node; `code` is also its colour in the viewport."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.diffuse_color = (*pictures.linear(code), 1.0)
    node = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    node.inputs["Base Color"].default_value = (*pictures.linear(code), 1.0)
    return material, node


def matte(name: str, code: str = "#cccccc", picture: np.ndarray | None = None, quality: int | None = None):
    """A material that only scatters light: a "#rrggbb" colour, or a painted image texture.

    A texture keeps every texel, or is a JPEG of `quality` (1 to 100), which makes a smaller file.
    """
    material, node = _material(name, code)
    node.inputs["Roughness"].default_value = 1.0
    node.inputs["Specular IOR Level"].default_value = 0.0
    if picture is not None:
        _link(node, "Base Color", _byte_image(name, picture, quality))
    return material


def polished(name: str, picture: np.ndarray, roughness: float | np.ndarray, ior: float = 1.5, quality: int = QUALITY):
    """A clear gloss over a painted image texture: Principled, no metal.

    `roughness` is one value of the node, which a script may change, or a picture of it (H, W) in 0..1.
    """
    material, node = _material(name, "#808080")
    node.inputs["IOR"].default_value = ior
    _link(node, "Base Color", _byte_image(name, picture, quality))
    if isinstance(roughness, np.ndarray):
        image = _byte_image(f"{name} roughness", np.repeat(roughness[..., None], 3, axis=2), quality)
        image.colorspace_settings.name = "Non-Color"
        _link(node, "Roughness", image)
    else:
        node.inputs["Roughness"].default_value = material.roughness = roughness
    return material


def reflects(thing) -> None:
    """Say of an object that it is a reflector, however rough its material is made."""
    thing["catoptric_reflector"] = True


def mirror(name: str, code: str = "#f5f5f5"):
    """A perfect mirror: metal without roughness, tinted by its colour."""
    material, node = _material(name, code)
    material.metallic, material.roughness = 1.0, 0.0
    node.inputs["Metallic"].default_value = 1.0
    node.inputs["Roughness"].default_value = 0.0
    return material


def glowing(name: str, code: str, strength: float, picture: np.ndarray | None = None, lamp: bool = True):
    """A material that gives off light, of one colour or a painted picture's, and scatters none.

    Cycles aims no light paths at a picture, nor at what is no `lamp`: lamps beside it light with less noise.
    """
    material, node = _material(name, code)
    node.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    node.inputs["Specular IOR Level"].default_value = 0.0
    node.inputs["Emission Color"].default_value = (*pictures.linear(code), 1.0)
    node.inputs["Emission Strength"].default_value = strength
    if picture is not None:
        _link(node, "Emission Color", _byte_image(name, picture, QUALITY))
    if picture is not None or not lamp:
        material.cycles.emission_sampling = "NONE"
    return material


def _link(node, socket: str, image) -> None:
    """Let an input of `node` be looked up in `image`."""
    tree = node.id_data
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.location = (node.location.x - 320.0, node.location.y - 280.0 * (socket != "Base Color"))
    tree.links.new(texture.outputs["Color"], node.inputs[socket])


def _byte_image(name: str, picture: np.ndarray, quality: int | None = None):
    """An sRGB image of 8 bits a channel, packed into the file: as PNG, or as JPEG of a `quality`."""
    height, width = picture.shape[:2]
    image = bpy.data.images.new(name, width, height)
    if quality is None:
        pixels = np.ones((height, width, 4), dtype=np.float32)
        pixels[..., :3] = np.clip(picture, 0.0, 1.0)
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
    else:
        specification = oiio.ImageSpec(width, height, 3, "uint8")
        specification.attribute("compression", f"jpeg:{quality}")
        _pack(image, np.clip(picture, 0.0, 1.0).astype(np.float32), specification, "texture.jpg")
    return image


def _pack(image, picture: np.ndarray, specification, file_name: str) -> None:
    """Pack (H, W, 3) float32 into `image` as a file of the kind that `file_name` ends in."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, file_name)
        output = oiio.ImageOutput.create(str(file))
        output.open(str(file), specification)
        output.write_image(np.ascontiguousarray(picture[::-1]))  # a file begins at the top
        output.close()
        data = file.read_bytes()
    image.pack(data=data, data_len=len(data))
    image.source = "FILE"


def sky(settings: pictures.Sky, sun: float, strength: float = 1.0, width: int = 1536) -> None:
    """The world: a painted panorama `width` texels wide, packed as an EXR, and a sun lamp of `sun` W/m² in its sun."""
    image = _panorama(settings.picture(width))
    world = bpy.data.worlds.new("Sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next(node for node in nodes if node.type == "BACKGROUND")
    background.inputs["Strength"].default_value = strength
    environment = nodes.new("ShaderNodeTexEnvironment")
    environment.image = image
    links.new(environment.outputs["Color"], background.inputs["Color"])
    azimuth, elevation = np.radians([settings.azimuth, settings.elevation])
    towards = [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
    lamp = _lamp("Sun", "SUN", sun, "#fff1dc", 10 * np.array(towards), (0, 0, 0))
    lamp.data.angle = SUN_ANGLE


def plain_world(code: str, strength: float) -> None:
    """The world: one colour in every direction."""
    world = bpy.data.worlds.new("Plain")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*pictures.linear(code), 1.0)
    background.inputs["Strength"].default_value = strength


def _panorama(radiance: np.ndarray):
    """A float image of (H, W, 3) scene-linear radiance, packed as a half-float EXR."""
    height, width = radiance.shape[:2]
    specification = oiio.ImageSpec(width, height, 3, "half")
    specification.attribute("compression", "dwaa:45")
    image = bpy.data.images.new("sky.exr", width, height, float_buffer=True)
    _pack(image, radiance, specification, "sky.exr")
    image.colorspace_settings.name = "Linear Rec.709"
    return image


def _lamp(name: str, kind: str, power: float, code: str, location, target):
    light = bpy.data.lights.new(name, kind)
    light.energy = power
    light.color = pictures.linear(code)
    lamp = bpy.data.objects.new(name, light)
    aim(lamp, location, target)
    # A mirror would show the lamp itself; no real-time method draws lamps, so none here does.
    lamp.visible_camera = lamp.visible_glossy = False
    bpy.context.collection.objects.link(lamp)
    return lamp


def area_lamp(name: str, power: float, size: tuple[float, float], location, target, code: str = "#ffffff"):
    """A rectangular lamp of `power` W and `size` metres at `location`, facing `target`. Returns it."""
    lamp = _lamp(name, "AREA", power, code, location, target)
    lamp.data.shape = "RECTANGLE"
    lamp.data.size, lamp.data.size_y = size
    return lamp


def point_lamp(name: str, power: float, radius: float, location, code: str = "#ffffff"):
    """A round lamp of `power` W and `radius` metres. Returns it."""
    lamp = _lamp(name, "POINT", power, code, location, (location[0], location[1], location[2] - 1.0))
    lamp.data.shadow_soft_size = radius
    return lamp


def lettering(text: str, height: float, depth: float) -> shapes.Shape:
    """`text` in Blender's own typeface, in y = 0 and `depth` before it, facing -Y, its middle at the origin."""
    curve = bpy.data.curves.new("Lettering", "FONT")
    curve.body, curve.size, curve.extrude = text, height * 1.4, depth / 2.0
    curve.align_x, curve.align_y, curve.resolution_u = "CENTER", "CENTER", 3
    writing = bpy.data.objects.new("Lettering", curve)
    bpy.context.collection.objects.link(writing)
    mesh = writing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    mesh.calc_loop_triangles()
    points = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float64)
    corners = points[np.array([triangle.vertices for triangle in mesh.loop_triangles])]
    bpy.data.objects.remove(writing)
    bpy.data.curves.remove(curve)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    corners = corners[areas > 1e-9]
    upright = (corners @ shapes.turn("X", 90.0).T) - (0.0, depth / 2.0, 0.0)
    return shapes.soup(np.concatenate([upright, upright[:, -1:]], axis=1))


def camera(location, target, lens: float) -> None:
    """The scene's camera at `location`, looking at `target` through a lens of `lens` mm."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    eye = bpy.data.objects.new("Camera", data)
    aim(eye, location, target)
    bpy.context.collection.objects.link(eye)
    bpy.context.scene.camera = eye


def fly(waypoints, frames: int = 500, steps: int = 4) -> None:
    """Let the camera fly from frame 1 to `frames` on a smooth curve through `waypoints`, evenly spaced in time.

    `waypoints` (N, 6) are where it is and what it looks at; a key is set at each and `steps` - 1 times between.
    Frame 1 is the first waypoint exactly; there and at the end it is at rest.
    """
    scene = bpy.context.scene
    curve = shapes.through(np.asarray(waypoints, dtype=np.float64), steps)
    eye, last = scene.camera, None
    for frame, key in zip(np.linspace(1.0, frames, len(curve)), curve, strict=True):
        aim(eye, key[:3], key[3:])
        if last is not None:
            eye.rotation_euler.make_compatible(last)
        last = eye.rotation_euler.copy()
        eye.keyframe_insert("location", frame=frame)
        eye.keyframe_insert("rotation_euler", frame=frame)
    for channel in eye.animation_data.action.fcurves:
        for point in channel.keyframe_points:
            point.handle_left_type = point.handle_right_type = "AUTO"
        channel.update()
    scene.frame_start, scene.frame_end = 1, frames
    scene.frame_set(1)


def aim(thing, location, target) -> None:
    """Put a lamp or a camera at `location`, its -Z towards `target`, its +Y upwards."""
    thing.location = location
    thing.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
