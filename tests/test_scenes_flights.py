"""Cameras that fly through the demonstration scenes."""

import numpy as np
import pytest
import trimesh

from .test_scenes import camera_rays, evaluated, is_mirror, meshes, opened

# The scenes whose camera flies, with the still view that its flight begins at: where it is, and what it looks at.
FLIGHTS = {
    "bathroom": ((0.2, -1.4, 1.53), (-0.08, 1.6, 1.2)),
    "living-room": ((0.34, -2.12, 1.46), (0.12, 2.4, 1.02)),
}
FRAMES = 500


def flight(scene) -> np.ndarray:
    """The camera's matrix (FRAMES, 4, 4) in every frame."""
    matrices = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        matrices.append(np.array(scene.camera.matrix_world))
    return np.array(matrices)


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_begins_at_the_still_view(name: str) -> None:
    scene = opened(name)
    assert (scene.frame_current, scene.frame_start, scene.frame_end) == (1, 1, FRAMES)
    location, target = (np.array(point) for point in FLIGHTS[name])
    matrix = np.array(scene.camera.matrix_world)
    assert (matrix[:3, 3] == location.astype(np.float32)).all()
    assert -matrix[:3, 2] == pytest.approx((target - location) / np.linalg.norm(target - location), abs=1e-6)
    assert abs(matrix[2, 0]) < 1e-6, "the horizon is not level"


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_is_smooth(name: str) -> None:
    matrices = flight(opened(name))
    places, axes = matrices[:, :3, 3], matrices[:, :3, 2]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    turns = np.degrees(np.arccos(np.clip(np.einsum("fi,fi->f", axes[1:], axes[:-1]), -1.0, 1.0)))
    assert len(matrices) == FRAMES
    assert steps.max() < 0.02
    assert steps.sum() > 3.0
    assert turns.max() < 1.2
    assert turns.sum() > 90.0
    assert np.linalg.norm(np.diff(places, 2, axis=0), axis=1).max() < 0.004


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_touches_nothing_and_always_sees_a_reflector(name: str) -> None:
    scene = opened(name)
    things = meshes()
    parts = [evaluated(thing) for thing in things]
    mirrors = np.repeat([is_mirror(thing) for thing in things], [len(part.faces) for part in parts])
    shown = trimesh.util.concatenate(parts)
    around = np.random.default_rng(1).normal(size=(600, 3))
    around /= np.linalg.norm(around, axis=1, keepdims=True)
    for frame in range(1, FRAMES + 1, 10):
        scene.frame_set(frame)
        place = np.array(scene.camera.matrix_world)[:3, 3]
        hits, _, _ = shown.ray.intersects_location(np.broadcast_to(place, around.shape), around, multiple_hits=False)
        assert np.linalg.norm(hits - place, axis=1).min() > 0.15, f"frame {frame}"
        first = shown.ray.intersects_first(*camera_rays(scene, 48, 32))
        assert np.mean((first >= 0) & mirrors[first]) > 0.05, f"frame {frame}"
