"""Errors that a person can cause and mend."""


class CatoptricError(Exception):
    """Something is wrong in the input or the machine.

    The message is one line: what is wrong, where, and what to do about it. Every door (panel,
    viewport, command line) shows that line and no traceback.
    """


class SceneError(CatoptricError):
    """The scene cannot be rendered as it is: no camera, no reflector, a file that cannot be read."""


class MachineError(CatoptricError):
    """The machine lacks something: OpenGL 4.1, memory, disk space."""


class UsageError(CatoptricError):
    """A name or value that does not exist: a method, a parameter, a range."""


class Cancelled(Exception):
    """The person pressed Esc or Ctrl-C. Raised by a progress callback, caught by the doors."""
