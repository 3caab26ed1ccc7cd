"""What Blender shows of the add-on. There is no panel and no viewport engine yet: the command line is the one door."""


def register() -> None:
    """Add the interface's classes to Blender; there are none yet."""


def unregister() -> None:
    """Take away what `register` added."""
