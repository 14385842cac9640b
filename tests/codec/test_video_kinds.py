import re

import pytest
from tests.clips import SYNTHETIC_ASH

from treestroke.codec.inputs import BEGINNING, PARTS
from treestroke.codec.video_kinds import refusal_of, video_kind


@pytest.mark.parametrize(
    ("beginning", "ending"),
    [
        (b"\0\0\0\x20ftypisom\0\0\x02\0isomiso2avc1mp41", "mp4"),
        (b"\0\0\0\x14ftypqt  \0\0\0\0qt  ", "mov"),
        (b"\0\0\0\x08wide\0\x01\0\0mdat", "mov"),
        (b"\x1a\x45\xdf\xa3\x9f\x42\x86\x81\x01\x42\x82\x84webm", "webm"),
        (b"\x1a\x45\xdf\xa3\x9f\x42\x86\x81\x01\x42\x82\x88matroska", "mkv"),
        (b"RIFF\x10\x20\0\0AVI LIST", "avi"),
        (b"GIF89a\x10\0", "gif"),
        (SYNTHETIC_ASH.read_bytes()[:BEGINNING], "mp4"),
    ],
)
def test_videos_are_told_by_their_first_bytes(beginning: bytes, ending: str) -> None:
    kind = video_kind(beginning)
    assert kind is not None
    assert kind.ending == ending
    assert PARTS["clip"].format_of(beginning).media_type == kind.media_type


@pytest.mark.parametrize(
    ("beginning", "said"),
    [
        (b"", "the file is empty"),
        (b"\xff\xd8\xff\xe0\0\x10JFIF", "still picture.*treestroke model"),
        (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "still picture"),
        (b"#EXTM3U\nhttp://example.org/a.ts", "save it as MP4, MOV, WebM, AVI or GIF"),
        (b"ffconcat version 1.0\nfile /etc/passwd", "save it as MP4"),
    ],
)
def test_other_files_are_refused_with_what_to_do(beginning: bytes, said: str) -> None:
    assert video_kind(beginning) is None
    assert re.search(said, refusal_of(beginning))
