"""Curved mirrors by drawing the scene where its vertices are reflected."""

from functools import cached_property
from weakref import WeakKeyDictionary

import moderngl

from ..baking.environment import EnvironmentCubes
from ..baking.reflector_maps import FINER, SIZE, SPREAD, maps_of
from ..baking.reflector_maps_tables import ResidentMaps
from ..cache import Cache
from ..drawing import Visibility
from ..parameters import Parameter
from ..progress import Progress
from .contract import View
from .deferred import DeferredMethod
from .environment_map import CUBE_SIZE
from .traced import reflections_left
from .virtual.bounce import MET_UNIT, Bounce
from .virtual.cuts import Cuts
from .virtual.scene import VirtualScene

STEPS = Parameter(
    "steps",
    "Search steps",
    6,
    "Newton steps that the search of a vertex' reflection point takes at most",
    minimum=1,
    maximum=32,
    section="Estalella et al., 4.3",
)
ORDERS = Parameter(
    "orders",
    "Reflections",
    2,
    "How often light may be mirrored by virtual objects; what is mirrored more often is left to the rest",
    minimum=1,
    maximum=2,
    section="Estalella et al., 8",
)
REST = Parameter(
    "rest",
    "The rest",
    "layered-depth",
    "What draws reflections that are not worth a search, and those of reflections of reflections",
    choices=("environment-map", "layered-depth"),
)
WORTH = Parameter(
    "worth",
    "Worth",
    25,
    "Most vertices for each pixel that a part of a reflector is seen in; where more may show, it is left to the rest",
    unit="vertices",
    minimum=1,
    maximum=1_000_000,
    section="Estalella et al., 8",
)
SHARE = Parameter(
    "share",
    "Piece size",
    0.25,
    "Triangles are cut until no edge is longer than this share of its distance from a reflector",
    minimum=0.05,
    maximum=10.0,
    section="Estalella et al., 8",
)
LEAST = Parameter(
    "least",
    "Least piece",
    0.1,
    "What share of a reflector's radius of curvature is short enough for an edge, however near it is",
    minimum=0.01,
    maximum=10.0,
)


class VirtualObjects(DeferredMethod):
    """Curved mirrors of any shape: the scene is drawn once more for each, every vertex where it is reflected.

    A reflector falls into star-shaped parts by itself: a convex body is one, everything else is cut into patches. Maps
    of each hold positions and normals. A vertex' reflection point is where the path from the eye to it is stationary;
    Newton's method finds it in the maps, from where an ellipsoid would reflect it, or where a pixel's ray that comes
    near the vertex leaves; or from where it was found in the last frame, while the part is seen from nearly there. A
    triangle is then drawn as a rectangle that holds its corners' reflection points, and in each pixel the pixel's own
    mirrored ray decides which of the triangles there it meets first: so curved edges, textures and what hides what are
    exact. What a reflector mirrors of another, or of itself, is found the same way, by paths of two points. A part of a
    reflector that is small on the screen for how much it shows is not worth a search: that, and reflections of
    reflections, are drawn by `rest`.

    Source: Estalella, Martin, Drettakis, Tost, Devillers and Cazals, *Accurate interactive specular reflections on
    curved objects*, 2005, for the maps and the search of vertices. Newton's method, patches, several reflections and
    the exact pixels are ours.

    Outputs: as every method.

    Limitations: costs a search for every vertex and part that may show it; near caustics of hollow mirrors thin strips
    may be missed; roughness counts as 0.
    """

    name = "virtual-objects"
    source = "after Estalella et al., 4 and 6: vertices reflected by a search in maps of the reflector"
    parameters = (ORDERS, WORTH, REST, STEPS, SHARE, LEAST, SIZE, FINER, SPREAD, CUBE_SIZE)
    shader = "virtual/virtual_objects.frag"

    @property
    def defines(self) -> dict[str, int]:
        """Which shader draws the rest."""
        return {"REST": REST.choices.index(self.settings["rest"])}

    @cached_property
    def _cuts(self) -> Cuts:
        return Cuts()

    def bake(self, progress: Progress) -> None:
        """Bake the maps of every reflector, and cut what they show."""
        # Of every reflector of the scene: another method's may show in ours.
        maps = maps_of(self.scene, self.scene.reflectors, self.settings, Cache(), progress)
        cube = self.settings["size"]
        self._cubes = EnvironmentCubes(self.resident, cube, progress=progress) if not self.defines["REST"] else None
        self._maps = ResidentMaps(self.scene, maps)
        share, least = self.settings["share"], self.settings["least"]
        self._virtual = VirtualScene(self.scene, self._maps, share, least, self._cuts)
        self._bounces: WeakKeyDictionary[Visibility, list[Bounce]] = WeakKeyDictionary()
        self._views: WeakKeyDictionary[Visibility, View] = WeakKeyDictionary()

    def reflect(self, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Find what the mirrored rays meet, order by order, and show it."""
        before = None
        known = self._views.get(seen)
        anew = known is None or not known.shows_the_same(view)
        self._views[seen] = view
        self.searched += anew
        for bounce in self._bounces_for(seen, view):
            bounce.draw(view, seen, sample["offset"], anew, before)
            before = bounce
        for bounce in self._bounces_for(seen, view):
            bounce.show()
        super().reflect(view, seen, target, **sample)

    def forget(self) -> None:
        """Search every view anew."""
        self._views.clear()

    def _bounces_for(self, seen: Visibility, view: View) -> list[Bounce]:
        if seen not in self._bounces:
            self._bounces[seen] = [
                Bounce(self.resident, self._maps, self._virtual, order, self.settings, seen)
                for order in range(1, self.settings["orders"] + 1)
            ]
        return self._bounces[seen][: reflections_left(self.scene, view)]

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """Bind what the rays have met, and the environment maps."""
        if self._cubes:
            self._cubes.bind(shader)
            self._maps.bind(shader, MET_UNIT + 2)
        shader["allowed"] = reflections_left(self.scene, view)
        shader["orders"] = min(self.settings["orders"], reflections_left(self.scene, view))
        shader["virtual_objects"], shader["virtual_objects_again"] = MET_UNIT, MET_UNIT + 1

    def free(self) -> None:
        """Give everything back."""
        for bounces in self._bounces.values():
            for bounce in bounces:
                bounce.release()
        for part in (self._maps, self._virtual, self._cubes):
            if part:
                part.release()
