"""Our reflection reprojection: the hit is taken over, not its colour."""

from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ..drawing import ScreenPass, Visibility, first_triangles
from ..gl import DataTexture, finish, sample_counter
from ..parameters import Parameter
from ..progress import Progress
from ..scene import Mesh, Scene
from ..tracing import across_edges
from .deferred import Clock
from .reuse.buffers import UNITS, ReflectionBuffers, Sample
from .reuse.gathering import LISTED_UNIT, Missing
from .reuse.reprojecting import MEMORY, SCHEDULE, THRESHOLD, History, ReprojectingMethod
from .traced import reflections_left
from .tracers import TRACER

_KNOWN_UNIT = LISTED_UNIT + 1
_NEIGHBOURS_UNIT = _KNOWN_UNIT + UNITS
_MOST_MOVED = 8
_NEIGHBOURS: "WeakKeyDictionary[Mesh, np.ndarray]" = WeakKeyDictionary()


class Reprojection(ReprojectingMethod):
    """Each mirrored ray finds what it meets among what the rays of earlier pictures met, and meets it itself.

    A key frame is traced, and keeps which triangle each ray met. In the pictures after, a ray begins in the key frame
    where its mirror stood. Newton's method goes on to the pixel whose ray met the same: the normals beside it say how
    the mirror is curved, and with it how fast its image moves. From the triangles around there the ray walks over the
    surface to the one that it meets itself, so that colours are looked up as sharp as if it were traced, and what has
    moved is met where it is now. On its way it must have been seen that nothing is there: where the key frame saw
    something else before, there may be something behind that it never met (the pillar of figure 9).

    What the key frame has not seen is searched in the last picture; what is then missing, or not sure, is gathered
    and traced. Of what is mirrored twice the second hit is found in the same way.

    Source: Xie, Wang and Dutré, *Reflection reprojection using temporal coherence*, 2017: key frames, reflection
    buffers (3.1), the search beside a pixel (3.2.1, after Algorithm 2), composition (3.3), reuse (4.3). There colours
    are shifted; that hits are taken over and met anew, Newton's method, the way that was seen to be empty, walks,
    second hits, moved objects and the last picture are ours. Differences between neighbouring rays are Igehy's,
    *Tracing ray differentials*, 1999.

    Outputs: as every method; `Frame.reuse` says what was traced.

    Limitations: the first picture, and one after a cut, costs as much as tracing it; thin things that the key frame's
    rays missed can stay unseen until the next one; more than eight moved objects begin a new key frame, and so does
    one that deforms; mirror-like materials only (roughness counts as 0); a picture within a mirror of another method
    is traced.
    """

    name = "reprojection"
    source = "after Xie et al., 3: what the key frame's rays met, met anew by each pixel's own ray"
    parameters = (
        TRACER,
        THRESHOLD,
        SCHEDULE,
        MEMORY,
        Parameter("steps", "Steps", 6, "Newton steps to what a ray meets, at most", minimum=1, maximum=64),
        Parameter("recent", "Last picture", True, "Search the last picture, too, for what the key frame does not show"),
        Parameter(
            "checks",
            "Checks",
            64,
            "Places on the way to a hit that the key frame must have seen to be empty, at most; 0 trusts it",
            minimum=0,
            maximum=1024,
        ),
    )

    def bake(self, progress: Progress) -> None:
        """Say which triangles lie side by side."""
        super().bake(progress)
        self._neighbours = DataTexture(_neighbours_of(self.scene))

    def free(self) -> None:
        """Give the neighbours back."""
        self._neighbours.release()

    def follows(self, known: ReflectionBuffers) -> bool:
        """Unless more has changed than the places of a few objects."""
        moved = moved_since(known.scene, self.scene)
        return moved is not None and len(moved) <= _MOST_MOVED

    def reuse(self, clock: Clock, picture: ReflectionBuffers, history: History, seen: Visibility) -> int:
        """Search what each ray meets: in the key frame, then in the last picture."""
        sample = picture.sample
        key, recent = history.key_of(sample), history.recent_of(sample)
        with clock("pixel searching"):
            whole, _ = self._search(key, sample)
            with (counted := sample_counter()):
                whole.draw(sample.view.camera, seen, picture.target, offset=sample.offset, blend=False)
        with clock("searching once more"):
            if history.gathering.gather(picture, Missing.AGAIN):
                history.gathering.fill(picture, self._search(key, sample)[1], self.resident, seen)
        if self.settings["recent"] and recent is not None and self.follows(recent):
            with clock("searching the last picture"):
                history.gathering.gather(picture, Missing.UNSEEN)
                history.gathering.fill(picture, self._search(recent, sample)[1], self.resident, seen)
        finish()
        return counted.samples

    def _search(self, known: ReflectionBuffers, sample: Sample) -> tuple[ScreenPass, moderngl.Program]:
        """The passes that search an earlier picture."""
        moved = moved_since(known.scene, self.scene)
        whole, listed = self.passes("reprojection/reused.frag", MOVED=len(moved))
        self._neighbours.use(_NEIGHBOURS_UNIT)
        for shader in (whole.shader, listed):
            known.bind(shader, _KNOWN_UNIT)
            shader["neighbours"] = _NEIGHBOURS_UNIT
            shader["steps"], shader["checks"] = self.settings["steps"], self.settings["checks"]
            shader["reflections"] = reflections_left(self.scene, sample.view)
            if moved:
                shader["moved"].write(np.array(moved, np.int32).tobytes())
        return whole, listed


def _neighbours_of(scene: Scene) -> np.ndarray:
    """(T, 3) int32 for all triangles of the scene; found once, as long as a mesh lives."""
    for mesh in scene.meshes:
        if mesh not in _NEIGHBOURS:
            _NEIGHBOURS[mesh] = across_edges(mesh.positions, mesh.triangles)
    table = np.concatenate([np.zeros((0, 3), np.int32), *(_NEIGHBOURS[mesh] for mesh in scene.meshes)])
    begins = first_triangles(scene)
    shift = np.repeat(begins[:-1], np.diff(begins))[:, None]
    return np.where(table < 0, table, table + shift).astype(np.int32)


def moved_since(before: Scene, now: Scene) -> list[int] | None:
    """The instances that stand elsewhere; None where a scene differs in more than their places, light apart."""
    parts = ((*one.meshes, None, *one.materials) for one in (before, now))
    if [*map(id, next(parts))] != [*map(id, next(parts))] or len(before.instances) != len(now.instances):
        return None
    pairs = list(zip(before.instances, now.instances, strict=True))
    if any(_looks(a) != _looks(b) for a, b in pairs):
        return None
    return [index for index, (a, b) in enumerate(pairs) if not np.array_equal(a.matrix, b.matrix)]


def _looks(instance) -> tuple:
    return instance.mesh, instance.materials, instance.reflector, instance.in_reflections, instance.in_camera
