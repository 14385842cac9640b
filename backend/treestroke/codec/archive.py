"""ZIP archives whose bytes depend on their members alone: no times, no names of systems."""

import io
import os
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import BinaryIO

_NO_TIME = (1980, 1, 1, 0, 0, 0)
_UNIX, _READABLE = 3, 0o644
_COMPRESSED_ALREADY = (
    *(".jpg", ".png", ".webp", ".heic", ".avif"),
    *(".mp4", ".mov", ".webm", ".mkv", ".avi", ".gif"),
)
_CHUNK = 1_000_000
"""Bytes that are copied at a time."""


def zipped(members: Mapping[str, bytes]) -> bytes:
    """Pack members, bytes by name, in memory, as `zip_into` does."""
    out = io.BytesIO()
    zip_into(out, {name: io.BytesIO(content) for name, content in members.items()})
    return out.getvalue()


def zip_into(out: BinaryIO, members: Mapping[str, BinaryIO]) -> None:
    """Pack members into a file in their order, in small chunks; pictures and videos are stored, the rest deflated."""
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in members.items():
            info = zipfile.ZipInfo(name, _NO_TIME)
            info.create_system, info.external_attr = _UNIX, _READABLE << 16
            stored = PurePosixPath(name).suffix in _COMPRESSED_ALREADY
            info.compress_type = zipfile.ZIP_STORED if stored else zipfile.ZIP_DEFLATED
            info.file_size = content.seek(0, os.SEEK_END)
            content.seek(0)
            with archive.open(info, "w") as member:
                shutil.copyfileobj(content, member, _CHUNK)
