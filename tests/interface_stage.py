"""The add-on registered in this Blender, with a small scene open; and what an add-on may leave behind."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import catoptric
from catoptric.addon.interface import stages, work

from .blender_stage import add_box, add_camera, add_lamp, add_sphere, empty_scene, principled

SIZE = (48, 32)


@contextmanager
def registered() -> Iterator[None]:
    """Blender 4.5 as a module hangs at its end where a render engine is still registered."""
    catoptric.register()
    try:
        yield
    finally:
        catoptric.unregister()


def small_scene() -> bpy.types.Scene:
    """A mirror ball between two boxes, under a lamp."""
    scene = empty_scene()
    mirror = principled("Chrome", (0.9, 0.9, 0.9), Metallic=1.0, Roughness=0.0)
    matte = principled("Red", (0.8, 0.1, 0.1), Roughness=1.0)
    add_sphere(scene, "Ball", 1.0, mirror, segments=24, rings=12)
    add_box(scene, "Box", 1.0, matte, (2.0, 0.0, 0.0))
    add_box(scene, "Crate", 1.0, matte, (-2.0, 0.5, 0.0))
    add_lamp(scene, "Sun", "SUN", 3.0, rotation=(0.5, 0.2, 0.0))
    add_camera(scene, (0.0, -8.0, 1.0), (1.45, 0.0, 0.0))
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.catoptric.reference_samples = 2
    scene.catoptric.methods.layered_depth_published.resolution = 16
    bpy.context.view_layer.update()
    return scene


def found() -> stages.Stage:
    """The stage of the open scene, read anew."""
    assert bpy.ops.catoptric.find() == {"FINISHED"}
    return stages.known(bpy.context.scene, bpy.context.view_layer)


def until(condition, seconds: float = 60.0) -> None:
    """Let work go on, as Blender's timers would, until something is so."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        work._look()
        time.sleep(0.02)


def temporary() -> list[Path]:
    """Folders of work under way."""
    return list(Path(bpy.app.tempdir).glob("catoptric-*"))


def alive(pid: int) -> bool:
    """Whether a process goes on."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z" if Path("/proc").is_dir() else True


def gone(pid: int, seconds: float = 20.0) -> bool:
    """Whether it ends soon."""
    end = time.monotonic() + seconds
    while alive(pid) and time.monotonic() < end:
        time.sleep(0.1)
    return not alive(pid)


def left_behind() -> dict[str, list[str]]:
    """What an add-on may leave in Blender."""
    types = {name: getattr(bpy.types, name) for name in dir(bpy.types)}
    described = {name: kind.bl_rna.properties for name, kind in types.items() if hasattr(kind, "bl_rna")}
    handlers = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    return {
        "types": sorted(types),
        "operators": sorted(dir(bpy.ops.catoptric)),
        "properties": sorted(
            f"{name}.{key}" for name, properties in described.items() for key, _ in properties.items()
        ),
        "handlers": sorted(f"{name}: {len(each)}" for name, each in handlers.items() if isinstance(each, list)),
        "panels": sorted(
            kind.__name__
            for kind in bpy.types.Panel.__subclasses__()
            if stages.ENGINE in getattr(kind, "COMPAT_ENGINES", ()) and kind.is_registered
        ),
    }
