"""Where a camera sees reflectors."""

import numpy as np

from ..gl import on_gl_thread
from ..scene import Lighting, Scene
from .canvas import Canvas
from .resident import Resident
from .visibility import world_to_clip


@on_gl_thread
def reflectors_seen(scene: Scene, width: int, height: int) -> np.ndarray:
    """(height, width) bool, row 0 the top: the pixels in whose middle the scene's camera sees a reflector."""
    resident, canvas = Resident(scene, Lighting.UNLIT), None
    try:
        canvas = Canvas(width, height)
        canvas.visibility.draw(resident, world_to_clip(scene.camera, width, height))
        return np.isin(canvas.read_instances(), scene.reflectors)
    finally:
        if canvas is not None:
            canvas.release()
        resident.release()
