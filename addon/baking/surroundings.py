"""What stands around a reflector, and is no nearby object to search."""

import numpy as np

from ..drawing import world_boxes
from ..scene import Scene


def surroundings(scene: Scene) -> frozenset[int]:
    """Instances whose box holds a whole reflector: rooms and skies."""
    boxes = world_boxes(scene, range(len(scene.instances)))
    around = set()
    for reflector in scene.reflectors:
        low, high = boxes[reflector]
        holds = (boxes[:, 0] <= low).all(axis=1) & (boxes[:, 1] >= high).all(axis=1)
        around |= set(np.flatnonzero(holds).tolist()) - {reflector}
    return frozenset(around)
