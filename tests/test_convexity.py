"""Which meshes count as convex, against the convex hull."""

import numpy as np
import trimesh
from catoptric.addon.tracing import is_convex
from hypothesis import given
from hypothesis import strategies as st


def test_convex_bodies():
    for body in (trimesh.creation.box(), trimesh.creation.icosphere(3), trimesh.creation.uv_sphere(count=[32, 32])):
        assert is_convex(body.vertices, body.faces)


def test_bodies_that_are_not():
    ring, two = trimesh.creation.torus(1.0, 0.3), trimesh.creation.box()
    two = two + trimesh.creation.box(transform=trimesh.transformations.translation_matrix((3, 0, 0)))
    inside_out = trimesh.creation.box()
    inside_out.invert()
    opened = trimesh.creation.icosphere(2)
    opened.update_faces(np.arange(len(opened.faces)) != 7)
    for body in (ring, two, inside_out, opened):
        assert not is_convex(body.vertices, body.faces)


@given(st.integers(0, 10_000), st.floats(0.05, 0.6))
def test_hull_is_convex_and_a_dent_is_not(seed, depth):
    points = np.random.default_rng(seed).normal(size=(30, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    hull = trimesh.convex.convex_hull(points)
    assert is_convex(hull.vertices, hull.faces)
    dented = hull.vertices.copy()
    dented[0] *= -depth
    assert not is_convex(dented, hull.faces)
