"""What `catoptric methods` prints, and the manual says, of methods and their parameters."""

import inspect
import re

from rich.console import Console
from rich.padding import Padding

from ..addon.methods.contract import Method
from ..addon.methods.registry import METHODS
from ..addon.parameters import Parameter, Value


def print_methods() -> None:
    """Print every method: name, source, parameters and limits."""
    console = Console(highlight=False)
    for method in METHODS.values():
        console.print(method.name, style="bold")
        console.print(Padding(summary(method), (0, 0, 0, 2)), markup=False)
        console.print(Padding(f"Source: {method.source}", (0, 0, 0, 2)), markup=False)
        console.print(Padding(f"Limits: {limitations(method)}", (0, 0, 0, 2)), markup=False)
        for parameter in method.parameters:
            console.print(Padding(_line(method, parameter), (0, 0, 0, 4)), markup=False)
        console.print()


def summary(method: type[Method]) -> str:
    """The first paragraph of the docstring, on one line."""
    return " ".join(inspect.getdoc(method).split("\n\n")[0].split())


def limitations(method: type[Method]) -> str:
    """The docstring's limitations, on one line."""
    match = re.search(r"Limitations:\s*(.+?)(?:\n\n|\Z)", inspect.getdoc(method), re.DOTALL)
    return " ".join(match[1].split()) if match else "none known"


def allowed(parameter: Parameter) -> str:
    """What values the parameter takes, for people."""
    if parameter.choices:
        return ", ".join(parameter.choices)
    if isinstance(parameter.default, bool):
        return "on, off"
    bounds = [None if bound is None else f"{bound:g}" for bound in (parameter.minimum, parameter.maximum)]
    match bounds:
        case [None, None]:
            return "any"
        case [low, None]:
            return f"{low} or more"
        case [None, high]:
            return f"{high} or less"
        case [low, high]:
            return f"{low} to {high}"


def with_unit(value: Value, unit: str) -> str:
    """A parameter's value, for people."""
    shown = {True: "on", False: "off"}[value] if isinstance(value, bool) else str(value)
    return f"{shown} {unit}".rstrip()


def _line(method: type[Method], parameter: Parameter) -> str:
    section = f" ({parameter.section})" if parameter.section else ""
    default = with_unit(parameter.default, parameter.unit)
    return f"{method.name}.{parameter.name} = {default}, {allowed(parameter)}: {parameter.help}{section}"
