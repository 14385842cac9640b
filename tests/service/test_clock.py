import time

import pytest

from treestroke.service.clock import Stopwatch


def test_each_stage_is_charged_its_own_time() -> None:
    watch = Stopwatch(lambda stage, fraction: None)
    with watch.stage("decode"):
        time.sleep(0.02)
    watch("grow", 0.0)
    time.sleep(0.05)
    watch("grow", 1.0)
    assert watch.seconds["decode"] == pytest.approx(0.02, abs=0.015)
    assert watch.seconds["grow"] == pytest.approx(0.05, abs=0.03)


def test_reports_are_passed_on() -> None:
    seen: list[tuple[str, float]] = []
    watch = Stopwatch(lambda stage, fraction: seen.append((stage, fraction)))
    watch("leaf", 0.5)
    assert seen == [("leaf", 0.5)]
