import pytest

from treestroke.core.capture import evenly


@pytest.mark.parametrize(
    ("count", "most", "chosen"),
    [(0, 5, []), (1, 5, [0]), (4, 5, [0, 1, 2, 3]), (9, 5, [0, 2, 4, 6, 8]), (60, 3, [0, 30, 59])],
)
def test_shots_are_chosen_evenly(count: int, most: int, chosen: list[int]) -> None:
    assert evenly(count, most) == chosen
