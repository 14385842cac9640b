import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageCms

from treestroke.codec.image import MAX_BYTES, check_size, decode_photo, encode_png
from treestroke.core.errors import PhotoError

UPRIGHT = np.zeros((80, 100, 3), dtype=np.uint8)
UPRIGHT[:40, :50] = (250, 10, 10)
UPRIGHT[40:, 50:] = (10, 10, 250)

# How a camera that was held so stores the upright picture.
STORED = {
    1: lambda a: a,
    2: lambda a: a[:, ::-1],
    3: lambda a: a[::-1, ::-1],
    4: lambda a: a[::-1],
    5: lambda a: a.transpose(1, 0, 2),
    6: lambda a: np.rot90(a),
    7: lambda a: a[::-1, ::-1].transpose(1, 0, 2),
    8: lambda a: np.rot90(a, -1),
}


def encoded(image: Image.Image, kind: str, **options: object) -> bytes:
    out = io.BytesIO()
    image.save(out, format=kind, **options)
    return out.getvalue()


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_every_exif_orientation_gives_the_same_upright_picture(orientation: int, kind: str) -> None:
    image = Image.fromarray(np.ascontiguousarray(STORED[orientation](UPRIGHT)))
    exif = Image.Exif()
    exif[0x0112] = orientation
    found = decode_photo(encoded(image, kind, exif=exif, quality=100), "photo")
    assert found.shape == UPRIGHT.shape
    assert np.abs(found[5:35, 5:45].astype(int) - UPRIGHT[5:35, 5:45]).max() < 20
    assert np.abs(found[45:75, 55:95].astype(int) - UPRIGHT[45:75, 55:95]).max() < 20


def test_a_lossless_photo_comes_back_as_it_was() -> None:
    assert np.array_equal(decode_photo(encode_png(UPRIGHT), "photo"), UPRIGHT)


def test_alpha_is_laid_over_white() -> None:
    layered = np.zeros((64, 64, 4), dtype=np.uint8)
    layered[:, 32:, 3] = 255
    found = decode_photo(encoded(Image.fromarray(layered), "PNG"), "photo")
    assert (found[:, :32] == 255).all()
    assert (found[:, 32:] == 0).all()


def test_a_palette_with_a_transparent_colour_is_laid_over_white() -> None:
    image = Image.new("P", (64, 64), 1)
    image.putpalette([0, 0, 0, 200, 0, 0])
    found = decode_photo(encoded(image, "PNG", transparency=1), "photo")
    assert (found == 255).all()


def test_sixteen_bit_grey_keeps_its_brightness() -> None:
    deep = np.full((64, 64), 0x8040, dtype=np.uint16)
    assert (decode_photo(encoded(Image.fromarray(deep), "PNG"), "photo") == 0x80).all()


@pytest.mark.parametrize(
    ("mode", "colour"), [("L", 128), ("1", 1), ("LA", (128, 255)), ("P", 0), ("RGBA", (9, 9, 9, 255))]
)
def test_every_png_mode_gives_three_channels(mode: str, colour: object) -> None:
    assert decode_photo(encoded(Image.new(mode, (64, 70), colour), "PNG"), "photo").shape == (70, 64, 3)


def test_a_cmyk_jpeg_keeps_its_colour() -> None:
    image = Image.new("RGB", (64, 64), (200, 30, 30)).convert("CMYK")
    red, green, blue = decode_photo(encoded(image, "JPEG", quality=100), "photo")[30, 30].tolist()
    assert red > 150
    assert max(green, blue) < 90


def test_an_icc_profile_is_honoured() -> None:
    lab = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    plain = encoded(Image.fromarray(UPRIGHT), "PNG", icc_profile=lab)
    assert np.abs(decode_photo(plain, "photo").astype(int) - UPRIGHT).max() <= 1


def test_a_broken_icc_profile_is_ignored() -> None:
    data = encoded(Image.fromarray(UPRIGHT), "PNG", icc_profile=b"nonsense")
    assert np.array_equal(decode_photo(data, "photo"), UPRIGHT)


@pytest.mark.parametrize("kind", ["GIF", "TIFF", "BMP"])
def test_another_format_is_refused_by_name(kind: str) -> None:
    with pytest.raises(PhotoError, match=r"^tree\.x: this is no JPEG, PNG or WebP"):
        decode_photo(encoded(Image.new("RGB", (64, 64)), kind), "tree.x")


@pytest.mark.parametrize("data", [b"", b"x" * 100, b"\xff\xd8\xff\xe0"])
def test_what_is_no_picture_is_refused(data: bytes) -> None:
    with pytest.raises(PhotoError):
        decode_photo(data, "photo")


@pytest.mark.parametrize("kind", ["PNG", "WEBP"])
def test_a_moving_picture_is_refused(kind: str) -> None:
    frames = [Image.new("RGB", (64, 64), colour) for colour in ("red", "blue")]
    with pytest.raises(PhotoError, match="2 frames"):
        decode_photo(encoded(frames[0], kind, save_all=True, append_images=frames[1:]), "photo")


@pytest.mark.parametrize(("width", "height"), [(64, 64), (16_384, 64), (10_000, 5_000)])
def test_sizes_at_the_bounds_are_taken(width: int, height: int) -> None:
    check_size(width, height, "photo")


@pytest.mark.parametrize(("width", "height"), [(63, 64), (64, 63), (16_385, 64), (10_000, 5_001)])
def test_sizes_beyond_the_bounds_are_refused(width: int, height: int) -> None:
    with pytest.raises(PhotoError, match="photo: the photo"):
        check_size(width, height, "photo")


def test_a_bomb_is_judged_by_its_header() -> None:
    data = bytearray(encode_png(UPRIGHT))
    data[16:24] = (15_000).to_bytes(4, "big") * 2
    with pytest.raises(PhotoError, match="megapixels|can be read"):
        decode_photo(bytes(data), "photo")


def test_a_huge_file_is_refused_before_decoding() -> None:
    with pytest.raises(PhotoError, match="25 MB"):
        decode_photo(bytes(MAX_BYTES + 1), "photo")


@pytest.mark.parametrize("share", [0.02, 0.3, 0.9])
@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_a_photo_cut_short_is_refused(maple_photo: Path, kind: str, share: float) -> None:
    data = encoded(Image.open(maple_photo).resize((200, 180)), kind)
    with pytest.raises(PhotoError):
        decode_photo(data[: int(share * len(data))], "photo")


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_damage_is_refused_or_decoded_but_never_breaks(maple_photo: Path, kind: str) -> None:
    data = encoded(Image.open(maple_photo).resize((80, 70)), kind)
    rng = np.random.default_rng(0)
    for _ in range(60):
        broken = bytearray(data)
        for place in rng.integers(0, len(data), 5):
            broken[place] ^= int(rng.integers(1, 256))
        try:
            assert decode_photo(bytes(broken), "photo").dtype == np.uint8
        except PhotoError as error:
            assert "\n" not in str(error)
