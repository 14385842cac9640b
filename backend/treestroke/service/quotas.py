"""Quotas of a team: what it may store, have queued and ask for in a day; checked where a row is written."""

import time
from dataclasses import dataclass
from typing import NamedTuple

from sqlalchemy.orm import Session

from treestroke.settings import Settings
from treestroke.store import usage
from treestroke.store.queries import stored_bytes, usual_seconds
from treestroke.store.tables import ModelRow

DAY_SECONDS = 24 * 3600.0
STORED, QUEUED, RUNNING, MODELS_A_DAY, STREAMS = "stored_bytes", "queued", "running", "models_a_day", "streams"
"""Names of the quotas, as `GET /v1/limits` shows them."""
_STORED_RETRY_SECONDS = 3600.0
"""When to ask again for room, of which nobody knows when there will be some."""


class QuotaExceeded(Exception):
    """A team, or of streams a person, has as much as it may have; ``retry_s`` is when it may have room again."""

    def __init__(self, quota: str, limit: int, retry_s: float) -> None:
        super().__init__(quota)
        self.quota, self.limit, self.retry_s = quota, limit, retry_s


@dataclass(frozen=True)
class Quotas:
    """What each team may have; 0: no limit, as in a service without teams."""

    stored_bytes: int = 0
    """Bytes of its photos and clips, and of its models' files."""
    queued: int = 0
    """Jobs that wait."""
    running: int = 0
    """Jobs that workers do at once; the claim of a job keeps it."""
    models_a_day: int = 0
    """Models asked for in the last 24 hours, deleted ones too."""


NO_QUOTAS = Quotas()


class Used(NamedTuple):
    """How much of a quota is used; a limit of 0 is none."""

    name: str
    limit: int
    used: int


def quotas_of(settings: Settings) -> Quotas:
    """Return the quotas of the teams of a service; one without teams has none."""
    if not settings.hosted:
        return NO_QUOTAS
    return Quotas(
        settings.team_stored_mb * 10**6, settings.team_queued, settings.team_running, settings.team_models_a_day
    )


def admit_model(session: Session, quotas: Quotas, waits: bool = True, sent_bytes: int = 0) -> None:
    """Make sure that a team may have one more model, whose row this session writes afterwards.

    ``waits`` tells whether it must be grown; one that is finished at once is not queued. ``sent_bytes`` is the size
    of the photo that it brings.

    Raises
    ------
    QuotaExceeded
        The team has as much stored, queued, or asked for in a day as it may have.
    """
    admit_upload(session, quotas, max(sent_bytes, 1))  # a model is not grown without room for its files
    if waits:
        admit_job(session, quotas)
    if quotas.models_a_day:
        usage.lock_team(session)
        asked, oldest = usage.models_since(session, time.time() - DAY_SECONDS)
        if asked >= quotas.models_a_day:
            raise QuotaExceeded(MODELS_A_DAY, quotas.models_a_day, oldest + DAY_SECONDS - time.time())


def admit_job(session: Session, quotas: Quotas) -> None:
    """Make sure that a team may have one more job waiting, whose row this session writes afterwards.

    Raises
    ------
    QuotaExceeded
        As many wait as may wait.
    """
    if quotas.queued:
        usage.lock_team(session)
        if usage.jobs(session, "queued") >= quotas.queued:
            raise QuotaExceeded(QUEUED, quotas.queued, usual_seconds(session, ModelRow))


def admit_upload(session: Session, quotas: Quotas, size: int) -> None:
    """Make sure that a team may store so many bytes more, of a photo or clip whose row this session writes afterwards.

    Raises
    ------
    QuotaExceeded
        It would have more than it may have.
    """
    if quotas.stored_bytes:
        files = usage.file_bytes(
            session
        )  # before the lock: workers write them, which are not refused, and it takes long
        usage.lock_team(session)
        if files + stored_bytes(session) + size > quotas.stored_bytes:
            raise stored_full(quotas.stored_bytes)


def stored_full(limit: int) -> QuotaExceeded:
    """Return what to raise where a team's photos, clips and files would take more than ``limit`` bytes."""
    return QuotaExceeded(STORED, limit, _STORED_RETRY_SECONDS)


def stored_by_team(session: Session) -> int:
    """Return the bytes of a team's photos, clips and models' files."""
    return usage.file_bytes(session) + stored_bytes(session)


def used_by_team(session: Session, quotas: Quotas) -> list[Used]:
    """Return how much of each of its quotas a team uses."""
    return [
        Used(STORED, quotas.stored_bytes, stored_by_team(session)),
        Used(QUEUED, quotas.queued, usage.jobs(session, "queued")),
        Used(RUNNING, quotas.running, usage.jobs(session, "running")),
        Used(MODELS_A_DAY, quotas.models_a_day, usage.models_since(session, time.time() - DAY_SECONDS)[0]),
    ]
