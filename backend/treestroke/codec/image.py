"""Photos: bytes in, upright sRGB pixels out; and pictures of leaves and fruit that are cut out."""

import io
import struct
import warnings
import zlib
from collections.abc import Callable, Sequence

import cv2
import numpy as np
from PIL import Image, ImageCms

from treestroke.codec.jpeg_ending import Ending, ending_of, ends_flat, missing_part
from treestroke.codec.photo_kinds import NAMES, is_sequence, kind_of, refusal_of
from treestroke.codec.watched_bytes import WatchedBytes
from treestroke.core.errors import PhotoError, TreestrokeError
from treestroke.core.geometry.mesh import ALPHA_CUT
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import StrokeWarning
from treestroke.core.types import Picture
from treestroke.limits import MAX_LEAF_BYTES, MAX_PHOTO_BYTES

Warn = Callable[[StrokeWarning], object]
"""Called with each fault of a photo that was mended while it was read."""

MIN_SIDE, MAX_SIDE = 64, 16_384
"""Least and greatest side of a photo, px."""
MAX_PIXELS = 50_000_000
MAX_STORED_BYTES = 4 * MAX_PIXELS * 101 // 100
"""Greatest size of a stored photo: noise that does not compress, a byte a channel, and 1 % for the PNG around it."""
PHOTO_HEAD = 24
"""Number of first bytes of a photo that `most_stored_bytes` needs."""

MIN_LEAF_SIDE, MAX_LEAF_SIDE = 16, 4096
"""Least and greatest side of a leaf's or a fruit's picture, px."""
MAX_LOST = 0.002
"""Greatest share of pixels that a truncated photo may lack: under half a row of blocks in 3000 rows of pixels."""
UNREADABLE = (
    *(OSError, SyntaxError, ValueError, EOFError, IndexError, KeyError, TypeError, RuntimeError),
    *(OverflowError, struct.error, zlib.error),
)
"""Exceptions that decoders raise for files that break their format."""
_UNSUPPORTED_MODES = {"F": "floating-point", "I": "32-bit", "I;16S": "signed", "LAB": "Lab"}
"""Kinds of pixels, by Pillow's modes, that have no unique meaning as sRGB."""
_ORIENTATION = 0x0112
"""EXIF tag of the orientation."""
_TURNS = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}
"""Transformation that makes a picture of each EXIF orientation upright."""
_SIDEWAYS, _BACKWARD = (5, 6, 7, 8), (3, 4, 6, 7)
"""Orientations whose rows are columns of the upright picture, and those whose first row comes last."""
_STRIP_PIXELS = 2_000_000
"""Pixels that are converted to sRGB at a time."""
_READING_SHARE = 0.7
"""Share of the decoding's progress at which all bytes are read."""
_SRGB = ImageCms.createProfile("sRGB")
_PNG = (cv2.IMWRITE_PNG_COMPRESSION, 1)
_FAST_PNG = (
    *_PNG,
    cv2.IMWRITE_PNG_STRATEGY,
    cv2.IMWRITE_PNG_STRATEGY_RLE,
    cv2.IMWRITE_PNG_FILTER,
    cv2.IMWRITE_PNG_FILTER_SUB,
)
"""OpenCV's options for a PNG that is written fast: only runs of equal values are compressed."""
_THOROUGH_PNG = (
    *_PNG,
    cv2.IMWRITE_PNG_STRATEGY,
    cv2.IMWRITE_PNG_STRATEGY_DEFAULT,
    cv2.IMWRITE_PNG_FILTER,
    cv2.IMWRITE_PNG_ALL_FILTERS,
)
"""OpenCV's options for a PNG in which repetitions are compressed, too."""
_SAMPLE_STRIPS, _SAMPLE_ROWS = 4, 12
"""Strips of a picture, and rows of each, by which the options for storing it are chosen."""


class StoredPhoto(bytes):
    """An encoded photo that was accepted before: the limit on uploads does not apply to it."""


def ignore_warning(warning: StrokeWarning) -> None:
    """Ignore a warning."""


