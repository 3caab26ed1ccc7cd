"""What finds the triangle that a ray meets first, for any method that sends rays."""

from ..drawing import Resident, grow_trees, raise_columns
from ..parameters import Parameter
from ..progress import Progress, silent

RAY_TRACED, LAYERED_DEPTH = "ray-traced", "layered-depth"

TRACER = Parameter(
    "tracer",
    "Tracer",
    RAY_TRACED,
    "What finds what a ray meets: a hierarchy of boxes around the triangles, or columns of them",
    choices=(LAYERED_DEPTH, RAY_TRACED),
)
"""For methods that can take either; both find the same triangle."""


def tracer_defines(name: str) -> dict[str, int]:
    """What a shader is compiled with to trace by `name`, one of TRACER's choices.

    gpu_shaders/common/tracer.glsl reads it, and with it `nearest_hit` and `traced_light`; the tables are the
    scene's own, which `Resident.bind` binds.
    """
    return {"TRACER": TRACER.choices.index(name)}


def prepare_tracer(name: str, resident: Resident, progress: Progress = silent) -> None:
    """Build for the resident scene what tracing by `name` needs and no other method has built, with progress.

    It is kept with the meshes: after objects have moved there is nothing to build.
    """
    build = grow_trees if name == RAY_TRACED else raise_columns
    build(resident.scene.meshes, progress)
