"""ZIP archives whose bytes depend on nothing but what is in them."""

import io
import zipfile
from collections.abc import Mapping
from pathlib import PurePosixPath

_NO_TIME = (1980, 1, 1, 0, 0, 0)
_UNIX, _READABLE = 3, 0o644
_COMPRESSED_ALREADY = (".jpg", ".png", ".webp", ".heic", ".avif")


def zipped(members: Mapping[str, bytes]) -> bytes:
    """Pack members in their order; pictures as they are, all else deflated."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in members.items():
            info = zipfile.ZipInfo(name, _NO_TIME)
            info.create_system, info.external_attr = _UNIX, _READABLE << 16
            stored = PurePosixPath(name).suffix in _COMPRESSED_ALREADY
            info.compress_type = zipfile.ZIP_STORED if stored else zipfile.ZIP_DEFLATED
            archive.writestr(info, content)
    return out.getvalue()
