"""Photos that nobody means well with, made by hand."""

import io
import struct
import zipfile
import zlib
from collections.abc import Iterable

import numpy as np
import pillow_heif
from PIL import Image, ImageCms
from tests.api import drawn

TAIL = b"<html><script>alert(1)</script></html>"
PRIVATE = (b"GPS", b"Canon", b"secret", b"http", b"Exif", b"ICC", b"tEXt", b"eXIf", TAIL)
_ORIENTATION, _GPS, _XMP = 0x0112, 0x8825, 700
_TURNS = {
    1: None,
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_90,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_270,
}
"""How a camera that was held so had its sensor see the upright picture."""


def picture() -> Image.Image:
    """Give the drawn tree."""
    return Image.fromarray(drawn.pixels())


def saved(image: Image.Image, kind: str, **options: object) -> bytes:
    """Encode a picture."""
    out = io.BytesIO()
    if kind != "HEIF":
        image.save(out, kind, **options)
        return out.getvalue()
    exif = options.get("exif")
    if isinstance(exif, Image.Exif):
        options["exif"] = exif.tobytes()
    pillow_heif.from_pillow(image).save(out, chroma=444, **options)
    return out.getvalue()


def turned(orientation: int) -> bytes:
    """Save the picture as a camera that was turned does: its pixels turned, and a note how."""
    turn = _TURNS[orientation]
    image = picture() if turn is None else picture().transpose(turn)
    exif = Image.Exif()
    exif[_ORIENTATION] = orientation
    return saved(image, "PNG", exif=exif)


def talkative(kind: str = "JPEG") -> bytes:
    """Save a photo that tells where, when and with what it was taken, and has a tail of another kind."""
    exif = Image.Exif()
    exif[0x010F], exif[_ORIENTATION] = "Canon", 1
    exif[_GPS] = {1: "N", 2: (52.0, 31.0, 12.0), 3: "E", 4: (13.0, 24.0, 36.0)}
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    notes = {"comment": b"a secret comment"} if kind == "JPEG" else {}
    xmp = {} if kind == "TIFF" else {"xmp": b"<x>secret</x>"}
    if kind == "TIFF":
        exif[_XMP] = b"<x>secret</x>"
    return (
        saved(picture(), kind, quality=95, exif=exif.tobytes(), icc_profile=profile, **notes, **xmp) + polyglot_tail()
    )


def polyglot_tail() -> bytes:
    """Give a ZIP with a page in it, and the page again."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr("index.html", TAIL)
    return out.getvalue() + TAIL


def chunk(kind: bytes, content: bytes) -> bytes:
    """Write one PNG chunk."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def flat_png(width: int, height: int, rows: int | None = None) -> bytes:
    """Write a PNG of one colour: tiny, however many pixels its header speaks of."""
    packer = zlib.compressobj(9)
    row = bytes(1 + width)
    packed = b"".join(packer.compress(row) for _ in range(height if rows is None else rows)) + packer.flush()
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


def tall_jpeg(width: int, height: int) -> bytes:
    """Give a small JPEG whose header speaks of another size."""
    content = bytearray(saved(picture(), "JPEG"))
    at = content.index(b"\xff\xc0") + 5
    content[at : at + 4] = struct.pack(">HH", height, width)
    return bytes(content)


def stuffed_png(*chunks: bytes) -> bytes:
    """Put chunks behind the header of a sound PNG."""
    content = saved(picture(), "PNG")
    return content[:33] + b"".join(chunks) + content[33:]


def text_chunks(count: int) -> bytes:
    """Write many chunks of text."""
    return b"".join(chunk(b"tEXt", b"Comment\0" + bytes([65 + at % 26]) * 60) for at in range(count))


