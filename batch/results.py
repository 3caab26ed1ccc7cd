"""What `catoptric compare` measured, and results.json, which keeps it."""

import json
import math
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_origin, get_type_hints

from ..addon.errors import CatoptricError, MachineError
from ..addon.metrics import Figures
from ..addon.parameters import Value

SCHEMA = 1
FILE_NAME = "results.json"

_SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swiftshader", "swr", "software", "basic render", "lavapipe")


class ResultsError(CatoptricError):
    """A results.json cannot be read: it is damaged, or another version wrote it."""


@dataclass(frozen=True)
class Machine:
    """Where the figures come from. `renderer` and `gl` are what OpenGL says of itself."""

    renderer: str
    gl: str
    cpu: str
    blender: str
    python: str

    @property
    def software(self) -> bool:
        """Whether OpenGL ran on the processor, so that times say nothing about a graphics card."""
        return any(word in self.renderer.lower() for word in _SOFTWARE_RENDERERS)


@dataclass(frozen=True)
class Times:
    """Milliseconds: baking once, the reflection pass and the whole frame each time. None where not measured.

    In a sequence, `bake` is what the frame added to what the frames before it had baked. `stages` are those of a
    method's `Frame`, whatever it names besides.
    """

    bake: float | None = None
    reflection: float | None = None
    frame: float | None = None
    stages: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Images:
    """Paths of pictures relative to the folder of results.json: EXR, EXR and PNG.

    `reference` and `flip` are None where there was nothing to judge by. `retraced`, a PNG, is white where a method
    that takes over from earlier frames traced anew; None for all others.
    """

    method: str
    reference: str | None
    flip: str | None
    retraced: str | None = None


@dataclass(frozen=True)
class Noise:
    """The reference's own error (`metrics.noise_maps`): what a perfect method would measure."""

    over_reflectors: Figures
    over_frame: Figures


@dataclass(frozen=True)
class Reused:
    """What a frame took over from an earlier one: all but the share `retraced` of the reflectors' pixels.

    `key`: it was traced whole, for those that follow.
    """

    retraced: float
    key: bool


@dataclass(frozen=True)
class Samples:
    """Samples a pixel of Cycles' picture, None where it is not the reference, and of the method's own, if known."""

    reference: int | None = None
    method: int | None = None


@dataclass(frozen=True)
class Result:
    """One method in one frame of one scene. Without a reference all figures but `pixels` are None.

    `settings` are what was asked for, `samples` what was taken. `against` names the method whose picture was the
    reference; None where Cycles' was, or none.
    """

    scene: str
    frame: int
    method: str
    lighting: str
    width: int
    height: int
    settings: dict[str, Value]
    over_reflectors: Figures
    over_frame: Figures
    time_ms: Times
    images: Images
    noise: Noise | None = None
    warnings: list[str] = field(default_factory=list)
    reuse: Reused | None = None
    against: str | None = None
    samples: Samples = Samples()

    @cached_property
    def line(self) -> str:
        """It as JSON, without a line break; made once, for it is written again after each frame that follows."""
        return json.dumps(_finite(asdict(self)), allow_nan=False)


@dataclass(frozen=True)
class Skipped:
    """A method that was not measured. `error` says that it failed, not that it does not apply to the scene.

    `frame` and `lighting` are None where it concerns all of them.
    """

    scene: str
    method: str
    reason: str
    error: bool = False
    frame: int | None = None
    lighting: str | None = None


