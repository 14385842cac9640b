import pytest
from tests.api import drawn, sketched

from treestroke.codec.project import Project
from treestroke.core.errors import TreestrokeError
from treestroke.service.evidence import Evidence, make_of
from treestroke.service.model import model
from treestroke.service.sketch import sketch

QUICK = drawn.QUICK


def test_what_is_given_decides_how_a_tree_is_made() -> None:
    photo = drawn.encoded()
    pairs = (
        (Evidence(photo, drawn.STROKES), model(photo, drawn.STROKES, QUICK, 1)),
        (Evidence(photo, drawn.STROKES, side=sketched.SIDE), model(photo, drawn.STROKES, QUICK, 1, side=sketched.SIDE)),
        (Evidence(front=sketched.FRONT), sketch(sketched.FRONT, None, QUICK, 1)),
        (Evidence(photo, front=sketched.FRONT), sketch(sketched.FRONT, None, QUICK, 1, photo=photo)),
    )
    made = [make_of(given, QUICK, 1).glb for given, _ in pairs]
    assert made == [wanted.glb for _, wanted in pairs]
    assert len(set(made)) == len(pairs)


@pytest.mark.parametrize(
    "given",
    [
        Evidence(),
        Evidence(b"P"),
        Evidence(strokes=drawn.STROKES),
        Evidence(side=sketched.SIDE),
        Evidence(b"P", drawn.STROKES, sketched.FRONT),
    ],
)
def test_what_makes_no_tree_together_is_refused(given: Evidence) -> None:
    with pytest.raises(TreestrokeError, match="missing|leave one of them out"):
        make_of(given, QUICK, 0)


def test_a_project_gives_all_its_parts() -> None:
    project = Project(b"P", None, {}, leaf=b"L", fruit=b"F", front=b"A", side=b"B")
    given = Evidence.of(project)
    assert (given.photo, given.strokes, given.front, given.side, given.leaf, given.fruit) == (
        b"P",
        None,
        b"A",
        b"B",
        b"L",
        b"F",
    )
