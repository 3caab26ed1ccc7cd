"""One declaration of a parameter serves the panel, the command line, the shader, the report and the manual."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .errors import UsageError

Value = int | float | bool | str


@dataclass(frozen=True)
class Parameter:
    """A setting of a method or a bake.

    `default` gives the type (bool, int, float or str); `minimum` and `maximum` bound numbers,
    both included; `choices` lists the values of a str. `section` names the paper's section.
    """

    name: str
    label: str
    default: Value
    help: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    section: str = ""

    def parse(self, value: Value) -> Value:
        """`value` (a string from the command line, or a number) as this parameter's type, checked."""
        try:
            parsed = _parse_bool(value) if isinstance(self.default, bool) else type(self.default)(value)
        except (TypeError, ValueError, OverflowError):
            raise UsageError(f"{self.name}: {value!r} is not a {type(self.default).__name__}") from None
        if parsed != parsed:
            raise UsageError(f"{self.name}: {value!r} is not a number")
        if self.choices and parsed not in self.choices:
            raise UsageError(f"{self.name}: {value!r} is none of {', '.join(self.choices)}")
        if self.minimum is not None and parsed < self.minimum:
            raise UsageError(f"{self.name}: {value} is below {self.minimum:g}, the least it can be")
        if self.maximum is not None and parsed > self.maximum:
            raise UsageError(f"{self.name}: {value} is above {self.maximum:g}, the most it can be")
        return parsed


def _parse_bool(value: Value) -> bool:
    words = {"true": True, "on": True, "yes": True, "1": True, "false": False, "off": False, "no": False, "0": False}
    if isinstance(value, str):
        if value.lower() not in words:
            raise ValueError(value)
        return words[value.lower()]
    return bool(value)


def resolve(declared: Sequence[Parameter], given: Mapping[str, Value]) -> dict[str, Value]:
    """Every declared parameter's value: the given one, checked, else its default.

    Raises `UsageError` for a name that is not declared.
    """
    known = {parameter.name: parameter for parameter in declared}
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise UsageError(f"no parameter {unknown[0]!r} here; there are: {', '.join(known) or 'none'}")
    return {name: parameter.parse(given.get(name, parameter.default)) for name, parameter in known.items()}
