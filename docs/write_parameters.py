"""Writes parameters.md from the declarations of the methods: python -m catoptric.docs.write_parameters"""

from collections.abc import Sequence
from pathlib import Path

from ..addon.baking.engine_export import PARAMETERS as EXPORT
from ..addon.methods.contract import Method
from ..addon.methods.registry import METHODS
from ..addon.parameters import Parameter
from ..batch.manual import allowed, limitations, summary, with_unit
from ..batch.tasks import BAKE

PAGE = Path(__file__).with_name("parameters.md")

HEAD = """\
<!-- Written by `python -m catoptric.docs.write_parameters` from the methods' own declarations: change those. -->
# Every parameter

In Blender the parameters of the chosen method stand in the tab *Catoptric*, and a pause over one shows what it does.
On the command line:

    uv run catoptric compare mirror-ball --set layered-depth-published.linear_steps=64 --set environment-map.size=1024

`catoptric methods` prints what stands here. [Choosing a method](choosing-a-method.md) says which to take.
"""

BAKES = """\
## Bakes on their own

`catoptric bake` and `catoptric export-engine` take these as options, such as `--resolution 256`.
"""


def page() -> str:
    """The whole of parameters.md."""
    parts = [HEAD, *(_section(method) for method in METHODS.values())]
    parts += [BAKES, "### bake\n", _table(BAKE), "### export-engine\n", _table(EXPORT)]
    return "\n".join(parts)


def _section(method: type[Method]) -> str:
    said = f"## {method.name}\n\n{summary(method)}\n\n*Source:* {method.source}.\n\n*Limits:* {limitations(method)}\n\n"
    return said + (_table(method.parameters) if method.parameters else "It has no parameters.\n")


def _table(parameters: Sequence[Parameter]) -> str:
    lines = ["| parameter | default | values | what it does |", "| --- | --- | --- | --- |"]
    return "\n".join([*lines, *map(_row, parameters)]) + "\n"


def _row(parameter: Parameter) -> str:
    default = with_unit(parameter.default, parameter.unit)
    section = f" ({parameter.section})" if parameter.section else ""
    cells = f"`{parameter.name}`", default, allowed(parameter), f"*{parameter.label}.* {parameter.help}{section}"
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
