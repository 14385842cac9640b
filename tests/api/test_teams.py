"""No team reaches what another has: each operation of the API is asked for another team's, by all that names it."""

import threading
import time
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import uvicorn
from fastapi import Request
from tests.api import drawn
from tests.api.teams import Belongings, operations, own_one_of_each

from treestroke.api import deps
from treestroke.api.app import make_app
from treestroke.service.principals import Principal
from treestroke.settings import read_settings


@pytest.fixture(scope="module")
def clients(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, httpx.Client]]:
    app = make_app(read_settings(data=tmp_path_factory.mktemp("data")))

    def of(request: Request) -> Principal:
        team = request.headers["x-team"]
        return Principal(f"usr_{team}", team, team, "owner")

    app.dependency_overrides[deps._principal] = of
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="warning"))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.05)
    port = server.servers[0].sockets[0].getsockname()[1]
    yield {
        team: httpx.Client(base_url=f"http://127.0.0.1:{port}", headers={"x-team": team}, timeout=60)
        for team in ("oaks", "elms")
    }
    server.should_exit = True
    thread.join()


@pytest.fixture(scope="module")
def oaks(clients: dict[str, httpx.Client]) -> httpx.Client:
    return clients["oaks"]


@pytest.fixture(scope="module")
def elms(clients: dict[str, httpx.Client]) -> httpx.Client:
    return clients["elms"]


@pytest.fixture(scope="module")
def theirs(oaks: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> Belongings:
    """What the oaks have."""
    return own_one_of_each(oaks, tmp_path_factory.mktemp("oaks"))


@pytest.fixture(scope="module")
def document(elms: httpx.Client) -> dict[str, Any]:
    return dict(elms.get("/openapi.json").json())


def test_each_operation_answers_404_for_what_another_team_has(
    elms: httpx.Client, document: dict[str, Any], theirs: Belongings
) -> None:
    asked = list(operations(document, theirs))
    assert len(asked) > 35
    answers = {str(one): one.ask(elms) for one in asked}
    assert {place: answer.status_code for place, answer in answers.items() if answer.status_code != 404} == {}
    assert not any(known in answer.text for answer in answers.values() for known in theirs.known)


def test_each_operation_finds_the_teams_own(oaks: httpx.Client, document: dict[str, Any], theirs: Belongings) -> None:
    reading = [one for one in operations(document, theirs) if one.verb == "GET"]
    found = {one.name for one in reading if one.ask(oaks).status_code == 200}
    assert {"get_photo", "get_image", "get_capture", "get_capture_photo", "get_capture_image", "get_clip"} <= found
    assert {"get_clip_video", "get_clip_frame", "get_model", "get_strokes"} <= found


def test_lists_hold_the_teams_own_alone(
    oaks: httpx.Client, elms: httpx.Client, document: dict[str, Any], theirs: Belongings
) -> None:
    lists = [path for path, verbs in document["paths"].items() if "get" in verbs and _is_list(verbs["get"])]
    assert {"/v1/photos", "/v1/captures", "/v1/clips", "/v1/models"} <= set(lists)
    for path in lists:
        assert any(known in oaks.get(path).text for known in theirs.known), path
        text = elms.get(path, params={"cursor": "999999"}).text + elms.get(path).text
        assert not any(known in text for known in theirs.known), path


@pytest.mark.parametrize("kind", ["photo", "capture", "clip"])
def test_a_model_of_what_another_team_has_is_refused(elms: httpx.Client, theirs: Belongings, kind: str) -> None:
    request = drawn.request(theirs.ids["pho"])
    del request["photo"]
    request[kind] = theirs.ids[{"photo": "pho", "capture": "cap", "clip": "clp"}[kind]]
    if kind == "capture":
        request["views"] = {"views": [{"photo": "0.png", **request.pop("strokes")}]}
    answer = elms.post("/v1/models", json=request)
    assert (answer.status_code, answer.json()["code"]) == (404, f"{kind}_not_found")


def test_a_photo_of_anothers_capture_is_not_found_in_ones_own(elms: httpx.Client, theirs: Belongings) -> None:
    own = elms.post("/v1/captures", json={"name": ""}).json()["id"]
    for verb, end in (("GET", ""), ("GET", "/image"), ("DELETE", "")):
        place = f"/v1/captures/{own}/photos/{theirs.photo_of_capture}{end}"
        assert elms.request(verb, place).status_code == 404


def test_an_idempotency_key_is_another_one_in_another_team(oaks: httpx.Client, elms: httpx.Client) -> None:
    made = []
    for client in (oaks, elms):
        photo = client.post("/v1/photos", files={"file": drawn.encoded()}).json()["id"]
        request = drawn.request(photo)
        answers = [client.post("/v1/models", json=request, headers={"Idempotency-Key": "one"}) for _ in range(2)]
        assert [answer.status_code for answer in answers] == [202, 202]
        assert answers[0].json()["id"] == answers[1].json()["id"]
        made.append(answers[0].json()["id"])
    assert made[0] != made[1]


def _is_list(operation: dict[str, Any]) -> bool:
    return any(parameter["name"] == "cursor" for parameter in operation.get("parameters", ()))
