import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pillow_heif
import pytest
from PIL import Image, ImageCms, ImageFile
from tests.api.corpora import saved, wide_profile

import treestroke.codec.image
from treestroke.codec.image import (
    check_size,
    decode_cutout,
    decode_photo,
    decode_stored,
    encode_png,
    encode_stored,
)
from treestroke.core.errors import FruitError, LeafError, PhotoError
from treestroke.core.imaging.opacity import over_white
from treestroke.core.strokes import StrokeWarning
from treestroke.limits import MAX_PHOTO_BYTES

ELM = Path(__file__).parents[1] / "data" / "elm_house.jpg"
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


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "HEIF", "AVIF", "TIFF"])
def test_every_exif_orientation_gives_the_same_upright_picture(orientation: int, kind: str) -> None:
    image = Image.fromarray(np.ascontiguousarray(STORED[orientation](UPRIGHT)))
    exif = Image.Exif()
    exif[0x0112] = orientation
    found = decode_photo(saved(image, kind, exif=exif, quality=100), "photo")
    assert found.shape == UPRIGHT.shape
    assert np.abs(found[5:35, 5:45].astype(int) - UPRIGHT[5:35, 5:45]).max() < 20
    assert np.abs(found[45:75, 55:95].astype(int) - UPRIGHT[45:75, 55:95]).max() < 20


def test_a_lossless_photo_comes_back_as_it_was() -> None:
    assert np.array_equal(decode_photo(encode_png(UPRIGHT), "photo"), UPRIGHT)


def test_alpha_is_kept_and_what_is_not_seen_is_white() -> None:
    layered = np.zeros((64, 64, 4), dtype=np.uint8)
    layered[:, 20:, 3] = 100
    layered[:, 32:, 3] = 255
    found = decode_photo(saved(Image.fromarray(layered), "PNG"), "photo")
    assert np.array_equal(found[..., 3], layered[..., 3])
    assert (found[:, :20, :3] == 255).all()
    assert (found[:, 20:, :3] == 0).all()
    laid = over_white(found)
    assert (laid[:, :20] == 255).all()
    assert (laid[:, 20:32] == 155).all()
    assert (laid[:, 32:] == 0).all()


def test_a_stored_cut_out_comes_back_as_it_was() -> None:
    noise = np.random.default_rng(0).integers(1, 256, (70, 64, 4), dtype=np.uint8)
    found = decode_photo(saved(Image.fromarray(noise), "PNG"), "photo")
    assert np.array_equal(found, noise)
    assert np.array_equal(decode_stored(encode_stored(found)), noise)


def test_a_palette_with_a_transparent_colour_is_laid_over_white() -> None:
    image = Image.new("P", (64, 64), 1)
    image.putpalette([0, 0, 0, 200, 0, 0])
    found = over_white(decode_photo(saved(image, "PNG", transparency=1), "photo"))
    assert (found == 255).all()


def test_sixteen_bit_grey_keeps_its_brightness() -> None:
    deep = np.full((64, 64), 0x8040, dtype=np.uint16)
    assert (decode_photo(saved(Image.fromarray(deep), "PNG"), "photo") == 0x80).all()


@pytest.mark.parametrize(
    ("mode", "colour"), [("L", 128), ("1", 1), ("LA", (128, 255)), ("P", 0), ("RGBA", (9, 9, 9, 255))]
)
def test_every_png_mode_gives_three_channels(mode: str, colour: object) -> None:
    assert decode_photo(saved(Image.new(mode, (64, 70), colour), "PNG"), "photo").shape == (70, 64, 3)


def test_a_cmyk_jpeg_keeps_its_colour() -> None:
    image = Image.new("RGB", (64, 64), (200, 30, 30)).convert("CMYK")
    red, green, blue = decode_photo(saved(image, "JPEG", quality=100), "photo")[30, 30].tolist()
    assert red > 150
    assert max(green, blue) < 90


def test_an_icc_profile_is_honoured() -> None:
    lab = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    plain = saved(Image.fromarray(UPRIGHT), "PNG", icc_profile=lab)
    assert np.abs(decode_photo(plain, "photo").astype(int) - UPRIGHT).max() <= 1


def test_a_broken_icc_profile_is_ignored() -> None:
    data = saved(Image.fromarray(UPRIGHT), "PNG", icc_profile=b"nonsense")
    assert np.array_equal(decode_photo(data, "photo"), UPRIGHT)


@pytest.mark.parametrize("data", [b"", b"x" * 100, b"\xff\xd8\xff\xe0"])
def test_what_is_no_picture_is_refused(data: bytes) -> None:
    with pytest.raises(PhotoError):
        decode_photo(data, "photo")


