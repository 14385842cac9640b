"""A hosted service as programs, browsers and proxies meet it."""

from collections.abc import Iterator

import httpx
import pytest
from tests.hosted import HOST, ORIGIN, Hosted, hosting, page_headers
from tests.postgres import PostgresServer

from treestroke.api.identity import COOKIE
from treestroke.api.sign_ins import MOST_A_MINUTE
from treestroke.client import Client, ServiceError
from treestroke.service.key_format import new_key

OPEN = ("/livez", "/readyz", "/openapi.json", "/", "/favicon.ico", "/page/nothing.js")


@pytest.fixture(scope="module")
def hosted(tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[Hosted]:
    with hosting(tmp_path_factory.mktemp("hosted") / "data", postgres.fresh_with_tables()) as service:
        yield service


def code(answer: httpx.Response) -> tuple[int, str]:
    return answer.status_code, answer.json()["code"]


def test_without_a_key_only_what_is_open_is_answered(hosted: Hosted) -> None:
    document = hosted.client.get("/openapi.json").json()
    for path in OPEN:
        assert hosted.client.get(path).status_code != 401, path
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            answer = hosted.client.request(method, path.replace("{id}", "mdl_" + "0" * 24))
            is_open = operation["security"] == []
            assert is_open == (answer.status_code != 401), operation["operationId"]
            if not is_open:
                assert code(answer) == (401, "unauthenticated")
                assert answer.headers["WWW-Authenticate"] == "Bearer"


UNKNOWN_KEY = pytest.param(f"Bearer {new_key()}", id="unknown")


@pytest.mark.parametrize("sent", ["Basic dXNlcjpwYXNz", "Bearer", "Bearer ts_x", UNKNOWN_KEY, "", "ts_x"])
def test_what_is_no_valid_key_is_refused(hosted: Hosted, sent: str) -> None:
    answer = hosted.client.get("/v1/models", headers={"Authorization": sent})
    assert code(answer) == (401, "unauthenticated")


def test_a_key_in_the_address_is_none(hosted: Hosted) -> None:
    assert hosted.client.get("/v1/models", params={"key": hosted.key(), "token": hosted.key()}).status_code == 401


def test_a_key_does_what_its_rule_allows(hosted: Hosted) -> None:
    looks, trees = hosted.key("viewer"), hosted.key("owner", scopes=("trees",))
    reads = hosted.key("owner", read_only=True)
    assert hosted.ask(looks, "GET", "/v1/models").status_code == 200
    assert code(hosted.ask(looks, "POST", "/v1/captures")) == (403, "role_missing")
    assert hosted.ask(trees, "POST", "/v1/captures").status_code == 201
    assert code(hosted.ask(trees, "GET", "/v1/members")) == (403, "scope_missing")
    assert hosted.ask(reads, "GET", "/v1/members").status_code == 200
    assert code(hosted.ask(reads, "POST", "/v1/members", json={"name": "Ben"})) == (403, "read_only")


def test_a_browser_signs_in_by_a_cookie_that_no_script_and_no_other_site_has(hosted: Hosted) -> None:
    key = hosted.key("owner")
    answer = hosted.client.post("/v1/session", json={"key": key})
    name, *flags = (part.strip() for part in answer.headers["Set-Cookie"].split(";"))
    assert name.startswith(f"{COOKIE}=")
    assert {"HttpOnly", "Secure", "SameSite=strict", "Path=/"} < set(flags)
    assert not any(flag.startswith("Domain") for flag in flags)
    assert answer.json() == hosted.client.get("/v1/session", headers=page_headers(answer)).json()
    told = answer.json()
    assert (told["hosted"], told["member"]["role"], told["team"]["name"]) == (True, "owner", "Oaks")
    assert (told["scopes"], told["read_only"]) == (["trees", "team"], False)


def test_signing_in_takes_no_session_that_was_given_before(hosted: Hosted) -> None:
    key = hosted.key("owner")
    for before in (f"{COOKIE}=planted", hosted.sign_in(key)["Cookie"]):
        answer = hosted.client.post("/v1/session", json={"key": key}, headers={"Cookie": before, "Origin": ORIGIN})
        assert page_headers(answer)["Cookie"] != before
        assert hosted.client.get("/v1/session", headers={"Cookie": before}).status_code == 401


def test_a_browser_that_signed_out_is_signed_out(hosted: Hosted) -> None:
    page = hosted.sign_in(hosted.key("owner"))
    answer = hosted.client.delete("/v1/session", headers=page)
    assert answer.status_code == 204
    assert "Max-Age=0" in answer.headers["Set-Cookie"]
    assert hosted.client.get("/v1/session", headers=page).status_code == 401


@pytest.mark.parametrize(
    "origin", [None, "null", f"http:{'//'}{HOST}", f"{ORIGIN}:8443", f"{ORIGIN}.evil.example", f"https:{'//'}127.0.0.1"]
)
def test_a_browser_writes_from_the_service_s_own_page_alone(hosted: Hosted, origin: str | None) -> None:
    page = hosted.sign_in(hosted.key("owner"))
    others = {"Cookie": page["Cookie"]} | ({} if origin is None else {"Origin": origin})
    assert code(hosted.client.post("/v1/captures", headers=others)) == (403, "foreign_origin")
    assert hosted.client.post("/v1/captures", headers=page).status_code == 201


def test_a_key_that_is_revoked_is_refused_at_the_next_request(hosted: Hosted) -> None:
    owner, key = hosted.key("owner"), hosted.key("member")
    page = hosted.sign_in(key)
    own = hosted.ask(key, "GET", "/v1/keys").json()["keys"][0]
    assert hosted.client.get("/v1/models", headers=page).status_code == 200
    assert hosted.ask(owner, "DELETE", f"/v1/keys/{own['id']}").status_code == 204
    assert hosted.ask(key, "GET", "/v1/models").status_code == 401
    assert hosted.client.get("/v1/models", headers=page).status_code == 401


def test_a_role_that_is_lowered_holds_at_the_next_request(hosted: Hosted) -> None:
    owner = hosted.key("owner")
    member = hosted.ask(owner, "POST", "/v1/members", json={"name": "Ben"}).json()
    made = hosted.ask(owner, "POST", "/v1/keys", json={"name": "for Ben", "member": member["id"]}).json()
    assert hosted.ask(made["key"], "POST", "/v1/captures").status_code == 201
    hosted.ask(owner, "PATCH", f"/v1/members/{member['id']}", json={"role": "viewer"})
    assert code(hosted.ask(made["key"], "POST", "/v1/captures")) == (403, "role_missing")
    assert hosted.ask(owner, "DELETE", f"/v1/members/{member['id']}").status_code == 204
    assert hosted.ask(made["key"], "GET", "/v1/models").status_code == 401


def test_a_key_is_shown_once(hosted: Hosted) -> None:
    owner = hosted.key("owner")
    made = hosted.ask(owner, "POST", "/v1/keys", json={"name": "farm", "days": 30}).json()
    listed = hosted.ask(owner, "GET", "/v1/keys")
    assert made["key"] not in listed.text
    assert made["beginning"] == made["key"][:7]
    assert {**next(key for key in listed.json()["keys"] if key["id"] == made["id"]), "key": made["key"]} == made
    assert made["expires"] - made["created"] == pytest.approx(30 * 86_400)
    beyond = hosted.ask(made["key"], "POST", "/v1/keys", json={"name": "more"})
    assert code(beyond) == (403, "scope_missing")


def test_the_last_owner_of_a_team_stays(hosted: Hosted) -> None:
    owner = hosted.key("owner", team="Elms")
    (member,) = hosted.ask(owner, "GET", "/v1/members").json()["members"]
    assert code(hosted.ask(owner, "DELETE", f"/v1/members/{member['id']}")) == (409, "last_owner")
    assert code(hosted.ask(owner, "PATCH", f"/v1/members/{member['id']}", json={"role": "viewer"}))[1] == "last_owner"


def test_another_team_s_keys_and_members_do_not_exist(hosted: Hosted) -> None:
    oaks, elms = hosted.key("owner"), hosted.key("owner", team="Elms")
    member = hosted.ask(oaks, "GET", "/v1/members").json()["members"][0]["id"]
    key = hosted.ask(oaks, "GET", "/v1/keys").json()["keys"][0]["id"]
    assert code(hosted.ask(elms, "DELETE", f"/v1/keys/{key}")) == (404, "key_not_found")
    assert code(hosted.ask(elms, "DELETE", f"/v1/members/{member}")) == (404, "member_not_found")
    assert code(hosted.ask(elms, "PATCH", f"/v1/members/{member}", json={"name": "x"})) == (404, "member_not_found")
    told = hosted.ask(elms, "POST", "/v1/keys", json={"name": "theirs", "member": member})
    assert code(told) == (404, "member_not_found")


def test_who_fails_to_sign_in_too_often_waits_and_nobody_else_does(hosted: Hosted) -> None:
    def sign_in(address: str, key: str) -> httpx.Response:
        return hosted.client.post("/v1/session", json={"key": key}, headers={"X-Forwarded-For": address})

    answers = [code(sign_in(f"2001:db8::{tried}", new_key())) for tried in range(2 * MOST_A_MINUTE)]
    assert answers[: MOST_A_MINUTE // 2] == [(401, "unauthenticated")] * (MOST_A_MINUTE // 2)
    answer = sign_in("2001:db8::ffff", hosted.key())
    assert code(answer) == (429, "rate_limited")
    assert 1 <= int(answer.headers["Retry-After"]) <= 60
    assert sign_in("2001:db8:0:1::1", hosted.key()).status_code == 200


def test_after_too_many_wrong_keys_an_address_waits_with_them_and_a_valid_key_is_answered(hosted: Hosted) -> None:
    def ask(key: str, address: str = "198.51.100.9") -> httpx.Response:
        headers = {"Authorization": f"Bearer {key}", "X-Forwarded-For": address}
        return hosted.client.get("/v1/models", headers=headers)

    answers = [ask(new_key()) for _ in range(2 * MOST_A_MINUTE)]
    assert code(answers[0]) == (401, "unauthenticated")
    assert code(answers[-1]) == (429, "rate_limited")
    assert 1 <= int(answers[-1].headers["Retry-After"]) <= 60
    assert ask(hosted.key()).status_code == 200
    assert code(ask(new_key(), "198.51.100.10")) == (401, "unauthenticated")


def test_the_client_sends_the_key_that_it_was_given_or_that_of_the_environment(
    hosted: Hosted, monkeypatch: pytest.MonkeyPatch
) -> None:
    address = str(hosted.client.base_url)
    with Client(address, key=hosted.key()) as client:
        assert list(client.models()) == []
    with Client(address) as client, pytest.raises(ServiceError) as refused:
        list(client.models())
    assert (refused.value.status, refused.value.code) == (401, "unauthenticated")
    monkeypatch.setenv("TREESTROKE_KEY", hosted.key())
    with Client(address) as client:
        assert list(client.photos()) == []


@pytest.mark.parametrize("host", ["evil.example", f"{HOST}.evil.example", "10.0.0.1", ""])
def test_it_answers_to_its_own_names_alone(hosted: Hosted, host: str) -> None:
    assert code(hosted.client.get("/livez", headers={"Host": host})) == (403, "foreign_host")
    assert hosted.client.get("/livez", headers={"Host": "127.0.0.1"}).status_code == 200


def test_browsers_are_told_to_come_by_tls_where_they_came_by_it(hosted: Hosted) -> None:
    assert "max-age" in hosted.client.get("/livez").headers["Strict-Transport-Security"]
    plain = hosted.client.get("/livez", headers={"X-Forwarded-Proto": "http"})
    assert "Strict-Transport-Security" not in plain.headers


def test_the_document_says_how_one_is_known(hosted: Hosted) -> None:
    document = hosted.client.get("/openapi.json").json()
    assert set(document["components"]["securitySchemes"]) == {"key", "session"}
    assert document["paths"]["/v1/models"]["post"]["security"] == [{"key": []}, {"session": []}]
