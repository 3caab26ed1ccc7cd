"""What people type after an option, turned into values, or one line that says what is wrong with it."""

import re
from collections.abc import Iterable, Mapping, Sequence

from ..addon.errors import UsageError
from ..addon.methods.registry import METHODS, named
from ..addon.parameters import Value, resolve

PEERS = ("eevee",)
"""Renderers that can stand beside the methods."""


def parse_resolution(text: str) -> tuple[int, int]:
    """`768x512` as (768, 512)."""
    match = re.fullmatch(r"\s*(\d+)\s*[xX×]\s*(\d+)\s*", text)
    if not match:
        raise UsageError(f"--resolution: {text!r} is no size; write width x height, as in 768x512")
    return int(match[1]), int(match[2])


def parse_frames(text: str) -> tuple[int, ...]:
    """`1:10` as the frames 1 to 10, `5` as frame 5."""
    match = re.fullmatch(r"\s*(-?\d+)\s*(?::\s*(-?\d+)\s*)?", text)
    if not match:
        raise UsageError(f"--frames: {text!r} is neither one frame nor a range; write first:last, as in 1:10")
    first = int(match[1])
    last = int(match[2]) if match[2] else first
    if last < first:
        raise UsageError(f"--frames: {text} ends before it begins; write first:last, as in 1:10")
    return tuple(range(first, last + 1))


def parse_names(text: str, known: Iterable[str], option: str) -> tuple[str, ...]:
    """`a,b` as ("a", "b"), each once and each one of `known`."""
    known = tuple(known)
    names = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    for name in names:
        if name not in known:
            raise UsageError(f"{option}: there is no {name!r}; there are: {', '.join(known)}")
    if not names:
        raise UsageError(f"{option}: nothing is named; there are: {', '.join(known)}")
    return names


def parse_against(text: str, methods: Sequence[str]) -> tuple[str, ...]:
    """The methods of a run with the one named by `--against` first."""
    named_ones = parse_names(text, METHODS, "--against")
    if len(named_ones) > 1:
        raise UsageError(f"--against: {text} are several; name the one method that the others are held against")
    others = [name for name in methods if name not in named_ones]
    if not others:
        raise UsageError(
            f"--against {named_ones[0]}: there is no other method to hold against it; name one in --methods"
        )
    return (*named_ones, *others)


def parse_settings(assignments: Sequence[str], methods: Iterable[str]) -> dict[str, dict[str, Value]]:
    """`method.parameter=value` strings as every parameter's value, by method; those not set have their default."""
    given: dict[str, dict[str, str]] = {}
    for text in assignments:
        match = re.fullmatch(r"([^.=]+)\.([^.=]+)=(.*)", text)
        if not match:
            raise UsageError(f"--set: {text!r}; write method.parameter=value, as in environment-map.size=256")
        named(match[1])
        given.setdefault(match[1], {})[match[2]] = match[3]
    unused = sorted(given.keys() - set(methods))
    if unused:
        raise UsageError(f"--set: {unused[0]} is set but not among the methods of this run")
    return {name: _resolved(name, given.get(name, {})) for name in methods}


def _resolved(name: str, given: Mapping[str, str]) -> dict[str, Value]:
    try:
        return resolve(METHODS[name].parameters, given)
    except UsageError as error:
        raise UsageError(f"--set {name}: {error}") from None
