import io
from collections.abc import Callable

import numpy as np
import pytest
from PIL import Image
from tests.api import corpora, drawn
from tests.api.conftest import Service, problem_of
from tests.promises import kept

from treestroke.core.imaging.opacity import over_white


def refused(service: Service, content: bytes, *codes: str) -> str:
    """Upload what must be refused in both ways, see that nothing is kept, and give the reason."""
    before = service.stored()
    form = service.client.post("/v1/photos", files={"file": ("tree.jpg", content, "image/jpeg")})
    raw = service.client.post("/v1/photos", content=content, headers={"Content-Type": "image/jpeg"})
    assert problem_of(form) == problem_of(raw)
    for answer in (form, raw):
        assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json"), answer.text
        assert answer.json()["code"] in codes
    assert service.stored() == before
    return str(raw.json()["detail"])


def stored(service: Service, content: bytes) -> tuple[np.ndarray, bytes]:
    """Upload a photo and give the stored pixels, over white, and bytes."""
    image = service.client.get(f"/v1/photos/{service.add_photo(content)}/image").content
    return over_white(np.asarray(Image.open(io.BytesIO(image)))), image


def memory_kb(service: Service, name: str = "VmRSS") -> int:
    """Read how much memory the web process holds."""
    status = (service.web_process() / "status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith(f"{name}:")).split()[1])


def children(service: Service) -> dict[int, tuple[float, int]]:
    """Read the CPU seconds and the highest memory, kB, of the tracing processes."""
    web, found = int(service.web_process().name), {}
    for folder in service.web_process().parent.glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
            status = (folder / "status").read_text()
            command = (folder / "cmdline").read_bytes()
        except OSError:
            continue
        if int(fields[1]) != web or b"spawn_main" not in command:
            continue
        high = [int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM:")]
        found[int(folder.name)] = ((int(fields[11]) + int(fields[12])) / 100, high[0] if high else 0)
    return found


@pytest.mark.parametrize("orientation", range(1, 9))
def test_a_turned_photo_is_stored_upright_whichever_way_it_was_held(service: Service, orientation: int) -> None:
    pixels, _ = stored(service, corpora.turned(orientation))
    assert np.array_equal(pixels, drawn.pixels())


def test_all_eight_ways_are_traced_alike(service: Service) -> None:
    photos = [service.add_photo(corpora.turned(orientation)) for orientation in range(1, 9)]
    traces = [service.client.post(f"/v1/photos/{one}/trace", json=drawn.STROKES).json() for one in photos]
    assert traces == [traces[0]] * 8


@pytest.mark.parametrize("kind", ["JPEG", "HEIF", "AVIF", "TIFF"])
def test_what_a_photo_tells_besides_its_picture_is_not_kept(service: Service, kind: str) -> None:
    content = corpora.talkative(kind)
    assert all(word in content for word in (b"Canon", b"secret", b"acsp", corpora.TAIL))
    pixels, image = stored(service, content)
    assert [word for word in corpora.PRIVATE if word in image] == []
    assert np.abs(pixels.astype(int) - drawn.pixels()).mean() < 6
    kept = b"".join(path.read_bytes() for path in (service.data / "blobs").rglob("*") if path.is_file())
    assert b"a secret comment" not in kept


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: corpora.flat_png(13_000, 13_000), "photo_too_many_pixels"),
        (lambda: corpora.flat_png(16_000, 16_000, rows=200), "photo_too_many_pixels"),
        (lambda: corpora.flat_png(30_000, 30_000, rows=2000), "photo_side_too_long"),
        (lambda: corpora.flat_png(65_500, 65_500, rows=10), "photo_side_too_long"),
        (lambda: corpora.flat_png(2**31 - 1, 2**31 - 1, rows=0), "photo_side_too_long"),
        (lambda: corpora.tall_jpeg(65_500, 65_500), "photo_side_too_long"),
        (lambda: corpora.tall_jpeg(13_000, 13_000), "photo_too_many_pixels"),
    ],
)
def test_a_flood_of_pixels_is_refused_by_its_header(service: Service, make: Callable[[], bytes], code: str) -> None:
    content = make()
    assert len(content) < 300_000
    service.client.post("/v1/photos", content=b"warm")
    before = memory_kb(service)
    with kept(1.0):  # two uploads
        refused(service, content, code, "photo_too_many_pixels")
    assert memory_kb(service) - before < 50_000


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP", "HEIF", "AVIF", "TIFF"])
def test_a_photo_that_is_cut_short_is_refused_wherever_it_ends(service: Service, kind: str) -> None:
    for content in corpora.cuts(corpora.saved(corpora.picture(), kind)):
        refused(service, content, "photo_unreadable", "format_not_allowed")


@pytest.mark.parametrize("size", [(1, 1), (63, 200), (1, 16_000), (16_385, 64)])
def test_a_photo_of_an_odd_size_is_refused(service: Service, size: tuple[int, int]) -> None:
    assert "resize it" in refused(service, corpora.flat_png(*size), "photo_too_small", "photo_side_too_long")


