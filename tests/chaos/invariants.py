"""What must hold once everything is whole again and every model has ended."""

import hashlib
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import closing, suppress

import httpx
import psycopg
from redis import Redis
from tests.chaos.asking import Asked
from tests.chaos.stack import Row, Stack, Team
from tests.faults.harness import Change
from tests.faults.processes import wait_for

from treestroke.service.retention import Sweeper
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.leases import MAX_ATTEMPTS
from treestroke.store.queries import referenced
from treestroke.store.scope import SERVICE
from treestroke.store.tables import TERMINAL

END_SECONDS = 900.0
"""Emergency exit of waiting for the last model."""
MODELS = "SELECT id, status, attempt, team, error, started, finished FROM models ORDER BY number"
FILES, GROWING = {"tree.glb", "preview.png", "growth.json"}, {"growth.json"}
GOOD_REASONS = ("storage_full", "storage_unavailable")
"""Codes of failures that say what was wrong around a job, and that it is worth another try."""


class History:
    """What became of every model, as the database showed it several times a second."""

    def __init__(self, stack: Stack) -> None:
        self._stack, self._over = stack, threading.Event()
        self.changes: dict[str, list[Change]] = {}
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._over.wait(0.1):
            with suppress(psycopg.Error):
                rows = self._stack.rows("SELECT id, status, attempt FROM models")
                now = time.monotonic()
                for row in rows:
                    changes = self.changes.setdefault(row["id"], [])
                    if not changes or (changes[-1].status, changes[-1].attempt) != (row["status"], row["attempt"]):
                        changes.append(Change(now, row["status"], row["attempt"]))


def wait_for_ends(stack: Stack) -> list[Row]:
    """Wait until every model has ended, and return their rows."""

    def all_ended() -> list[Row] | None:
        with suppress(psycopg.Error):
            rows = stack.rows(MODELS)
            return rows if all(row["status"] in TERMINAL for row in rows) else None
        return None

    return wait_for(all_ended, END_SECONDS, "the end of all models", 0.5)


def lost(rows: list[Row], asked: list[Asked]) -> Iterator[str]:
    """Yield what was accepted and came to nothing without a reason."""
    known = {row["id"]: row for row in rows}
    canceled = {id for each in asked for id in each.canceled}
    for each in asked:
        yield from (f"{id} of {each.team.name} was accepted and is gone" for id in each.ids if id not in known)
    for id, row in known.items():
        if row["status"] == "canceled" and id not in canceled:
            yield f"{id} was canceled by nobody"
        if row["status"] == "failed" and not has_reason(row):
            yield f"{id} failed after {row['attempt']} attempts: {row['error']}"


def has_reason(row: Row) -> bool:
    """Tell whether a model failed as one may: it was struck three times, or there was no room or no bucket."""
    code = row["error"]["code"]
    return code in GOOD_REASONS or (code == "worker_lost" and row["attempt"] >= MAX_ATTEMPTS)


def doubled(rows: list[Row], asked: list[Asked], changes: dict[str, list[Change]]) -> Iterator[str]:
    """Yield what was made twice, ended twice, or went backwards."""
    wanted = sum(len(each.ids) for each in asked)
    if len(rows) != wanted:
        yield f"{wanted} models were accepted, and there are {len(rows)}"
    for id, seen in changes.items():
        ends = [change for change in seen if change.status in TERMINAL]
        attempts = [change.attempt for change in seen]
        if len(ends) > 1 or (ends and seen[-1] != ends[0]) or attempts != sorted(attempts):
            yield f"{id} did not go straight to its end: {seen}"


def unlike(stack: Stack, rows: list[Row], asked: list[Asked]) -> Iterator[str]:
    """Yield each model whose files are not, from every web process and for its own team alone, what they should be."""
    teams = {id: each.team for each in asked for id in each.ids}
    others = {each.team.name: asked[at - 1].team for at, each in enumerate(asked)}
    for at, row in enumerate(rows):
        names = {file["name"]: file["blob"] for file in stack.rows(f"SELECT * FROM files WHERE model = '{row['id']}'")}
        done = row["status"] == "succeeded"
        # The view of the growing tree is left out where the database or the bucket is away at that moment.
        if set(names) not in ((FILES, FILES - GROWING) if done else (GROWING, set())):
            yield f"{row['id']} is {row['status']} and has the files {sorted(names)}"
        team = teams[row["id"]]
        expected = {team: names.get("tree.glb") if done else None, others[team.name]: None}
        for asker, content in expected.items():
            got = _tree(stack, at % len(stack.webs), asker, row["id"])
            if got != content:
                yield f"{row['id']} ({row['status']}): {asker.name} got {got} in place of {content}"


def _tree(stack: Stack, web: int, team: Team, id: str) -> str | None:
    """Return the SHA-256 of a tree as a team gets it; None where it is told that there is none."""
    with stack.client(web, team) as client:
        answer = client.get(f"/v1/models/{id}/tree.glb")
    if answer.status_code == httpx.codes.NOT_FOUND:
        return None
    return hashlib.sha256(answer.content).hexdigest() if answer.is_success else f"{answer.status_code} {answer.text}"


def orphans(stack: Stack) -> Iterator[str]:
    """Yield files without a row, rows without a file, and what is left over in folders, queue and database."""
    database = Database(stack.folder, stack.database_url).of(SERVICE)
    blobs = open_blobs(database, stack.folder, stack.bucket_url)
    with closing(database):
        sweeper = Sweeper(database, blobs, 0, threading.Event())
        for _ in range(2):  # what no row names is to be seen twice
            sweeper.sweep(unreferenced_s=0)
        with database.reading() as session:
            named = referenced(session)
    kept = Counter(row["sha256"] for row in stack.rows("SELECT sha256 FROM blobs"))
    stored = set(_objects(stack))
    yield from (f"{name} has no row" for name in stored - set(kept))
    yield from (f"{name} has no object" for name in set(kept) - stored)
    yield from (f"{name}: no row refers to it" for name in set(kept) - named)
    for program in stack.programs:
        left = [path for path in program.data.rglob(".*") if path.is_file()]
        left += [path for path in (program.data / "tmp").rglob("*") if path.is_file()]
        yield from (f"{program.name}: {path} is left over" for path in left)
    with Redis.from_url(stack.redis.url) as redis:
        if waiting := redis.llen("treestroke"):
            yield f"{waiting} messages that nobody takes"
    workers = stack.rows("SELECT id FROM workers")
    if len(workers) != len(stack.workers):
        yield f"{len(workers)} workers are known, of {len(stack.workers)}"


def _objects(stack: Stack) -> Iterator[str]:
    """Yield the names of all objects that are ours."""
    bucket, _, prefix = stack.bucket_url.removeprefix("s3://").partition("/")
    pages = stack.s3.client().get_paginator("list_objects_v2").paginate(Bucket=bucket, Prefix=f"{prefix}/")
    for page in pages:
        yield from (each["Key"].rpartition("/")[2] for each in page.get("Contents", []))
