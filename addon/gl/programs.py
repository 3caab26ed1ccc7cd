"""Shader programs from gpu_shaders/, with `#include` and errors that name a file and line."""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import moderngl

from .context import require

SHADERS = Path(__file__).resolve().parents[2] / "gpu_shaders"

_VERSION = "#version 410 core"
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"')
_SCREEN = "common/screen.vert"


class ShaderError(Exception):
    """A shader does not compile: a defect of the project, with the file and line to open."""


def source(name: str, defines: Mapping[str, int] | None = None) -> tuple[str, list[str]]:
    """The text of a shader file with every include pasted in once, and the files in it, by `#line` number."""
    files: list[str] = []
    lines = [_VERSION, *(f"#define {key} {value}" for key, value in (defines or {}).items())]
    _paste(name, files, lines)
    return "\n".join(lines) + "\n", files


def _paste(name: str, files: list[str], lines: list[str]) -> None:
    if name in files:
        return
    index = len(files)
    files.append(name)
    lines.append(f"#line 1 {index}")
    for number, line in enumerate((SHADERS / name).read_text(encoding="utf-8").splitlines(), 1):
        include = _INCLUDE.match(line)
        if include:
            _paste(include[1], files, lines)
            lines.append(f"#line {number + 1} {index}")
        else:
            lines.append(line)


def program(
    vertex: str | None, fragment: str, defines: Mapping[str, int] | None = None, geometry: str | None = None
) -> moderngl.Program:
    """The program of two or three files below gpu_shaders/, compiled once; no vertex file: a full-screen triangle."""
    between = (("geometry_shader", geometry),) if geometry else ()
    stages = ("vertex_shader", vertex or _SCREEN), *between, ("fragment_shader", fragment)
    return _compile(stages, (), tuple(sorted((defines or {}).items())))


def feedback(
    stages: Mapping[str, str], varyings: Sequence[str], defines: Mapping[str, int] | None = None
) -> moderngl.Program:
    """A program that draws nothing: a vertex array's `transform` writes its `varyings`, one after the other.

    `stages` maps moderngl's names, as vertex_shader or geometry_shader, to files below gpu_shaders/. Compiled once.
    """
    return _compile(tuple(stages.items()), tuple(varyings), tuple(sorted((defines or {}).items())))


@cache
def _compile(
    stages: tuple[tuple[str, str], ...], varyings: tuple[str, ...], defines: tuple[tuple[str, int], ...]
) -> moderngl.Program:
    sources = {stage: source(name, dict(defines)) for stage, name in stages}
    try:
        return require().program(**{stage: text for stage, (text, _) in sources.items()}, varyings=varyings)
    except moderngl.Error as error:
        files = next((files for stage, (_, files) in sources.items() if stage in str(error)), [])
        raise ShaderError(_located(str(error), files)) from None


def _located(message: str, files: list[str]) -> str:
    def name(match: re.Match) -> str:
        index = int(match[1])
        return f"{files[index]}:{match[2]}" if index < len(files) else match[0]

    return re.sub(r"\b(\d+)[:(](\d+)\)?", name, message)


@cache
def screen(shader: moderngl.Program) -> moderngl.VertexArray:
    """A vertex array that covers the viewport with `shader`; render it with `vertices=3`. Made once."""
    return require().vertex_array(shader, [])


def set_uniforms(shader: moderngl.Program, values: Mapping[str, object]) -> None:
    """Set the uniforms that the program has kept of these: a compiler drops what is not read."""
    for name, value in values.items():
        if name in shader:
            shader[name] = value
