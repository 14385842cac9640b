from treestroke.service.execution import Stopwatch


def test_each_stage_is_charged_its_own_time() -> None:
    hand = iter([0.0, 1.0, 3.0, 7.0, 15.0])
    watch = Stopwatch(lambda stage, fraction: None, clock=lambda: next(hand))
    with watch.stage("decode"):
        pass
    watch("grow", 0.0)
    watch("grow", 1.0)
    assert watch.seconds == {"decode": 2.0 + 4.0, "grow": 8.0}


def test_reports_are_passed_on() -> None:
    seen: list[tuple[str, float]] = []
    watch = Stopwatch(lambda stage, fraction: seen.append((stage, fraction)))
    watch("leaf", 0.5)
    assert seen == [("leaf", 0.5)]
