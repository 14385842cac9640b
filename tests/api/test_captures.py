"""Captures over HTTP; what finds the cameras is tried with photos of a small scene that are drawn here."""

import hashlib
import io
from collections.abc import Sequence
from typing import Any
from zipfile import ZipFile

import httpx
import numpy as np
import pytest
from PIL import Image
from tests import walked_capture
from tests.api import drawn
from tests.api.conftest import PATIENCE_SECONDS, Service
from tests.api.test_events import events
from tests.engines.rendered_set import SIZE, photos_of, ring
from tests.faults.processes import wait_for
from tests.structures import small_structure
from tests.walked_capture import write_structure_in

from treestroke.codec.image import encode_png
from treestroke.codec.project import read_project
from treestroke.codec.structure import encode_structure


def made(client: httpx.Client, seeds: Sequence[int] = (), **body: Any) -> str:
    """Make a capture of drawn photos; give its place."""
    place = str(client.post("/v1/captures", json=body).headers["location"])
    for seed in seeds:
        assert add(client, place, f"{seed}.png", drawn.encoded(seed=seed)).status_code == 201
    return place


def add(client: httpx.Client, place: str, name: str, content: bytes) -> httpx.Response:
    return client.post(f"{place}/photos", files={"file": (name, content)})


def names(client: httpx.Client, place: str) -> list[str]:
    return [photo["name"] for photo in client.get(place).json()["photos"]]


def test_a_capture_is_made_with_or_without_a_name(client: httpx.Client) -> None:
    named = client.post("/v1/captures", json={"name": "All around"})
    assert named.status_code == 201
    told = named.json()
    assert named.headers["location"] == f"/v1/captures/{told['id']}"
    assert (told["name"], told["status"], told["photos"], told["cameras"], told["cloud"]) == (
        *("All around", "unsolved", [], [], None),
    )
    assert client.get(named.headers["location"]).json() == told
    assert client.post("/v1/captures").json()["name"] == ""


@pytest.mark.parametrize(
    ("body", "status", "code"),
    [(b"{", 400, "malformed_json"), (b"[]", 422, "wrong_type"), (b'{"name": "a\\nb"}', 422, "name_invalid")],
)
def test_a_body_that_makes_no_capture_is_refused(client: httpx.Client, body: bytes, status: int, code: str) -> None:
    answer = client.post("/v1/captures", content=body, headers={"content-type": "application/json"})
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_a_photo_goes_up_in_a_form_or_by_itself_and_is_kept_pixel_by_pixel(client: httpx.Client) -> None:
    place, content = made(client), drawn.encoded("JPEG", quality=80)
    formed = add(client, place, "walk/IMG_2.jpg", content)
    raw = client.post(f"{place}/photos?name=IMG_1.jpg", content=content, headers={"content-type": "image/jpeg"})
    nameless = client.post(f"{place}/photos", content=content)
    assert [answer.status_code for answer in (formed, raw, nameless)] == [201, 201, 201]
    photo = formed.json()
    assert (photo["name"], photo["width"], photo["height"]) == ("IMG_2.jpg", drawn.WIDTH, drawn.HEIGHT)
    assert (photo["used"], photo["reason"], photo["focal_px"]) == (None, None, None)
    sha256 = hashlib.sha256(content).hexdigest()
    assert photo["sha256"] == sha256
    assert names(client, place) == sorted(["IMG_1.jpg", "IMG_2.jpg", sha256[:12]])
    assert client.get(formed.headers["location"]).json() == photo
    stored = np.asarray(Image.open(io.BytesIO(client.get(photo["image"]).content)))
    assert np.array_equal(stored, np.asarray(Image.open(io.BytesIO(content))))


def test_the_focal_length_is_kept_though_the_metadata_is_not(client: httpx.Client) -> None:
    exif = Image.Exif()
    exif[0x0110] = "a camera"
    exif.get_ifd(0x8769)[0xA405] = 36
    out = io.BytesIO()
    Image.fromarray(np.zeros((64, 96, 3), np.uint8)).save(out, "JPEG", exif=exif)
    photo = add(client, made(client), "a.jpg", out.getvalue()).json()
    assert photo["focal_px"] == pytest.approx(96.0)
    assert b"a camera" not in client.get(photo["image"]).content


def test_a_photo_that_is_sent_again_is_the_same_photo(service: Service) -> None:
    client, content = service.client, drawn.encoded(seed=51)
    place = made(client)
    first, again = (add(client, place, "a.png", content) for _ in range(2))
    assert (first.status_code, again.status_code) == (201, 200)
    assert again.json() == first.json()
    assert again.headers["location"] == first.headers["location"]
    other = add(client, place, "a.png", drawn.encoded(seed=52))
    assert (other.status_code, other.json()["name"]) == (201, "a (2).png")
    assert names(client, place) == ["a (2).png", "a.png"]


