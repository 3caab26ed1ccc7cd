"""Reflections by rays that are traced, sharp and rough."""

from typing import ClassVar

import moderngl

from ..parameters import Parameter
from ..progress import Progress
from ..scene import Scene
from .contract import View
from .rough import SHARED, Rough
from .tracers import prepare_tracer, tracer_defines

RAYS = Parameter(
    "rays",
    "Rays",
    1,
    "Directions of a rough mirror's lobe that each sample of a pixel looks along",
    minimum=1,
    maximum=256,
)


class Traced(Rough):
    """A method that follows rays from mirror to mirror; `tracer` names what finds what they meet."""

    tracer: ClassVar[str]
    parameters = (RAYS, SHARED)
    shader = "traced/traced.frag"

    @property
    def defines(self) -> dict[str, int]:
        """Which tracer."""
        return {**super().defines, **tracer_defines(self.tracer)}

    def bake(self, progress: Progress) -> None:
        """Build what rays are searched for in."""
        prepare_tracer(self.tracer, self.resident, progress)

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """How often a path reflects."""
        shader["reflections"] = reflections_left(self.scene, view)


def reflections_left(scene: Scene, view: View) -> int:
    """How often a path may reflect that a view begins: in all once more than Cycles' glossy bounces."""
    return scene.glossy_bounces + 1 - view.mirrored
