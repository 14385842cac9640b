from tests.api import sketched

from treestroke.service.sketch_trace import trace_sketches


def test_a_trace_shows_what_was_drawn() -> None:
    found = trace_sketches(sketched.FRONT, sketched.SIDE)
    assert found.grown is None
    answer = found.answer()
    for view, given in (("front", sketched.FRONT), ("side", sketched.SIDE)):
        points = answer[view]["skeleton"]["points"]
        for branch in given["branches"]:
            assert min(abs(x - branch["points"][-1][0]) + abs(y - branch["points"][-1][1]) for x, y in points) < 1.0
