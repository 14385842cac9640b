import hashlib
import io
import shutil

import httpx
import numpy as np
import pytest
from PIL import Image
from tests.api import drawn
from tests.api.conftest import Service, problem_of
from tests.api.corpora import picture, saved

import treestroke
from treestroke.codec.image import decode_photo


def image(client: httpx.Client, id: str) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(client.get(f"/v1/photos/{id}/image").content)))


def test_a_photo_in_a_form_is_stored(client: httpx.Client) -> None:
    content = drawn.encoded("JPEG", quality=70)
    answer = client.post("/v1/photos", files={"file": ("a tree.jpg", content, "image/jpeg")})
    photo = answer.json()
    assert answer.status_code == 201
    assert answer.headers["location"] == f"/v1/photos/{photo['id']}"
    assert (photo["width"], photo["height"]) == (drawn.WIDTH, drawn.HEIGHT)
    assert photo["sha256"] == hashlib.sha256(content).hexdigest()
    assert client.get(answer.headers["location"]).json() == photo


def test_a_large_form_is_taken_although_the_folder_for_temporary_files_is_gone(service: Service) -> None:
    large = drawn.encoded("PNG") + bytes(2_000_000)  # what is behind its end does not matter
    for _ in range(2):
        assert service.client.post("/v1/photos", files={"file": large}).status_code == 201
        shutil.rmtree(service.data / "tmp")


@pytest.mark.parametrize(
    "kind",
    [
        *("image/jpeg", "image/png", "image/webp", "image/heic", "image/avif", "image/tiff", "image/x-of-tomorrow"),
        *("image/jpg", "image/pjpeg", "Image/JPG; name=tree.jpg", "application/octet-stream", None),
    ],
)
def test_a_photo_may_be_the_whole_body_whatever_picture_type_it_is_sent_as(
    client: httpx.Client, kind: str | None
) -> None:
    answer = client.post("/v1/photos", content=drawn.encoded(), headers={"Content-Type": kind} if kind else {})
    assert answer.status_code == 201


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP", "HEIF", "AVIF", "TIFF"])
def test_the_stored_picture_is_the_decoded_upload_pixel_by_pixel(service: Service, kind: str) -> None:
    content = saved(picture(), kind)
    stored = image(service.client, service.add_photo(content))
    assert np.array_equal(stored, decode_photo(content, "photo"))


def test_a_cut_out_gives_the_same_tree_by_the_service_and_the_library(service: Service) -> None:
    plain = drawn.pixels()
    alpha = np.where(plain[..., 2] > plain[..., 1], 0, 255).astype(np.uint8)
    content = saved(Image.fromarray(np.dstack([plain, alpha])), "PNG")
    id = service.add_photo(content)
    assert np.array_equal(image(service.client, id), decode_photo(content, "photo"))
    made = service.make(**drawn.request(id))
    by_library = treestroke.model(content, drawn.STROKES, drawn.QUICK)
    assert service.client.get(made["files"]["tree.glb"]).content == by_library.glb
    opaque = treestroke.model(plain, drawn.STROKES, drawn.QUICK)
    assert by_library.glb != opaque.glb


