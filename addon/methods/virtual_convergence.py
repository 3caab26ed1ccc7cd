"""Where the searches of reflection points end."""

import moderngl
import numpy as np

from ..baking.reflector_maps_tables import ResidentMaps
from ..drawing import FREE_UNIT
from ..gl import feedback, require
from ..tracing import Curvature


def reflection_points(
    maps: ResidentMaps, number: int, eye: np.ndarray, points: np.ndarray, steps: int, published: bool, **uniforms: float
) -> np.ndarray:
    """(N, 4) float32: where the search for each of the world's `points` (N, 3) is after so many steps; GL thread.

    xyz the point of the reflector, w how the bisector leans there, below 0 for a hidden vertex. `eye` (4,), w 0 for
    one that is infinitely far away; `number` that of the part, from 1; `uniforms` of the search.
    """
    stages = {"vertex_shader": "virtual_published/points.vert"}
    shader = feedback(stages, ("reached",), {"ORDER": 1, "PUBLISHED": int(published)})
    maps.bind(shader, FREE_UNIT + 1)
    maps.choose(shader, (number,))
    concave = maps.maps[number - 1].part.curvature is Curvature.CONCAVE
    given = {"eye": tuple(eye), "steps": steps, "threshold": 0.0, "first_step": -1.0 if concave else 1.0, **uniforms}
    for name, value in given.items():
        if name in shader:
            shader[name] = value
    context = require()
    vertices, reached = context.buffer(np.asarray(points, np.float32)), context.buffer(reserve=16 * len(points))
    array = context.vertex_array(shader, [(vertices, "3f", "position")])
    nothing = context.simple_framebuffer((1, 1))  # OpenGL draws, even to nowhere, only where there is one
    try:
        nothing.use()
        array.transform(reached, moderngl.POINTS, vertices=len(points))
        return np.frombuffer(reached.read(), np.float32).reshape(-1, 4)
    finally:
        for part in (array, vertices, reached, nothing):
            part.release()