def test_an_upload_that_fails_loses_nothing(client: httpx.Client) -> None:
    place = made(client, [0, 1])
    before = client.get(place).json()
    for content in (b"", b"no photo", drawn.encoded(seed=2)[:-400]):
        assert add(client, place, "2.png", content).status_code == 422
    assert client.post(f"{place}/photos", files={"picture": b"1"}).json()["code"] == "bad_request"
    assert client.get(place).json() == before


def test_a_removed_photo_is_gone(client: httpx.Client) -> None:
    place = made(client, [0, 1])
    photo = client.get(place).json()["photos"][0]
    there = f"{place}/photos/{photo['id']}"
    assert client.delete(there).status_code == 204
    assert names(client, place) == ["1.png"]
    for answer in (client.get(there), client.delete(there), client.get(photo["image"])):
        assert (answer.status_code, answer.json()["code"]) == (404, "photo_not_found")


def test_a_deleted_capture_is_gone(client: httpx.Client) -> None:
    place = made(client, [0])
    assert client.delete(place).status_code == 204
    answers = [client.get(place), client.delete(place), client.post(f"{place}/solve"), client.get(f"{place}/events")]
    answers += [client.post(f"{place}/cancel"), add(client, place, "a.png", drawn.encoded())]
    assert {(one.status_code, one.json()["code"]) for one in answers} == {(404, "capture_not_found")}


def test_a_deleted_capture_is_restored_with_its_photos(client: httpx.Client) -> None:
    place = made(client, [0], name="Oak")
    before = client.get(place).json()
    client.delete(place)
    assert client.post(f"{place}/restore").json() == before
    assert client.post(f"{place}/restore").json() == client.get(place).json() == before
    nothing = client.post(f"/v1/captures/cap_{'0' * 24}/restore")
    assert (nothing.status_code, nothing.json()["code"]) == (404, "capture_not_found")


def test_a_capture_is_named(client: httpx.Client) -> None:
    place = made(client)
    renamed = client.patch(place, json={"name": "Ash"})
    assert (renamed.status_code, renamed.json()["name"]) == (200, "Ash")
    assert client.get(place).json() == renamed.json()
    for body, code in (({"name": "a\nb"}, "name_invalid"), ({}, "missing_key")):
        assert client.patch(place, json=body).json()["code"] == code
    client.delete(place)
    assert client.patch(place, json={"name": "Oak"}).status_code == 404


def test_captures_are_listed_newest_first_page_by_page(client: httpx.Client) -> None:
    places = [made(client, name=name) for name in ("one", "two", "three")]
    first = client.get("/v1/captures", params={"limit": 2}).json()
    second = client.get("/v1/captures", params={"limit": 1, "cursor": first["next"]}).json()
    listed = [*first["captures"], *second["captures"]]
    assert [f"/v1/captures/{one['id']}" for one in listed] == places[::-1]
    assert set(listed[0]) == set(client.get(places[2]).json()) - {"photos", "cameras", "cloud"}


def test_too_few_photos_are_not_solved(client: httpx.Client) -> None:
    answer = client.post(f"{made(client, [0, 1])}/solve")
    assert (answer.status_code, answer.json()["code"]) == (422, "too_few_photos")
    assert "there are 2, at least 5 are needed" in answer.json()["detail"]


def test_nothing_under_way_is_told_at_once(client: httpx.Client) -> None:
    told = list(events(client, made(client)))
    assert [event.name for event in told] == ["snapshot", "unsolved"]


@pytest.fixture(scope="module")
def walk() -> list[bytes]:
    """Six photos of a small scene, taken on an arc around it."""
    return [encode_png(photo.picture) for photo in photos_of(ring(6, 60.0))]


def walked(client: httpx.Client, walk: Sequence[bytes]) -> str:
    place = made(client)
    for number in (3, 0, 5, 1, 4, 2):
        assert add(client, place, f"{number}.png", walk[number]).status_code == 201
    return place


