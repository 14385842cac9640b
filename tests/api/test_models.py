import json
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
from tests.api import drawn
from tests.api.conftest import Service
from tests.promises import kept

LONG = {"iterations": 2000, "leaf_density": 3}
WAIT = {"Prefer": "wait=60"}


def asked(client: httpx.Client, key: str | None = None, **request: Any) -> httpx.Response:
    return client.post("/v1/models", headers={} if key is None else {"Idempotency-Key": key}, **request)


def test_a_model_is_accepted_and_made(service: Service, client: httpx.Client, photo: str) -> None:
    answer = asked(client, json=drawn.request(photo, name="First", seed=11))
    told = answer.json()
    assert answer.status_code == 202
    assert answer.headers["location"] == f"/v1/models/{told['id']}"
    assert told["status"] in ("queued", "running")
    assert (told["name"], told["seed"], told["attempt"] <= 1, told["error"]) == ("First", 11, True, None)
    assert told["settings"]["iterations"] == drawn.QUICK["iterations"]
    told = service.finished(answer)
    assert (told["status"], told["progress"], told["attempt"]) == ("succeeded", 1.0, 1)
    assert set(told["files"]) == {"tree.glb", "preview.png", "strokes.json", "project"}
    assert told["score"] == told["report"]["score"]
    assert told["taken"] == told["report"]["taken"]
    assert told["created"] <= told["started"] <= told["finished"]


def test_a_client_that_prefers_to_wait_gets_the_finished_model(client: httpx.Client, photo: str) -> None:
    answer = client.post("/v1/models", json=drawn.request(photo, seed=12), headers=WAIT)
    assert (answer.status_code, answer.json()["status"]) == (200, "succeeded")
    assert answer.headers["preference-applied"] == "wait=60"


def test_a_wait_that_is_too_short_ends_with_an_unfinished_model(client: httpx.Client, photo: str) -> None:
    answer = client.post("/v1/models", json=drawn.request(photo, seed=13, settings=LONG), headers={"Prefer": "wait=0"})
    assert answer.status_code == 202
    client.post(f"{answer.headers['location']}/cancel")


def test_a_form_brings_the_photo_along(client: httpx.Client, made: dict[str, Any]) -> None:
    answer = asked(client, **drawn.form(drawn.encoded(), name="By form"))
    told = answer.json()
    assert (answer.status_code, told["status"], told["name"]) == (200, "succeeded", "By form")  # made before
    assert told["photo"] != made["photo"]
    assert client.get(f"/v1/photos/{told['photo']}").status_code == 200


def test_a_form_may_hold_all_its_parts_as_files(client: httpx.Client) -> None:
    parts = drawn.form(drawn.encoded(), seed="0")
    files = {**parts["files"], **{name: (f"{name}.json", text) for name, text in parts["data"].items()}}
    assert asked(client, files=files).status_code in (200, 202)


def test_the_same_request_again_is_another_model_that_is_finished_at_once(
    client: httpx.Client, photo: str, made: dict[str, Any]
) -> None:
    answer = asked(client, json=drawn.request(photo, name="Twin"))
    told = answer.json()
    assert answer.status_code == 200
    assert told["id"] != made["id"]
    assert (told["status"], told["name"], told["report"]) == ("succeeded", "Twin", made["report"])
    for name in ("tree.glb", "preview.png"):
        assert client.get(told["files"][name]).headers["etag"] == client.get(made["files"][name]).headers["etag"]


def test_a_repeated_request_gives_the_first_answers_model(client: httpx.Client, photo: str) -> None:
    first, second = (asked(client, "again-1", json=drawn.request(photo, seed=14)).json() for _ in range(2))
    assert first["id"] == second["id"]


def test_a_repeated_form_keeps_one_photo(service: Service) -> None:
    first = asked(service.client, "form-1", **drawn.form(drawn.encoded(seed=15))).json()
    before = service.rows("photos")
    second = asked(service.client, "form-1", **drawn.form(drawn.encoded(seed=15))).json()
    assert (second["id"], second["photo"]) == (first["id"], first["photo"])
    assert service.rows("photos") == before


