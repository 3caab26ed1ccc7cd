"""A real Blender window with the extension in it, for the tests of this folder, which are all slow."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from catoptric.addon.cache import DIRECTORY_VARIABLE
from catoptric.addon.errors import MachineError
from catoptric.batch.package import package

from .machine import Machine, NoWindow, find
from .window import Window


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark every test of this folder as slow."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def gui_machine(tmp_path_factory: pytest.TempPathFactory) -> Machine:
    """Where Blender can have a window; made if need be, which takes minutes once."""
    try:
        return find(tmp_path_factory.mktemp("gui"))
    except NoWindow as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session")
def gui_zip(gui_machine: Machine, root: Path) -> Path:
    """The extension with wheels for that Blender's Python, which a distribution may have chosen itself."""
    python = Window(gui_machine).version()
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv(DIRECTORY_VARIABLE)
        try:
            (path,) = package(gui_machine.share, print, ["linux-x64"], [python], root)
        except MachineError as error:
            if "cannot fetch" in str(error):
                pytest.skip(str(error))
            raise
    return path


@pytest.fixture(scope="module")
def window(gui_machine: Machine, gui_zip: Path) -> Iterator[Window]:
    """A window with the extension installed and enabled, one for each file of tests."""
    window = Window(gui_machine)
    window.install(gui_zip)
    with window:
        yield window