def test_the_cameras_of_a_walk_are_found_and_followed(client: httpx.Client, walk: list[bytes]) -> None:
    place = walked(client, walk)
    add(client, place, "copy.png", walk[0])
    asked = client.post(f"{place}/solve")
    assert (asked.status_code, asked.json()["status"]) == (202, "queued")
    told = list(events(client, place))
    assert (told[0].name, told[-1].name) == ("snapshot", "solved")
    shares = [event.data["progress"] for event in told]
    assert shares == sorted(shares)
    assert any(0 < share < 1 for share in shares)
    capture = client.get(place).json()
    assert [camera["photo"] for camera in capture["cameras"]] == [f"{number}.png" for number in range(6)]
    for camera in capture["cameras"]:
        assert np.array(camera["camera_from_world"]).shape == (3, 4)
        assert camera["size_px"] == list(SIZE)
    used = {photo["name"]: (photo["used"], photo["reason"] is None) for photo in capture["photos"]}
    assert used == {**{f"{number}.png": (True, True) for number in range(6)}, "copy.png": (False, False)}
    assert 0 < len(capture["cloud"]["points"]) == len(capture["cloud"]["colours"]) <= 5000
    again = client.post(f"{place}/solve")
    assert (again.status_code, again.json()) == (200, capture)


def test_the_same_photos_in_another_capture_are_solved_at_once(client: httpx.Client, walk: list[bytes]) -> None:
    first, second = walked(client, walk), walked(client, walk)
    client.post(f"{first}/solve")
    assert list(events(client, first))[-1].name == "solved"
    answer = client.post(f"{second}/solve")
    assert answer.status_code == 200
    assert answer.json()["cameras"] == client.get(first).json()["cameras"]


def test_cameras_are_told_in_pixels_of_the_photos(service: Service) -> None:
    """Photos are solved smaller than they are; here in pictures of 64 by 48 px."""
    place = made(service.client, range(70, 75))
    found = small_structure([f"{seed}.png" for seed in range(70, 75)], [])
    write_structure_in(service.data, place.rpartition("/")[2], found)
    capture = service.client.get(place).json()
    assert capture["status"] == "solved"
    scale = drawn.WIDTH / 64
    for told, solved in zip(capture["cameras"], found.photos, strict=True):
        assert told["size_px"] == [drawn.WIDTH, drawn.HEIGHT]
        assert told["focal_px"] == pytest.approx(scale * solved.camera.focal_px)
        assert told["principal_px"] == pytest.approx([drawn.WIDTH / 2, drawn.HEIGHT / 2])
        assert told["camera_from_world"] == solved.camera.camera_from_world.tolist()


@pytest.fixture(scope="module")
def tree_walk(service: Service) -> str:
    """The id of a solved capture of a small tree."""
    place = made(service.client)
    for name, shot in zip(walked_capture.names(), walked_capture.shots(), strict=True):
        assert add(service.client, place, name, encode_png(shot.picture)).status_code == 201
    id = place.rpartition("/")[2]
    write_structure_in(service.data, id, walked_capture.structure())
    return id


def test_a_solved_capture_is_traced_and_its_edits_are_replayed(client: httpx.Client, tree_walk: str) -> None:
    place, drawn_over = f"/v1/captures/{tree_walk}/trace", walked_capture.views()
    first = client.post(place, json={**drawn_over, "rev": 3}).json()
    assert first["rev"] == 3
    assert [photo["photo"] for photo in first["photos"]] == walked_capture.names()
    assert "grown" not in first
    edit = {"do": "remove", "at": first["skeleton"]["points"][-1]}
    edits = {"edits": [edit, {**edit, "at": [99, 99, 99]}], "settings": walked_capture.SETTINGS}
    asked = [client.post(place, json={**drawn_over, **edits, "grow": grow}).json() for grow in (False, True, False)]
    assert asked[0] == asked[2]
    assert asked[0] == {key: value for key, value in asked[1].items() if key not in ("grown", "photo")}
    assert len(asked[0]["skeleton"]["points"]) < len(first["skeleton"]["points"])
    told = [(one["code"], one["stroke"]) for one in asked[0]["warnings"]]
    assert told == [("same_photo", "photos/copy.png"), ("edit_lost", "edits/1")]
    assert asked[1]["grown"]["photo"] == asked[1]["photo"]
    assert len(asked[1]["grown"]["points"]) >= len(asked[0]["skeleton"]["points"])


@pytest.mark.parametrize(
    ("wish", "code", "pointer"),
    [
        ({"views": []}, "wrong_type", "/views"),
        ({"views": [{**walked_capture.views()["views"][0], "branches": []}]}, "trunk_missing", "/views/0/branches"),
        ({"views": [{**walked_capture.views()["views"][0], "photo": "9.png"}]}, "photo_unknown", "/views/0/photo"),
        ({**walked_capture.views(), "edits": [{"do": "grow"}]}, "edit_unknown", "/edits/0"),
        ({**walked_capture.views(), "settings": {"height": "tall"}}, "setting_not_allowed", "/settings/height"),
    ],
)
def test_a_trace_that_cannot_be_made_is_refused_by_name(
    client: httpx.Client, tree_walk: str, wish: dict[str, Any], code: str, pointer: str
) -> None:
    answer = client.post(f"/v1/captures/{tree_walk}/trace", json=wish)
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]


