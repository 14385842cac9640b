import struct
from collections.abc import Sequence

import numpy as np
import pytest
from PIL import Image
from tests.api.corpora import saved

from treestroke.codec.photo_kinds import extension_of, kind_of, refusal_of

PICTURE = Image.fromarray(np.full((64, 70, 3), (40, 120, 60), np.uint8))
DNG_VERSION, SUB_IFDS, SUBFILE_TYPE, PHOTOMETRIC = 50706, 330, 254, 262


def tiff(*tags: tuple[int, int], start: bytes = b"II*\0\x08\0\0\0") -> bytes:
    """Write the first directory of a TIFF, of tags of one long each."""
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in sorted(tags))
    return start + bytes(8 - len(start)) + struct.pack("<H", len(tags)) + entries + bytes(200)


def box(*brands: bytes) -> bytes:
    return struct.pack(">I", 8 + 4 * len(brands)) + b"ftyp" + b"".join(brands) + bytes(40)


@pytest.mark.parametrize(
    ("kind", "ending"),
    [("JPEG", "jpg"), ("PNG", "png"), ("WEBP", "webp"), ("HEIF", "heic"), ("AVIF", "avif"), ("TIFF", "tif")],
)
def test_every_kind_is_told_by_its_bytes(kind: str, ending: str) -> None:
    data = saved(PICTURE, kind)
    assert kind_of(data) == kind
    assert extension_of(data) == ending


@pytest.mark.parametrize(
    ("brands", "kind"),
    [
        ([b"heic", bytes(4), b"mif1"], "HEIF"),
        ([b"mif1", bytes(4), b"miaf"], "HEIF"),
        ([b"mif1", bytes(4), b"avif", b"miaf"], "AVIF"),
        ([b"avis", bytes(4), b"msf1"], "AVIF"),
        ([b"isom", bytes(4), b"mp42"], None),
        ([b"crx ", bytes(4), b"isom"], None),
    ],
)
def test_what_phones_save_is_told_by_its_brands(brands: Sequence[bytes], kind: str | None) -> None:
    assert kind_of(box(*brands)) == kind


@pytest.mark.parametrize(
    ("data", "what", "how"),
    [
        (saved(PICTURE, "GIF"), "a GIF picture", "save it as PNG"),
        (saved(PICTURE, "BMP"), "a BMP picture", "save it as PNG"),
        (saved(PICTURE, "ICO"), "an icon", "save it as PNG"),
        (saved(PICTURE, "JPEG2000"), "a JPEG 2000 picture", "save it as JPEG"),
        (b"\xff\x4f\xff\x51\0\x2f", "a JPEG 2000 picture", "save it as JPEG"),
        (b"\xff\x0a\xfa\x7f", "a JPEG XL picture", "save it as JPEG"),
        (b"\0\0\0\x0cJXL \r\n\x87\n", "a JPEG XL picture", "save it as JPEG"),
        (b'<svg xmlns="a"></svg>', "an SVG drawing", "export it as PNG"),
        (b'\xef\xbb\xbf<?xml version="1.0"?>\n<!-- a tree -->\n<svg></svg>', "an SVG drawing", "export it as PNG"),
        (saved(PICTURE, "PDF"), "a PDF document", "export its picture as JPEG or PNG"),
        (saved(PICTURE, "EPS"), "an EPS drawing", "export it as PNG"),
        (b"8BPS\0\x01", "a Photoshop document (PSD)", "export it as JPEG or PNG"),
        (box(b"crx ", bytes(4)), "a camera's raw file", "export it as JPEG"),
        (b"IIRO\x08\0\0\0", "a camera's raw file", "export it as JPEG"),
        (box(b"qt  ", bytes(4)), "a video", "save one of its frames as JPEG"),
        (b"<!doctype html><html><img></html>", "a web page", "save its picture"),
        (b"PK\x03\x04" + bytes(20), "a ZIP archive", "take the photo in it"),
    ],
)
def test_what_is_no_photo_is_named_with_the_way_out(data: bytes, what: str, how: str) -> None:
    assert kind_of(data) is None
    said = refusal_of(data)
    assert said.startswith(f"this is {what}")
    assert "must be JPEG, PNG, WebP, HEIC, AVIF or TIFF; " in said
    assert said.endswith(how)


@pytest.mark.parametrize(
    "data",
    [
        tiff((SUBFILE_TYPE, 0), (DNG_VERSION, 0x0104)),
        tiff((SUBFILE_TYPE, 1), (SUB_IFDS, 8)),
        tiff((PHOTOMETRIC, 32803)),
        tiff((PHOTOMETRIC, 34892)),
        b"II*\0\x10\0\0\0CR\x02\0" + bytes(100),
    ],
    ids=["DNG", "NEF, ARW", "colour filter", "linear", "CR2"],
)
def test_a_cameras_raw_file_is_no_tiff(data: bytes) -> None:
    assert kind_of(data) is None
    assert refusal_of(data).startswith("this is a camera's raw file")
    assert refusal_of(data).endswith("export it as JPEG")


@pytest.mark.parametrize(
    "data",
    [
        tiff((SUBFILE_TYPE, 1)),
        tiff((SUB_IFDS, 8)),
        b"II*\0\xff\xff\xff\xff",
        b"MM\0*",
        b"II+\0\x08\0\0\0" + b"\xff" * 8,
    ],
)
def test_other_and_damaged_tiffs_are_left_to_their_decoder(data: bytes) -> None:
    assert kind_of(data) == "TIFF"


@pytest.mark.parametrize(
    ("data", "said"), [(b"", "the file is empty"), (b"no photo", "this is not a photo"), (bytes(9), "")]
)
def test_what_has_no_name_is_refused_all_the_same(data: bytes, said: str) -> None:
    assert kind_of(data) is None
    assert refusal_of(data).startswith(said)
