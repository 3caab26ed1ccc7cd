"""Curved mirrors by virtual objects, as they were published."""

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
from .virtual.meshes import VirtualMeshes
from .virtual.pictures import MET_UNIT, VirtualPicture

STEPS = Parameter(
    "steps",
    "Search steps",
    7,
    "Midpoint steps that the search of a reflection point takes at most; the paper shows 3, 5, 7 and 9",
    minimum=1,
    maximum=64,
    section="Estalella et al., 4.3",
)
THRESHOLD = Parameter(
    "threshold",
    "Threshold",
    1e-8,
    "The error at which a search ends: a quarter of the squared angle between bisector and normal, in radians",
    minimum=0.0,
    maximum=0.1,
    section="Estalella et al., 4.2",
)
GRID = Parameter(
    "grid",
    "Grid vertices",
    10.0,
    "Vertices of the grid that are searched, of those of the mesh, which lie between them; 0 searches every vertex",
    unit="%",
    minimum=0.0,
    maximum=100.0,
    section="Estalella et al., 5",
)
REFINE = Parameter(
    "refine",
    "Refine until",
    0.0,
    "Cells are cut, view by view, until what lies in their middles is shown no farther than this from where it "
    "belongs; 0 keeps to grids of equal cells, as published",
    unit="pixels",
    minimum=0.0,
    maximum=100.0,
    section="Estalella et al., 8",
)
CUT = Parameter(
    "cut",
    "Piece size",
    0.0,
    "Triangles are cut until no edge is longer than this share of its distance from a reflector; 0 leaves them whole, "
    "as published",
    minimum=0.0,
    maximum=10.0,
    section="Estalella et al., 8",
)


class VirtualObjectsPublished(DeferredMethod):
    """Curved mirrors as published: the reflected meshes are drawn with each vertex where the mirror shows it.

    Cube maps of a reflector hold its positions and normals. A vertex' reflection point is searched in them: the
    bisector of the ways to eye and vertex, projected onto the map, leads there, in midpoint steps of changing length.
    Mirrored about the tangent plane there, the vertex is one of the virtual mesh, which is rasterised, kept to its
    reflector and blended over an environment map of the rest. With a grid, only its vertices are searched, and the
    mesh's are interpolated in its cells.

    Source: Estalella, Martin, Drettakis, Tost, Devillers and Cazals, *Accurate interactive specular reflections on
    curved objects*, 2005.

    The paper leaves open, and we chose: a search begins where the bisector of the directions from the map's centre to
    eye and vertex meets the map, nearest to the eye if it faces away there, or in the middle of a patch; its first step
    has the length 1, and backwards on concave parts, whose normals turn the other way; a step that changes the vector
    by more than its own length, or passes a body's horizon, is taken again, and the next is as long as would change it
    by half. Reflectors fall into parts by themselves, and parts out of sight, or objects that no ray of a part can
    meet, are not searched. A mesh too small for a grid of its own is searched whole, if a quarter of all searches is
    enough for these. What has a corner without any reflection point is not drawn. *Refine until* is the level-of-detail
    grid that the paper leaves to future work: cells in cells are cut where their middles are not yet where they belong
    on the screen.

    Outputs: as every method.

    Limitations: edges are straight between vertices, so that coarse meshes, a floor of two triangles say, are bent
    wrongly, and tear where the mirror hides a part of them, unless *Piece size* cuts them; nothing of a reflector in
    itself; other reflectors show in the environment map alone, and hide nothing; saddles, and concave parts of what
    is near their focus, have no one reflection point for the search to find; too few steps, or too wide a grid, move
    images; dear for reflectors of many parts.
    """

    name = "virtual-objects-published"
    source = "Estalella et al. 2005: vertices searched in midpoint steps through maps of the reflector"
    parameters = (STEPS, THRESHOLD, GRID, REFINE, CUT, SIZE, FINER, SPREAD, CUBE_SIZE)
    shader = "virtual_published/virtual_objects_published.frag"

    def bake(self, progress: Progress) -> None:
        """Bake the maps of the reflectors, lay grids around what they show, and capture the rest."""
        maps = maps_of(self.scene, self.reflectors, self.settings, Cache(), progress)
        instances = enumerate(self.scene.instances)
        shown = [index for index, one in instances if one.in_reflections and not one.reflector]
        size, hidden = self.settings["size"], frozenset(shown)
        self._cubes = EnvironmentCubes(self.resident, size, hidden, self.reflectors, progress)
        self._maps = ResidentMaps(self.scene, maps)
        grid, cut, refine = self.settings["grid"] / 100.0, self.settings["cut"], self.settings["refine"]
        self._meshes = VirtualMeshes(self.scene, shown, grid, cut, refine > 0.0)
        self._pictures: WeakKeyDictionary[Visibility, VirtualPicture] = WeakKeyDictionary()

    def reflect(self, view: View, seen: Visibility, target: moderngl.Framebuffer, **sample) -> None:
        """Search and draw the virtual meshes, anew for each sample as for each frame, and show them."""
        if seen not in self._pictures:
            within = self.settings["refine"]
            self._pictures[seen] = VirtualPicture(self.resident, self._maps, self._meshes, within, seen)
        picture = self._pictures[seen]
        picture.draw(view, seen, sample["offset"], self.settings["steps"], self.settings["threshold"])
        picture.met.use(MET_UNIT)
        super().reflect(view, seen, target, **sample)

    def bind_reflection(self, shader: moderngl.Program, view: View) -> None:
        """Bind what was drawn, and the environment maps."""
        self._cubes.bind(shader)
        shader["virtual_objects"] = MET_UNIT

    def free(self) -> None:
        """Give everything back."""
        for part in (*self._pictures.values(), self._meshes, self._maps, self._cubes):
            part.release()