@dataclass
class Results:
    """All that one `compare` measured. `sources` gives each method's one-line source."""

    catoptric: str
    machine: Machine
    results: list[Result] = field(default_factory=list)
    skipped: list[Skipped] = field(default_factory=list)
    sources: dict[str, str] = field(default_factory=dict)

    def add(self, result: Result) -> None:
        """Take in `result`, in place of an older one of that scene, frame, method and lighting."""
        places = [_place(old) for old in self.results]
        if _place(result) in places:
            self.results[places.index(_place(result))] = result
        else:
            self.results.append(result)
        self.skipped = [old for old in self.skipped if not _covers(old, result)]

    def skip(self, skipped: Skipped) -> None:
        """Note that a method was not measured, once."""
        self.skipped = [old for old in self.skipped if _place(old) != _place(skipped)] + [skipped]

    def find(self, **wanted: object) -> Result | None:
        """The result whose attributes are as `wanted`, as in `find(scene="box", frame=1, settings={...})`."""
        for result in self.results:
            if all(getattr(result, name) == value for name, value in wanted.items()):
                return result
        return None

    def save(self, directory: Path) -> Path:
        """Write results.json into `directory`, whole or not at all; raises `MachineError` for a full disk."""
        path = Path(directory) / FILE_NAME
        content = _finite({"schema": SCHEMA, **asdict(replace(self, results=[]))})
        del content["results"]
        rest = json.dumps(content, indent=1, allow_nan=False).removesuffix("\n}")
        rows = ",\n  ".join(result.line for result in self.results)
        with atomically(path) as temporary:
            temporary.write_text(f'{rest},\n "results": [\n  {rows}\n ]\n}}\n', encoding="utf-8")
        return path

    @classmethod
    def load(cls, directory: Path) -> "Results":
        """Read back what `save` wrote. Raises `ResultsError`, naming the entry that is wrong."""
        path = Path(directory) / FILE_NAME
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if not isinstance(content, dict) or content.pop("schema", None) != SCHEMA:
                raise ValueError(f"it is not of schema {SCHEMA}")
            return _read(cls, content, "$")
        except OSError as error:
            raise ResultsError(f"cannot read {path}: {error.strerror}") from None
        except ValueError as error:
            raise ResultsError(f"{path} cannot be used: {error}") from None

    @classmethod
    def resume(cls, directory: Path, catoptric: str, machine: Machine) -> tuple["Results", str | None]:
        """The results in `directory`, or none yet, and what to tell the person if they were damaged.

        A damaged file is kept as results.damaged.json.
        """
        path = Path(directory) / FILE_NAME
        if not path.exists():
            return cls(catoptric, machine), None
        try:
            found = cls.load(directory)
        except ResultsError as error:
            kept = path.with_name("results.damaged.json")
            os.replace(path, kept)
            return cls(catoptric, machine), f"{error}; kept as {kept.name}, starting anew"
        found.catoptric, found.machine = catoptric, machine
        return found, None


@contextmanager
def atomically(path: Path) -> Iterator[Path]:
    """A temporary path beside `path`, of the same ending, that replaces it once the block ends well.

    Makes the folder. Raises `MachineError` for a full disk or a folder that cannot be written.
    """
    path = Path(path)
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=path.suffix)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        # mkstemp makes files that only their owner can read; a report is to be shown to others.
        temporary.chmod(0o644)
        os.replace(temporary, path)
    except OSError as error:
        raise MachineError(f"cannot write {path}: {error.strerror}; free some space or choose another --out") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def _place(entry: Result | Skipped) -> tuple:
    return entry.scene, entry.frame, entry.method, entry.lighting


def _covers(skipped: Skipped, result: Result) -> bool:
    """Whether `skipped` says that `result` does not exist."""
    return (
        (skipped.scene, skipped.method) == (result.scene, result.method)
        and skipped.frame in (None, result.frame)
        and skipped.lighting in (None, result.lighting)
    )


def _finite(value: Any) -> Any:
    """`value` with None for every number that JSON cannot hold."""
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _read(kind: Any, data: Any, where: str) -> Any:
    """`data` from JSON as the annotated type `kind`. Raises `ValueError` that names the place where it does not fit."""
    origin, inner = get_origin(kind), get_args(kind)
    if is_dataclass(kind):
        return _read_dataclass(kind, data, where)
    if origin is list and isinstance(data, list):
        return [_read(inner[0], entry, f"{where}[{index}]") for index, entry in enumerate(data)]
    if origin is dict and isinstance(data, dict):
        return {key: _read(inner[1], entry, f"{where}.{key}") for key, entry in data.items()}
    if data is None and NoneType in inner:
        return None
    if NoneType in inner:
        return _read(next(option for option in inner if option is not NoneType), data, where)
    allowed = inner or (kind,)
    if float in allowed and type(data) is int and int not in allowed:
        return float(data)
    if type(data) not in allowed:
        raise ValueError(f"{where} is {json.dumps(data)[:40]}, which cannot be")
    return data


def _read_dataclass(kind: type, data: Any, where: str) -> Any:
    if not isinstance(data, dict):
        raise ValueError(f"{where} is {json.dumps(data)[:40]}, which cannot be")
    unknown = set(data) - {entry.name for entry in fields(kind)}
    if unknown:
        raise ValueError(f"{where} has an entry {min(unknown)!r} that is not known here")
    hints = get_type_hints(kind)
    try:
        return kind(**{name: _read(hints[name], entry, f"{where}.{name}") for name, entry in data.items()})
    except TypeError as error:
        raise ValueError(f"{where}: {error}") from None
