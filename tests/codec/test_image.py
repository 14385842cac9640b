import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageCms

import treestroke.codec.image
from treestroke.codec.image import (
    MAX_BYTES,
    check_size,
    decode_fruit,
    decode_leaf,
    decode_photo,
    decode_stored,
    encode_png,
    encode_stored,
)
from treestroke.core.errors import FruitError, LeafError, PhotoError

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
    with pytest.raises(PhotoError, match="2 frames") as refused:
        decode_photo(encoded(frames[0], kind, save_all=True, append_images=frames[1:]), "photo")
    assert refused.value.code == "photo_animated"


@pytest.mark.parametrize(("width", "height"), [(64, 64), (16_384, 64), (10_000, 5_000)])
def test_sizes_at_the_bounds_are_taken(width: int, height: int) -> None:
    check_size(width, height, "photo")


@pytest.mark.parametrize(
    ("width", "height", "code"),
    [
        (63, 64, "photo_too_small"),
        (64, 63, "photo_too_small"),
        (16_385, 64, "photo_side_too_long"),
        (10_000, 5_001, "photo_too_many_pixels"),
    ],
)
def test_sizes_beyond_the_bounds_are_refused(width: int, height: int, code: str) -> None:
    with pytest.raises(PhotoError, match="photo: the photo") as refused:
        check_size(width, height, "photo")
    assert refused.value.code == code


def ftyp(*brands: bytes) -> bytes:
    return (8 + 4 * len(brands)).to_bytes(4, "big") + b"ftyp" + b"".join(brands) + bytes(200)


@pytest.mark.parametrize(
    ("data", "code", "message"),
    [
        (ftyp(b"heic", bytes(4), b"mif1"), "format_not_allowed", "but HEIC; export it as JPEG$"),
        (ftyp(b"mif1", bytes(4), b"avif", b"mif1"), "format_not_allowed", "but AVIF; export it as JPEG$"),
        (ftyp(b"isom", bytes(4)), "format_not_allowed", "save it as one$"),
        (b"RIFF\x10\0\0\0WAVEfmt ", "format_not_allowed", "save it as one$"),
        (b"RIFF\x10\0\0\0WEBPVP8 ", "photo_unreadable", "save it as one$"),
        (b"GIF89a", "format_not_allowed", "save it as one$"),
        (b"\xff\xd8\xff\xe0", "photo_unreadable", "save it as one$"),
        (encode_png(UPRIGHT)[:-30], "photo_unreadable", "damaged or cut short"),
        (bytes(MAX_BYTES + 1), "photo_too_large_file", "more than 25 MB"),
    ],
)
def test_a_refusal_says_for_programs_what_is_wrong(data: bytes, code: str, message: str) -> None:
    with pytest.raises(PhotoError, match=message) as refused:
        decode_photo(data, "photo")
    assert refused.value.code == code


def test_a_stored_photo_comes_back_as_it_was(maple_photo: Path) -> None:
    photo = decode_photo(maple_photo.read_bytes(), "photo")
    stored = encode_stored(photo)
    assert np.array_equal(decode_stored(stored), photo)
    assert {kind for kind in (b"tEXt", b"eXIf", b"iCCP", b"tIME", b"pHYs") if kind in stored} == set()


def test_a_stored_photo_may_be_larger_than_an_upload(maple_photo: Path) -> None:
    stored = encode_png(UPRIGHT) + bytes(MAX_BYTES)
    assert np.array_equal(decode_stored(stored), UPRIGHT)


