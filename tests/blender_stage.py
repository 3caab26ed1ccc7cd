"""A small Blender scene and the Scene that extraction would make of it, written down by hand."""

import bpy
import numpy as np
from catoptric.addon.scene import BLACK, Camera, ColorSource, Fresnel, Instance, Lamp, LampKind, Material, Mesh, Scene

WORLD = (0.1, 0.2, 0.3)


def empty_scene() -> bpy.types.Scene:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*WORLD, 1.0)
    return scene


def add_camera(scene, location, rotation, **settings):
    data = bpy.data.cameras.new("Camera")
    for name, value in settings.items():
        setattr(data, name, value)
    camera = bpy.data.objects.new("Camera", data)
    camera.location, camera.rotation_euler = location, rotation
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def fly(scene, frames=40, way=(2.0, 0.0, 0.0)):
    """Let the scene's camera move by `way` from frame 1 to `frames`, its timeline's last."""
    camera, begin = scene.camera, scene.camera.location.copy()
    for frame, share in ((1, 0.0), (frames, 1.0)):
        camera.location = [at + share * by for at, by in zip(begin, way, strict=True)]
        camera.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = 1, frames
    scene.frame_set(1)


def add_mesh(scene, name, positions, faces, material=None, location=(0, 0, 0), smooth=False):
    data = bpy.data.meshes.new(name)
    data.from_pydata([tuple(map(float, p)) for p in positions], [], [tuple(map(int, f)) for f in faces])
    data.uv_layers.new(name="UVMap")
    if smooth:
        data.shade_smooth()
    if material:
        data.materials.append(material)
    shaped = bpy.data.objects.new(name, data)
    shaped.location = location
    scene.collection.objects.link(shaped)
    return shaped


def add_plane(scene, name, size, material=None, location=(0, 0, 0)):
    h = size / 2
    return add_mesh(scene, name, [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)], material, location)


def add_box(scene, name, size, material=None, location=(0, 0, 0)):
    h = size / 2
    corners = [(x, y, z) for x in (-h, h) for y in (-h, h) for z in (-h, h)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return add_mesh(scene, name, corners, faces, material, location)


def add_sphere(scene, name, radius, material=None, location=(0, 0, 0), segments=128, rings=64):
    theta = np.linspace(0, np.pi, rings + 1)[1:-1]
    phi = np.arange(segments) * 2 * np.pi / segments
    ring = np.stack(
        [
            np.sin(theta)[:, None] * np.cos(phi),
            np.sin(theta)[:, None] * np.sin(phi),
            np.cos(theta)[:, None] * np.ones_like(phi),
        ],
        axis=-1,
    ).reshape(-1, 3)
    points = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]]) * radius
    top, bottom, last = len(points) - 2, len(points) - 1, (rings - 2) * segments
    faces = []
    for k in range(segments):
        after = (k + 1) % segments
        faces += [(top, k, after), (bottom, last + after, last + k)]
        for r in range(rings - 2):
            faces.append((r * segments + k, (r + 1) * segments + k, (r + 1) * segments + after, r * segments + after))
    return add_mesh(scene, name, points, faces, material, location, smooth=True)


def add_lamp(scene, name, kind, energy, location=(0, 0, 0), rotation=(0, 0, 0), size=0.0):
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    if kind == "SUN":
        data.angle = size
    elif kind == "AREA":
        data.size = size
    else:
        data.shadow_soft_size = size
    lamp = bpy.data.objects.new(name, data)
    lamp.location, lamp.rotation_euler = location, rotation
    scene.collection.objects.link(lamp)
    return lamp


def principled(name, color, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1.0)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    return material


def as_scene(scene, materials, reflectors=(), leave_out=()) -> Scene:
    """The Scene of the meshes in `scene`; `materials` says what each Blender material means."""
    bpy.context.view_layer.update()
    meshes, instances = [], []
    listed = list(materials)
    for shaped in scene.objects:
        if shaped.type != "MESH" or shaped.name in leave_out:
            continue
        data = shaped.data
        data.calc_loop_triangles()
        triangles = np.array([tuple(t.loops) for t in data.loop_triangles])
        vertex_of = np.array([loop.vertex_index for loop in data.loops])
        normals = np.array([tuple(n.vector) for n in data.corner_normals], np.float32)
        meshes.append(
            Mesh(
                name=data.name,
                positions=np.array([tuple(v.co) for v in data.vertices], np.float32),
                triangles=vertex_of[triangles].astype(np.int32),
                normals=normals[triangles],
                uvs=np.zeros((len(triangles), 3, 2), np.float32),
                slots=np.zeros(len(triangles), np.int32),
            )
        )
        instances.append(
            Instance(
                name=shaped.name,
                mesh=len(meshes) - 1,
                matrix=np.array(shaped.matrix_world, np.float64),
                materials=(listed.index(data.materials[0].name) if data.materials and data.materials[0] else 0,),
                reflector=shaped.name in reflectors,
            )
        )
    lamps = tuple(
        Lamp(lamp.name, LampKind[lamp.data.type], np.array(lamp.matrix_world, np.float64), (lamp.data.energy,) * 3)
        for lamp in scene.objects
        if lamp.type == "LIGHT"
    )
    return Scene(
        name="stage",
        camera=Camera(np.array(scene.camera.matrix_world, np.float64)),
        meshes=tuple(meshes),
        instances=tuple(instances),
        materials=tuple(materials.values()),
        lamps=lamps,
    )


def matte(name, color):
    return Material(name, ColorSource(color))


def chrome(name, color=(1.0, 1.0, 1.0)):
    return Material(name, ColorSource(color), 0.0, BLACK, ColorSource(color), fresnel=Fresnel.SCHLICK, roughness=BLACK)


def state() -> dict:
    """Everything in the file that a render might have changed, as plain values."""
    skipped = {"linear_colorspace_settings"}  # Blender fills it in on the way
    skipped |= {"rna_type", "pixels", "is_updated", "is_evaluated", "session_uid", "users", "library_weak_reference"}

    def plain(value):
        if isinstance(value, bpy.types.bpy_struct):
            return getattr(value, "name_full", None) or getattr(value, "name", None) or type(value).__name__
        if hasattr(value, "__iter__") and not isinstance(value, str):
            return [plain(inner) for inner in value]
        return value

    def struct(owner):
        names = [item.identifier for item in owner.bl_rna.properties if item.identifier not in skipped]
        return {name: plain(getattr(owner, name)) for name in names}

    taken = {}
    for kind in ("scenes", "objects", "meshes", "materials", "images", "lights", "cameras", "node_groups", "worlds"):
        for block in getattr(bpy.data, kind):
            taken[kind, block.name_full] = struct(block)
            tree = getattr(block, "node_tree", None) if kind != "node_groups" else block
            if tree:
                taken[kind, block.name_full, "nodes"] = [struct(node) for node in tree.nodes]
                taken[kind, block.name_full, "links"] = [
                    (link.from_node.name, link.from_socket.name, link.to_node.name) for link in tree.links
                ]
    for scene in bpy.data.scenes:
        for part in ("render", "cycles", "eevee", "view_settings"):
            taken[scene.name, part] = struct(getattr(scene, part))
        taken[scene.name, "image"] = struct(scene.render.image_settings)
    for shaped in bpy.data.objects:
        taken[shaped.name, "slots"] = [(slot.link, plain(slot.material)) for slot in shaped.material_slots]
    return taken
