"""Kinds of videos, told by a file's first bytes: those that are accepted, and words for others."""

import re
from typing import NamedTuple

from treestroke.codec import photo_kinds

ACCEPTED_VIDEOS = "MP4, MOV, WebM, AVI or GIF"
"""Kinds that are accepted, for messages."""


class VideoKind(NamedTuple):
    """A kind of video: the ending of its files' names, and its media type."""

    ending: str
    media_type: str


MP4 = VideoKind("mp4", "video/mp4")
MOV = VideoKind("mov", "video/quicktime")
WEBM = VideoKind("webm", "video/webm")
MATROSKA = VideoKind("mkv", "video/x-matroska")
AVI = VideoKind("avi", "video/x-msvideo")
GIF = VideoKind("gif", "image/gif")
VIDEO_KINDS = (MP4, MOV, WEBM, MATROSKA, AVI, GIF)
_SIGNATURES = (
    (MOV, rb"....(?:ftypqt  |(?:moov|mdat|wide|free|skip|pnot))"),
    (MP4, rb"....ftyp"),
    (WEBM, rb"\x1a\x45\xdf\xa3.{0,60}webm"),
    (MATROSKA, rb"\x1a\x45\xdf\xa3"),
    (AVI, rb"RIFF....AVI "),
    (GIF, rb"GIF8[79]a"),
)


def video_kind(beginning: bytes) -> VideoKind | None:
    """Return the kind of a video by its first bytes; None where it is not one that is accepted.

    Photos in the same container (HEIC, AVIF) are none.
    """
    if photo_kinds.kind_of(beginning) is not None:
        return None
    return next((kind for kind, signature in _SIGNATURES if re.match(signature, beginning, re.DOTALL)), None)


def refusal_of(beginning: bytes) -> str:
    """Return a message that says what a file that is not an accepted video is, and what to do."""
    if not beginning:
        return "the file is empty; choose another, or copy it again"
    if photo_kinds.kind_of(beginning) is not None:
        return "this is a still picture; film the tree for some seconds, or, for a photo, use `treestroke model`"
    return f"this is not a video that can be read; save it as {ACCEPTED_VIDEOS}"