@pytest.mark.parametrize("kind", ["PNG", "WEBP", "AVIF"])
def test_a_moving_picture_is_refused(kind: str) -> None:
    frames = [Image.new("RGB", (64, 64), colour) for colour in ("red", "blue")]
    with pytest.raises(PhotoError, match="2 frames") as refused:
        decode_photo(saved(frames[0], kind, save_all=True, append_images=frames[1:]), "photo")
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
        (ftyp(b"heic", bytes(4), b"mif1"), "photo_unreadable", "this HEIC is damaged.*save it as JPEG$"),
        (ftyp(b"mif1", bytes(4), b"avif", b"mif1"), "photo_unreadable", "this AVIF is damaged.*save it as JPEG$"),
        (ftyp(b"isom", bytes(4)), "format_not_allowed", "save one of its frames as JPEG$"),
        (b"RIFF\x10\0\0\0WAVEfmt ", "format_not_allowed", "not a photo that can be read; save it as JPEG, PNG, WebP"),
        (b"RIFF\x10\0\0\0WEBPVP8 ", "photo_unreadable", "this WebP is damaged"),
        (b"II*\0\x08\0\0\0", "photo_unreadable", "this TIFF is damaged"),
        (b"II+\0\x08\0\0\0" + b"\xff" * 9, "photo_unreadable", "this TIFF is damaged"),
        (b"GIF89a", "format_not_allowed", "this is a GIF picture.*save it as PNG$"),
        (b"\xff\xd8\xff\xe0", "photo_unreadable", "this JPEG is damaged"),
        (encode_png(UPRIGHT)[:-30], "photo_unreadable", "damaged or cut short"),
        (bytes(MAX_PHOTO_BYTES + 1), "photo_too_large_file", "more than 25 MB"),
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
    stored = encode_png(UPRIGHT) + bytes(MAX_PHOTO_BYTES)
    assert np.array_equal(decode_stored(stored), UPRIGHT)


@pytest.mark.parametrize("tile", [(1, 1500), (1, 700), (40, 50), (300, 1), (1, 12_000)])
def test_what_is_small_as_an_upload_is_not_stored_a_hundred_times_as_large(tile: tuple[int, int]) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (*tile, 3), dtype=np.uint8)
    height, width = 300, max(1500, tile[1])
    picture = np.ascontiguousarray(np.tile(noise, (height, -(-width // tile[1]), 1))[:height, :width])
    stored = encode_stored(picture)
    assert np.array_equal(decode_stored(stored), picture)
    assert len(stored) < 3 * len(encode_png(picture)) < picture.size / 3


def test_an_ordinary_photo_is_stored_in_the_fast_way(maple_photo: Path) -> None:
    photo = decode_photo(maple_photo.read_bytes(), "photo")
    assert 0.7 < len(encode_stored(photo)) / photo.size < 0.8


def in_strips(data: bytes, monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    with monkeypatch.context() as patch:
        patch.setattr(treestroke.codec.image, "_STRIP_PIXELS", 7 * 90)
        return decode_photo(data, "photo")


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "P", "L", "CMYK", "I;16"])
def test_strips_join_to_the_same_picture(maple_photo: Path, mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    given = Image.open(maple_photo).resize((90, 80))
    image = given.convert("L").convert(mode) if mode == "I;16" else given.convert(mode)
    data = saved(image, "JPEG" if mode == "CMYK" else "PNG", **({"icc_profile": profile} if mode == "RGB" else {}))
    assert np.array_equal(in_strips(data, monkeypatch), decode_photo(data, "photo"))


@pytest.mark.parametrize("orientation", range(1, 9))
def test_strips_are_turned_upright(orientation: int, monkeypatch: pytest.MonkeyPatch) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    data = saved(Image.fromarray(np.ascontiguousarray(STORED[orientation](UPRIGHT))), "PNG", exif=exif)
    assert np.array_equal(in_strips(data, monkeypatch), UPRIGHT)


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "HEIF", "AVIF", "TIFF"])
def test_decoding_tells_how_far_it_is(maple_photo: Path, kind: str) -> None:
    seen: list[tuple[str, float]] = []
    decode_photo(saved(Image.open(maple_photo), kind), "photo", lambda *told: seen.append(told))
    fractions = [fraction for _, fraction in seen]
    assert {stage for stage, _ in seen} == {"decode"}
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_a_bomb_is_judged_by_its_header() -> None:
    data = bytearray(encode_png(UPRIGHT))
    data[16:24] = (15_000).to_bytes(4, "big") * 2
    with pytest.raises(PhotoError, match="megapixels|unsupported") as refused:
        decode_photo(bytes(data), "photo")
    assert refused.value.code in ("photo_too_many_pixels", "photo_unreadable")


@pytest.mark.parametrize("share", [0.02, 0.3, 0.9])
@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "HEIF", "AVIF", "TIFF"])
def test_a_photo_cut_short_is_refused(maple_photo: Path, kind: str, share: float) -> None:
    data = saved(Image.open(maple_photo).resize((200, 180)), kind)
    with pytest.raises(PhotoError):
        decode_photo(data[: int(share * len(data))], "photo")


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "HEIF", "AVIF", "TIFF"])
def test_damage_is_refused_or_decoded_but_never_breaks(maple_photo: Path, kind: str) -> None:
    data = saved(Image.open(maple_photo).resize((80, 70)), kind)
    rng = np.random.default_rng(0)
    for _ in range(60):
        broken = bytearray(data)
        for place in rng.integers(0, len(data), 5):
            broken[place] ^= int(rng.integers(1, 256))
        try:
            assert decode_photo(bytes(broken), "photo").dtype == np.uint8
        except PhotoError as error:
            assert "\n" not in str(error)


