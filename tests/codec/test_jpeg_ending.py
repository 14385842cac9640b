import io

import pytest
from PIL import Image
from tests.api.corpora import saved
from tests.conftest import DATA

from treestroke.codec.jpeg_ending import ending_of, ends_flat, missing_part

ELM = Image.open(DATA / "elm_house.jpg").convert("RGB").resize((240, 320))
OPTIONS = {
    "baseline": {},
    "progressive": {"progressive": True},
    "restarts by row": {"restart_marker_rows": 1},
    "restarts by block": {"restart_marker_blocks": 1},
}


def opened(data: bytes) -> Image.Image:
    image = Image.open(io.BytesIO(data))
    image.load()
    return image


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_a_whole_jpeg_has_its_end_and_all_its_passes(options: dict[str, object]) -> None:
    data = saved(ELM, "JPEG", **options)
    ending = ending_of(data + b"behind it \xff\xd9")
    assert ending.marked
    assert not ending.is_coarse
    assert ending.completed() == data


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_noise_behind_the_last_block_changes_nothing(options: dict[str, object]) -> None:
    ending = ending_of(saved(ELM, "JPEG", **options)[:-2])
    assert not ending.marked
    assert missing_part(opened(ending.completed()), opened(ending.filled_with_noise())) == (0.0, ELM.height)


@pytest.mark.parametrize("kept", [0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("name", ["baseline", "restarts by row", "restarts by block"])
def test_what_is_lost_begins_where_the_whole_picture_differs(name: str, kept: float) -> None:
    data = saved(ELM, "JPEG", **OPTIONS[name])
    ending = ending_of(data[: int(kept * len(data))])
    cut = opened(ending.completed())
    _, first = missing_part(cut, opened(ending.filled_with_noise()))
    _, differs = missing_part(cut, opened(data))
    assert abs(first - differs) <= 16


def test_a_cut_at_the_end_of_a_restart_interval_is_seen() -> None:
    data = saved(ELM, "JPEG", restart_marker_rows=1)
    ending = ending_of(data[: data.rindex(b"\xff\xd0")])
    share, first = missing_part(opened(ending.completed()), opened(ending.filled_with_noise()))
    assert share > 0.01
    assert first < ELM.height - 16


def test_passes_that_are_not_there_are_missed() -> None:
    data = saved(ELM, "JPEG", progressive=True)
    scans = [at for at in range(len(data)) if data[at : at + 2] == b"\xff\xda"]
    assert ending_of(data[: scans[-1]]).is_coarse
    assert not ending_of(data[: scans[-1] + 200]).is_coarse


@pytest.mark.parametrize(
    "data", [b"", b"\xff\xd8", b"\xff\xd8\xff\xda", b"\xff\xd8\xff\xda\0\3\4", b"\xff\xd8\xff\xc2\0\2"]
)
def test_a_stump_has_no_end(data: bytes) -> None:
    assert not ending_of(data).marked


def test_a_file_of_nothing_but_markers_is_left_to_the_decoder() -> None:
    assert ending_of(b"\xff\xd8" + b"\xff\xfe\0\2" * 1_000_000).marked


@pytest.mark.parametrize(("mode", "flat"), [("RGB", False), ("L", False)])
def test_a_photo_does_not_end_flat(mode: str, flat: bool) -> None:
    assert ends_flat(ELM.convert(mode)) is flat
    assert ends_flat(Image.new(mode, (64, 64), 128))
