import numpy as np
import pytest
from tests.builders import oak
from tests.codec.gltf.unfolding import unfold, unfold_one

from treestroke.codec.gltf.meshopt import encode_attributes, encode_triangles, fixed_point, octahedral
from treestroke.core.mesh.tubes import tubes


def turned(triangles: np.ndarray) -> np.ndarray:
    """Let each triangle begin with its smallest corner."""
    return np.take_along_axis(triangles, (triangles.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)


@pytest.mark.parametrize("count", [1, 15, 16, 17, 255, 256, 257, 1000])
@pytest.mark.parametrize("stride", [4, 8, 64, 256])
def test_attributes_return_unchanged(count: int, stride: int) -> None:
    rng = np.random.default_rng(count)
    spread = rng.choice([0, 1, 2, 5, 20, 128], stride)  # bytes that stay, creep, and leap: all four forms of a group
    elements = np.cumsum(rng.integers(-spread, spread + 1, (count, stride)), axis=0).astype(np.uint8)
    assert np.array_equal(unfold_one(encode_attributes(elements), count, stride), elements)


def test_small_changes_take_few_bytes() -> None:
    elements = np.repeat(np.arange(256, dtype=np.uint8), 16)[:, None] * np.ones(4, dtype=np.uint8)
    assert len(encode_attributes(elements)) == 1 + 16 * 4 * 4 + 255 * 4 * 4 + 32  # 2 bits a byte where one changes
    assert len(encode_attributes(np.zeros((4096, 4), np.uint8))) == 1 + 16 * 4 * 4 + 32


@pytest.mark.parametrize("shape", [(0, 4), (3, 6), (3, 260)])
def test_elements_that_the_format_cannot_hold_are_refused(shape: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="there must be elements"):
        encode_attributes(np.zeros(shape, np.uint8))


def test_triangles_of_a_tree_return() -> None:
    triangles = tubes(oak()).triangles.astype(np.int64)
    read = unfold_one(encode_triangles(triangles), triangles.size, 4, "TRIANGLES").view("<u4").reshape(-1, 3)
    assert np.array_equal(turned(read), turned(triangles))


def test_triangles_without_any_order_return() -> None:
    rng = np.random.default_rng(0)
    far = np.array([rng.permutation(70_000)[:3] for _ in range(500)])
    near = np.array([rng.permutation(12)[:3] for _ in range(500)])
    for triangles in (far, near, np.concatenate([near, far])):
        read = unfold_one(encode_triangles(triangles), triangles.size, 4, "TRIANGLES").view("<u4").reshape(-1, 3)
        assert np.array_equal(turned(read), turned(triangles))


def test_16_bit_indices_are_decoded_too() -> None:
    triangles = np.array([[0, 1, 2], [2, 1, 3], [9, 3, 7]])
    read = unfold_one(encode_triangles(triangles), 9, 2, "TRIANGLES").view("<u2").reshape(-1, 3)
    assert np.array_equal(turned(read), turned(triangles))


def test_cards_take_a_byte_a_triangle() -> None:
    cards = (4 * np.arange(1000)[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    encoded = encode_triangles(cards)
    assert len(encoded) == 1 + len(cards) + 16
    assert np.array_equal(unfold_one(encoded, cards.size, 4, "TRIANGLES").view("<u4").reshape(-1, 3), cards)


def test_normals_return_within_two_degrees() -> None:
    vectors = np.random.default_rng(0).normal(size=(2000, 3))
    vectors = np.concatenate([vectors, np.eye(3), -np.eye(3)])
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    read = unfold_one(encode_attributes(octahedral(vectors)), len(vectors), 4, filter_="OCTAHEDRAL").view(np.int8)[
        :, :3
    ]
    cosines = (read * vectors).sum(axis=1) / np.linalg.norm(read.astype(float), axis=1)
    assert np.degrees(np.arccos(np.clip(cosines, -1, 1))).max() < 2


def test_the_sign_of_a_tangent_passes_as_it_is() -> None:
    given = np.array([[1, 0, 0, 1], [0, 0, -1, -1]])
    read = unfold_one(encode_attributes(octahedral(given)), 2, 4, filter_="OCTAHEDRAL").view(np.int8)
    assert np.array_equal(read, given * 127)


def test_fixed_point_rounds_to_its_steps() -> None:
    values = np.random.default_rng(0).uniform(-60, 60, (100, 2))
    encoded = encode_attributes(fixed_point(values, 12))
    read = unfold_one(encoded, 100, 8, filter_="EXPONENTIAL").view("<f4")
    assert np.array_equal(read, np.rint(values * 4096) / 4096)


@pytest.mark.parametrize("largest", [1023.9, 5000.0, 1e9])
def test_large_values_are_rounded_to_larger_steps(largest: float) -> None:
    encoded = encode_attributes(fixed_point(np.array([[largest], [-largest / 3]]), 12))
    read = unfold_one(encoded, 2, 4, filter_="EXPONENTIAL").view("<f4")
    assert np.allclose(read.ravel(), [largest, -largest / 3], rtol=1e-6)


def test_several_streams_lie_in_one_buffer() -> None:
    first, second = encode_attributes(np.full((3, 4), 7, np.uint8)), encode_attributes(np.full((2, 4), 9, np.uint8))
    rows = [
        {"byteOffset": 0, "byteLength": len(first), "count": 3, "byteStride": 4, "mode": "ATTRIBUTES"},
        {"byteOffset": len(first), "byteLength": len(second), "count": 2, "byteStride": 4, "mode": "ATTRIBUTES"},
    ]
    assert [int(one[0, 0]) for one in unfold(first + second, rows)] == [7, 9]