CUT_OFF = (
    ("JPEG", {"quality": 88}),
    ("JPEG", {"quality": 88, "progressive": True}),
    ("JPEG", {"restart_marker_rows": 1}),
)


def elm() -> Image.Image:
    return Image.open(ELM).convert("RGB")


def cut(data: bytes, lost: int) -> tuple[np.ndarray, list[StrokeWarning]]:
    """Decode a photo whose last bytes are lost."""
    warnings: list[StrokeWarning] = []
    return decode_photo(data[: len(data) - lost], "photo", warn=warnings.append), warnings


@pytest.mark.parametrize("lost", [1, 2, 10, 60])
@pytest.mark.parametrize(("kind", "options"), CUT_OFF, ids=["baseline", "progressive", "restarts"])
def test_a_jpeg_that_lacks_its_last_bytes_is_taken_with_a_warning(
    kind: str, options: dict[str, object], lost: int
) -> None:
    data = saved(elm(), kind, **options)
    whole, nothing = cut(data, 0)
    picture, (warning,) = cut(data, lost)
    assert nothing == []
    assert (warning.code, warning.stroke) == ("photo_cut_short", "photo")
    assert "cut short" in warning.detail
    assert "again" in warning.detail
    assert (np.abs(picture.astype(int) - whole).max(axis=2) > 32).mean() < 0.002


def test_a_jpeg_without_its_end_marker_gives_the_same_pixels() -> None:
    data = ELM.read_bytes()
    picture, (warning,) = cut(data, 2)
    assert np.array_equal(picture, decode_photo(data, "photo"))
    assert "nothing of its picture is missing" in warning.detail


@pytest.mark.parametrize("share", [0.03, 0.2, 0.5, 0.9])
@pytest.mark.parametrize(("kind", "options"), [CUT_OFF[0], CUT_OFF[2]], ids=["baseline", "restarts"])
def test_a_jpeg_that_lacks_part_of_its_picture_is_refused_and_told_how_much(
    kind: str, options: dict[str, object], share: float
) -> None:
    data = saved(elm(), kind, **options)
    with pytest.raises(
        PhotoError, match=r"cut short: \d+ % of the picture is missing; save or copy it again$"
    ) as refused:
        cut(data, int(share * len(data)))
    assert refused.value.code == "photo_unreadable"
    assert int(str(refused.value).split("short: ")[1].split()[0]) == pytest.approx(100 * share, abs=15)


@pytest.mark.parametrize("share", [0.5, 0.7, 0.9])
def test_a_progressive_jpeg_that_lacks_whole_passes_is_refused(share: float) -> None:
    data = saved(elm(), "JPEG", quality=88, progressive=True)
    with pytest.raises(PhotoError, match="cut short"):
        cut(data, int(share * len(data)))


