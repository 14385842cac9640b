import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from treestroke.core.geometry.vectors import UP, unit


@given(st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=3).filter(lambda v: np.hypot(*v[:2]) > 1e-3))
def test_a_unit_vector_points_the_same_way(vector: list[float]) -> None:
    found = unit(np.array([vector]))[0]
    np.testing.assert_allclose(found * np.linalg.norm(vector), vector, rtol=1e-12, atol=1e-9)


def test_vectors_without_length_become_what_was_asked_for() -> None:
    assert unit(np.zeros((2, 3)), UP).tolist() == [[0, 1, 0]] * 2
    assert unit(np.zeros(3)).tolist() == [0, 0, 0]
