"""What every test shares."""

import os
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--slow`."""
    parser.addoption("--slow", action="store_true", help="run the tests marked slow as well")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect slow tests, unless `--slow` asks for them."""
    if config.getoption("--slow"):
        return
    slow = [item for item in items if "slow" in item.keywords]
    config.hook.pytest_deselected(items=slow)
    items[:] = [item for item in items if "slow" not in item.keywords]


@pytest.fixture(scope="session", autouse=True)
def isolated_cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache folder of this run's own, for this process and those it starts."""
    folder = tmp_path_factory.mktemp("cache")
    os.environ["CATOPTRIC_CACHE"] = str(folder)
    return folder


@pytest.fixture(scope="session")
def root() -> Path:
    """The repository's root."""
    return ROOT


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with meshes and scenes that do not ship; its tests are skipped where it is absent."""
    folder = ROOT.parent / "shared"
    if not folder.is_dir():
        pytest.skip("no ../shared here")
    return folder


@pytest.fixture(scope="session")
def blender_ext() -> Callable[..., subprocess.CompletedProcess]:
    """Run Blender's command-line tool for extensions, from the bpy wheel."""
    (tool,) = Path(find_spec("bpy").origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")

    def run(*arguments: str | Path) -> subprocess.CompletedProcess:
        # `--valid-tags=` says that there is no list of tags to ask the network for.
        command = [sys.executable, tool, *arguments, "--valid-tags="]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)

    return run