def test_half_a_jpeg_is_refused_although_somebody_put_an_end_to_it() -> None:
    data = saved(elm(), "JPEG")
    with pytest.raises(PhotoError, match=r"50 % of the picture is missing"):
        decode_photo(data[: len(data) // 2] + b"\xff\xd9", "photo")


@pytest.mark.parametrize("colour", [(128, 128, 128), (255, 255, 255)])
def test_a_picture_that_ends_in_one_colour_lacks_nothing(colour: tuple[int, int, int]) -> None:
    picture = UPRIGHT.copy()
    picture[20:] = colour
    found, warnings = cut(saved(Image.fromarray(picture), "JPEG"), 0)
    assert warnings == []
    assert np.abs(found[40:].astype(int) - colour).max() <= 2


def test_bytes_behind_a_jpeg_do_not_matter() -> None:
    data = saved(elm(), "JPEG")
    whole, _ = cut(data, 0)
    found, warnings = cut(data + b"PK\x03\x04" * 99, 0)
    assert warnings == []
    assert np.array_equal(found, whole)


def test_a_jpeg_with_further_pictures_may_lack_these() -> None:
    first = elm()
    data = saved(first, "MPO", save_all=True, append_images=[first.rotate(180)])
    whole, _ = cut(data, 0)
    assert np.array_equal(cut(data, len(data) // 4)[0], whole)
    with pytest.raises(PhotoError, match="% of the picture is missing"):
        cut(data, 3 * len(data) // 4)


def test_pillow_is_as_its_user_left_it() -> None:
    Image.init()
    before = (dict(Image.OPEN), ImageFile.LOAD_TRUNCATED_IMAGES)
    cut(saved(elm(), "JPEG"), 2)
    decode_photo(saved(Image.fromarray(UPRIGHT), "HEIF"), "photo")
    assert (dict(Image.OPEN), ImageFile.LOAD_TRUNCATED_IMAGES) == before


def test_who_needs_no_heic_does_not_wait_for_its_decoder() -> None:
    code = f"""
import sys
from treestroke.codec.image import decode_photo
decode_photo(open({str(ELM)!r}, "rb").read(), "photo")
sys.exit("pillow_heif" in sys.modules)
"""
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("kind", ["HEIF", "AVIF", "TIFF"])
def test_what_phones_and_scanners_save_is_read(kind: str) -> None:
    image = elm()
    found = decode_photo(saved(image, kind, quality=95), "photo.jpg")
    assert np.abs(found.astype(int) - np.asarray(image)).mean() < 3


@pytest.mark.parametrize("kind", ["HEIF", "AVIF", "TIFF"])
def test_alpha_of_every_kind_is_laid_over_white(kind: str) -> None:
    layered = np.zeros((64, 64, 4), dtype=np.uint8)
    layered[:, 32:, 3] = 255
    found = over_white(decode_photo(saved(Image.fromarray(layered), kind, quality=100), "photo"))
    assert found[:, :28].min() > 250
    assert found[:, 36:].max() < 5


@pytest.mark.parametrize("kind", ["PNG", "HEIF", "AVIF", "TIFF"])
def test_wide_colours_of_every_kind_become_srgb(kind: str) -> None:
    patches = np.full((64, 64, 3), (180, 120, 60), np.uint8)
    data = saved(Image.fromarray(patches), kind, icc_profile=wide_profile(), quality=100)
    assert np.abs(decode_photo(data, "photo")[32, 32].astype(int) - (192, 117, 40)).max() <= 6


@pytest.mark.parametrize("options", [{}, {"primary_index": 1}])
def test_of_a_burst_its_first_picture_is_taken(options: dict[str, int]) -> None:
    out, other = io.BytesIO(), Image.new("RGB", (90, 70), "green")
    burst = pillow_heif.from_pillow(Image.fromarray(UPRIGHT))
    burst.add_from_pillow(other)
    burst.save(out, **options)
    assert decode_photo(out.getvalue(), "photo").shape == ((70, 90, 3) if options else UPRIGHT.shape)


def test_thumbnails_are_no_frames() -> None:
    data = saved(elm(), "HEIF", thumbnails=[128, 256])
    assert decode_photo(data, "photo").shape == (600, 450, 3)


def test_a_heic_sequence_is_refused() -> None:
    data = saved(Image.fromarray(UPRIGHT), "HEIF")
    with pytest.raises(PhotoError, match="several frames; save one of them by itself") as refused:
        decode_photo(data[:8] + b"hevc" + data[12:], "photo")
    assert refused.value.code == "photo_animated"


def test_a_tiff_of_several_pages_is_refused() -> None:
    pages = [Image.fromarray(UPRIGHT)] * 3
    with pytest.raises(PhotoError, match="several pages; save one of them by itself") as refused:
        decode_photo(saved(pages[0], "TIFF", save_all=True, append_images=pages[1:]), "photo")
    assert refused.value.code == "photo_animated"


@pytest.mark.parametrize(
    "options",
    [
        {"compression": "tiff_lzw"},
        {"compression": "tiff_adobe_deflate"},
        {"compression": "packbits"},
        {"compression": "jpeg", "quality": 100},
        {"big_tiff": True},
        {"compression": "tiff_lzw", "tiffinfo": {322: 64, 323: 64}},
    ],
    ids=["LZW", "deflate", "PackBits", "JPEG", "BigTIFF", "tiled"],
)
def test_every_usual_tiff_is_read(options: dict[str, object]) -> None:
    found = decode_photo(saved(Image.fromarray(UPRIGHT), "TIFF", **options), "photo")
    assert np.abs(found[5:35, 5:45].astype(int) - UPRIGHT[5:35, 5:45]).max() <= 4


@pytest.mark.parametrize(
    ("mode", "colour", "wanted"),
    [
        ("1", 1, (255, 255, 255)),
        ("L", 77, (77, 77, 77)),
        ("LA", (77, 255), (77, 77, 77)),
        ("P", 0, (0, 0, 0)),
        ("I;16", 0x8040, (0x80, 0x80, 0x80)),
        ("I;16B", 0x8040, (0x80, 0x80, 0x80)),
        ("RGBA", (9, 8, 7, 255), (9, 8, 7)),
        ("CMYK", (0, 255, 255, 0), (255, 0, 0)),
        ("YCbCr", (128, 128, 128), (128, 128, 128)),
    ],
)
def test_every_mode_of_tiff_gives_three_channels(mode: str, colour: object, wanted: tuple[int, int, int]) -> None:
    found = decode_photo(saved(Image.new(mode, (64, 70), colour), "TIFF"), "photo")
    assert found.shape == (70, 64, 3)
    assert np.abs(found[30, 30].astype(int) - wanted).max() <= 3


@pytest.mark.parametrize(("mode", "what"), [("F", "floating-point"), ("I", "32-bit"), ("LAB", "Lab")])
def test_pixels_that_mean_no_one_colour_are_refused_by_name(mode: str, what: str) -> None:
    with pytest.raises(PhotoError, match=f"{what} pixels; save it as RGB or grey") as refused:
        decode_photo(saved(Image.new(mode, (64, 70)), "TIFF"), "photo")
    assert refused.value.code == "format_not_allowed"


def test_ten_bits_a_channel_become_eight() -> None:
    deep = np.full((64, 64, 3), 0x8000, np.uint16)
    out = io.BytesIO()
    pillow_heif.encode("RGB;16", (64, 64), deep.tobytes(), out, quality=100, chroma=444)
    assert np.abs(decode_photo(out.getvalue(), "photo").astype(int) - 128).max() <= 2


@pytest.mark.parametrize(("width", "height", "code"), [(30_000, 30_000, "photo_side_too_long"), (9000, 9000, "pixels")])
@pytest.mark.parametrize("kind", ["HEIF", "AVIF"])
def test_a_phones_photo_is_judged_by_its_header(kind: str, width: int, height: int, code: str) -> None:
    data = bytearray(saved(Image.fromarray(UPRIGHT), kind))
    place = data.index(b"ispe") + 8
    data[place : place + 8] = width.to_bytes(4, "big") + height.to_bytes(4, "big")
    with pytest.raises(PhotoError) as refused:
        decode_photo(bytes(data), "photo")
    assert refused.value.code.endswith(code) or refused.value.code == "photo_unreadable"


def leaf_png(alpha: np.ndarray, colour: tuple[int, int, int] = (60, 120, 40)) -> bytes:
    pixels = np.dstack([np.full((*alpha.shape, 3), colour, np.uint8), alpha.astype(np.uint8)])
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


def disc_alpha(side: int = 64) -> np.ndarray:
    y, x = np.mgrid[:side, :side] + 0.5 - side / 2
    return np.where(np.hypot(x, y) < 0.4 * side, 255, 0)


def test_a_leaf_keeps_its_colour_and_its_alpha() -> None:
    leaf = decode_cutout(leaf_png(disc_alpha()), "leaf.png", LeafError)
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
        decode_cutout(data, "leaf.png", LeafError)
    assert refused.value.code == code


def test_a_fruit_is_read_as_a_leaf_and_refused_by_its_own_name() -> None:
    assert decode_cutout(leaf_png(disc_alpha()), "fruit", FruitError).shape == (64, 64, 4)
    with pytest.raises(FruitError, match="no fruit: all of it is transparent; cut the fruit out") as refused:
        decode_cutout(leaf_png(np.zeros((64, 64))), "fruit", FruitError)
    assert refused.value.code == "fruit_not_cut_out"
