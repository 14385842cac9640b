"""Photos: bytes in, upright sRGB pixels out."""

import io
import struct
import warnings
import zlib

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms

from treestroke.core.errors import PhotoError

Picture = NDArray[np.uint8]

MAX_BYTES = 25_000_000
MIN_SIDE, MAX_SIDE = 64, 16_384
MAX_PIXELS = 50_000_000

_FORMATS = ("JPEG", "PNG", "WEBP")
_DAMAGED = (OSError, SyntaxError, ValueError, EOFError, IndexError, KeyError, TypeError, struct.error, zlib.error)
"""What Pillow's decoders raise on files that break their format."""
_ORIENTATION = 0x0112
_UPRIGHT = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}
_SRGB = ImageCms.createProfile("sRGB")


def decode_photo(data: bytes, name: str) -> Picture:
    """Decode a JPEG, PNG or WebP photo to (h, w, 3) uint8 sRGB, upright by EXIF, alpha over white.

    An ICC profile is honoured (a broken one is ignored); 16 bits a channel become 8; ``name`` appears in messages.
    The size is judged from the header, before any pixel is decoded.

    Raises
    ------
    PhotoError
        Another format, damaged, more than one frame, too small or too large.
    """
    if len(data) > MAX_BYTES:
        raise PhotoError(f"{name}: the photo has more than {MAX_BYTES // 10**6} MB; save it smaller")
    # Pillow speaks of odd metadata by warnings, which say nothing about the pixels.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return _decoded(data, name)


def check_size(width: int, height: int, name: str) -> None:
    """Refuse a photo of a size, px, that is out of bounds.

    Raises
    ------
    PhotoError
        A side or the number of pixels is out of bounds.
    """
    if min(width, height) < MIN_SIDE or max(width, height) > MAX_SIDE:
        raise PhotoError(
            f"{name}: the photo is {width} x {height} px, each side must be {MIN_SIDE} to {MAX_SIDE} px; resize it"
        )
    if width * height > MAX_PIXELS:
        raise PhotoError(
            f"{name}: the photo has {width * height / 1e6:.1f} megapixels, at most {MAX_PIXELS / 1e6:.0f} are allowed; "
            "resize it"
        )


def encode_png(picture: Picture) -> bytes:
    """Encode a picture (h, w, 3) uint8 as PNG."""
    out = io.BytesIO()
    Image.fromarray(picture).save(out, format="PNG")
    return out.getvalue()


def _decoded(data: bytes, name: str) -> Picture:
    image = _opened(data, name)
    check_size(image.width, image.height, name)
    try:
        # A JPEG may carry further pictures (depth, gain map) behind the photo; those are no frames of it.
        if image.format != "MPO" and getattr(image, "n_frames", 1) > 1:
            raise PhotoError(
                f"{name}: the photo has {getattr(image, 'n_frames', 2)} frames; save one of them by itself"
            )
        image.load()
    except _DAMAGED as error:
        raise PhotoError(
            f"{name}: the photo is damaged or cut short ({_brief(error)}); save or copy it anew"
        ) from error
    return np.ascontiguousarray(_upright(_over_white(image), image))


def _opened(data: bytes, name: str) -> Image.Image:
    try:
        return Image.open(io.BytesIO(data), formats=_FORMATS)
    except Image.DecompressionBombError as error:
        raise PhotoError(
            f"{name}: the photo has more than {MAX_PIXELS / 1e6:.0f} megapixels, which is not allowed; resize it"
        ) from error
    except _DAMAGED as error:
        raise PhotoError(f"{name}: this is no JPEG, PNG or WebP photo that can be read; save it as one") from error


def _over_white(image: Image.Image) -> Image.Image:
    """Bring any mode to sRGB, 8 bit, without alpha."""
    profile = image.info.get("icc_profile")
    if image.mode.startswith("I"):
        deep = np.asarray(image)
        image = Image.fromarray((np.clip(deep, 0, 65535) >> 8).astype(np.uint8))
    if not image.has_transparency_data:
        plain = image if image.mode in ("RGB", "CMYK", "L") else image.convert("RGB")
        return _in_srgb(plain, profile)
    layered = image.convert("RGBA")
    colours = _in_srgb(layered.convert("RGB"), profile)
    white = Image.new("RGB", layered.size, "white")
    white.paste(colours, mask=layered.getchannel("A"))
    return white


def _in_srgb(image: Image.Image, profile: bytes | None) -> Image.Image:
    if profile:
        try:
            source = ImageCms.ImageCmsProfile(io.BytesIO(profile))
            converted = ImageCms.profileToProfile(image, source, _SRGB, outputMode="RGB")
        except (ImageCms.PyCMSError, OSError, TypeError, ValueError):
            return image.convert("RGB")
        if converted is not None:
            return converted
    return image.convert("RGB")


def _upright(picture: Image.Image, source: Image.Image) -> Image.Image:
    try:
        orientation = source.getexif().get(_ORIENTATION, 1)
    except _DAMAGED:
        return picture
    turn = _UPRIGHT.get(orientation)
    return picture if turn is None else picture.transpose(turn)


def _brief(error: BaseException) -> str:
    return " ".join(str(error).split())[:80] or type(error).__name__
