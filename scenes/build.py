"""Builds the demonstration scenes: `python -m catoptric.scenes.build [names]`, all of them without names.

Run it with Blender 4.5's Python: what 4.5 saves, 4.5 and 5.2 both open.
"""

import sys
from importlib import import_module

from ..addon.errors import CatoptricError
from . import SCENES, path_of


def build(name: str) -> None:
    """Build one scene, `build_<name>.py` beside this file, and save it over its .blend."""
    path = path_of(name)
    from . import stage

    stage.clear()
    import_module(f".build_{name.replace('-', '_')}", __package__).build()
    stage.save(path)
    print(f"{path.name}: {path.stat().st_size / 1024:.0f} KiB")


def main(names: list[str]) -> int:
    """Build the scenes called `names`, or all. Returns the exit status."""
    try:
        for name in names or SCENES:
            build(name)
    except CatoptricError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
