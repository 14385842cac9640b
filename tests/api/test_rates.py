"""Rates and quotas of a service that teams share, as its answers tell them."""

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import httpx
import pytest
from tests.api import drawn, sketched
from tests.api.shared_service import as_person, shared_service
from tests.api.test_limits import noise
from tests.postgres import PostgresServer

from treestroke.api.app import make_app
from treestroke.api.rates import RATES
from treestroke.api.request_counts import Rate
from treestroke.settings import Settings

FEW = Rate("models", 2, 600)
"""A rate that no test is too slow to exceed."""


@pytest.fixture(scope="module")
def web(postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    quotas: dict[str, Any] = {"team_queued": 2, "team_models_a_day": 3, "team_stored_mb": 1}
    data, url = tmp_path_factory.mktemp("shared"), postgres.fresh()
    with shared_service(Settings(data=data, database_url=url, workers=0, tracers=1, **quotas)) as (client, _):
        yield client


def refusal(answer: httpx.Response) -> tuple[int, str]:
    assert answer.status_code == 429, answer.text
    assert int(answer.headers["retry-after"]) >= 1
    return answer.status_code, answer.json()["code"]


def ask(web: httpx.Client, team: str) -> httpx.Response:
    """Ask for a model of sketches, which brings no photo."""
    return web.post("/v1/models", json=sketched.request(), headers=as_person(team))


def test_the_table_of_rates_names_operations_that_there_are() -> None:
    paths = make_app(Settings()).openapi()["paths"]
    named = {operation["operationId"] for path in paths.values() for operation in path.values()}
    assert set(RATES) - named == set()
    traces = {name for name in named if name.startswith("trace_")}
    assert {name for name, rate in RATES.items() if rate and rate.name == "traces"} == traces


def test_each_answer_tells_what_is_left_of_its_rate(web: httpx.Client) -> None:
    for answer in (web.get("/v1/models", headers=as_person("ash")), web.get("/v1/models/x", headers=as_person("ash"))):
        assert answer.headers["ratelimit-policy"] == '"calls";q=50;w=1'
        assert answer.headers["ratelimit"].startswith('"calls";r=')
    answer = web.post("/v1/models", content=b"{}", headers=as_person("ash"))
    assert (answer.status_code, answer.headers["ratelimit-policy"]) == (422, '"models";q=60;w=60')


def test_whether_it_lives_is_asked_without_a_limit(web: httpx.Client) -> None:
    assert "ratelimit" not in web.get("/livez").headers


def test_beyond_the_rate_a_person_is_refused_and_nobody_else(
    web: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RATES, "ask_for_model", FEW)
    monkeypatch.setitem(RATES, "ask_for_siblings", FEW)
    for path in ("/v1/models", "/v1/models/mdl_1/siblings"):
        assert web.post(path, content=b"nonsense", headers=as_person("birch")).status_code in (400, 422)
    answer = web.post("/v1/models", content=b"nonsense", headers=as_person("birch"))
    assert refusal(answer) == (429, "rate_limited")
    assert answer.headers["ratelimit"].startswith('"models";r=0;t=')
    assert web.post("/v1/models", content=b"nonsense", headers=as_person("birch", "ben")).status_code in (400, 422)
    assert web.get("/v1/models", headers=as_person("birch")).status_code == 200


def test_without_a_key_requests_are_counted_by_their_address(
    web: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RATES, "version", FEW)
    answers = [web.get("/v1/version") for _ in range(3)]
    assert [answer.status_code for answer in answers] == [200, 200, 429]
    assert web.get("/v1/version", headers=as_person("cedar")).status_code == 200


def test_a_team_s_queue_and_its_models_of_a_day_are_full_for_itself_alone(web: httpx.Client) -> None:
    places = [ask(web, "elm").headers["location"] for _ in range(2)]
    assert refusal(ask(web, "elm")) == (429, "queue_full")
    assert ask(web, "fir").status_code == 202
    for _ in range(2):
        web.post(f"{places.pop()}/cancel", headers=as_person("elm"))
    assert ask(web, "elm").status_code == 202
    answer = ask(web, "elm")
    assert refusal(answer) == (429, "quota_exceeded")
    assert int(answer.headers["retry-after"]) > 3600
    assert "3" in answer.json()["detail"]


def test_beyond_what_a_team_may_store_it_stores_nothing_more_by_any_way(web: httpx.Client) -> None:
    own = as_person("holly")
    assert web.post("/v1/photos", files={"file": noise(500)}, headers=own).status_code == 201
    capture = web.post("/v1/captures", headers=own).json()["id"]
    ways = [
        web.post("/v1/photos", files={"file": noise(500, 1)}, headers=own),
        web.post("/v1/models", **drawn.form(noise(500, 2)), headers=own),
        web.post(f"/v1/captures/{capture}/photos", files={"file": noise(500, 3)}, headers=own),
        web.post("/v1/clips", content=bytes(400_000), headers={**own, "Upload-Length": "400000"}),
    ]
    assert [refusal(way) for way in ways] == [(429, "quota_exceeded")] * len(ways)
    assert web.post("/v1/photos", files={"file": noise(500)}, headers=as_person("ivy")).status_code == 201


def test_a_person_s_fourth_stream_is_refused_until_one_ends(web: httpx.Client) -> None:
    own = as_person("larch")
    place = f"{ask(web, 'larch').headers['location']}/events"
    with ExitStack() as streams:
        first = web.stream("GET", place, headers=own)
        with first as answer:
            assert answer.status_code == 200
            for _ in range(2):
                assert streams.enter_context(web.stream("GET", place, headers=own)).status_code == 200
            assert refusal(web.get(place, headers=own)) == (429, "quota_exceeded")
            with web.stream("GET", place, headers=as_person("larch", "ben")) as other:
                assert other.status_code == 200
            used = {one["name"]: one["used"] for one in web.get("/v1/limits", headers=own).json()["quotas"]}
            assert used["streams"] == 3
        assert next_status(web, place, own) == 200


def next_status(web: httpx.Client, place: str, own: dict[str, str]) -> int:
    """Follow until that is allowed: a place is free soon after its stream has ended."""
    for _ in range(200):
        with web.stream("GET", place, headers=own) as answer:
            if answer.status_code != 429:
                return answer.status_code
    return 429


def test_limits_tell_rates_and_quotas_of_who_asks(web: httpx.Client) -> None:
    own = as_person("maple")
    ask(web, "maple")
    limits = web.get("/v1/limits", headers=own).json()
    assert [(rate["name"], rate["requests"], rate["seconds"]) for rate in limits["rates"]] == [
        ("traces", 10, 1),
        ("models", 60, 60),
        ("uploads", 60, 60),
        ("calls", 50, 1),
    ]
    assert limits["rates"][1]["remaining"] == 59
    assert limits["quotas"] == [
        {"name": "stored_bytes", "limit": 1_000_000, "used": 0},
        {"name": "queued", "limit": 2, "used": 1},
        {"name": "running", "limit": 2, "used": 0},
        {"name": "models_a_day", "limit": 3, "used": 1},
        {"name": "streams", "limit": 3, "used": 0},
    ]
