"""Formats of photos, told by a file's first bytes: those that are accepted, and names for others."""

import io
import re
import struct
import warnings
from collections.abc import Mapping

ACCEPTED_FORMATS = "JPEG, PNG, WebP, HEIC, AVIF or TIFF"
"""Formats that are accepted, for messages."""
MEDIA_TYPES = ("image/jpeg", "image/png", "image/webp", "image/heic", "image/heif", "image/avif", "image/tiff")
"""Media types of these formats."""
NAMES: Mapping[str, str] = {
    "JPEG": "JPEG",
    "PNG": "PNG",
    "WEBP": "WebP",
    "HEIF": "HEIC",
    "AVIF": "AVIF",
    "TIFF": "TIFF",
}
"""Usual names of the accepted formats, by Pillow's names."""
_EXTENSIONS = {"JPEG": "jpg", "PNG": "png", "WEBP": "webp", "HEIF": "heic", "AVIF": "avif", "TIFF": "tif"}
PHOTO_ENDINGS = (".jpg", ".jpeg", ".png", ".webp", ".heic", ".heif", ".avif", ".tif", ".tiff")
"""Endings by which photos are found in a folder."""
"""File name extensions, by Pillow's names."""
_SIGNATURES = {
    "JPEG": rb"\xff\xd8\xff",
    "PNG": rb"\x89PNG\r\n\x1a\n",
    "WEBP": rb"RIFF....WEBP",
    "TIFF": rb"II[*+]\0|MM\0[*+]",
}
"""Regular expressions for the first bytes, by Pillow's names."""
_AVIF_BRANDS = (b"avif", b"avis")
"""Brands of AVIF files."""
_HEIF_SEQUENCES = (b"hevc", b"hevx", b"hevm", b"hevs", b"msf1")
"""Brands of HEIF image sequences."""
_HEIF_BRANDS = (b"heic", b"heix", b"heim", b"heis", b"mif1", *_HEIF_SEQUENCES)
"""Brands of HEIF files."""

_SAVE_AS_PNG = "open it in a picture program and save it as PNG"
"""How files of many other formats become a photo."""
_OTHER_FILES = (
    ("a GIF picture", rb"GIF8", _SAVE_AS_PNG),
    ("a BMP picture", rb"BM.{4}\0\0\0\0", _SAVE_AS_PNG),
    ("an icon (ICO)", rb"\0\0[\x01\x02]\0", _SAVE_AS_PNG),
    ("a JPEG 2000 picture", rb"\0\0\0\x0cjP  |\xff\x4f\xff\x51", "open it in a picture program and save it as JPEG"),
    ("a JPEG XL picture", rb"\0\0\0\x0cJXL |\xff\x0a", "open it in a picture program and save it as JPEG"),
    ("an SVG drawing", rb"(?:\xef\xbb\xbf)?\s*<(?:svg|(?:\?xml|!--|!DOCTYPE svg).{0,4000}?<svg)", "export it as PNG"),
    ("a PDF document", rb"%PDF", "export its picture as JPEG or PNG"),
    ("an EPS drawing", rb"%!PS|\xc5\xd0\xd3\xc6", "export it as PNG"),
    ("a Photoshop document (PSD)", rb"8BP[SB]", "export it as JPEG or PNG"),
    (
        "a camera's raw file",
        rb"....ftypcrx |II[*]\0....CR|IIR[OS]|MMOR|IIU\0|FUJIFILMCCD-RAW|FOVb|\0MRM|II\x1a\0\0\0HEAP",
        "develop it in a photo program and export it as JPEG",
    ),
    ("a video", rb"....ftyp|\x1a\x45\xdf\xa3|RIFF....AVI ", "save one of its frames as JPEG"),
    ("a web page", rb"\s*<(?:!DOCTYPE html|html)", "open it in a browser and save its picture"),
    ("a ZIP archive", rb"PK\x03\x04", "unpack it and take the photo in it"),
)
"""Other files that are sent as photos: name, regular expression for the first bytes, and how it becomes a photo."""
_RAW = "a camera's raw file (such as DNG, NEF or ARW)", "develop it in a photo program and export it as JPEG"
"""Name of a raw file that is a TIFF, and how it becomes a photo."""
_DNG_VERSION, _PHOTOMETRIC, _SUBFILE_TYPE, _SUB_IFDS = 50706, 262, 254, 330
"""TIFF tags."""
_SENSOR = (32803, 34892)
"""Photometric interpretations of a sensor's raw pixels: with a colour filter, and linear."""


def kind_of(data: bytes) -> str | None:
    """Return the format of a photo as Pillow calls it, or None for files that are not accepted."""
    brands = _brands(data)
    if brands.intersection(_AVIF_BRANDS):
        return "AVIF"
    if brands.intersection(_HEIF_BRANDS):
        return "HEIF"
    kind = next((kind for kind, beginning in _SIGNATURES.items() if re.match(beginning, data, re.DOTALL)), None)
    return None if kind == "TIFF" and _is_raw(data) else kind


def extension_of(data: bytes) -> str:
    """Return the file name extension of a photo; png for files that are not accepted."""
    return _EXTENSIONS[kind_of(data) or "PNG"]


def is_sequence(data: bytes) -> bool:
    """Tell whether a HEIF file is primarily a sequence of frames."""
    return data[8:12] in _HEIF_SEQUENCES


def refusal_of(data: bytes) -> str:
    """Return a message that says what a file that is not accepted is, and how it becomes a photo."""
    if not data:
        return "the file is empty; choose another, or copy it again"
    named = (
        (name, mend) for name, beginning, mend in _OTHER_FILES if re.match(beginning, data, re.DOTALL | re.IGNORECASE)
    )
    name, mend = next(named, _RAW if re.match(_SIGNATURES["TIFF"], data) else ("", ""))
    if not name:
        return f"this is not a photo that can be read; save it as {ACCEPTED_FORMATS}"
    return f"this is {name}, and a photo must be {ACCEPTED_FORMATS}; {mend}"


def _brands(data: bytes) -> set[bytes]:
    """Read the brands in the ftyp box (ISO 14496-12, 4.3); empty without such a box."""
    if data[4:8] != b"ftyp":
        return set()
    return {data[start : start + 4] for start in (8, *range(16, min(int.from_bytes(data[:4], "big"), 128), 4))}


def _is_raw(data: bytes) -> bool:
    """Tell whether a TIFF is a camera's raw file, whose first page holds a sensor's pixels or a small preview."""
    if data[8:10] == b"CR":
        return True
    from PIL.TiffImagePlugin import ImageFileDirectory_v2  # imported here because it is slow and rarely needed

    try:
        tags = ImageFileDirectory_v2(data[:16] if data[2:3] == b"+" or data[3:4] == b"+" else data[:8])
        file = io.BytesIO(data)
        file.seek(tags.next)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tags.load(file)
        is_preview = bool(int(tags.get(_SUBFILE_TYPE, 0)) & 1) and _SUB_IFDS in tags
        return _DNG_VERSION in tags or tags.get(_PHOTOMETRIC) in _SENSOR or is_preview
    except (OSError, SyntaxError, ValueError, TypeError, KeyError, IndexError, OverflowError, struct.error):
        return False  # a damaged file, which its decoder will report
