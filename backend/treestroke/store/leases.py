"""The lease on a job: claimed, kept by beats, given back or ended. Each change holds only for the attempt it names.

queued -> running -> succeeded | failed | canceled        running -> queued where an attempt was lost
"""

import time
from typing import Any, Literal

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from treestroke.store.tables import File, ModelRow

MAX_ATTEMPTS = 3
UNFINISHED = ("queued", "running")
TERMINAL = ("succeeded", "failed", "canceled")
Ending = Literal["succeeded", "failed", "canceled"]


def claim(session: Session, model: str, token: str, worker: str, engine: str) -> ModelRow | None:
    """Take a queued job for one more attempt; None where somebody was first or nothing is left to do.

    From now on the row names the ``engine`` that grows it, whichever it was asked of.
    """
    return session.scalars(
        update(ModelRow)
        .where(ModelRow.id == model, ModelRow.status == "queued")
        .values(
            status="running",
            attempt=ModelRow.attempt + 1,
            beat=ModelRow.beat + 1,
            seq=ModelRow.seq + 1,
            claim=token,
            worker=worker,
            engine=engine,
            phase=None,
            phase_fraction=0.0,
            progress=0.0,
            started=time.time(),
        )
        .returning(ModelRow)
    ).first()


def heartbeat(
    session: Session, job: ModelRow, phase: str | None, phase_fraction: float, progress: float
) -> bool | None:
    """Say that an attempt lives and how far it is; tell whether it is to stop, or None where it is no longer ours."""
    change = _ours(job).values(
        beat=ModelRow.beat + 1, seq=ModelRow.seq + 1, phase=phase, phase_fraction=phase_fraction, progress=progress
    )
    # No RETURNING: the change is to be over when SQLite comes back.
    if session.connection().execute(change).rowcount == 0:
        return None
    return session.scalar(select(ModelRow.cancel).where(ModelRow.id == job.id))


def add_file(session: Session, job: ModelRow, name: str, blob: str, size: int, **values: Any) -> bool:
    """Publish one file of a job under way, with other ``values`` of its row; False where it is no longer ours."""
    if session.scalars(_ours(job).values(seq=ModelRow.seq + 1, **values).returning(ModelRow.id)).first() is None:
        return False
    session.merge(File(model=job.id, name=name, blob=blob, bytes=size))
    return True


def succeed(session: Session, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]) -> bool:
    """Publish a model and its files, (blob, size) by name; False where it is not ours any more or was to be stopped."""
    change = _ours(job).where(ModelRow.cancel.is_(False)).values(**_ended("succeeded"), progress=1.0, report=report)
    if session.scalars(change.returning(ModelRow.id)).first() is None:
        return False
    for name, (blob, size) in files.items():
        session.merge(File(model=job.id, name=name, blob=blob, bytes=size))
    return True


def end(session: Session, job: ModelRow, status: Literal["failed", "canceled"], error: dict[str, Any] | None) -> bool:
    """End an attempt without a model; False where it is no longer ours."""
    change = _ours(job).values(**_ended(status), error=error)
    return session.scalars(change.returning(ModelRow.id)).first() is not None


def take_back(session: Session, job: ModelRow, error: dict[str, Any] | None) -> bool:
    """Take an attempt back: the job queues again, or ends where it was to be stopped or has used its attempts up.

    ``error`` says what went wrong; None where nothing did, and the job queues again however often it was begun.
    False where the attempt that ``job`` shows is over already, or has beaten since.
    """
    lost = _ours(job).where(ModelRow.beat == job.beat)
    # Asked of the row, not of ``job``: the wish to stop may have come a moment ago.
    stopped = lost.where(ModelRow.cancel.is_(True)).values(**_ended("canceled"))
    if session.scalars(stopped.returning(ModelRow.id)).first() is not None:
        return True
    if error is not None and job.attempt >= MAX_ATTEMPTS:
        change = lost.values(**_ended("failed"), error=error)
    else:
        change = lost.values(
            status="queued", seq=ModelRow.seq + 1, claim=None, worker=None, phase=None, phase_fraction=0.0, progress=0.0
        )
    return session.scalars(change.returning(ModelRow.id)).first() is not None


def cancel(session: Session, model: str) -> None:
    """Ask for a job's end: at once where it still queues, and where it runs as soon as its worker hears of it."""
    session.execute(
        update(ModelRow).where(ModelRow.id == model, ModelRow.status == "queued").values(**_ended("canceled"))
    )
    session.execute(
        update(ModelRow)
        .where(ModelRow.id == model, ModelRow.status == "running", ModelRow.cancel.is_(False))
        .values(cancel=True, seq=ModelRow.seq + 1)
    )


def _ours(job: ModelRow) -> Any:
    return update(ModelRow).where(ModelRow.id == job.id, ModelRow.status == "running", ModelRow.attempt == job.attempt)


def _ended(status: Ending) -> dict[str, Any]:
    return {
        "status": status,
        "seq": ModelRow.seq + 1,
        "claim": None,
        "worker": None,
        "phase": None,
        "phase_fraction": 0.0,
        "finished": time.time(),
    }
