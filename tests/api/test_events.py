import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import httpx
import pytest
from tests.api import drawn
from tests.api.conftest import Service

PHASES = ("decode", "foliage", "trace", "lift", "grow", "leaf", "mesh", "write", "preview")


@dataclass
class Event:
    """One event of a stream."""

    name: str
    data: Any
    id: str | None = None


def events(client: httpx.Client, place: str, last: str | None = None) -> Iterator[Event]:
    """Follow a model until its stream ends."""
    headers = {} if last is None else {"Last-Event-ID": last}
    with client.stream("GET", f"{place}/events", headers=headers) as answer:
        assert answer.headers["content-type"] == "text/event-stream; charset=utf-8"
        fields: dict[str, str] = {}
        for line in answer.iter_lines():
            name, _, value = line.partition(": ")
            if name:
                fields[name] = value
            elif "event" in fields:
                yield Event(fields["event"], json.loads(fields["data"]), fields.get("id"))
                fields = {}


@pytest.fixture(scope="module")
def followed(service: Service, photo: str) -> list[Event]:
    """All events of a model that was followed from its beginning on."""
    request = drawn.request(photo, seed=31, settings={"iterations": 300})
    answer = service.client.post("/v1/models", json=request)
    return list(events(service.client, answer.headers["location"]))


def test_a_stream_begins_with_a_snapshot_and_ends_with_one_last_event(followed: list[Event]) -> None:
    names = [event.name for event in followed]
    assert names[0] == "snapshot"
    assert names[-1] == "succeeded"
    assert set(names[1:-1]) == {"progress", "preview"}
    assert names.count("preview") == 1


def test_only_what_must_not_be_missed_has_an_id(followed: list[Event]) -> None:
    assert {event.name for event in followed if event.id is not None} == {"preview", "succeeded"}
    ids = [int(event.id) for event in followed if event.id is not None]
    assert ids == sorted(set(ids))


def test_progress_never_falls_within_an_attempt(followed: list[Event]) -> None:
    shown = [event.data for event in followed if event.name != "preview"]
    for before, after in pairwise(shown):
        assert (before["attempt"], before["progress"]) <= (after["attempt"], after["progress"])
    assert shown[-1]["progress"] == 1.0


def test_phases_come_in_their_order_each_with_its_own_fraction(followed: list[Event]) -> None:
    told = [event.data for event in followed if event.name == "progress" and event.data["phase"]]
    places = [PHASES.index(model["phase"]) for model in told]
    assert places == sorted(places)
    for before, after in pairwise(told):
        if before["phase"] == after["phase"]:
            assert before["phase_fraction"] <= after["phase_fraction"]
    assert all(0 <= model["phase_fraction"] <= 1 for model in told)


def test_the_preview_is_a_grown_skeleton_in_the_glbs_frame(followed: list[Event]) -> None:
    (preview,) = [event.data for event in followed if event.name == "preview"]
    assert set(preview) == {"points", "radii", "parents", "born", "photo"}
    assert preview["points"][0] == [0, 0, 0]
    assert len({len(preview[column]) for column in ("points", "radii", "parents", "born")}) == 1
    assert max(preview["born"]) > 0


def test_the_last_event_holds_the_finished_model(client: httpx.Client, followed: list[Event]) -> None:
    assert followed[-1].data == client.get(f"/v1/models/{followed[-1].data['id']}").json()


def test_a_stream_is_resumed_after_the_last_event_that_came(client: httpx.Client, followed: list[Event]) -> None:
    place = f"/v1/models/{followed[-1].data['id']}"
    preview = next(event.id for event in followed if event.name == "preview")
    names = {last: [event.name for event in events(client, place, last)] for last in ("0", preview, "nonsense")}
    whole = ["snapshot", "preview", "succeeded"]
    assert names == {"0": whole, preview: ["snapshot", "succeeded"], "nonsense": whole}


def test_a_finished_model_may_be_followed_still(client: httpx.Client, made: dict[str, Any]) -> None:
    told = list(events(client, f"/v1/models/{made['id']}"))
    assert [event.name for event in told] == ["snapshot", "preview", "succeeded"]
    assert told[0].data == told[-1].data == made


def test_a_model_that_was_made_before_has_a_preview_too(service: Service, made: dict[str, Any]) -> None:
    twin = service.make(**drawn.request(made["photo"], name="Twin"))
    told = {id: list(events(service.client, f"/v1/models/{id}")) for id in (made["id"], twin["id"])}
    assert told[twin["id"]][1].data == told[made["id"]][1].data


def test_a_preview_whose_file_is_damaged_is_left_out(service: Service, photo: str) -> None:
    model = service.make(**drawn.request(photo, seed=33))["id"]
    with closing(sqlite3.connect(service.data / "treestroke.sqlite3")) as database:
        growth = "SELECT blob FROM files WHERE model = ? AND name = 'growth.json'"
        blob = database.execute(growth, (model,)).fetchone()[0]
    (service.data / "blobs" / blob[:2] / blob).write_bytes(b"{}")
    told = list(events(service.client, f"/v1/models/{model}"))
    assert [event.name for event in told] == ["snapshot", "succeeded"]


def test_a_canceled_model_ends_its_stream(client: httpx.Client, photo: str) -> None:
    request = drawn.request(photo, seed=32, settings={"iterations": 2000, "leaf_density": 3})
    place = client.post("/v1/models", json=request).headers["location"]
    names = []
    for event in events(client, place):
        if not names:
            client.post(f"{place}/cancel")
        names.append(event.name)
    assert names[-1] == "canceled"


def test_a_queued_model_tells_its_place(service: Service, photo: str) -> None:
    client, long = service.client, {"iterations": 2000, "leaf_density": 3}
    asked = [drawn.request(photo, seed=seed, settings=long) for seed in range(33, 37)]
    places = [client.post("/v1/models", json=request).headers["location"] for request in asked]
    listed = client.get("/v1/models").json()["models"]  # of one moment: asked one by one, some might go on meanwhile
    queued = [model for model in reversed(listed) if model["status"] == "queued"]
    assert len(queued) >= 2
    assert [model["queue_position"] for model in queued] == list(range(1, len(queued) + 1))
    assert all(model["eta_s"] > 0 for model in queued)
    for place in places:
        client.post(f"{place}/cancel")
    service.settle()


def test_whoever_follows_a_model_that_is_deleted_is_told_its_end(client: httpx.Client, photo: str) -> None:
    request = drawn.request(photo, seed=38, settings={"iterations": 2000, "leaf_density": 3})
    place = client.post("/v1/models", json=request).headers["location"]
    kinds = []
    for event in events(client, place):
        client.delete(place)
        kinds.append(event.name)
    assert kinds[-1] == "canceled"
    assert client.get(place).status_code == 404


def test_an_id_of_an_event_that_is_too_long_is_refused(client: httpx.Client, made: dict[str, Any]) -> None:
    answer = client.get(f"/v1/models/{made['id']}/events", headers={"Last-Event-ID": "1" * 41})
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
