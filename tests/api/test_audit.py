"""Whatever changes keys, members, the team or links, and whatever deletes, leaves one entry of the audit."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from sqlalchemy import select
from tests.api.teams import Asked, Belongings, operations, own_one_of_each
from tests.hosted import Hosted, hosting
from tests.postgres import PostgresServer

from treestroke.api.request_ids import HEADER
from treestroke.store.scope import SERVICE
from treestroke.store.tables import AuditRow, File, ModelPart, ModelRow

AUDITED = {
    "share_model": "share.made",
    "revoke_share": "share.revoked",
    "remove_capture_photo": "capture_photo.removed",
    "delete_capture": "capture.deleted",
    "restore_capture": "capture.restored",
    "delete_model": "model.deleted",
    "restore_model": "model.restored",
    "delete_photo": "photo.deleted",
    "delete_clip": "clip.deleted",
    "change_member": "member.changed",
    "remove_member": "member.removed",
    "revoke_key": "key.revoked",
    "change_webhook": "webhook.changed",
    "remove_webhook": "webhook.removed",
}
"""Action of each operation that names an id, in an order in which each finds what it changes."""
SENT: dict[str, tuple[str, str, dict[str, Any]]] = {
    "make_key": ("POST", "/v1/keys", {"name": "laptop"}),
    "add_member": ("POST", "/v1/members", {"name": "Ben", "role": "member"}),
    "rename_team": ("PATCH", "/v1/team", {"name": "Oaks"}),
    "make_webhook": ("POST", "/v1/webhooks", {"url": f"https:{'//'}hooks.invalid/told", "events": ["model.succeeded"]}),
}
"""The others, but for signing in and out."""
ACTIONS = {
    "make_key": "key.made",
    "add_member": "member.added",
    "rename_team": "team.renamed",
    "make_webhook": "webhook.made",
}
UNAUDITED = {
    *("add_photo", "trace_photo", "trace_sketches", "make_capture", "add_capture_photo", "solve_capture"),
    *("cancel_solve", "trace_capture", "rename_capture", "add_clip", "trace_clip", "add_piece", "delete_upload"),
    *("ask_for_model", "ask_for_siblings", "change_model", "cancel_model"),
    *("ping_webhook", "resend_delivery"),
}
"""Operations that only look, or make what a later deletion tells of."""


@pytest.fixture(scope="module")
def hosted(postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hosted]:
    with hosting(tmp_path_factory.mktemp("data"), postgres.fresh_with_tables()) as service:
        yield service


def client_of(hosted: Hosted, team: str, role: Any = "owner") -> httpx.Client:
    headers = {**hosted.client.headers, "Authorization": f"Bearer {hosted.key(role, team)}"}
    return httpx.Client(base_url=hosted.client.base_url, headers=headers, timeout=60)


@pytest.fixture(scope="module")
def oaks(hosted: Hosted) -> Iterator[httpx.Client]:
    with client_of(hosted, "Oaks") as client:
        yield client


@pytest.fixture(scope="module")
def document(oaks: httpx.Client) -> dict[str, Any]:
    return dict(oaks.get("/openapi.json").json())


@pytest.fixture(scope="module")
def owned(hosted: Hosted, oaks: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> Belongings:
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
def asked(document: dict[str, Any], owned: Belongings) -> dict[str, Asked]:
    return {one.name: one for one in operations(document, owned) if one.name in AUDITED}


def rows(hosted: Hosted) -> int:
    with hosted.database.of(SERVICE).reading() as session:
        return len(session.scalars(select(AuditRow.number)).all())


def newest(client: httpx.Client) -> dict[str, Any]:
    return dict(client.get("/v1/audit", params={"limit": 1}).json()["entries"][0])


def test_each_operation_that_writes_is_audited_or_named_as_not(document: dict[str, Any]) -> None:
    writing = {
        one["operationId"] for verbs in document["paths"].values() for verb, one in verbs.items() if verb != "get"
    }
    assert writing == {*AUDITED, *SENT, *UNAUDITED, "sign_in", "sign_out"}


def test_what_is_refused_leaves_none(hosted: Hosted, asked: dict[str, Asked]) -> None:
    with client_of(hosted, "Oaks", "viewer") as viewer, client_of(hosted, "Elms") as elms:
        before = rows(hosted)
        for one in asked.values():
            assert one.ask(viewer).status_code in (403, 404), one.name
            assert one.ask(elms).status_code == 404, one.name
        for verb, path, body in SENT.values():
            if path != "/v1/keys":  # a viewer makes keys of their own
                assert viewer.request(verb, path, json=body).status_code == 403
            assert elms.request(verb, path, json={"nonsense": 1}).status_code == 422
    assert rows(hosted) == before


def test_what_is_done_leaves_one(hosted: Hosted, oaks: httpx.Client, asked: dict[str, Asked]) -> None:
    who = oaks.get("/v1/session").json()["member"]
    sent = {name: asked[name].ask for name in AUDITED} | {
        name: lambda client, of=of: client.request(of[0], of[1], json=of[2]) for name, of in SENT.items()
    }
    for name, ask in sent.items():
        before = rows(hosted)
        answer = ask(oaks)
        assert answer.is_success, (name, answer.text)
        assert rows(hosted) == before + 1, name
        entry = newest(oaks)
        assert entry["action"] == {**AUDITED, **ACTIONS}[name]
        assert entry["who"] == {"id": who["id"], "name": who["name"]}
        assert entry["request_id"] == answer.headers[HEADER]
        assert (entry["address"], entry["credential"][:4]) == ("203.0.113.7", "key_")
        if name in asked:
            assert entry["subject"] in asked[name].place or name == "share_model"


def test_signing_in_and_out_and_a_key_that_is_over_are_told(hosted: Hosted, oaks: httpx.Client) -> None:
    key = hosted.key("owner", "Oaks")
    page = hosted.sign_in(key)
    assert newest(oaks)["action"] == "signed_in"
    hosted.client.delete("/v1/session", headers=page)
    assert newest(oaks)["action"] == "signed_out"
    made = oaks.get("/v1/keys").json()["keys"][0]["id"]
    oaks.delete(f"/v1/keys/{made}")
    assert hosted.client.post("/v1/session", json={"key": key}).status_code == 401
    refused = newest(oaks)
    assert (refused["action"], refused["who"], refused["subject"]) == ("sign_in.refused", None, made)


def test_it_is_the_teams_own_for_owners_in_pages(hosted: Hosted, oaks: httpx.Client) -> None:
    for _ in range(3):
        oaks.patch("/v1/team", json={"name": "Oaks"})
    first = oaks.get("/v1/audit", params={"limit": 2}).json()
    second = oaks.get("/v1/audit", params={"limit": 2, "before": first["next"]}).json()
    numbers = [int(entry["id"]) for entry in [*first["entries"], *second["entries"]]]
    assert numbers == sorted(set(numbers), reverse=True)
    assert len(numbers) == 4
    with client_of(hosted, "Beeches") as others, client_of(hosted, "Oaks", "member") as member:
        assert {entry["action"] for entry in others.get("/v1/audit").json()["entries"]} <= {
            *("team.made", "member.added", "key.made")
        }
        assert member.get("/v1/audit").status_code == 403


def test_no_key_and_no_token_is_told(hosted: Hosted, oaks: httpx.Client) -> None:
    key = oaks.post("/v1/keys", json={"name": "secret"}).json()["key"]
    text = oaks.get("/v1/audit", params={"limit": 100}).text
    assert key not in text
    assert '"digest"' not in text
    assert hosted.client.headers["Host"] not in text  # no address of a link
