"""No team reaches what another has: each operation of the API is asked for another team's, by all that names it."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from sqlalchemy import select
from tests.api import drawn
from tests.api.teams import Belongings, operations, own_one_of_each
from tests.hosted import Hosted, hosting
from tests.postgres import PostgresServer

from treestroke.store.scope import SERVICE
from treestroke.store.tables import File, ModelPart, ModelRow


@pytest.fixture(scope="module")
def hosted(postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hosted]:
    with hosting(tmp_path_factory.mktemp("data"), postgres.fresh_with_tables()) as service:
        yield service


def client_of(hosted: Hosted, team: str) -> httpx.Client:
    headers = {**hosted.client.headers, "Authorization": f"Bearer {hosted.key(team=team)}"}
    return httpx.Client(base_url=hosted.client.base_url, headers=headers, timeout=60)


@pytest.fixture(scope="module")
def oaks(hosted: Hosted) -> Iterator[httpx.Client]:
    with client_of(hosted, "Oaks") as client:
        yield client


@pytest.fixture(scope="module")
def elms(hosted: Hosted) -> Iterator[httpx.Client]:
    with client_of(hosted, "Elms") as client:
        yield client


@pytest.fixture(scope="module")
def theirs(hosted: Hosted, oaks: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> Belongings:
    """What the oaks have."""

    def finish(model: str) -> None:
        with hosted.database.of(SERVICE).writing() as session:
            row = session.scalars(select(ModelRow).where(ModelRow.id == model)).one()
            part = session.scalars(select(ModelPart).where(ModelPart.model == model)).first()
            assert part is not None
            row.status, row.progress = "succeeded", 1.0
            session.add(File(team=row.team, model=model, name="tree.glb", blob=part.blob, bytes=1))

    return own_one_of_each(oaks, tmp_path_factory.mktemp("oaks"), finish)


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
    assert {"get_clip_video", "get_clip_frame", "get_model", "get_strokes", "get_tree"} <= found


def test_lists_hold_the_teams_own_alone(
    oaks: httpx.Client, elms: httpx.Client, document: dict[str, Any], theirs: Belongings
) -> None:
    lists = [
        path
        for path, verbs in document["paths"].items()
        if "get" in verbs and "{" not in path and _is_list(verbs["get"])
    ]
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
        request = drawn.request(photo, seed=5)
        answers = [client.post("/v1/models", json=request, headers={"Idempotency-Key": "one"}) for _ in range(2)]
        assert [answer.status_code for answer in answers] == [202, 202]
        assert answers[0].json()["id"] == answers[1].json()["id"]
        made.append(answers[0].json()["id"])
    assert made[0] != made[1]


def _is_list(operation: dict[str, Any]) -> bool:
    return any(parameter["name"] == "cursor" for parameter in operation.get("parameters", ()))