NAMED = {
    "eps": "an EPS drawing, and a photo must be JPEG, PNG, WebP, HEIC, AVIF or TIFF; export it as PNG",
    "svg": "an SVG drawing",
    "pdf": "a PDF document",
    "raw": "a camera's raw file",
    "psd": "a Photoshop document",
    "jp2": "a JPEG 2000 picture",
    "gif": "a GIF picture",
    "bmp": "a BMP picture",
    "ico": "an icon",
    "zip": "a ZIP archive",
    "html": "a web page",
    "empty": "the file is empty",
}


@pytest.mark.parametrize("kind", corpora.foreign())
def test_another_kind_of_file_is_refused_whatever_it_is_called(service: Service, kind: str) -> None:
    said = refused(service, corpora.foreign()[kind], "format_not_allowed")
    assert NAMED.get(kind, "save it as JPEG, PNG, WebP, HEIC, AVIF or TIFF") in said


def test_a_file_that_is_a_page_too_becomes_a_picture_alone(service: Service) -> None:
    _, image = stored(service, drawn.encoded("JPEG") + corpora.polyglot_tail())
    assert corpora.TAIL not in image
    assert not image.endswith(corpora.polyglot_tail())


@pytest.mark.parametrize("kind", corpora.animated())
def test_an_animation_is_refused(service: Service, kind: str) -> None:
    assert "2 frames" in refused(service, corpora.animated()[kind], "photo_animated")


@pytest.mark.parametrize("name", corpora.phones())
def test_a_stump_of_a_phones_own_format_is_refused_with_the_way_out(service: Service, name: str) -> None:
    said = refused(service, corpora.phones()[name], "photo_unreadable")
    assert f"this {name.split()[0]} is damaged" in said
    assert said.endswith("save it as JPEG")


def test_a_jpeg_with_further_pictures_behind_it_is_taken(service: Service) -> None:
    first, second = corpora.picture(), Image.fromarray(drawn.pixels(1))
    pixels, _ = stored(service, corpora.saved(first, "MPO", save_all=True, append_images=[second], quality=100))
    assert np.abs(pixels.astype(int) - drawn.pixels()).mean() < 6


@pytest.mark.parametrize("mode", corpora.modes())
def test_every_mode_comes_out_as_srgb(service: Service, mode: str) -> None:
    content, wanted = corpora.modes()[mode]
    pixels, _ = stored(service, content)
    assert np.abs(pixels.astype(float) - wanted).mean() < (2 if mode == "CMYK" else 1)


def test_wide_colours_come_out_as_the_srgb_that_looks_the_same(service: Service) -> None:
    patches = (
        np.repeat([[[128, 128, 128], [255, 0, 0], [180, 120, 60]]], 64, axis=0).repeat(64, axis=1).astype(np.uint8)
    )
    content = corpora.saved(Image.fromarray(patches), "PNG", icc_profile=corpora.wide_profile())
    grey, red, brown = stored(service, content)[0][32, 32::64].astype(int)
    assert np.abs(grey - 128).max() <= 3
    assert red.tolist() == [255, 0, 0]  # it is beyond what sRGB can show
    assert np.abs(brown - (192, 117, 40)).max() <= 4  # the same light, told with less saturated primaries


def test_a_broken_profile_is_passed_over(service: Service) -> None:
    pixels, _ = stored(service, drawn.encoded("PNG", icc_profile=b"no profile at all" * 9))
    assert np.array_equal(pixels, drawn.pixels())


@pytest.mark.parametrize(
    "make",
    [
        lambda: corpora.stuffed_png(corpora.text_chunks(10_000)),
        lambda: corpora.stuffed_png(corpora.bomb(b"iCCP", b"profile\0\0")),
        lambda: corpora.stuffed_png(corpora.bomb(b"zTXt", b"Comment\0\0")),
        lambda: corpora.stuffed_png(corpora.bomb(b"iTXt", b"Comment\0\x01\0\0\0")),
        lambda: corpora.stuffed_png(corpora.chunk(b"iCCP", b"profile\0\0" + bytes(20_000_000))),
        lambda: corpora.stuffed_png(corpora.chunk(b"eXIf", b"II*\0\x08\0\0\0\xff\xff" + bytes(3_000_000))),
    ],
)
def test_a_photo_stuffed_with_other_things_costs_little(service: Service, make: Callable[[], bytes]) -> None:
    content = make()
    service.client.post("/v1/photos", content=drawn.encoded())
    before = children(service)
    assert before
    answer = service.client.post("/v1/photos", content=content)
    assert answer.status_code in (201, 422), answer.text
    after = children(service)
    assert set(after) == set(before)  # nobody crashed
    for pid, (seconds, memory) in after.items():
        assert seconds - before[pid][0] < 2.0
        assert memory < 300_000 or memory == before[pid][1]
