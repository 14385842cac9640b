"""Work on several items at once."""

import pytest

from treestroke.core.side_by_side import side_by_side


def test_results_come_in_the_order_of_the_items_and_progress_is_told() -> None:
    told: list[float] = []
    assert side_by_side(lambda item: item**2, range(5), told.append) == [0, 1, 4, 9, 16]
    assert told == [0.2, 0.4, 0.6, 0.8, 1.0]


def test_nothing_gives_nothing() -> None:
    assert side_by_side(lambda item: item, list[int]()) == []


def test_an_error_of_an_item_ends_the_work() -> None:
    def inverse(item: int) -> float:
        return 1 / item

    with pytest.raises(ZeroDivisionError):
        side_by_side(inverse, [1, 0, 2])


def test_an_error_of_the_progress_report_ends_the_work() -> None:
    def stop(fraction: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        side_by_side(lambda item: item, range(3), stop)
