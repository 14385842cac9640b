import json
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from tests.api import drawn
from tests.api.conftest import PATIENCE_SECONDS, Service
from tests.promises import kept

PLACE = "HERE"
MARKED: dict[str, Any] = {
    "crown": {"points": [[PLACE, 30], [170, 40], [150, 160], [30, 150]]},
    "branches": drawn.STROKES["branches"],
}


def told(answer: httpx.Response) -> dict[str, Any]:
    """See that an answer is a refusal in its right form, and read it."""
    assert answer.status_code in (400, 422), (answer.status_code, answer.text[:300])
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["status"] == answer.status_code
    assert len(problem["detail"]) < 600
    return dict(problem)


def sent(client: httpx.Client, method: str, place: str, body: str | bytes) -> httpx.Response:
    content = body if isinstance(body, bytes) else body.encode("utf-8", "surrogatepass")
    return client.request(method, place, content=content, headers={"Content-Type": "application/json"})


@pytest.fixture(params=["trace", "model"])
def ask(request: pytest.FixtureRequest, client: httpx.Client, photo: str) -> Callable[[str | bytes], httpx.Response]:
    """Send a strokes' JSON text, to be traced or as a part of a request for a model."""
    if request.param == "trace":
        return lambda text: sent(client, "POST", f"/v1/photos/{photo}/trace", text)

    def model(text: str | bytes) -> httpx.Response:
        body = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
        return sent(client, "POST", "/v1/models", b'{"photo": "%s", "strokes": %s}' % (photo.encode(), body))

    return model


@pytest.mark.parametrize(
    ("value", "code"),
    [
        ("NaN", "non_finite_number"),
        ("Infinity", "non_finite_number"),
        ("-Infinity", "non_finite_number"),
        ("1e999", "non_finite_number"),
        ("-1e999", "non_finite_number"),
        ("9" * 5000, "non_finite_number"),
        ('"NaN"', "wrong_type"),
        ('"5"', "wrong_type"),
        ("true", "wrong_type"),
        ("null", "wrong_type"),
        ("[5]", "wrong_type"),
        ("{}", "wrong_type"),
    ],
)
def test_what_is_no_number_is_pointed_at(ask: Callable[[str], httpx.Response], value: str, code: str) -> None:
    problem = told(ask(json.dumps(MARKED).replace(f'"{PLACE}"', value)))
    assert problem["code"] == code
    (fault,) = problem["errors"]
    assert fault["pointer"].endswith("/crown/points/0")


@pytest.mark.parametrize("value", ["1e308", "-0.0", "1e-400", "5.000000000000000000000000000001", "9" * 300])
def test_odd_numbers_are_numbers(client: httpx.Client, photo: str, value: str) -> None:
    text = json.dumps(MARKED).replace(f'"{PLACE}"', value)
    assert sent(client, "POST", f"/v1/photos/{photo}/trace", text).status_code == 200


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        '{"crown": }',
        "[" * 100_000,
        '{"a":' * 100_000,
        "[" * 100_000 + "]" * 100_000,
        '{"crown": {"points": [[1, 2]]}, "crown": {"points": [[1, 2]]}}',
        '{"crown": {"points": [[1, 2]], "points": []}}',
        b'\xff\xfe{"crown": 1}',
        b'{"crown": "\xff"}',
        "{'crown': 1}",
        '{"crown": 1} x',
        '{"crown": "\0"}',
        "nan",
        '{"crown": 0x10}',
    ],
)
def test_what_is_no_json_is_malformed(ask: Callable[[str | bytes], httpx.Response], text: str | bytes) -> None:
    answer = ask(text)
    assert (answer.status_code, told(answer)["code"]) == (400, "malformed_json")


@pytest.mark.parametrize(
    "text",
    [
        "null",
        "true",
        "5",
        '"text"',
        "[]",
        "{}",
        '{"crown": null}',
        '{"crown": {"points": null}}',
        '{"crown": {"points": {"0": 1}}}',
        '{"crown": {"points": "[[1,2]]"}}',
        '{"crown": {"points": [[1, 2, 3]]}}',
        '{"crown": {"points": [[1]]}}',
        '{"crown": {"points": [1, 2]}}',
        '{"crown": {}}',
        '{"\\ud800": 1}',
        '{"\\u0000": 1}',
        '{"crown": {"points": [[1, 2]], "\\udfff": 1}}',
        '{"branches": 5, "crown": {"points": [[1, 2]]}}',
        '{"erase": [5], "crown": {"points": [[1, 2]]}}',
        '{"__proto__": {}}',
        json.dumps({"k" * 100_000: 1}),
        '{"crown": {"points": ' + "[" * 500 + "]" * 500 + "}}",
    ],
)
def test_json_of_another_form_is_refused(ask: Callable[[str], httpx.Response], text: str) -> None:
    told(ask(text))


