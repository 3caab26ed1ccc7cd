"""Environment maps: once, every frame, and projected onto a box."""

import moderngl

from ..baking.environment import EnvironmentCubes
from ..parameters import Parameter
from ..progress import Progress
from .contract import View
from .deferred import DeferredMethod

CUBE_SIZE = Parameter(
    "size", "Cube size", 512, "Texels along a face of the captured cube", unit="texels", minimum=16, maximum=4096
)


class EnvironmentMap(DeferredMethod):
    """One cube, captured once from the reflector's centre and looked up by the reflected direction.

    Source: Blinn and Newell 1976; the baseline of Zhang et al., Table 2, column Reflector.

    Limitations: everything seems infinitely far away, so what is near is misplaced, too large or
    missing; the reflector does not show in itself; other reflectors mirror the world alone; what
    moves after the capture stays where it was.
    """

    name = "environment-map"
    source = "Blinn and Newell 1976: a cube captured once at the reflector's centre"
    parameters = (CUBE_SIZE,)
    shader = "environment_map/environment_map.frag"

    def bake(self, progress: Progress) -> None:
        """Capture the cubes."""
        self.cubes = self._cubes(progress=progress)

    def _cubes(self, **how) -> EnvironmentCubes:
        return EnvironmentCubes(self.resident, self.settings["size"], reflectors=self.reflectors, **how)

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """Bind the cubes."""
        self.cubes.bind(shader)

    def free(self) -> None:
        """Give the cubes back."""
        self.cubes.release()


class EnvironmentMapDynamic(EnvironmentMap):
    """The cube of `environment-map`, captured again every frame.

    Source: Greene 1986, captured on the GPU as games do.

    Limitations: those of `environment-map`, but for movement; costs six pictures a reflector and frame.
    """

    name = "environment-map-dynamic"
    source = "Greene 1986: a cube captured every frame at the reflector's centre"

    def bake(self, progress: Progress) -> None:
        """Make room for the cubes."""
        self.cubes = self._cubes(empty=True)

    def before_frame(self, view: View) -> None:
        """Capture the cubes again."""
        self.cubes.capture()


class EnvironmentMapParallax(EnvironmentMap):
    """The cube of `environment-map`, projected onto a box around the rest of the scene.

    Where the cube shows the world at the point that a ray meets on the box, the box is open there: such a ray
    shows the world by its own direction. In a closed room this changes nothing.

    Source: Lagarde and Zanuttini, *Local image-based lighting with parallax-corrected cubemaps*, 2012; they
    leave open scenes to the artist who places the boxes.

    Limitations: right for what lies on the box, as a room's walls and an open scene's floor do, and for the
    world; objects inside the box are misplaced.
    """

    name = "environment-map-parallax"
    source = "Lagarde and Zanuttini 2012: the cube projected onto the scene's box"
    shader = "environment_map/parallax.frag"
