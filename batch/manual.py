"""What `catoptric methods` prints."""

import inspect
import re

from rich.console import Console
from rich.padding import Padding
from rich.table import Table

from ..addon.methods.contract import Method
from ..addon.methods.registry import METHODS
from ..addon.parameters import Parameter


def print_methods() -> None:
    """Print every method: name, source, parameters and limits."""
    console = Console(highlight=False)
    for method in METHODS.values():
        console.print(method.name, style="bold")
        console.print(Padding(summary(method), (0, 0, 0, 2)), markup=False)
        console.print(Padding(f"Source: {method.source}", (0, 0, 0, 2)), markup=False)
        console.print(Padding(f"Limits: {limitations(method)}", (0, 0, 0, 2)), markup=False)
        if method.parameters:
            console.print(Padding(_table(method), (0, 0, 0, 2)))
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


def _table(method: type[Method]) -> Table:
    table = Table("parameter", "default", "unit", "range", "section", "meaning", box=None, pad_edge=False)
    for parameter in method.parameters:
        default = "on" if parameter.default is True else "off" if parameter.default is False else str(parameter.default)
        table.add_row(
            f"{method.name}.{parameter.name}",
            default,
            parameter.unit,
            allowed(parameter),
            parameter.section,
            parameter.help,
        )
    return table
