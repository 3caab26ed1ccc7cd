"""A camera and the matrices that a viewport draws it with."""

import numpy as np
from catoptric.addon.scene import Camera, SensorFit
from hypothesis import given
from hypothesis import strategies as st

from .stage import looking

NEAR = st.floats(0.01, 1.0)
SHIFT = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
SIZE = st.tuples(st.integers(1, 4000), st.integers(1, 4000))


@given(
    st.floats(8.0, 200.0),
    st.sampled_from(SensorFit),
    SHIFT,
    st.none() | st.floats(0.1, 50.0),
    NEAR,
    SIZE,
    st.floats(0.5, 2.0),
)
def test_a_camera_comes_back_from_its_matrices(lens, fit, shift, ortho, near, size, aspect):
    matrix = looking((3.0, -4.0, 2.0)).matrix
    given_one = Camera(matrix, lens, (36.0, 24.0), fit, shift, ortho, near, 50.0, aspect)
    found = Camera.of_matrices(np.linalg.inv(matrix), given_one.projection(*size), *size)
    np.testing.assert_allclose(found.matrix, matrix, atol=1e-9)
    np.testing.assert_allclose(found.window(*size), given_one.window(*size), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose((found.near, found.far), (near, 50.0), rtol=1e-6)
    assert (found.ortho_scale is None) == (ortho is None)
