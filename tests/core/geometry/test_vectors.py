import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from treestroke.core.geometry.vectors import UP, rotation_minimizing_normals, unit

BACK = np.array([[0.0, 0.0, -1.0]])
ONE = np.array([0])


def helix(turns: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    t = np.linspace(0.0, 2 * np.pi * turns, count)
    points = np.stack([np.cos(t), 0.5 * t, np.sin(t)], axis=1)
    tangents = np.stack([-np.sin(t), np.full(count, 0.5), np.cos(t)], axis=1)
    return points, tangents / np.linalg.norm(tangents, axis=1, keepdims=True)


@given(st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_normals_are_unit_and_square_to_any_curve(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, tangents = rng.normal(size=(20, 3)), rng.normal(size=(20, 3))
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    normals = rotation_minimizing_normals(points, tangents, np.array([0, 1, 8]), rng.normal(size=(3, 3)))
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    assert np.einsum("ij,ij->i", normals, tangents) == pytest.approx(0.0, abs=1e-9)


def test_a_straight_curve_keeps_its_normal() -> None:
    points = np.linspace(0, 1, 6)[:, None] * [0.0, 3.0, 0.0]
    tangents = np.tile([0.0, 1.0, 0.0], (6, 1))
    assert rotation_minimizing_normals(points, tangents, ONE, BACK) == pytest.approx(np.tile(BACK, (6, 1)))


def test_a_plane_curve_keeps_its_square_normal() -> None:
    t = np.linspace(0, 3, 30)
    points = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    tangents = np.stack([-np.sin(t), np.cos(t), 0 * t], axis=1)
    assert rotation_minimizing_normals(points, tangents, ONE, BACK) == pytest.approx(np.tile(BACK, (30, 1)))


def test_normals_turn_about_a_helix_by_its_torsion_as_wang_2008_proves() -> None:
    points, tangents = helix(turns=1.0, count=400)
    start = np.array([[-1.0, 0.0, 0.0]])  # the Frenet normal
    last = rotation_minimizing_normals(points, tangents, ONE, start)[-1]
    torsion, length = 0.5 / 1.25, 2 * np.pi * np.sqrt(1.25)
    frenet = np.array([-1.0, 0.0, 0.0])
    turned = np.arctan2(np.cross(frenet, last) @ tangents[-1], frenet @ last)
    # with the winding's sign: this helix is left-handed
    assert np.exp(1j * turned) == pytest.approx(np.exp(1j * torsion * length), abs=1e-4)


def test_curves_carried_together_equal_curves_carried_alone() -> None:
    a, b = helix(0.7, 12), helix(0.2, 5)
    together = rotation_minimizing_normals(
        np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1]]), np.array([0, 12]), np.repeat(BACK, 2, axis=0)
    )
    alone = [rotation_minimizing_normals(*curve, ONE, BACK) for curve in (a, b)]
    assert np.array_equal(together, np.concatenate(alone))


def test_a_seed_along_the_tangent_is_replaced() -> None:
    points, tangents = np.array([[0.0, 0, 0], [0, 0, 1]]), np.array([[0.0, 0, 1], [0, 0, 1]])
    normals = rotation_minimizing_normals(points, tangents, ONE, BACK)
    assert np.abs(normals[:, 2]).max() < 1e-9


@given(st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=3).filter(lambda v: np.hypot(*v[:2]) > 1e-3))
def test_a_unit_vector_points_the_same_way(vector: list[float]) -> None:
    found = unit(np.array([vector]))[0]
    np.testing.assert_allclose(found * np.linalg.norm(vector), vector, rtol=1e-12, atol=1e-9)


def test_vectors_without_length_become_the_given_one() -> None:
    assert unit(np.zeros((2, 3)), UP).tolist() == [[0, 1, 0]] * 2
    assert unit(np.zeros(3)).tolist() == [0, 0, 0]