def test_a_repeated_request_is_answered_though_its_photo_is_deleted(service: Service) -> None:
    id = service.add_photo(drawn.encoded(seed=16))
    first = asked(service.client, "gone-1", json=drawn.request(id)).json()
    service.client.delete(f"/v1/photos/{id}")
    assert asked(service.client, "gone-1", json=drawn.request(id)).json()["id"] == first["id"]
    assert asked(service.client, "gone-2", json=drawn.request(id)).status_code == 404


@pytest.mark.parametrize("change", [{"seed": 1}, {"name": "Other"}, {"settings": {}}])
def test_a_key_with_another_request_is_refused(client: httpx.Client, photo: str, change: dict[str, Any]) -> None:
    key = f"other-{json.dumps(change).replace(' ', '')}"
    assert asked(client, key, json=drawn.request(photo)).status_code in (200, 202)
    answer = asked(client, key, json=drawn.request(photo, **change))
    assert (answer.status_code, answer.json()["code"]) == (422, "idempotency_key_reused")


def test_twenty_requests_at_once_with_one_key_make_one_model(service: Service, photo: str) -> None:
    before = service.rows("models")
    with ThreadPoolExecutor(20) as many, httpx.Client(base_url=service.url, timeout=70) as client:
        request = drawn.request(photo, seed=17)
        answers = list(many.map(lambda _: _patient(client, "twenty", request), range(20)))
    assert {answer.status_code for answer in answers} <= {200, 202}
    assert len({answer.json()["id"] for answer in answers}) == 1
    assert service.rows("models") == before + 1


def _patient(client: httpx.Client, key: str, request: dict[str, Any]) -> httpx.Response:
    """Ask again where the service says that it is busy: no more than 16 requests wait."""
    while (answer := asked(client, key, json=request)).status_code == 503:
        time.sleep(float(answer.headers["retry-after"]) / 4)
    return answer


@pytest.mark.parametrize("key", ["", "a b", "ü".encode(), "k" * 256])
def test_a_key_of_another_form_is_refused(client: httpx.Client, photo: str, key: Any) -> None:
    answer = asked(client, key, json=drawn.request(photo))
    assert answer.status_code == 422
    assert "dempotency" in answer.text


def test_the_list_has_no_gap_and_no_double_while_models_are_added(service: Service, photo: str) -> None:
    client = service.client
    for number in range(7):
        service.make(**drawn.request(photo, name=f"Listed {number}"))
    known = [one["id"] for one in client.get("/v1/models", params={"limit": 100}).json()["models"]]
    found: list[str] = []
    cursor = None
    while True:
        page = client.get("/v1/models", params={"limit": 2, **({"cursor": cursor} if cursor else {})}).json()
        found += [one["id"] for one in page["models"]]
        service.make(**drawn.request(photo, name="Added meanwhile"))
        if (cursor := page["next"]) is None:
            break
    assert found == known


@pytest.mark.parametrize(
    ("query", "pointer"),
    [
        ({"limit": "0"}, "/limit"),
        ({"limit": "101"}, "/limit"),
        ({"limit": "x"}, "/limit"),
        ({"cursor": "-1"}, "/cursor"),
        ({"cursor": "c" * 41}, "/cursor"),
        ({"cursor": ""}, "/cursor"),
        ({"cursor": "\0"}, "/cursor"),
    ],
)
def test_a_wrong_page_is_refused(client: httpx.Client, query: dict[str, str], pointer: str) -> None:
    answer = client.get("/v1/models", params=query)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, pointer)


@pytest.mark.parametrize(
    "name", ['Müller\'s "oak" 🌳', "", "n" * 200, "👨‍👩‍👧", "می‌خواهم", "樫の　木", "a/b\\c:*?<>|", "..", "<script>"]
)
def test_a_model_is_named(service: Service, photo: str, name: str) -> None:
    id = service.make(**drawn.request(photo, name="Before"))["id"]
    answer = service.client.patch(f"/v1/models/{id}", json={"name": name})
    assert (answer.status_code, answer.json()["name"]) == (200, name)
    assert service.client.get(f"/v1/models/{id}").json()["name"] == name
    assert service.make(**drawn.request(photo, name=name))["name"] == name


