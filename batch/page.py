"""The templates of the pages that are written, and the files that go into them."""

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

_TEMPLATES = Path(__file__).parent / "templates"


def templates() -> Environment:
    """Jinja's environment of templates/: what goes in is escaped, what is missing raises."""
    return Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def texts(*names: str) -> str:
    """The files of templates/ with these names, one after another: styles and scripts."""
    return "\n".join((_TEMPLATES / name).read_text(encoding="utf-8") for name in names)
