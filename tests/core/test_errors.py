import pickle

import pytest

from treestroke.core.errors import PhotoError, SettingsError, StrokesError, TreestrokeError, shown

CODES = {
    TreestrokeError: "bad_input",
    PhotoError: "photo_unreadable",
    StrokesError: "strokes_invalid",
    SettingsError: "setting_invalid",
}


@pytest.mark.parametrize(("kind", "code"), CODES.items())
def test_each_kind_has_a_code_of_its_own(kind: type[TreestrokeError], code: str) -> None:
    error = kind("oak.jpg: it is no photo")
    assert (str(error), error.code, error.pointer) == ("oak.jpg: it is no photo", code, "")


@pytest.mark.parametrize("kind", CODES)
def test_an_error_crosses_a_process_border_whole(kind: type[TreestrokeError]) -> None:
    error = pickle.loads(pickle.dumps(kind("what", code="wrong_type", pointer="/branches/0")))
    assert (type(error), str(error), error.code, error.pointer) == (kind, "what", "wrong_type", "/branches/0")


def test_text_and_pointer_are_of_one_place() -> None:
    error = StrokesError.at(("branches", 0, "points", 3), "it is odd", "wrong_type")
    assert (str(error), error.pointer) == ("branches/0/points/3: it is odd", "/branches/0/points/3")


def test_the_whole_has_a_name_and_an_empty_pointer() -> None:
    error = StrokesError.at((), "there are 201", "too_many_strokes")
    assert (str(error), error.pointer) == ("strokes: there are 201", "")


def test_a_key_is_escaped_in_the_pointer() -> None:
    error = StrokesError.at(("crown",), "the key is unknown", "unknown_key", key="a/b~c\0\ud800")
    assert (str(error), error.pointer) == ("crown: the key is unknown", r"/crown/a~1b~0c\x00\ud800")


def test_a_file_s_name_before_the_message_changes_nothing_else() -> None:
    error = StrokesError.at(("crown",), "it is missing", "crown_missing").within("oak.json")
    assert (str(error), error.code, error.pointer) == ("oak.json: crown: it is missing", "crown_missing", "/crown")


def test_a_message_is_one_line_that_can_be_written() -> None:
    text = str(TreestrokeError("b\nad \0 \ud800 ümlaut"))
    assert text == r"b\nad \x00 \ud800 ümlaut"
    assert text.encode().isascii() is False


@pytest.mark.parametrize("value", [[10**5000], "x" * 1000, [[0] * 500]])
def test_a_value_of_any_size_can_be_shown(value: object) -> None:
    assert len(shown(value)) <= 60


def test_a_short_value_is_shown_as_it_is() -> None:
    assert shown("wind") == "'wind'"