@pytest.mark.parametrize("name", ["n" * 201, "a\nb", "a\0b", "a\x7fb", "a\u2028b", "\u202egpj.exe", 7, None, ["a"]])
def test_a_name_that_is_no_line_of_text_is_refused(client: httpx.Client, made: dict[str, Any], name: Any) -> None:
    request = drawn.request(made["photo"], name=name)
    for answer in (client.patch(f"/v1/models/{made['id']}", json={"name": name}), asked(client, json=request)):
        assert (answer.status_code, answer.json()["code"]) == (422, "name_invalid")
        assert answer.json()["errors"][0]["pointer"] == "/name"


def test_a_deleted_model_is_gone_until_it_is_restored(service: Service, photo: str) -> None:
    client, model = service.client, service.make(**drawn.request(photo, name="Deleted"))
    place = f"/v1/models/{model['id']}"
    assert client.delete(place).status_code == 204
    for path in ("", "/events", "/tree.glb", "/preview.png", "/project", "/strokes.json"):
        assert client.get(place + path).json()["code"] == "model_not_found"
    assert client.delete(place).status_code == 404
    assert client.patch(place, json={"name": "x"}).status_code == 404
    assert client.post(f"{place}/cancel").status_code == 404
    assert model["id"] not in client.get("/v1/models", params={"limit": 100}).text
    restored = client.post(f"{place}/restore")
    assert (restored.status_code, restored.json()) == (200, model)
    assert client.get(f"{place}/tree.glb").status_code == 200


def test_a_running_model_is_canceled(service: Service, client: httpx.Client, photo: str) -> None:
    answer = asked(client, json=drawn.request(photo, seed=18, settings=LONG))
    place = answer.headers["location"]
    with kept(20.0):
        assert client.post(f"{place}/cancel").status_code == 200
        told = service.finished(answer)
    assert told["status"] == "canceled"
    assert set(told["files"]) == {"strokes.json", "project"}
    assert client.get(f"{place}/tree.glb").json()["code"] == "file_not_found"
    assert client.post(f"{place}/cancel").json() == told


def test_a_finished_model_stays_as_it_is_when_it_is_canceled(client: httpx.Client, made: dict[str, Any]) -> None:
    assert client.post(f"/v1/models/{made['id']}/cancel").json() == made


