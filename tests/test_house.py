"""The rules of the house, held against the tree itself."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SHADERS = ROOT / "gpu_shaders"

RANKS = {
    "addon.errors": 0,
    "addon.parameters": 1,
    "addon.progress": 1,
    "addon.cache": 1,
    "addon.scene": 2,
    "addon.gl": 2,
    "addon.tracing": 2,
    "addon.drawing": 3,
    "addon.baking": 4,
    "addon.methods": 5,
    "addon.metrics": 6,
    "addon.blender": 7,
    "addon.interface": 8,
    "scenes": 8,
    "batch": 9,
}
"""A room may import what stands lower, or itself."""

BLENDER_ROOMS = ("addon.blender", "addon.interface", "scenes")
BLENDER_MODULES = {"bpy", "mathutils", "bmesh", "gpu", "bl_ui", "bl_math"}

UNIFORM = re.compile(r"\buniform\s+\w+\s+(\w+)(?:\s*\[[^\]]*\])?\s*;")


def python_files(*folders: str) -> list[Path]:
    """Every Python file of the project's folders, the root's own module first."""
    found = [ROOT / "__init__.py"] if not folders else []
    for folder in folders or ("addon", "batch", "scenes", "tests"):
        found += sorted((ROOT / folder).rglob("*.py"))
    return found


def package_files() -> list[Path]:
    """The files that make up the package."""
    return python_files("addon", "batch", "scenes")


def shader_files() -> list[Path]:
    """Every GLSL file."""
    return [path for path in sorted(SHADERS.rglob("*")) if path.is_file()]


def name_of(path: Path) -> str:
    """A file's path from the root."""
    return path.relative_to(ROOT).as_posix()


