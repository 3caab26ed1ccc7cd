"""The buttons."""


def register() -> None:
    """None yet."""


def unregister() -> None:
    """None yet."""
