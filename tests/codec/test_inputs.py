import itertools

import pytest

from treestroke.codec.inputs import PARTS, SIDES, SOURCES, Inputs, check_parts, file_name, part_of
from treestroke.core.errors import TreestrokeError

SOURCE_OF = {
    ("photo", "strokes"): "photo",
    ("photo", "strokes", "side"): "photo",
    ("front",): "sketches",
    ("front", "side"): "sketches",
    ("photo", "front"): "sketches",
    ("photo", "front", "side"): "sketches",
}


def inputs_of(*names: str) -> Inputs[str]:
    return Inputs.of({name: f"the {name}" for name in names})


@pytest.mark.parametrize("pictures", [(), ("leaf",), ("leaf", "fruit")])
@pytest.mark.parametrize(("names", "source"), SOURCE_OF.items())
def test_parts_decide_their_source(names: tuple[str, ...], source: str, pictures: tuple[str, ...]) -> None:
    assert inputs_of(*pictures, *names).source == source


@pytest.mark.parametrize("count", range(5))
def test_all_other_parts_together_are_refused(count: int) -> None:
    for names in itertools.combinations(("photo", "strokes", *SIDES), count):
        if names not in SOURCE_OF:
            with pytest.raises(TreestrokeError, match="missing|leave one of them out"):
                inputs_of(*names)


@pytest.mark.parametrize(
    ("names", "pointer", "code"),
    [
        ((), "/photo", "missing_key"),
        (("leaf",), "/photo", "missing_key"),
        (("photo",), "/strokes", "missing_key"),
        (("photo", "side"), "/strokes", "missing_key"),
        (("strokes",), "/photo", "missing_key"),
        (("side",), "/sketches/front", "missing_key"),
        (("strokes", "front"), "/strokes", "strokes_and_sketch"),
    ],
)
def test_a_refusal_points_at_the_part_to_add_or_leave_out(names: tuple[str, ...], pointer: str, code: str) -> None:
    with pytest.raises(TreestrokeError) as refused:
        check_parts({*names, "settings"}, ("sketches",))
    assert (refused.value.pointer, refused.value.code) == (pointer, code)


def test_parts_that_are_none_are_absent_and_the_others_are_in_the_order_of_the_description() -> None:
    inputs = Inputs.of({"fruit": 1, "side": None, "strokes": 2, "photo": 3})
    assert list(inputs.parts.items()) == [("photo", 3), ("strokes", 2), ("fruit", 1)]


@pytest.mark.parametrize("name", ["", "bark", "photo/1", "strokes.json"])
def test_a_name_that_is_not_described_is_no_part(name: str) -> None:
    with pytest.raises(ValueError, match="not a part"):
        part_of(name)


@pytest.mark.parametrize(
    ("name", "content", "file"),
    [
        ("strokes", b"{}", "strokes.json"),
        ("front", b"{}", "front.json"),
        ("side", b"\x89PNG\r\n\x1a\n", "side.png"),
        ("leaf", b"\x89PNG\r\n\x1a\n", "leaf.png"),
        ("photo", b"\xff\xd8\xff", "photo.jpg"),
        ("photo", b"RIFF....WEBP", "photo.webp"),
    ],
)
def test_a_file_is_named_by_its_content(name: str, content: bytes, file: str) -> None:
    form = part_of(name).format_of(content)
    assert file_name(name, form.media_type) == file
    assert form.max_bytes <= part_of(name).max_bytes


def test_every_source_is_described_by_parts_and_decided_by_one_of_its_own() -> None:
    for source in SOURCES.values():
        assert {*source.needs, *source.options} <= PARTS.keys()
        assert source.decided_by in source.needs
    assert len({source.decided_by for source in SOURCES.values()}) == len(SOURCES)