def test_a_capture_is_solved_before_it_is_traced(client: httpx.Client) -> None:
    answer = client.post(f"{made(client)}/trace", json=walked_capture.views())
    assert (answer.status_code, answer.json()["code"]) == (409, "capture_unsolved")


def test_a_capture_becomes_a_tree(service: Service, tree_walk: str) -> None:
    edits = [{"do": "remove", "at": [99, 0, 0]}]
    client, wish = service.client, walked_capture.request(tree_walk, name="Around", edits=edits)
    asked = client.post("/v1/models", json=wish, headers={"idempotency-key": tree_walk})
    assert (asked.status_code, asked.json()["capture"], asked.json()["photo"]) == (202, tree_walk, None)
    told = list(events(client, f"/v1/models/{asked.json()['id']}"))
    assert [event.name for event in told if event.name != "progress"] == ["snapshot", "preview", "succeeded"]
    model = client.get(asked.headers["location"]).json()
    assert {"tree.glb", "preview.png", "views.json", "project"} <= set(model["files"])
    assert "structure.json" not in model["files"]
    assert client.get(model["files"]["views.json"]).json() == walked_capture.views()
    assert client.get(model["files"]["edits.json"]).json() == {"edits": edits}
    assert client.get(model["files"]["tree.glb"]).content[:4] == b"glTF"
    assert [camera["photo"] for camera in model["report"]["cameras"]] == walked_capture.names()
    again = client.post("/v1/models", json=wish)
    assert (again.status_code, again.json()["report"]) == (200, model["report"])
    assert client.post("/v1/models", json=wish, headers={"idempotency-key": tree_walk}).json()["id"] == model["id"]


def test_the_project_of_a_capture_s_tree_holds_its_photos_and_cameras(service: Service, tree_walk: str) -> None:
    asked = service.client.post("/v1/models", json=walked_capture.request(tree_walk)).json()
    content = service.client.get(asked["files"]["project"]).content
    photos = {f"photos/{name}.png" for name in walked_capture.names()}
    with ZipFile(io.BytesIO(content)) as archive:
        assert set(archive.namelist()) == {*photos, "views.json", "structure.json", "settings.json"}
    project = read_project(io.BytesIO(content), "x")
    assert project.inputs.parts["structure"] == encode_structure(walked_capture.structure())
    service.finished(service.client.get(f"/v1/models/{asked['id']}"))


def test_a_tree_of_a_capture_that_is_not_solved_is_refused(client: httpx.Client) -> None:
    place = made(client, range(5))
    answer = client.post("/v1/models", json=walked_capture.request(place.rpartition("/")[2]))
    assert (answer.status_code, answer.json()["code"]) == (409, "capture_unsolved")
    assert [fault["pointer"] for fault in answer.json()["errors"]] == ["/capture"]
    nowhere = client.post("/v1/models", json=walked_capture.request("cap_" + "0" * 24))
    assert (nowhere.status_code, nowhere.json()["code"]) == (404, "capture_not_found")


def test_strokes_over_a_photo_that_the_capture_does_not_have_are_refused(client: httpx.Client, tree_walk: str) -> None:
    over = walked_capture.views()
    over["views"][0]["photo"] = "IMG_9.jpg"
    answer = client.post("/v1/models", json=walked_capture.request(tree_walk, views=over))
    assert (answer.status_code, answer.json()["code"]) == (422, "photo_unknown")
    assert [fault["pointer"] for fault in answer.json()["errors"]] == ["/views/views/0/photo"]


def test_photos_that_do_not_go_together_fail_with_a_sentence(client: httpx.Client) -> None:
    place = made(client, range(60, 66))
    client.post(f"{place}/solve")
    last = list(events(client, place))[-1]
    assert last.name == "failed"
    assert last.data["error"]["code"] == "input_unusable"
    assert ".png" in last.data["error"]["detail"]
    assert len(names(client, place)) == 6


def test_a_solve_is_canceled(client: httpx.Client, walk: list[bytes]) -> None:
    place = walked(client, walk)
    add(client, place, "one more.png", drawn.encoded())
    client.post(f"{place}/solve")
    client.post(f"{place}/cancel")
    wait_for(lambda: client.get(place).json()["status"] == "unsolved", PATIENCE_SECONDS, "the end of the solve", 0.1)
