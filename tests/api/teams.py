"""What one team has of every kind, and how each operation of the API is asked for it."""

import re
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
from tests.api import drawn
from tests.api.conftest import PATIENCE_SECONDS
from tests.clips import clip_bytes

METHODS = ("get", "put", "post", "delete", "patch")
_KIND = re.compile(r"\^([a-z]+)_")


@dataclass(frozen=True)
class Belongings:
    """Ids of what a team has, by kind; of some kinds with those of the wholes that they are parts of."""

    ids: Mapping[str, str]
    photo_of_capture: str

    @property
    def known(self) -> set[str]:
        return {*self.ids.values(), self.photo_of_capture}


@dataclass(frozen=True)
class Asked:
    """An operation of the API: its name, and a request for what a team has."""

    name: str
    verb: str
    place: str
    headers: dict[str, str] = field(default_factory=dict)
    content: bytes = b""

    def __str__(self) -> str:
        return f"{self.verb} {self.place}"

    def ask(self, client: httpx.Client) -> httpx.Response:
        """Send the request, and read no more than the head of a stream."""
        with client.stream(self.verb, self.place, headers=self.headers, content=self.content) as answer:
            if "event-stream" not in answer.headers.get("content-type", ""):
                answer.read()
            return answer


PARTS = {"view": "front", "ending": "json", "frame": "0", "name": "tree.glb"}
"""Parts of paths that are no ids."""
STROKES = b'{"crown": {"points": [[10, 10], [50, 10], [30, 50]]}, "branches": []}'
BODIES: dict[str, tuple[str, bytes]] = {
    "trace_photo": ("application/json", STROKES),
    "trace_capture": ("application/json", b'{"views": []}'),
    "trace_clip": ("application/json", STROKES),
    "change_model": ("application/json", b'{"name": "theirs"}'),
    "rename_capture": ("application/json", b'{"name": "theirs"}'),
    "add_capture_photo": ("image/png", drawn.encoded(seed=3)),
    "add_piece": ("application/partial-upload", b"more"),
    "share_model": ("application/json", b"{}"),
    "change_webhook": ("application/json", b'{"enabled": false}'),
    "change_member": ("application/json", b'{"name": "theirs"}'),
    "ask_for_siblings": ("application/json", b'{"count": 1}'),
}
"""Bodies of operations that name an id in their path: without one a 422 could hide whose it is."""
HEADERS = {"add_piece": {"upload-offset": "4"}}


def own_one_of_each(client: httpx.Client, folder: Path, finish: Callable[[str], None]) -> Belongings:
    """Make one of each kind, by the API itself; ``finish`` ends a model as its worker would."""

    def made(answer: httpx.Response) -> str:
        assert answer.status_code in (201, 202), answer.text
        return str(answer.json()["id"])

    photo = made(_insisting(client, "/v1/photos", drawn.encoded()))
    capture = made(client.post("/v1/captures", json={"name": "ours"}))
    part = made(_insisting(client, f"/v1/captures/{capture}/photos", drawn.encoded(seed=1)))
    model = made(client.post("/v1/models", json=drawn.request(photo, name="ours")))
    finish(model)
    key = client.post("/v1/keys", json={"name": "ours"})
    member = client.post("/v1/members", json={"name": "Ours", "role": "viewer"})
    wanted = {"url": f"https:{'//'}hooks.invalid/", "events": ["model.failed"]}
    webhook = made(client.post("/v1/webhooks", json=wanted))
    begun = client.post("/v1/clips", headers={"upload-complete": "?0"}, content=b"four")
    ids = {
        "pho": photo,
        "cap": capture,
        "clp": made(_insisting(client, "/v1/clips", clip_bytes(folder))),
        "upl": begun.headers["location"].rpartition("/")[2],
        "mdl": model,
        "shr": made(client.post(f"/v1/models/{model}/shares", json={})),
        "key": made(key),
        "usr": made(member),
        "hook": webhook,
        "msg": made(client.post(f"/v1/webhooks/{webhook}/ping")),
    }
    return Belongings(ids, part)


def _insisting(client: httpx.Client, path: str, content: bytes) -> httpx.Response:
    """Send a file again while the processes that read it are not ready, as on a busy machine."""
    deadline = time.monotonic() + PATIENCE_SECONDS
    while True:
        answer = client.post(path, files={"file": content})
        if answer.status_code != 503 or time.monotonic() > deadline:
            return answer


def operations(document: Mapping[str, Any], owned: Belongings) -> Iterator[Asked]:
    """Yield a request for what a team has, for each operation whose path names an id.

    Raises
    ------
    KeyError
        An operation has a part of a path, or names a kind of thing, that this list does not know.
    """
    for path, verbs in document["paths"].items():
        for verb in METHODS:
            if verb in verbs and "{" in path and "{token}" not in path:  # a link is for anybody
                yield _asked(path, verb, verbs[verb], owned)


def _asked(path: str, verb: str, operation: Mapping[str, Any], owned: Belongings) -> Asked:
    name = operation["operationId"]
    place = path
    for parameter in operation["parameters"]:
        if parameter["in"] == "path":
            place = place.replace(f"{{{parameter['name']}}}", _value(parameter, owned))
    kind, content = BODIES.get(name, ("", b""))
    headers = {**({"content-type": kind} if kind else {}), **HEADERS.get(name, {})}
    return Asked(name, verb.upper(), place, headers, content)


def _value(parameter: Mapping[str, Any], owned: Belongings) -> str:
    kind = _KIND.match(parameter["schema"].get("pattern", ""))
    if kind is None:
        return PARTS[parameter["name"]]
    return owned.photo_of_capture if kind[1] == "cph" else owned.ids[kind[1]]
