"""The blend's laws, by finite differences and by scipy's rotations."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from backend.pipeline.execute.blend import rotations, rotvec, to_zero

values = arrays(np.float64, 3, elements=st.floats(-2.0, 2.0))


@given(values, values, st.floats(0.1, 5.0))
def test_a_blend_starts_with_what_it_is_given_and_ends_at_rest(start: np.ndarray, velocity: np.ndarray, T: float):
    h = 1e-6 * T
    early = to_zero(start, velocity, T, np.array([0.0, h]))
    late = to_zero(start, velocity, T, np.array([T - h, T, T + 1.0]))
    np.testing.assert_allclose(early[0], start)
    np.testing.assert_allclose((early[1] - early[0]) / h, velocity, atol=1e-3)
    np.testing.assert_allclose(late, 0.0, atol=1e-9)


@given(values)
def test_rotations_agree_with_scipy_and_undo(vector: np.ndarray):
    matrix = rotations(vector[None])[0]
    np.testing.assert_allclose(matrix, Rotation.from_rotvec(vector).as_matrix(), atol=1e-9)
    if np.linalg.norm(vector) < 3.1:
        np.testing.assert_allclose(rotvec(matrix), vector, atol=1e-6)
