"""Links to models: what they show to anybody, and until when."""

import io
import json
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image
from sqlalchemy import select, update
from tests.hosted import ORIGIN, Hosted, hosting
from tests.postgres import PostgresServer
from tests.rows import add_model

from treestroke.api.routes.page import PAGE
from treestroke.codec.image import encode_png
from treestroke.store.blobs import open_blobs
from treestroke.store.scope import SERVICE, Scope
from treestroke.store.tables import File, ModelRow, Share

GLB = b"glTF" + bytes(200)
PREVIEW = encode_png(np.full((40, 60, 3), 200, dtype=np.uint8))
PHOTO = encode_png(np.full((90, 2000, 3), 90, dtype=np.uint8))
NOWHERE = "A" * 22


@dataclass(frozen=True)
class Team:
    """A hosted service, and a member of a team on it who has one finished model."""

    hosted: Hosted
    folder: Path
    key: str
    who: dict[str, Any]
    model: str

    def ask(self, method: str, path: str, **request: Any) -> httpx.Response:
        return self.hosted.ask(self.key, method, path, **request)

    def share(self, **terms: Any) -> tuple[dict[str, Any], str]:
        """Make a link; return it, and the path it leads to."""
        answer = self.ask("POST", f"/v1/models/{self.model}/shares", json=terms)
        assert answer.status_code == 201, answer.text
        return answer.json(), answer.json()["url"].removeprefix(ORIGIN)

    def get(self, path: str, **request: Any) -> httpx.Response:
        """Ask as anybody does: without a key."""
        return self.hosted.client.get(path, **request)


def finished_model(hosted: Hosted, folder: Path, who: dict[str, Any], **values: Any) -> str:
    """Write a finished model of a member as its worker would."""
    scope = Scope(who["team"]["id"], who["member"]["id"])
    database, blobs = hosted.database.of(scope), open_blobs(hosted.database, folder).of(scope)
    row = add_model(database, {"photo": blobs.put(PHOTO)}, status="succeeded", name="The <old> oak", **values)
    files = {"tree.glb": GLB, "preview.png": PREVIEW}
    stored = {name: blobs.put(content) for name, content in files.items()}
    with database.writing() as session:
        for name, content in files.items():
            session.add(File(model=row.id, name=name, blob=stored[name], bytes=len(content)))
    return row.id