@pytest.mark.parametrize("tile", [(1, 1500), (1, 700), (40, 50), (700, 1), (1, 12_000)])
def test_what_is_small_as_an_upload_is_not_stored_a_hundred_times_as_large(tile: tuple[int, int]) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (*tile, 3), dtype=np.uint8)
    height, width = 700, max(1500, tile[1])
    picture = np.ascontiguousarray(np.tile(noise, (height, -(-width // tile[1]), 1))[:height, :width])
    stored = encode_stored(picture)
    assert np.array_equal(decode_stored(stored), picture)
    assert len(stored) < 3 * len(encode_png(picture)) < picture.size / 3


def test_an_ordinary_photo_is_stored_in_the_fast_way(maple_photo: Path) -> None:
    photo = decode_photo(maple_photo.read_bytes(), "photo")
    assert 0.7 < len(encode_stored(photo)) / photo.size < 0.8


def in_strips(data: bytes, monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    with monkeypatch.context() as patch:
        patch.setattr(treestroke.codec.image, "_STRIP", 7 * 90)
        return decode_photo(data, "photo")


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "P", "L", "CMYK", "I;16"])
def test_strips_join_to_the_same_picture(maple_photo: Path, mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    given = Image.open(maple_photo).resize((90, 80))
    image = given.convert("L").convert(mode) if mode == "I;16" else given.convert(mode)
    data = encoded(image, "JPEG" if mode == "CMYK" else "PNG", **({"icc_profile": profile} if mode == "RGB" else {}))
    assert np.array_equal(in_strips(data, monkeypatch), decode_photo(data, "photo"))


@pytest.mark.parametrize("orientation", range(1, 9))
def test_strips_are_turned_upright(orientation: int, monkeypatch: pytest.MonkeyPatch) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    data = encoded(Image.fromarray(np.ascontiguousarray(STORED[orientation](UPRIGHT))), "PNG", exif=exif)
    assert np.array_equal(in_strips(data, monkeypatch), UPRIGHT)


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_decoding_tells_how_far_it_is(maple_photo: Path, kind: str) -> None:
    seen: list[tuple[str, float]] = []
    decode_photo(encoded(Image.open(maple_photo), kind), "photo", lambda *told: seen.append(told))
    fractions = [fraction for _, fraction in seen]
    assert {stage for stage, _ in seen} == {"decode"}
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_a_bomb_is_judged_by_its_header() -> None:
    data = bytearray(encode_png(UPRIGHT))
    data[16:24] = (15_000).to_bytes(4, "big") * 2
    with pytest.raises(PhotoError, match="megapixels|can be read") as refused:
        decode_photo(bytes(data), "photo")
    assert refused.value.code in ("photo_too_many_pixels", "photo_unreadable")


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


def leaf_png(alpha: np.ndarray, colour: tuple[int, int, int] = (60, 120, 40)) -> bytes:
    pixels = np.dstack([np.full((*alpha.shape, 3), colour, np.uint8), alpha.astype(np.uint8)])
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


def disc_alpha(side: int = 64) -> np.ndarray:
    y, x = np.mgrid[:side, :side] + 0.5 - side / 2
    return np.where(np.hypot(x, y) < 0.4 * side, 255, 0)


def test_a_leaf_keeps_its_colour_and_its_alpha() -> None:
    leaf = decode_leaf(leaf_png(disc_alpha()), "leaf.png")
    assert leaf.shape == (64, 64, 4)
    assert leaf[32, 32].tolist() == [60, 120, 40, 255]
    assert leaf[0, 0, 3] == 0


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"", "leaf_unreadable"),
        (b"no picture", "leaf_unreadable"),
        (leaf_png(disc_alpha())[:200], "leaf_unreadable"),
        (leaf_png(disc_alpha(8)), "leaf_size"),
        (leaf_png(np.full((64, 64), 255)), "leaf_not_cut_out"),
        (leaf_png(np.zeros((64, 64))), "leaf_not_cut_out"),
        (b"\x89PNG" + bytes(4_000_000), "leaf_too_large"),
    ],
    ids=["empty", "text", "cut short", "tiny", "opaque", "clear", "large"],
)
def test_what_is_no_leaf_cut_out_is_refused(data: bytes, code: str) -> None:
    with pytest.raises(LeafError, match=r"^leaf\.png: ") as refused:
        decode_leaf(data, "leaf.png")
    assert refused.value.code == code


def test_a_fruit_is_read_as_a_leaf_and_refused_by_its_own_name() -> None:
    assert decode_fruit(leaf_png(disc_alpha()), "fruit").shape == (64, 64, 4)
    with pytest.raises(FruitError, match="no fruit: all is clear; cut the fruit out") as refused:
        decode_fruit(leaf_png(np.zeros((64, 64))), "fruit")
    assert refused.value.code == "fruit_not_cut_out"
