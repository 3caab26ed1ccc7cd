"""A `Scene` as one file: a zip of scene.json and an .npy for every array.

The file says what it is and which version wrote it. Numbers round-trip exactly: Python prints a
float so that it reads back the same, and arrays are stored as they are.
"""

import io
import json
import os
import struct
import tempfile
import types
import typing
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import MachineError, SceneError
from .scene import Scene

EXTENSION = ".catoptric"
FORMAT = "catoptric scene"
VERSION = 3
"""2 lets roughness vary, and tells how people look at the scene; 3 knows of light between facets.

What an older file lacks has its default.
"""

_DESCRIPTION = "scene.json"
_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, RuntimeError),  # the zip
    *(LookupError, ValueError, TypeError, AttributeError),  # the description and the arrays
)


def save(scene: Scene, path: str | Path) -> None:
    """Write `scene` to `path`, whole or not at all.

    Raises `SceneError` if the folder cannot be written to, `MachineError` if the disk is full.
    """
    path = Path(path)
    temporary = None
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=path.name, suffix=".part", delete=False) as file:
            temporary = Path(file.name)
            _write(scene, file)
        os.replace(temporary, path)
    except FileNotFoundError:
        raise SceneError(f"{path}: there is no folder {path.parent}") from None
    except PermissionError:
        raise SceneError(f"{path}: may not be written; choose another folder") from None
    except OSError as error:
        raise MachineError(f"{path}: cannot be written ({error.strerror or error})") from None
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def load(path: str | Path) -> Scene:
    """The `Scene` in the file at `path`. Raises `SceneError` if it is missing, damaged, foreign or too new."""
    path = Path(path)
    try:
        if not zipfile.is_zipfile(path) and path.stat():
            raise SceneError(f"{path}: is not a {EXTENSION} archive, or is damaged; export the scene again")
        with zipfile.ZipFile(path) as archive:
            return _read(archive, path)
    except FileNotFoundError:
        raise SceneError(f"{path}: there is no such file") from None
    except PermissionError:
        raise SceneError(f"{path}: may not be read") from None
    except _DAMAGE:
        raise SceneError(f"{path}: is damaged; export the scene again") from None


def _write(scene: Scene, file: io.BufferedIOBase) -> None:
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        arrays = 0

        def store(array: np.ndarray) -> dict[str, str]:
            nonlocal arrays
            name, arrays = f"arrays/{arrays}.npy", arrays + 1
            with archive.open(name, "w", force_zip64=True) as member:
                np.save(member, np.ascontiguousarray(array), allow_pickle=False)
            return {"array": name}

        description = {"format": FORMAT, "version": VERSION, "scene": _encode(scene, store)}
        archive.writestr(_DESCRIPTION, json.dumps(description, indent=1))


def _read(archive: zipfile.ZipFile, path: Path) -> Scene:
    if _DESCRIPTION not in archive.namelist():
        raise SceneError(f"{path}: is a zip, but not a {EXTENSION} archive")
    description = json.loads(archive.read(_DESCRIPTION))
    if description["format"] != FORMAT:
        raise SceneError(f"{path}: is not a {EXTENSION} archive")
    if description["version"] > VERSION:
        raise SceneError(f"{path}: was written by a newer Catoptric; update this one, or export the scene again")

    def fetch(reference: dict[str, str]) -> np.ndarray:
        return np.load(io.BytesIO(archive.read(reference["array"])), allow_pickle=False)

    if description["version"] == 1:
        _bring_up_to_2(description["scene"])
    scene = _decode(description["scene"], Scene, fetch)
    _check(scene)
    return scene


def _bring_up_to_2(scene: dict) -> None:
    """Version 1 knew roughness as one number."""
    for material in scene["materials"]:
        material["roughness"] = {"color": [material["roughness"]] * 3}


def _encode(value: Any, store: Callable[[np.ndarray], dict]) -> Any:
    """`value` in JSON's terms: a dataclass by its fields, an enum by its value, an array by where it is stored."""
    if isinstance(value, np.ndarray):
        return store(value)
    if is_dataclass(value):
        return {field.name: _encode(getattr(value, field.name), store) for field in fields(value)}
    if isinstance(value, tuple):
        return [_encode(item, store) for item in value]
    if isinstance(value, Enum):
        return value.value
    return value.item() if isinstance(value, np.generic) else value


def _decode(value: Any, kind: Any, fetch: Callable[[dict], np.ndarray]) -> Any:
    """What `_encode` made of a value of type `kind`; raises TypeError, ValueError or KeyError for anything else."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is types.UnionType:
        kinds = [argument for argument in arguments if argument is not type(None)]
        return None if value is None else _decode(value, kinds[0], fetch)
    if origin is tuple:
        kinds = arguments[:1] * len(value) if arguments[-1] is Ellipsis else arguments
        return tuple(_decode(item, one, fetch) for item, one in zip(value, kinds, strict=True))
    if kind is np.ndarray:
        return fetch(value)
    if is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        return kind(**{name: _decode(item, hints[name], fetch) for name, item in value.items()})
    if issubclass(kind, Enum):
        return kind(value)
    if type(value) is not kind and not (kind is float and type(value) is int):
        raise TypeError(f"{value!r} is not a {kind.__name__}")
    return value


def _check(scene: Scene) -> None:
    """Raise ValueError if something refers to what is not there."""
    for instance in scene.instances:
        _within((instance.mesh,), scene.meshes)
        _within(instance.materials, scene.materials)
        _within((instance.lightmap,), scene.images)
        _within((int(scene.meshes[instance.mesh].slots.max(initial=-1)),), instance.materials, least=-1)
    for mesh in scene.meshes:
        count = len(mesh.triangles)
        _within((int(mesh.triangles.max(initial=-1)), int(mesh.triangles.min(initial=0))), mesh.positions, least=-1)
        shapes = (mesh.triangles.shape, mesh.normals.shape, mesh.uvs.shape, mesh.slots.shape)
        if shapes != ((count, 3), (count, 3, 3), (count, 3, 2), (count,)) or mesh.positions.shape[1:] != (3,):
            raise ValueError(f"the arrays of {mesh.name} do not fit together")
    for material in scene.materials:
        sources = (material.base, material.emission, material.reflection, material.roughness)
        _within((source.image for source in sources), scene.images)


def _within(indices: typing.Iterable[int | None], there: typing.Sized, least: int = 0) -> None:
    if any(index is not None and not least <= index < len(there) for index in indices):
        raise ValueError("an index out of range")
