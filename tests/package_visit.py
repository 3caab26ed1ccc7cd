"""Runs by itself in a Blender that has nothing but what Blender brings: installs a zip, uses it, takes it away.

Usage: python -I -S package_visit.py SITE ZIP, where SITE is a folder with bpy and what it needs.
Prints one line of JSON, last. Not a test: test_package.py starts it.
"""

import importlib
import json
import os
import pkgutil
import sys
from pathlib import Path

sys.path.append(sys.argv[1])

import bpy

MODULE = "bl_ext.user_default.catoptric"
HOME = Path(os.environ["BLENDER_USER_RESOURCES"])


def state() -> dict[str, list[str]]:
    """What an add-on may leave behind in Blender."""
    types = {name: getattr(bpy.types, name) for name in dir(bpy.types)}
    described = {name: cls.bl_rna.properties for name, cls in types.items() if hasattr(cls, "bl_rna")}
    handlers = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    return {
        "types": list(types),
        "properties": [f"{name}.{key}" for name, properties in described.items() for key, _ in properties.items()],
        "handlers": [
            f"{name}: {each}" for name, several in handlers.items() if isinstance(several, list) for each in several
        ],
        "drawn": [
            f"{name}: {each.__module__}.{each.__qualname__}"
            for name, cls in types.items()
            for each in getattr(getattr(cls, "draw", None), "_draw_funcs", ())
        ],
        "add-ons": list(bpy.context.preferences.addons.keys()),
    }


def files() -> list[str]:
    """What lies in Blender's folder of the user, but for the lists of extensions that Blender keeps."""
    found = [path.relative_to(HOME).as_posix() for path in HOME.rglob("*") if path.is_file()]
    return [name for name in found if name not in {"extensions/.cache/compat.dat"} and "/.blender_ext/" not in name]


def visit(package: str) -> dict:
    """Install, use, switch off and on, uninstall."""
    before = state(), files()
    bpy.ops.extensions.package_install_files(filepath=package, repo="user_default", enable_on_install=True)
    told = {"enabled": MODULE in bpy.context.preferences.addons, "missing": {}, "outside": []}
    extension = importlib.import_module(MODULE)
    for found in pkgutil.walk_packages(extension.__path__, MODULE + ".", onerror=lambda name: None):
        try:
            importlib.import_module(found.name)
        except ImportError as error:
            told["missing"][found.name] = error.name
    for name in ("flip_evaluator", "glcontext", "moderngl", "platformdirs"):
        if not Path(importlib.import_module(name).__file__).is_relative_to(HOME):
            told["outside"].append(name)
    gl = importlib.import_module(f"{MODULE}.addon.gl")
    told["gl"] = gl.call(lambda: gl.require().info["GL_VERSION"])
    for _ in range(3):
        bpy.ops.preferences.addon_disable(module=MODULE)
        told["disabled"] = differences(before[0], state())
        bpy.ops.preferences.addon_enable(module=MODULE)
    names = [repo.module for repo in bpy.context.preferences.extensions.repos]
    bpy.ops.extensions.package_uninstall(repo_index=names.index("user_default"), pkg_id="catoptric")
    told["left"] = differences(before[0], state())
    told["files"] = sorted(set(files()) - set(before[1]))
    return told


def differences(before: dict[str, list[str]], after: dict[str, list[str]]) -> list[str]:
    """What is there now and was not before, or is there more often."""
    left = []
    for kind, names in after.items():
        extra = list(names)
        for name in before[kind]:
            if name in extra:
                extra.remove(name)
        left += [f"{kind}: {name}" for name in extra]
    return sorted(left)


if __name__ == "__main__":
    print(json.dumps(visit(sys.argv[2])))
