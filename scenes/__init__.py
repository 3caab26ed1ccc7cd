"""The demonstration scenes: the .blend files and the scripts that build them (see README.md here)."""

from pathlib import Path

from ..addon.errors import UsageError

SCENES: tuple[str, ...] = (
    "mirror-ball",
    "two-balls",
    "hollow-box",
    "knotty-cup",
    "genus3",
    "three-genus3",
    "statue",
    "mirror-bowl",
    "mirror-torus",
    "mirror-room",
    "cathedral",
    "mirror-hall",
    "wet-street",
    "bathroom",
    "kitchen",
    "living-room",
)


def path_of(name: str) -> Path:
    """The .blend file of a demonstration scene. Raises UsageError for a name not in `SCENES`."""
    if name not in SCENES:
        raise UsageError(f"no demonstration scene is called '{name}': choose from {', '.join(SCENES)}")
    return Path(__file__).resolve().parent / f"{name}.blend"