@pytest.mark.parametrize("name", [r"\ud800", r"a\udfffb", r"\u0000", "\\n", r"\u001b[31m", r"\u202e"])
def test_a_name_that_is_no_text_is_refused(client: httpx.Client, made: dict[str, Any], name: str) -> None:
    place = f"/v1/models/{made['id']}"
    problem = told(sent(client, "PATCH", place, f'{{"name": "{name}"}}'))
    assert (problem["code"], problem["errors"][0]["pointer"]) == ("name_invalid", "/name")
    request = json.dumps(drawn.request(made["photo"], name="NAME")).replace("NAME", name)
    assert told(sent(client, "POST", "/v1/models", request))["code"] == "name_invalid"
    assert client.get(place).json()["name"] == made["name"]


@pytest.mark.parametrize(
    "body",
    [
        "",
        "[]",
        "null",
        "{",
        "{}",
        '{"name": 1}',
        '{"name": "a", "id": "b"}',
        '{"name": "a", "name": "b"}',
        '{"name": NaN}',
        "[" * 50_000,
    ],
)
def test_a_request_for_another_name_is_strict_too(client: httpx.Client, made: dict[str, Any], body: str) -> None:
    told(sent(client, "PATCH", f"/v1/models/{made['id']}", body))


@pytest.mark.parametrize("value", ["NaN", "1e999", "true", '"10"', "null", "9" * 5000, "[]", "-0.0"])
@pytest.mark.parametrize("name", ["height", "iterations", "leaf_size", "foliage"])
def test_a_setting_of_another_type_is_refused(client: httpx.Client, photo: str, name: str, value: str) -> None:
    request = json.dumps(drawn.request(photo, settings={name: PLACE})).replace(f'"{PLACE}"', value)
    problem = told(sent(client, "POST", "/v1/models", request))
    assert problem["errors"][0]["pointer"] == f"/settings/{name}"


@pytest.mark.parametrize("value", ["NaN", "1e999", "-1", "1.5", "true", '"1"', "null", "9" * 5000, str(2**63)])
def test_a_seed_of_another_type_is_refused(client: httpx.Client, photo: str, value: str) -> None:
    request = json.dumps(drawn.request(photo, seed=PLACE)).replace(f'"{PLACE}"', value)
    assert told(sent(client, "POST", "/v1/models", request))["errors"][0]["pointer"] == "/seed"


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "application/xml"])
def test_another_type_of_body_is_refused(client: httpx.Client, made: dict[str, Any], kind: str) -> None:
    calls = [
        ("POST", f"/v1/photos/{made['photo']}/trace"),
        ("POST", "/v1/models"),
        ("PATCH", f"/v1/models/{made['id']}"),
    ]
    for method, place in calls:
        answer = client.request(method, place, content=b"{}", headers={"Content-Type": kind})
        assert (answer.status_code, answer.json()["code"]) == (415, "unsupported_media_type")


@pytest.mark.parametrize(
    "make",
    [
        lambda: b'{"crown": {"points": [' + b"[1,2]," * 10_600_000 + b"[1,2]]}}",
        lambda: b'{"crown": [' + b"[]," * 21_000_000 + b"[]]}",
        lambda: b'{"crown": [' + b"{}," * 21_000_000 + b"{}]}",
        lambda: b'{"crown": [' + b"1," * 31_000_000 + b"1]}",
        lambda: b'{"crown": [' + b"[]," * 2_100_000 + b"[]]}",
        lambda: b'{"' + b"k" * 63_000_000 + b'": 1}',
        lambda: b'{"crown": ' + b"1" * 63_000_000 + b"}",
    ],
    ids=["points", "lists", "objects", "numbers", "just not too many lists", "key", "digits"],
)
@pytest.mark.parametrize("path", ["trace", "model"])
def test_an_enormous_body_is_refused_while_others_are_answered(
    service: Service, photo: str, make: Callable[[], bytes], path: str
) -> None:
    text = make()
    place = f"/v1/photos/{photo}/trace" if path == "trace" else "/v1/models"
    body = text if path == "trace" else b'{"photo": "%s", "strokes": %s}' % (photo.encode(), text)
    with probing(service, most_s=0.2):
        answer = sent(service.client, "POST", place, body)
    assert answer.status_code in (400, 422, 503), answer.text[:300]
    assert len(answer.content) < 2000


@contextmanager
def probing(service: Service, most_s: float) -> Iterator[None]:
    """Ask meanwhile whether the service lives, again and again, each time answered within what is promised."""
    over = threading.Event()

    def probe() -> None:
        with httpx.Client(base_url=service.url, timeout=PATIENCE_SECONDS) as client:
            while not over.wait(0.02):
                with kept(most_s):
                    assert client.get("/livez").status_code == 200

    with ThreadPoolExecutor(1) as pool:
        probes = pool.submit(probe)
        try:
            yield
        finally:
            over.set()
        probes.result()
