"""Layered depth textures as published."""

import moderngl

from ..baking.environment import EnvironmentCubes
from ..baking.layered_depth import LAYERS, RESOLUTION, bake_layers
from ..baking.layered_depth_tables import MEMORY, UNITS, ResidentLayers, fitting_resolution
from ..baking.regions import Regions
from ..baking.surroundings import surroundings
from ..cache import Cache
from ..drawing import FREE_UNIT
from ..parameters import Parameter
from ..progress import Progress
from .contract import View
from .deferred import DeferredMethod
from .environment_map import CUBE_SIZE

_FIRST_UNIT = FREE_UNIT + 3
"""The environment cubes take the two units before."""

SEARCH = (
    Parameter(
        "linear_steps",
        "Linear steps",
        32,
        "Equal steps through an object's box; a part thinner than one may be stepped over",
        minimum=1,
        maximum=1024,
        section="Zhang et al., 3.3",
    ),
    Parameter(
        "binary_steps",
        "Binary steps",
        8,
        "Halvings of the step that went inside",
        minimum=0,
        maximum=24,
        section="Zhang et al., 3.3",
    ),
    Parameter(
        "threshold",
        "Threshold",
        1.0,
        "Distance between ray and surface along a face's depth that ends the search of further faces",
        unit="texels",
        minimum=0.0,
        maximum=1e6,
        section="Zhang et al., 3.3",
    ),
    Parameter(
        "regions",
        "Reflection regions",
        True,
        "Search only the objects whose virtual image may show in the reflector's triangle",
        section="Zhang et al., 3.2",
    ),
    Parameter(
        "nearest",
        "Nearest object",
        False,
        "Of several objects that a ray hits show the nearest; as published, the last one is blended over the others",
        section="Zhang et al., 5",
    ),
)


class LayeredDepthPublished(DeferredMethod):
    """Layered depth textures as published: samples of depth, searched by steps.

    A reflected ray is taken into each object's own space and marched from where it enters the object's
    box to where it leaves it: equal steps until a layer holds the point (Algorithm 1), then halves. Up
    to three faces are searched, the one that the ray enters by first, and the layer that fits the ray
    best gives the colour, blended over the global environment map. That map holds what is no nearby
    closed object: an object around a reflector, such as a room, and one without any thickness.

    Source: Zhang, Hsieh and Shen, 3.2 to 3.4, with the inequalities of Algorithm 1. The paper leaves
    open how several objects share a ray; it renders one after another and blends, so that the last one
    in the scene's order covers the others, however near. `nearest` mends that.

    Limitations: nothing is hidden by the reflector itself or by other objects; one reflection, none of
    the reflector in itself; closed meshes only, since an open one has no inside to step into; parts
    thinner than a step are missed, and surfaces that all chosen faces see edge-on are misplaced; colours
    are as sharp as texels; curved mirrors of few triangles lose rims to the region test.
    """

    name = "layered-depth-published"
    source = "Zhang, Hsieh and Shen, 3.2 to 3.4: depth peeled from six faces, linear then binary search"
    parameters = (RESOLUTION, LAYERS, MEMORY, *SEARCH, CUBE_SIZE)
    shader = "layered_depth_published/layered_depth_published.frag"

    def bake(self, progress: Progress) -> None:
        """Peel every reflected object, and capture the global environment map."""
        reflectors = self.scene.reflectors
        unsearched = surroundings(self.scene) | frozenset(reflectors if len(reflectors) == 1 else ())
        resolution = fitting_resolution(self.scene, self.settings["resolution"], self.settings["memory"], unsearched)
        settings = {"resolution": resolution, "layers": self.settings["layers"]}
        bakes = bake_layers(self.resident, settings, Cache(), progress, unsearched)
        self.bakes = [bake if bake is not None and bake.has_inside else None for bake in bakes]
        searched = frozenset(index for index, bake in enumerate(self.bakes) if bake is not None)
        self._cubes = EnvironmentCubes(self.resident, self.settings["size"], searched, self.reflectors, progress)
        self._layers = ResidentLayers(self.bakes)
        self._regions = Regions(self.resident, self.reflectors)

    def before_frame(self, view: View) -> None:
        """Find the reflection regions of this view."""
        if self.settings["regions"]:
            self._regions.update(view.camera)

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """Bind the layers, the regions and the environment map; set the search."""
        self._cubes.bind(shader)
        self._layers.bind(shader, _FIRST_UNIT)
        self._regions.bind(shader, _FIRST_UNIT + UNITS)
        for name in ("linear_steps", "binary_steps", "threshold", "nearest"):
            shader[name] = self.settings[name]
        shader["most_layers"] = self.settings[LAYERS.name]
        shader["use_regions"] = self.settings["regions"] and not view.mirrored  # they are of the frame's own camera
        shader["objects"] = len(self.scene.instances)

    def free(self) -> None:
        """Give the layers, the regions and the environment map back."""
        for part in (self._layers, self._cubes, self._regions):
            part.release()
