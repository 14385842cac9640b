import pytest

from treestroke.codec.focal_length import focal_px


def test_the_equivalent_focal_length_refers_to_the_diagonal() -> None:
    assert focal_px((3600, 2400), 36.0) == pytest.approx(3600.0)
    assert focal_px((2400, 3600), 36.0) == pytest.approx(3600.0)


def test_the_size_of_the_sensor_serves_without_an_equivalent() -> None:
    assert focal_px((4000, 3000), None, focal_mm=4.5, sensor_mm=6.0) == pytest.approx(3000.0)


@pytest.mark.parametrize("equivalent", [0.0, None, 5000.0, float("nan")])
def test_nonsense_is_unknown(equivalent: float | None) -> None:
    assert focal_px((4000, 3000), equivalent) is None