def module_of(path: Path) -> tuple[str, ...]:
    """`addon/gl/context.py` as ("addon", "gl", "context")."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


def room_of(module: tuple[str, ...]) -> str | None:
    """The room that a module stands in; None for the packages that only hold rooms."""
    for length in (2, 1):
        name = ".".join(module[:length])
        if name in RANKS:
            return name
    return None


@cache
def tree_of(path: Path) -> ast.Module:
    """The parsed file."""
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def imports_of(path: Path) -> Iterator[tuple[str, ...]]:
    """What a file imports, as absolute module paths; our own begin at the root package."""
    package = module_of(path) if path.name == "__init__.py" else module_of(path)[:-1]
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (tuple(alias.name.split(".")) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            named = tuple(node.module.split(".")) if node.module else ()
            yield from ((*base, *named, alias.name) for alias in node.names)


def test_imports_run_downhill():
    uphill = []
    for path in package_files():
        here = room_of(module_of(path))
        for target in imports_of(path):
            there = room_of(target)
            if here is None or there is None or there == here:
                continue
            if RANKS[there] >= RANKS[here]:
                uphill.append(f"{path.relative_to(ROOT)} imports {'.'.join(target)}")
    assert uphill == []


def test_every_module_stands_in_a_room():
    homeless = [path for path in package_files() if room_of(module_of(path)) is None]
    assert [path.relative_to(ROOT).as_posix() for path in homeless] == ["addon/__init__.py"]


def test_modules_import_each_other_in_no_circle():
    modules = {module_of(path): path for path in package_files()}
    edges = {
        module: {target[:length] for target in imports_of(path) for length in (len(target), len(target) - 1)}
        & modules.keys() - {module, *(module[:length] for length in range(len(module)))}
        for module, path in modules.items()
        if path.name != "__init__.py"
    }
    while leaves := [module for module, targets in edges.items() if not targets & edges.keys()]:
        for module in leaves:
            del edges[module]
    assert edges == {}


def test_imports_inside_the_package_are_relative():
    absolute = [
        f"{path.relative_to(ROOT)}: {node.names[0].name if isinstance(node, ast.Import) else node.module}"
        for path in package_files()
        for node in ast.walk(tree_of(path))
        if (isinstance(node, ast.Import) and any(alias.name.split(".")[0] == "catoptric" for alias in node.names))
        or (isinstance(node, ast.ImportFrom) and not node.level and node.module.split(".")[0] == "catoptric")
    ]
    assert absolute == []


def test_only_the_blender_rooms_import_blender():
    offenders = [
        f"{path.relative_to(ROOT)} imports {target[0]}"
        for path in package_files()
        for target in imports_of(path)
        if target[0] in BLENDER_MODULES and room_of(module_of(path)) not in BLENDER_ROOMS
    ]
    assert offenders == []


def test_everything_else_runs_without_blender():
    names = [
        ".".join(("catoptric", *module_of(path)))
        for path in package_files()
        if room_of(module_of(path)) not in BLENDER_ROOMS
    ]
    script = (
        "import importlib, sys\n"
        f"for name in {sorted(BLENDER_MODULES)!r}: sys.modules[name] = None\n"
        f"for name in {names!r}: importlib.import_module(name)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_setuptools_packages_are_the_tree():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    found = {".".join(("catoptric", *module_of(path))) for path in package_files() if path.name == "__init__.py"}
    assert set(declared) == found | {"catoptric"}
    assert declared == sorted(declared)


def test_every_other_file_of_the_package_ships_with_it():
    patterns = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]["catoptric"]
    shipped = {path for pattern in patterns for path in ROOT.glob(pattern)}
    folders = [ROOT / name for name in ("addon", "batch", "gpu_shaders", "scenes")]
    beside = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    kept_out = re.compile(r"\.(py|pyc|md|blend\d)$")
    assert [name_of(path) for path in beside if not kept_out.search(path.name) and path not in shipped] == []


@pytest.mark.parametrize("path", [*python_files(), *shader_files()], ids=name_of)
def test_file_is_one_idea(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert len(lines) < 400
    assert [number for number, line in enumerate(lines, 1) if len(line) > 120] == []


@pytest.mark.parametrize("arguments", [["check"], ["format", "--check"]], ids=" ".join)
def test_ruff_has_nothing_to_say(arguments):
    command = [sys.executable, "-m", "ruff", *arguments, "."]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("path", python_files("addon", "batch", "scenes"), ids=name_of)
def test_what_is_public_is_documented(path):
    tree = tree_of(path)
    undocumented = [path.name] if tree.body and not ast.get_docstring(tree) else []
    pending = [(path.stem, tree)]
    while pending:
        owner, node = pending.pop()
        for child in node.body:
            if not isinstance(child, ast.FunctionDef | ast.ClassDef) or child.name.startswith("_"):
                continue
            if not ast.get_docstring(child):
                undocumented.append(f"{owner}.{child.name}")
            if isinstance(child, ast.ClassDef):
                pending.append((f"{owner}.{child.name}", child))
    assert undocumented == []


@pytest.mark.parametrize("path", shader_files(), ids=name_of)
def test_shader_says_what_it_is(path):
    assert path.read_text(encoding="utf-8").lstrip().startswith(("//", "/*"))


def declared_uniforms() -> dict[str, Path]:
    """Every uniform that a shader declares, and the file that does."""
    return {name: path for path in shader_files() for name in UNIFORM.findall(path.read_text(encoding="utf-8"))}


def strings_in_python() -> set[str]:
    """Every string literal and keyword name in the rooms that drive shaders."""
    names: set[str] = set()
    for path in python_files("addon", "batch"):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                names.add(node.value)
            elif isinstance(node, ast.keyword) and node.arg:
                names.add(node.arg)
    return names


def uniforms_set_in_python() -> Iterator[str]:
    """Each NAME of `shader["NAME"] = …`, `shader["NAME"].write(…)` and `uniforms = {"NAME": …}`."""
    for path in python_files("addon", "batch"):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Assign):
                target = node.targets[0]
                yield from uniform_of(target)
                if isinstance(target, ast.Name) and target.id == "uniforms" and isinstance(node.value, ast.Dict):
                    yield from (key.value for key in node.value.keys if isinstance(key, ast.Constant))
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "write":
                yield from uniform_of(node.func.value)


def uniform_of(node: ast.AST) -> Iterator[str]:
    """NAME, if the node is `shader["NAME"]` or `program["NAME"]`, under whatever longer name."""
    if not isinstance(node, ast.Subscript) or not isinstance(node.slice, ast.Constant):
        return
    holder = node.value.id if isinstance(node.value, ast.Name) else getattr(node.value, "attr", "")
    if isinstance(node.slice.value, str) and re.search("program|shader|visibility", holder):
        yield node.slice.value


def test_every_uniform_that_python_sets_is_declared_in_a_shader():
    used = set(uniforms_set_in_python())
    assert used
    assert used - declared_uniforms().keys() == set()


def test_every_uniform_of_a_shader_is_named_in_python():
    assert declared_uniforms().keys() - strings_in_python() == set()


def test_no_path_of_a_machine_is_written_down():
    text_files = [*python_files(), *shader_files(), ROOT / "README.md", ROOT / "pyproject.toml", ROOT / ".ci" / "run"]
    pattern = re.compile(r"(?<![\w.])/(?:home|root|Users|tmp|work|mnt)/[\w.]")
    assert [path.name for path in text_files if pattern.search(path.read_text(encoding="utf-8"))] == []
