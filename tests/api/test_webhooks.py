"""Webhooks as owners make and change them."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from sqlalchemy import select, update
from tests.faults.processes import wait_for
from tests.hosted import Hosted, hosting
from tests.postgres import PostgresServer

from treestroke.store.scope import SERVICE
from treestroke.store.webhook_tables import DeliveryRow, WebhookRow

HTTPS = f"https:{'//'}"
URL = f"{HTTPS}hooks.invalid/trees"
"""A name that nobody has, so that nothing is sent."""
EVENTS = ["model.succeeded", "model.failed"]
SECONDS = 120.0


@pytest.fixture(scope="module")
def hosted(tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[Hosted]:
    with hosting(tmp_path_factory.mktemp("webhooks") / "data", postgres.fresh_with_tables()) as service:
        yield service


class Owner:
    """An owner of a team of their own."""

    def __init__(self, hosted: Hosted, team: str) -> None:
        self.hosted, self.key = hosted, hosted.key(team=team)

    def ask(self, method: str, path: str, **request: Any) -> httpx.Response:
        return self.hosted.ask(self.key, method, path, **request)

    def make(self, **changed: Any) -> dict[str, Any]:
        answer = self.ask("POST", "/v1/webhooks", json={"url": URL, "events": EVENTS, **changed})
        assert answer.status_code == 201, answer.text
        return dict(answer.json())

    def change(self, id: str, **changes: Any) -> dict[str, Any]:
        answer = self.ask("PATCH", f"/v1/webhooks/{id}", json=changes)
        assert answer.status_code == 200, answer.text
        return dict(answer.json())

    def listed(self) -> list[dict[str, Any]]:
        return list(self.ask("GET", "/v1/webhooks").json()["webhooks"])


@pytest.fixture
def owner(hosted: Hosted, request: pytest.FixtureRequest) -> Owner:
    return Owner(hosted, request.node.name)


def test_the_secret_is_told_once_and_nowhere_kept(owner: Owner) -> None:
    made = owner.make()
    assert made["secret"].startswith("whsec_")
    assert (made["url"], made["events"], made["enabled"], made["last_delivery"]) == (URL, EVENTS, True, None)
    (listed,) = owner.listed()
    assert "secret" not in listed
    assert owner.change(made["id"], enabled=True)["secret"] is None
    with owner.hosted.database.of(SERVICE).reading() as session:
        row = session.scalars(select(WebhookRow).where(WebhookRow.id == made["id"])).one()
    assert made["secret"].removeprefix("whsec_") not in str(vars(row))


def test_a_new_secret_is_another_one(owner: Owner) -> None:
    made = owner.make()
    rotated = owner.change(made["id"], rotate=True)["secret"]
    assert rotated.startswith("whsec_")
    assert rotated != made["secret"]


@pytest.mark.parametrize(
    "url",
    [
        *(
            f"http:{'//'}8.8.8.8/",
            f"{HTTPS}127.0.0.1/",
            f"{HTTPS}localhost/",
            f"{HTTPS}169.254.169.254/latest/meta-data",
        ),
        *(f"{HTTPS}100.64.0.1/", f"{HTTPS}10.0.0.1/", f"{HTTPS}[::1]/", f"{HTTPS}[::ffff:127.0.0.1]/", f"{HTTPS}0/"),
        *(f"{HTTPS}2130706433/", f"{HTTPS}[64:ff9b::7f00:1]/", f"{HTTPS}ann:pw@8.8.8.8/", "8.8.8.8", "file:///etc"),
    ],
)
def test_an_address_that_is_not_public_is_refused(owner: Owner, url: str) -> None:
    made = owner.make()
    for answer in (
        owner.ask("POST", "/v1/webhooks", json={"url": url, "events": EVENTS}),
        owner.ask("PATCH", f"/v1/webhooks/{made['id']}", json={"url": url}),
    ):
        assert (answer.status_code, answer.json()["code"]) == (422, "webhook_address")
        assert answer.json()["errors"][0]["pointer"] == "/url"
    assert [one["url"] for one in owner.listed()] == [URL]


@pytest.mark.parametrize("body", [{}, {"url": URL}, {"url": URL, "events": []}, {"url": URL, "events": ["tree.fell"]}])
def test_what_is_no_request_for_a_webhook(owner: Owner, body: dict[str, Any]) -> None:
    assert owner.ask("POST", "/v1/webhooks", json=body).status_code == 422
    assert owner.ask("POST", "/v1/webhooks", json={"url": f"{URL}{'x' * 2000}", "events": EVENTS}).status_code == 422


def test_a_team_has_at_most_ten(owner: Owner) -> None:
    made = [owner.make()["id"] for _ in range(10)]
    answer = owner.ask("POST", "/v1/webhooks", json={"url": URL, "events": EVENTS})
    assert (answer.status_code, answer.json()["code"]) == (409, "too_many_webhooks")
    assert owner.ask("DELETE", f"/v1/webhooks/{made[0]}").status_code == 204
    owner.make()


def test_a_ping_is_tried_at_once_and_logged(owner: Owner) -> None:
    id = owner.make()["id"]
    pinged = owner.ask("POST", f"/v1/webhooks/{id}/ping")
    assert (pinged.status_code, pinged.json()["event"], pinged.json()["state"]) == (202, "ping", "waiting")

    def log() -> list[dict[str, Any]]:
        return list(owner.ask("GET", f"/v1/webhooks/{id}/deliveries").json()["deliveries"])

    wait_for(lambda: log()[0]["state"] == "failed", SECONDS, "the attempt", 0.2)
    (delivery,) = log()
    assert (delivery["id"], delivery["attempts"], delivery["status"]) == (pinged.json()["id"], 1, None)
    assert delivery["error"] == "the name hooks.invalid is not known"
    assert owner.listed()[0]["last_delivery"] == delivery
    assert owner.ask("POST", f"/v1/deliveries/{delivery['id']}/resend").status_code == 202
    wait_for(lambda: (log()[0]["state"], log()[0]["attempts"]) == ("failed", 2), SECONDS, "the second attempt", 0.2)


def test_the_log_has_pages_newest_first(owner: Owner) -> None:
    id = owner.make()["id"]
    pinged = [owner.ask("POST", f"/v1/webhooks/{id}/ping").json()["id"] for _ in range(3)]
    page = owner.ask("GET", f"/v1/webhooks/{id}/deliveries", params={"limit": 2}).json()
    rest = owner.ask("GET", f"/v1/webhooks/{id}/deliveries", params={"cursor": page["next"]}).json()
    assert [one["id"] for one in [*page["deliveries"], *rest["deliveries"]]] == pinged[::-1]
    assert rest["next"] is None


def test_nothing_is_sent_to_a_webhook_that_is_disabled(owner: Owner) -> None:
    id = owner.make()["id"]
    sent = owner.ask("POST", f"/v1/webhooks/{id}/ping").json()["id"]
    assert owner.change(id, enabled=False)["enabled"] is False
    for path in (f"/v1/webhooks/{id}/ping", f"/v1/deliveries/{sent}/resend"):
        answer = owner.ask("POST", path)
        assert (answer.status_code, answer.json()["code"]) == (409, "webhook_disabled")
    with owner.hosted.database.of(SERVICE).writing() as session:
        session.execute(update(WebhookRow).where(WebhookRow.id == id).values(disabled_reason="gone", failures=4))
    again = owner.change(id, enabled=True, events=["capture.solved", "capture.solved"])
    assert (again["enabled"], again["disabled_reason"], again["events"]) == (True, None, ["capture.solved"])


def test_a_webhook_is_removed_with_its_messages(owner: Owner) -> None:
    id = owner.make()["id"]
    owner.ask("POST", f"/v1/webhooks/{id}/ping")
    assert owner.ask("DELETE", f"/v1/webhooks/{id}").status_code == 204
    for method, path in (("DELETE", ""), ("PATCH", ""), ("POST", "/ping"), ("GET", "/deliveries")):
        body = {"json": {"enabled": True}} if method == "PATCH" else {}
        answer = owner.ask(method, f"/v1/webhooks/{id}{path}", **body)
        assert (answer.status_code, answer.json()["code"]) == (404, "webhook_not_found")
    with owner.hosted.database.of(SERVICE).reading() as session:
        assert session.scalars(select(DeliveryRow).where(DeliveryRow.webhook == id)).all() == []


def test_webhooks_are_for_owners_with_the_scope_team(hosted: Hosted) -> None:
    for role, scopes, code in (
        ("member", ("trees", "team"), "role_missing"),
        ("viewer", ("trees", "team"), "role_missing"),
        ("owner", ("trees",), "scope_missing"),
    ):
        key = hosted.key(role, "Limes", scopes)  # type: ignore[arg-type]
        answer = hosted.ask(key, "GET", "/v1/webhooks")
        assert (answer.status_code, answer.json()["code"]) == (403, code)
