"""A service without keys, whose only person need not sign in."""

import httpx
import pytest


def test_its_only_person_is_always_signed_in(client: httpx.Client) -> None:
    told = client.get("/v1/session").json()
    assert told == {
        "hosted": False,
        "member": {"id": "local", "name": "", "role": "owner"},
        "team": {"id": "local", "name": "local"},
        "scopes": ["trees", "team"],
        "read_only": False,
        "expires": None,
    }
    answer = client.post("/v1/session", json={"key": "whatever"})
    assert (answer.json(), "Set-Cookie" in answer.headers) == (told, False)
    assert client.delete("/v1/session").status_code == 204
    assert client.get("/v1/session").json() == told


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/v1/keys"),
        ("POST", "/v1/keys"),
        ("DELETE", "/v1/keys/key_0"),
        ("GET", "/v1/team"),
        ("PATCH", "/v1/team"),
        ("GET", "/v1/members"),
        ("POST", "/v1/members"),
        ("PATCH", "/v1/members/usr_0"),
        ("DELETE", "/v1/members/usr_0"),
    ],
)
def test_it_has_neither_keys_nor_members(client: httpx.Client, method: str, path: str) -> None:
    answer = client.request(method, path, json={"name": "x"})
    assert (answer.status_code, answer.json()["code"]) == (403, "not_hosted")


def test_its_document_asks_for_no_key(client: httpx.Client) -> None:
    document = client.get("/openapi.json").json()
    assert not any("security" in operation for path in document["paths"].values() for operation in path.values())