@pytest.mark.parametrize(
    "id", ["x", "mdl_0a1b2c3d4e5f60718293a4b5", "%00", "%F0%9F%8C%B3", "%FF", "i" * 4000, "..%2f", "'--"]
)
@pytest.mark.parametrize("kind", ["models", "photos"])
def test_an_unknown_id_of_any_shape_is_not_found(client: httpx.Client, kind: str, id: str) -> None:
    place = f"/v1/{kind}/{id}"
    answers = [client.get(place), client.delete(place)]
    if kind == "models":
        answers += [
            client.patch(place, json={"name": "a"}),
            client.post(f"{place}/cancel"),
            client.post(f"{place}/restore"),
        ]
        answers += [client.get(f"{place}/{name}") for name in ("events", "tree.glb", "preview.png", "project")]
    else:
        answers += [client.get(f"{place}/image"), client.post(f"{place}/trace", json=drawn.STROKES)]
    for answer in answers:
        assert (answer.status_code, answer.headers["content-type"]) == (404, "application/problem+json")


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"photo": 5}, "/photo", "wrong_type"),
        ({"photo": "p" * 41}, "/photo", "wrong_type"),
        ({"strokes": []}, "/strokes", "wrong_type"),
        ({"strokes": {"branches": []}}, "/strokes/crown", "crown_missing"),
        ({"strokes": {"crown": drawn.STROKES["crown"]}}, "/strokes/branches", "trunk_missing"),
        (
            {"strokes": {**drawn.STROKES, "branches": [{"points": [[5, 235], [5, 238]]}]}},
            "/strokes/branches/0",
            "trunk_outside_crown",
        ),
        ({"settings": {"heigth": 3}}, "/settings/heigth", "unknown_setting"),
        ({"settings": {"height": 0}}, "/settings/height", "setting_not_allowed"),
        ({"settings": {"height": "10"}}, "/settings/height", "setting_not_allowed"),
        ({"settings": {"iterations": 2001}}, "/settings/iterations", "setting_not_allowed"),
        ({"settings": {"iterations": True}}, "/settings/iterations", "setting_not_allowed"),
        ({"settings": {"library": "none"}}, "/settings/library", "setting_not_allowed"),
        ({"settings": None}, "/settings", "wrong_type"),
        ({"seed": -1}, "/seed", "seed_invalid"),
        ({"seed": 2**63}, "/seed", "seed_invalid"),
        ({"seed": "1"}, "/seed", "seed_invalid"),
        ({"colour": "red"}, "/colour", "unknown_key"),
    ],
)
def test_what_is_wrong_in_a_request_is_pointed_at_and_nothing_is_kept(
    service: Service, photo: str, change: dict[str, Any], pointer: str, code: str
) -> None:
    before = service.stored()
    answer = asked(service.client, json={**drawn.request(photo), **change})
    told = answer.json()
    assert (answer.status_code, told["code"]) == (422, code), told
    assert [fault["pointer"] for fault in told["errors"]] == [pointer]
    assert told["detail"].endswith(told["errors"][0]["detail"])
    assert service.stored() == before


@pytest.mark.parametrize("missing", ["photo", "strokes"])
def test_a_request_without_photo_or_strokes_is_refused(client: httpx.Client, photo: str, missing: str) -> None:
    request = {key: value for key, value in drawn.request(photo).items() if key != missing}
    answer = asked(client, json=request)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, f"/{missing}")


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"strokes": "{"}, 400),
        ({"strokes": '{"crown": {"points": [[1, 1], [2, 2], [1, 2]]}, "branches": []}'}, 422),
        ({"settings": '{"height": NaN}'}, 422),
        ({"settings": '{"height": "ten"}'}, 422),
        ({"seed": "-1"}, 422),
        ({"seed": "one"}, 400),
        ({"name": "a\nb"}, 422),
        ({"colour": "red"}, 422),
    ],
)
def test_a_form_that_is_refused_leaves_no_row(service: Service, change: dict[str, str], status: int) -> None:
    before = service.rows("photos"), service.rows("models")
    answer = asked(service.client, **drawn.form(drawn.encoded(seed=20), **change))
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert (service.rows("photos"), service.rows("models")) == before


def test_a_form_with_strokes_that_do_not_fit_its_photo_leaves_no_row(service: Service) -> None:
    before = service.rows("photos"), service.rows("models")
    strokes = {**drawn.STROKES, "branches": [{"points": [[5, 235], [5, 238]]}]}
    answer = asked(service.client, **drawn.form(drawn.encoded(seed=21), strokes=json.dumps(strokes)))
    assert answer.json()["errors"][0]["pointer"] == "/strokes/branches/0"
    assert (service.rows("photos"), service.rows("models")) == before


def test_a_form_with_a_field_twice_is_refused(client: httpx.Client) -> None:
    parts = drawn.form(drawn.encoded())
    parts["data"]["strokes"] = [parts["data"]["strokes"]] * 2
    answer = asked(client, **parts)
    assert (answer.status_code, "twice" in answer.json()["detail"]) == (400, True)


def test_a_form_with_long_strokes_is_taken(client: httpx.Client) -> None:
    branch = {"points": [[100 + 0.001 * at, 230 - 0.01 * at] for at in range(9000)]}
    strokes = json.dumps({**drawn.STROKES, "branches": [branch] * 20})
    assert len(strokes) > 2**20
    answer = asked(client, **drawn.form(drawn.encoded(), strokes=strokes))
    assert answer.status_code == 202, answer.text
    client.post(f"{answer.headers['location']}/cancel")