def decode_photo(data: bytes, name: str, report: Report = silent, warn: Warn = ignore_warning) -> Picture:
    """Decode a JPEG, PNG, WebP, HEIC, AVIF or TIFF photo to (h, w, 3) uint8 sRGB, upright.

    A photo with transparent pixels becomes (h, w, 4) with straight alpha; whoever uses its colours lays it over white.
    An ICC profile is applied (a broken one is ignored); 16 bits a channel become 8; ``name`` appears in messages. The
    size is judged from the header, before any pixel is decoded. ``report("decode", fraction)`` is called as the bytes
    are read, ``warn`` if a JPEG lacks its last bytes but no visible part of the picture.

    Raises
    ------
    PhotoError
        Another format, damaged, more than one frame, too small or too large.
    """
    limit = MAX_STORED_BYTES if isinstance(data, StoredPhoto) else MAX_PHOTO_BYTES
    if len(data) > limit:
        fault = f"the photo has more than {limit // 10**6} MB; save it smaller"
        raise PhotoError(f"{name}: {fault}", code="photo_too_large_file")
    # Pillow warns of unusual metadata, which does not affect the pixels.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return _decoded(data, name, report, warn)


def decode_stored(data: bytes, report: Report = silent) -> Picture:
    """Decode a photo that `encode_stored` encoded, or any other that was accepted before, as `decode_photo` does.

    Raises
    ------
    PhotoError
        As `decode_photo`, except for the file's size.
    """
    return decode_photo(StoredPhoto(data), "photo", report)


