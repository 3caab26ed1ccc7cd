"""What the add-on starts beside the Blender that a person works in.

Usage: blender --background --python beside.py -- PATHS REQUEST, or python beside.py -- PATHS REQUEST
PATHS are the folders that the other Blender finds modules in, REQUEST is what `requests` takes. It ends when its
standard input does, that is, with the other Blender, however that ends.
"""

import importlib
import importlib.util
import os
import sys
import threading
import traceback
from pathlib import Path

_FAILED, _STOPPED = 1, 130
_POLITENESS = 15


def _load_package() -> None:
    """Make the package that this file belongs to known as `catoptric`, wherever it lies."""
    root = Path(__file__).resolve().parents[1]
    spec = importlib.util.spec_from_file_location(
        "catoptric", root / "__init__.py", submodule_search_locations=[str(root)]
    )
    sys.modules["catoptric"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules["catoptric"])


def _watch_over() -> None:
    """End this process when nobody holds the other end of its standard input any more."""
    while os.read(sys.stdin.fileno(), 1):
        pass
    os._exit(_STOPPED)


def _give_way() -> None:
    """The Blender that somebody works in comes first, its most patient threads too: see `addon.gl.give_way`."""
    if hasattr(os, "SCHED_IDLE"):
        os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    elif hasattr(os, "nice"):
        os.nice(_POLITENESS)


if __name__ == "__main__":
    paths, request = sys.argv[sys.argv.index("--") + 1 :]
    sys.path += [path for path in paths.split(os.pathsep) if path not in sys.path]
    os.environ["CATOPTRIC_PROGRESS"] = "lines"
    threading.Thread(target=_watch_over, daemon=True).start()
    _give_way()
    try:
        _load_package()
        status = importlib.import_module("catoptric.batch.requests").main(request)
    except Exception as defect:  # in a script, Blender would go on, and end as if all were well
        traceback.print_exc()
        print(f"catoptric: {type(defect).__name__}: {defect}", file=sys.stderr, flush=True)
        status = _FAILED
    os._exit(status)  # what Blender would do on its way out is for windows