def test_the_stored_picture_has_a_tag_and_is_not_sent_again(client: httpx.Client, photo: str) -> None:
    first = client.get(f"/v1/photos/{photo}/image")
    assert first.headers["content-type"] == "image/png"
    assert first.headers["etag"] == f'"{hashlib.sha256(first.content).hexdigest()}"'
    again = client.get(f"/v1/photos/{photo}/image", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_a_deleted_photo_is_gone_and_its_models_keep_their_copy(service: Service) -> None:
    client, id = service.client, service.add_photo(drawn.encoded(seed=5))
    model = service.make(**drawn.request(id))
    assert client.delete(f"/v1/photos/{id}").status_code == 204
    for path in ("", "/image"):
        assert client.get(f"/v1/photos/{id}{path}").json()["code"] == "photo_not_found"
    assert client.post(f"/v1/photos/{id}/trace", json=drawn.STROKES).status_code == 404
    assert client.post("/v1/models", json=drawn.request(id)).status_code == 404
    assert client.delete(f"/v1/photos/{id}").status_code == 404
    assert client.get(f"/v1/models/{model['id']}/project").status_code == 200


def test_a_form_without_the_photo_says_which_field_it_needs(client: httpx.Client) -> None:
    answer = client.post("/v1/photos", files={"picture": b"1"})
    assert answer.status_code == 400
    assert "field file" in answer.json()["detail"]


def test_a_body_of_another_type_is_refused(client: httpx.Client) -> None:
    for kind in ("application/json", "application/pdf", "text/html"):
        answer = client.post("/v1/photos", content=drawn.encoded(), headers={"Content-Type": kind})
        assert (answer.status_code, answer.json()["code"]) == (415, "unsupported_media_type")
        assert "image/jpeg" in answer.json()["detail"]


@pytest.mark.parametrize(
    ("kind", "media_type", "what"),
    [("GIF", "image/gif", "a GIF picture"), ("BMP", "image/bmp", "a BMP picture"), ("JPEG2000", "image/jp2", "2000")],
)
def test_a_picture_of_another_kind_is_refused_by_name_however_it_is_sent(
    client: httpx.Client, kind: str, media_type: str, what: str
) -> None:
    content = saved(picture(), kind)
    raw = client.post("/v1/photos", content=content, headers={"Content-Type": media_type})
    form = client.post("/v1/photos", files={"file": ("tree", content, media_type)})
    asked = client.post("/v1/models", **drawn.form(content))
    assert (raw.status_code, raw.json()["code"]) == (422, "format_not_allowed")
    assert what in raw.json()["detail"]
    assert problem_of(raw) == problem_of(form) == problem_of(asked)


def test_what_was_mended_in_a_photo_is_told_wherever_it_is_used(service: Service, client: httpx.Client) -> None:
    whole = drawn.encoded("JPEG", seed=31)
    photo = client.post("/v1/photos", content=whole[:-2]).json()
    warnings = photo["warnings"]
    assert [(one["code"], one["stroke"]) for one in warnings] == [("photo_cut_short", "photo")]
    assert client.get(f"/v1/photos/{photo['id']}").json()["warnings"] == warnings
    assert client.post(f"/v1/photos/{photo['id']}/trace", json=drawn.STROKES).json()["warnings"] == warnings
    made = service.make(**drawn.request(photo["id"]))
    brought, of_whole = (
        service.finished(client.post("/v1/models", **drawn.form(content))) for content in (whole[:-2], whole)
    )
    assert made["report"]["warnings"] == warnings
    assert brought["report"]["warnings"] == warnings
    assert of_whole["report"]["warnings"] == []  # though its pixels are the same
    assert client.post("/v1/photos", content=whole).json()["warnings"] == []


@pytest.mark.parametrize("name", ["../../x", "a\r\nX-Evil: 1", "\u202egpj.exe", "🌳", "a\0b", "n" * 4096, ".."])
def test_the_name_of_an_uploaded_file_does_not_matter(service: Service, name: str) -> None:
    content = drawn.encoded(seed=9)
    answer = service.client.post("/v1/photos", files={"file": (name, content)})
    assert answer.status_code == 201
    assert "x-evil" not in answer.headers
    assert name not in [path.name for path in service.data.parent.rglob("*")]


def test_photos_are_listed_newest_first_page_by_page_without_the_deleted(service: Service) -> None:
    client = service.client
    added = [service.add_photo(drawn.encoded(seed=seed)) for seed in range(40, 45)]
    client.delete(f"/v1/photos/{added.pop(2)}")
    first = client.get("/v1/photos", params={"limit": 2}).json()
    assert [photo["id"] for photo in first["photos"]] == [added[3], added[2]]
    assert first["photos"][0] == client.get(f"/v1/photos/{added[3]}").json()
    service.add_photo(drawn.encoded(seed=45))  # what comes meanwhile shifts nothing
    second = client.get("/v1/photos", params={"limit": 2, "cursor": first["next"]}).json()
    assert [photo["id"] for photo in second["photos"]] == [added[1], added[0]]
    rest = client.get("/v1/photos", params={"limit": 100, "cursor": second["next"] or "0"}).json()
    assert rest["next"] is None
    assert not {photo["id"] for photo in rest["photos"]} & set(added)


@pytest.mark.parametrize("query", [{"limit": 0}, {"limit": 101}, {"cursor": "x"}, {"cursor": "-1"}])
def test_a_page_that_cannot_be_is_refused(client: httpx.Client, query: dict[str, str]) -> None:
    assert client.get("/v1/photos", params=query).status_code == 422