@pytest.fixture(scope="module")
def hosted(tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[tuple[Hosted, Path]]:
    folder = tmp_path_factory.mktemp("shares") / "data"
    with hosting(folder, postgres.fresh_with_tables()) as service:
        yield service, folder


def joined(hosted: tuple[Hosted, Path], role: Any = "member", team: str = "Oaks") -> Team:
    service, folder = hosted
    key = service.key(role, team)
    who = service.ask(key, "GET", "/v1/session").json()
    return Team(service, folder, key, who, finished_model(service, folder, who))


@pytest.fixture(scope="module")
def team(hosted: tuple[Hosted, Path]) -> Team:
    return joined(hosted)


def test_a_link_shows_the_tree_to_anybody_and_nothing_of_the_team(team: Team) -> None:
    share, path = team.share()
    assert share["photo"] is False
    assert re.fullmatch(r"/s/[A-Za-z0-9_-]{22}", path)
    told = team.get(f"{path}/model.json")
    assert told.json()["name"] == "The <old> oak"
    assert told.json()["bytes"] == len(GLB)
    for hidden in (team.model, team.who["team"]["id"], team.who["member"]["id"], "Oaks"):
        assert hidden not in told.text
    glb = team.get(f"{path}/tree.glb")
    assert glb.content == GLB
    assert "The _old_ oak.glb" in glb.headers["Content-Disposition"]
    assert team.get(f"{path}/tree.glb", headers={"Range": "bytes=0-3"}).content == b"glTF"
    picture = team.get(f"{path}/preview.png")
    assert picture.content == PREVIEW
    assert picture.headers["Cross-Origin-Resource-Policy"] == "cross-origin"
    for answer in (told, glb, picture):
        assert answer.headers["X-Robots-Tag"] == "noindex"
        assert answer.headers["Referrer-Policy"] == "no-referrer"
        assert answer.headers["Cache-Control"].startswith("private")


def test_the_photo_is_shown_only_where_it_was_chosen(team: Team) -> None:
    _, without = team.share()
    share, with_it = team.share(photo=True, download=False)
    assert share["photo"] is True
    refused = team.get(f"{without}/photo.jpg")
    assert (refused.status_code, refused.json()["code"]) == (404, "file_not_found")
    shown = team.get(f"{with_it}/photo.jpg")
    assert shown.headers["Content-Type"] == "image/jpeg"
    assert Image.open(io.BytesIO(shown.content)).size == (1600, 72)
    assert "Content-Disposition" not in team.get(f"{with_it}/tree.glb").headers


@pytest.mark.parametrize(("over", "code"), [("revoked", "share_revoked"), ("expires", "share_expired")])
def test_a_link_that_is_over_leads_nowhere_with_all_its_files(team: Team, over: str, code: str) -> None:
    share, path = team.share(days=1)
    if over == "revoked":
        assert team.ask("DELETE", f"/v1/shares/{share['id']}").status_code == 204
    else:
        with team.hosted.database.of(SERVICE).writing() as session:
            session.execute(update(Share).where(Share.id == share["id"]).values(expires=time.time() - 1))
    for name in ("model.json", "tree.glb", "preview.png", "photo.jpg"):
        answer = team.get(f"{path}/{name}")
        assert (answer.status_code, answer.json()["code"]) == (410, code)
    assert team.get("/oembed", params={"url": f"{ORIGIN}{path}"}).status_code == 410
    assert team.get(path).status_code in (410, 404)  # 404 where the page is not built
    listed = team.ask("GET", f"/v1/models/{team.model}/shares").json()["shares"]
    found = next(one for one in listed if one["id"] == share["id"])
    assert found["url"] is None
    assert (found["revoked"] is not None) == (over == "revoked")


def test_a_link_to_a_deleted_model_leads_nowhere_until_it_is_restored(hosted: tuple[Hosted, Path]) -> None:
    team = joined(hosted)
    _, path = team.share()
    assert team.ask("DELETE", f"/v1/models/{team.model}").status_code == 204
    answer = team.get(f"{path}/tree.glb")
    assert (answer.status_code, answer.json()["code"]) == (404, "share_not_found")
    assert team.ask("POST", f"/v1/models/{team.model}/restore").status_code == 200
    assert team.get(f"{path}/tree.glb").content == GLB


def test_the_token_is_nowhere_in_the_database_or_the_log(team: Team) -> None:
    share, path = team.share()
    token = path.removeprefix("/s/")
    team.get(path)
    team.get(f"{path}/none.txt")
    with team.hosted.database.of(SERVICE).reading() as session:
        row = session.scalars(select(Share).where(Share.id == share["id"])).one()
        assert token not in json.dumps(
            {column.key: str(getattr(row, column.key)) for column in Share.__table__.columns}
        )
    assert token not in team.folder.with_name(f"{team.folder.name}.log").read_text()


@pytest.mark.skipif(not (PAGE / "share.html").is_file(), reason="the page is not built: run `make page`")
def test_only_the_embedded_page_may_stand_in_a_frame(team: Team) -> None:
    _, path = team.share()
    page, embedded = team.get(path), team.get(f"{path}?embed")
    assert "frame-ancestors 'none'" in page.headers["Content-Security-Policy"]
    assert "frame-ancestors *" in embedded.headers["Content-Security-Policy"]
    assert page.headers["X-Robots-Tag"] == embedded.headers["X-Robots-Tag"] == "noindex"
    assert "The &lt;old&gt; oak" in page.text
    assert "<old>" not in page.text
    gone = team.get(f"/s/{NOWHERE}")
    assert gone.status_code == 404
    assert gone.headers["Content-Type"].startswith("text/html")


def test_a_page_elsewhere_learns_how_to_embed_a_link(team: Team) -> None:
    _, path = team.share()
    told = team.get("/oembed", params={"url": f"{ORIGIN}{path}", "maxwidth": 400, "format": "json"}).json()
    assert (told["version"], told["type"], told["width"], told["height"]) == ("1.0", "rich", 400, 600)
    assert f'src="{ORIGIN}{path}?embed"' in told["html"]
    assert "<old>" not in told["html"]
    for url in (f"https:{'//'}elsewhere.example{path}", f"{ORIGIN}/v1/models", f"{ORIGIN}/s/{NOWHERE}", "x"):
        assert team.get("/oembed", params={"url": url}).status_code == 404


def test_links_belong_to_their_team_and_members_revoke_their_own(team: Team, hosted: tuple[Hosted, Path]) -> None:
    share, path = team.share()
    other, owner = joined(hosted, team="Elms"), joined(hosted, "owner")
    assert other.ask("GET", f"/v1/models/{team.model}/shares").status_code == 404
    assert other.ask("POST", f"/v1/models/{team.model}/shares", json={}).status_code == 404
    assert other.ask("DELETE", f"/v1/shares/{share['id']}").status_code == 404
    owners, _ = owner.share()
    refused = team.ask("DELETE", f"/v1/shares/{owners['id']}")
    assert (refused.status_code, refused.json()["code"]) == (403, "not_yours")
    assert owner.ask("DELETE", f"/v1/shares/{share['id']}").status_code == 204
    assert team.get(f"{path}/model.json").status_code == 410


def test_what_has_no_tree_is_not_shared(team: Team) -> None:
    database = team.hosted.database.of(Scope(team.who["team"]["id"], team.who["member"]["id"]))
    waiting = add_model(database, status="failed")
    answer = team.ask("POST", f"/v1/models/{waiting.id}/shares", json={})
    assert (answer.status_code, answer.json()["code"]) == (409, "model_unfinished")
    for terms in ({"days": 0}, {"days": 366}, {"photo": 1}, {"what": 1}):
        assert team.ask("POST", f"/v1/models/{team.model}/shares", json=terms).status_code == 422


def test_a_member_deletes_their_own_and_an_owner_anything(team: Team, hosted: tuple[Hosted, Path]) -> None:
    owner = joined(hosted, "owner")
    for method, path in (("DELETE", ""), ("POST", "/restore")):
        refused = team.ask(method, f"/v1/models/{owner.model}{path}")
        assert (refused.status_code, refused.json()["code"]) == (403, "not_yours")
    mine = joined(hosted)
    assert mine.ask("DELETE", f"/v1/models/{mine.model}").status_code == 204
    assert owner.ask("POST", f"/v1/models/{mine.model}/restore").status_code == 200


def test_the_gallery_finds_models_by_words_tags_and_makers(hosted: tuple[Hosted, Path]) -> None:
    team = joined(hosted, team="Birches")
    owner = joined(hosted, "owner", "Birches")
    tagged = team.ask("PATCH", f"/v1/models/{team.model}", json={"name": "Élan", "tags": ["Park", " Park ", "north"]})
    assert tagged.json()["tags"] == ["Park", "north"]
    assert tagged.json()["maker"] == {"id": team.who["member"]["id"], "name": "member"}
    everything = {team.model, owner.model}
    for query, found in (
        ({}, everything),
        ({"q": "élan"}, {team.model}),
        ({"q": "PARK north"}, {team.model}),
        ({"q": "owner"}, {owner.model}),
        ({"tag": "park"}, {team.model}),
        ({"tag": "par"}, set()),
        ({"maker": owner.who["member"]["id"]}, {owner.model}),
        ({"q": "oak", "maker": team.who["member"]["id"]}, set()),
    ):
        listed = team.ask("GET", "/v1/models", params=query).json()["models"]
        assert {model["id"] for model in listed} == found, query
    for body in ({}, {"tags": ["x" * 41]}, {"tags": ["x"] * 21}, {"tags": None}):
        assert team.ask("PATCH", f"/v1/models/{team.model}", json=body).status_code == 422


def test_without_keys_there_are_neither_links_nor_makers(client: httpx.Client, made: dict[str, Any]) -> None:
    answer = client.post(f"/v1/models/{made['id']}/shares", json={})
    assert (answer.status_code, answer.json()["code"]) == (403, "not_hosted")
    assert client.get(f"/s/{NOWHERE}/model.json").json()["code"] == "share_not_found"
    assert client.get(f"/v1/models/{made['id']}").json()["maker"] is None


def test_links_go_with_their_model(team: Team) -> None:
    share, _ = team.share()
    model = finished_model(team.hosted, team.folder, team.who)
    made = team.ask("POST", f"/v1/models/{model}/shares", json={}).json()["id"]
    with team.hosted.database.of(SERVICE).writing() as session:
        session.delete(session.scalars(select(ModelRow).where(ModelRow.id == model)).one())
    with team.hosted.database.of(SERVICE).reading() as session:
        left = set(session.scalars(select(Share.id).where(Share.id.in_([made, share["id"]]))))
    assert left == {share["id"]}