def most_stored_bytes(head: bytes) -> int:
    """Return the greatest size of a stored photo with these first bytes: an upload's, or that of a PNG's pixels."""
    if len(head) < PHOTO_HEAD or kind_of(head) != "PNG" or head[12:16] != b"IHDR":
        return MAX_PHOTO_BYTES
    width, height = (int.from_bytes(head[at : at + 4], "big") for at in (16, 20))
    return max(MAX_PHOTO_BYTES, min(4 * width * height * 101 // 100, MAX_STORED_BYTES))


def decode_cutout(data: bytes, name: str, refusal: type[TreestrokeError]) -> Picture:
    """Decode the PNG of something cut out, a leaf or a fruit, to (h, w, 4) uint8 sRGB, straight alpha.

    ``name`` appears in messages; what is cut out is named by ``refusal``.

    Raises
    ------
    TreestrokeError
        Of the type ``refusal``: another format, damaged, too small or too large, or not cut out: no or only opaque
        pixels.
    """
    subject = refusal.whole
    if len(data) > MAX_LEAF_BYTES:
        fault = f"the {subject}'s picture has more than {MAX_LEAF_BYTES // 10**6} MB; save it smaller"
        raise refusal(f"{name}: {fault}", code=f"{subject}_too_large")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(io.BytesIO(data), formats=("PNG",))
            if not MIN_LEAF_SIDE <= min(image.size) <= max(image.size) <= MAX_LEAF_SIDE:
                size = f"the {subject}'s picture is {image.width} x {image.height} px"
                fault = f"{size}, each side must be {MIN_LEAF_SIDE} to {MAX_LEAF_SIDE} px; resize it"
                raise refusal(f"{name}: {fault}", code=f"{subject}_size")
            picture = np.asarray(image.convert("RGBA"))
    except UNREADABLE as error:
        fault = f"this is not a readable PNG ({_shortened(error)}); save the {subject} as PNG"
        raise refusal(f"{name}: {fault}") from error
    opaque = float((picture[..., 3] >= 255 * ALPHA_CUT).mean())
    if not 0.01 <= opaque <= 0.99:
        lacks = (
            f"no {subject}: all of it is transparent" if opaque < 0.01 else f"nothing transparent around the {subject}"
        )
        fault = f"the picture has {lacks}; cut the {subject} out, with an alpha channel"
        raise refusal(f"{name}: {fault}", code=f"{subject}_not_cut_out")
    return np.ascontiguousarray(picture)


def check_size(width: int, height: int, name: str) -> None:
    """Reject a photo of a width and height, px, that are out of bounds.

    Raises
    ------
    PhotoError
        A side or the number of pixels is out of bounds.
    """
    if min(width, height) < MIN_SIDE or max(width, height) > MAX_SIDE:
        raise PhotoError(
            f"{name}: the photo is {width} x {height} px, each side must be {MIN_SIDE} to {MAX_SIDE} px; resize it",
            code="photo_too_small" if min(width, height) < MIN_SIDE else "photo_side_too_long",
        )
    if width * height > MAX_PIXELS:
        raise PhotoError(
            f"{name}: the photo has {width * height / 1e6:.1f} megapixels, at most {MAX_PIXELS / 1e6:.0f} are allowed; "
            "resize it",
            code="photo_too_many_pixels",
        )


def encode_png(picture: Picture) -> bytes:
    """Encode a picture (h, w, 3) uint8 as PNG."""
    out = io.BytesIO()
    Image.fromarray(picture).save(out, format="PNG")
    return out.getvalue()


def encode_stored(picture: Picture) -> StoredPhoto:
    """Encode a photo (h, w, 3 or 4) uint8 without loss, as a PNG that is written fast and holds nothing but pixels.

    Only runs are compressed: this takes a third of the time of Pillow's fastest PNG, and is 7 % smaller on 12
    megapixels with noise (6 % larger on 2 megapixels from a clean JPEG). Pictures that repeat in larger pieces, as
    photos do not, may be small as uploads and a thousand times as large when stored this way: if sample strips show
    that, repetitions are compressed, too.
    """
    order = cv2.COLOR_RGB2BGR if picture.shape[2] == 3 else cv2.COLOR_RGBA2BGRA
    colours = np.asarray(cv2.cvtColor(picture, order), dtype=np.uint8)
    return StoredPhoto(_png(colours, _THOROUGH_PNG if _repeats(colours) else _FAST_PNG))


def _repeats(colours: Picture) -> bool:
    """Tell, by a few strips, whether compressing repetitions makes a picture (h, w, 3 or 4) less than half as large."""
    starts = np.linspace(0, max(len(colours) - _SAMPLE_ROWS, 0), _SAMPLE_STRIPS).astype(int)
    strips = [colours[top : top + _SAMPLE_ROWS] for top in starts]
    fast, thorough = (sum(len(_png(strip, options)) for strip in strips) for options in (_FAST_PNG, _THOROUGH_PNG))
    return 2 * thorough < fast


def _png(colours: Picture, options: Sequence[int]) -> bytes:
    """Encode colours (h, w, 3 or 4), BGR or BGRA, as PNG with OpenCV's options."""
    _, encoded = cv2.imencode(".png", colours, options)
    return encoded.tobytes()


def _decoded(data: bytes, name: str, report: Report, warn: Warn) -> Picture:
    """Decode a photo of an accepted size to (h, w, 3) uint8 sRGB, or (h, w, 4) where it is transparent."""
    kind = kind_of(data)
    if kind is None:
        raise PhotoError(f"{name}: {refusal_of(data)}", code="format_not_allowed")
    ending = ending_of(data) if kind == "JPEG" else None
    image = opened(data if ending is None or ending.marked else ending.completed(), kind, name, report)
    check_size(image.width, image.height, name)
    try:
        _check_one_frame(image, kind, data, name)
        image.load()
        check_size(image.width, image.height, name)
        if ending is not None and (not ending.marked or ends_flat(image)):
            _check_complete(image, ending, name, warn)
    except UNREADABLE as error:
        raise PhotoError(
            f"{name}: the photo is damaged or cut short ({_shortened(error)}); save or copy it again"
        ) from error
    if image.mode in _UNSUPPORTED_MODES:
        fault = (
            f"the photo has {_UNSUPPORTED_MODES[image.mode]} pixels; save it as RGB or grey, of 8 or 16 bits a channel"
        )
        raise PhotoError(f"{name}: {fault}", code="format_not_allowed")
    return _pixels(image, report)


def opened(data: bytes, kind: str, name: str, report: Report = silent) -> Image.Image:
    """Open a photo of a known kind and read its header.

    Raises
    ------
    PhotoError
        It is damaged, or has too many pixels.
    """
    try:
        file = io.BufferedReader(WatchedBytes(data, lambda share: report("decode", _READING_SHARE * share)))
        if kind == "HEIF":
            # Imported here because it is slow and rarely needed. It is not registered with Pillow, which callers share.
            from pillow_heif import HeifImageFile

            return HeifImageFile(file)  # type: ignore[no-untyped-call]
        return Image.open(file, formats=(kind,))
    except Image.DecompressionBombError as error:
        raise PhotoError(
            f"{name}: the photo has more than {MAX_PIXELS / 1e6:.0f} megapixels, which is not allowed; resize it",
            code="photo_too_many_pixels",
        ) from error
    except UNREADABLE as error:
        fault = f"this {NAMES[kind]} is damaged, or of an unsupported variant; copy it again, or save it as JPEG"
        raise PhotoError(f"{name}: {fault}") from error


def _check_one_frame(image: Image.Image, kind: str, data: bytes, name: str) -> None:
    """Reject animations and documents of several pages.

    JPEG and HEIC may hold further pictures beside the photo (depth, gain map, other shots of a burst): these do not
    count as frames.
    """
    several = ""
    if kind == "TIFF":
        several = "several pages" if _has_second_page(image) else ""
    elif kind == "HEIF":
        several = "several frames" if is_sequence(data) else ""
    elif kind != "JPEG" and getattr(image, "n_frames", 1) > 1:
        several = f"{getattr(image, 'n_frames', 2)} frames"
    if several:
        raise PhotoError(f"{name}: the photo has {several}; save one of them by itself", code="photo_animated")


def _has_second_page(image: Image.Image) -> bool:
    """Look for a second page; there may be millions, so they are not counted."""
    try:
        image.seek(1)
    except EOFError:
        return False
    return True


def _check_complete(image: Image.Image, ending: Ending, name: str, warn: Warn) -> None:
    """Reject a JPEG that lacks part of its picture; warn of one that lacks next to nothing."""
    with Image.open(io.BytesIO(ending.filled_with_noise()), formats=("JPEG",)) as noisy:
        share, first = missing_part(image, noisy)
    if ending.is_coarse and not ending.marked:
        missing = "the finer detail of the picture"
    else:
        missing = f"{max(1, round(100 * max(share, 1 - first / image.height)))} % of the picture"
    if share > MAX_LOST or (ending.is_coarse and not ending.marked):
        raise PhotoError(f"{name}: the photo is cut short: {missing} is missing; save or copy it again")
    if share > 0 or not ending.marked:
        part = (
            "nothing of its picture" if share < MAX_LOST / 100 else f"no more than {100 * share:.2f} % of its picture"
        )
        detail = f"the photo's file is cut short, but {part} is missing; if you can, save or copy it again"
        warn(StrokeWarning("photo_cut_short", "photo", detail))


def _pixels(image: Image.Image, report: Report) -> Picture:
    """Convert a picture to upright sRGB (h, w, 3), or (h, w, 4) where some of it is transparent, strip by strip."""
    orientation, (width, height) = _orientation(image), image.size
    channels = 4 if image.has_transparency_data else 3
    sides = (width, height) if orientation in _SIDEWAYS else (height, width)
    upright = np.empty((*sides, channels), dtype=np.uint8)
    rows = max(1, _STRIP_PIXELS // width)
    for top in range(0, height, rows):
        bottom = min(top + rows, height)
        strip = _plain(image.crop((0, top, width, bottom)), image.info.get("icc_profile"))
        turned = np.asarray(strip.transpose(_TURNS[orientation]) if orientation in _TURNS else strip)
        place = slice(height - bottom, height - top) if orientation in _BACKWARD else slice(top, bottom)
        upright[(slice(None), place) if orientation in _SIDEWAYS else place] = turned
        report("decode", _READING_SHARE + (1 - _READING_SHARE) * bottom / height)
    is_opaque = channels == 3 or bool((upright[..., 3] == 255).all())
    return np.ascontiguousarray(upright[..., :3]) if is_opaque else upright


def _orientation(image: Image.Image) -> int:
    """Read a picture's EXIF orientation; 1 for HEIC, which Pillow's plugin turns upright by itself."""
    if image.format == "HEIF":
        return 1
    try:
        return int(image.getexif().get(_ORIENTATION, 1))
    except UNREADABLE:
        return 1


def _plain(image: Image.Image, profile: bytes | None) -> Image.Image:
    """Convert any mode to sRGB, 8 bit, with alpha where it has transparency; what is not seen at all becomes white."""
    if image.mode.startswith("I"):
        deep = np.asarray(image)
        image = Image.fromarray((np.clip(deep, 0, 65535) >> 8).astype(np.uint8))
    if not image.has_transparency_data:
        plain = image if image.mode in ("RGB", "CMYK", "L") else image.convert("RGB")
        return _in_srgb(plain, profile)
    layered = image.convert("RGBA")
    colours = _in_srgb(layered.convert("RGB"), profile)
    alpha = layered.getchannel("A")
    seen = Image.new("RGB", layered.size, "white")
    seen.paste(colours, mask=alpha.point(lambda opacity: 255 if opacity else 0))
    seen.putalpha(alpha)
    return seen


def _in_srgb(image: Image.Image, profile: bytes | None) -> Image.Image:
    """Convert a picture by its ICC profile to sRGB; without one, or with a broken one, only its mode."""
    if profile:
        try:
            source = ImageCms.ImageCmsProfile(io.BytesIO(profile))
            converted = ImageCms.profileToProfile(image, source, _SRGB, outputMode="RGB")
        except (ImageCms.PyCMSError, OSError, TypeError, ValueError):
            return image.convert("RGB")
        if converted is not None:
            return converted
    return image if image.mode == "RGB" else image.convert("RGB")


def _shortened(error: BaseException) -> str:
    """Return an error's message in one line of at most 80 characters."""
    return " ".join(str(error).split())[:80] or type(error).__name__