def bomb(kind: bytes, beginning: bytes, size: int = 400_000_000) -> bytes:
    """Write a chunk that is small and would be ``size`` bytes."""
    packer = zlib.compressobj(9)
    block = bytes(1_000_000)
    packed = b"".join(packer.compress(block) for _ in range(size // len(block))) + packer.flush()
    return chunk(kind, beginning + packed)


def foreign() -> dict[str, bytes]:
    """Give files of kinds that are no photos of ours."""
    image = picture()
    svg = b'<svg xmlns="a"><script>alert(1)</script><rect width="99" height="99"/></svg>'
    return {
        "eps": saved(image, "EPS"),
        "svg": svg,
        "pdf": saved(image, "PDF"),
        "raw": saved(image, "TIFF", tiffinfo={50706: b"\1\4\0\0"}),
        "psd": b"8BPS\0\x01" + bytes(6) + struct.pack(">HIIHH", 3, 240, 200, 8, 3) + bytes(200),
        "jp2": saved(image, "JPEG2000"),
        "gif": saved(image, "GIF"),
        "bmp": saved(image, "BMP"),
        "ico": saved(image.crop((0, 0, 64, 64)), "ICO"),
        "zip": polyglot_tail(),
        "html": TAIL,
        "text": b"no photo",
        "zeros": bytes(5000),
        "empty": b"",
    }


def animated() -> dict[str, bytes]:
    """Give pictures of several frames."""
    frames = [picture(), Image.fromarray(drawn.pixels(1))]
    return {kind: saved(frames[0], kind, save_all=True, append_images=frames[1:]) for kind in ("WEBP", "PNG")}


def phones() -> dict[str, bytes]:
    """Give the beginnings of what phones save by default, without the rest."""
    brands = {"HEIC": b"heic", "HEIC image": b"mif1", "AVIF": b"avif"}
    return {
        name: struct.pack(">I", 24) + b"ftyp" + brand + bytes(4) + brand + b"miaf" + bytes(500)
        for name, brand in brands.items()
    }


def modes() -> dict[str, tuple[bytes, np.ndarray]]:
    """Give photos in all modes, and the pixels that each is to come out as."""
    image = picture()
    plain = np.asarray(image)
    grey = np.asarray(image.convert("L"))
    half = np.full(plain.shape[:2], 128, np.uint8)
    alpha = Image.fromarray(np.dstack([plain, half]))
    white = np.round((plain * 128.0 + 255.0 * 127.0) / 255.0)
    palette = image.quantize(64)
    deep = Image.fromarray(grey.astype(np.uint16) * 257)
    return {
        "gray": (saved(image.convert("L"), "PNG"), np.dstack([grey] * 3)),
        "16 bit": (saved(deep, "PNG"), np.dstack([grey] * 3)),
        "palette": (saved(palette, "PNG"), np.asarray(palette.convert("RGB"))),
        "alpha": (saved(alpha, "PNG"), white),
        "alpha in WebP": (saved(alpha, "WEBP", lossless=True), white),
        "CMYK": (saved(image.convert("CMYK"), "JPEG", quality=100, subsampling=0), plain),
    }


def wide_profile() -> bytes:
    """Write an ICC profile of Display P3's primaries (adapted to D50), with a gamma of 2.2 (ICC.1:2001, 6)."""

    def fixed(*values: float) -> bytes:
        return struct.pack(f">{len(values)}i", *(round(value * 65_536) for value in values))

    def place(*values: float) -> bytes:
        return b"XYZ \0\0\0\0" + fixed(*values)

    tags = {
        b"rXYZ": place(0.51512, 0.24120, -0.00105),
        b"gXYZ": place(0.29198, 0.69225, 0.04189),
        b"bXYZ": place(0.15710, 0.06657, 0.78407),
        b"wtpt": place(0.96420, 1.0, 0.82491),
        b"cprt": b"text\0\0\0\0none",
        b"desc": b"desc\0\0\0\0" + struct.pack(">I", 3) + b"P3\0" + bytes(79),
        **dict.fromkeys(
            (b"rTRC", b"gTRC", b"bTRC"), b"curv\0\0\0\0" + struct.pack(">IH", 1, round(2.2 * 256)) + b"\0\0"
        ),
    }
    table, content = struct.pack(">I", len(tags)), b""
    for name, tag in tags.items():
        padded = tag + bytes(-len(tag) % 4)
        table += name + struct.pack(">II", 128 + 4 + 12 * len(tags) + len(content), len(tag))
        content += padded
    size = 128 + len(table) + len(content)
    head = struct.pack(">I4xI4s4s4s", size, 0x02400000, b"mntr", b"RGB ", b"XYZ ") + bytes(12) + b"acsp"
    return head + bytes(68 - len(head)) + fixed(0.9642, 1.0, 0.8249) + bytes(48) + table + content


def cuts(content: bytes, count: int = 20) -> Iterable[bytes]:
    """Cut a file short at ``count`` places."""
    return [content[: len(content) * at // (count + 1)] for at in range(1, count + 1)]
