"""The lease on a job: claimed, kept by heartbeats, taken back or ended. Each change applies to one attempt only.

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
    """Start one more attempt of a queued job and return its row; None if it is no longer queued.

    The row now has the ``engine`` that grows the tree, which may be another than when the model was requested.
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
    """Record a heartbeat and the progress; return whether the attempt is to stop, or None if it was taken back."""
    change = _attempt(job).values(
        beat=ModelRow.beat + 1, seq=ModelRow.seq + 1, phase=phase, phase_fraction=phase_fraction, progress=progress
    )
    # Without RETURNING the statement, and its lock, ends as soon as SQLite returns.
    if session.connection().execute(change).rowcount == 0:
        return None
    return session.scalar(select(ModelRow.cancel).where(ModelRow.id == job.id))


def add_file(session: Session, job: ModelRow, name: str, blob: str, size: int, **values: Any) -> bool:
    """Publish a file of a running job and set ``values`` of its row; False if the attempt was taken back."""
    if session.scalars(_attempt(job).values(seq=ModelRow.seq + 1, **values).returning(ModelRow.id)).first() is None:
        return False
    session.merge(File(model=job.id, name=name, blob=blob, bytes=size))
    return True


def succeed(session: Session, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]) -> bool:
    """Publish a model and its files, (blob, bytes) by name; False if the attempt was taken back or is to stop."""
    change = _attempt(job).where(ModelRow.cancel.is_(False)).values(**_ended("succeeded"), progress=1.0, report=report)
    if session.scalars(change.returning(ModelRow.id)).first() is None:
        return False
    for name, (blob, size) in files.items():
        session.merge(File(model=job.id, name=name, blob=blob, bytes=size))
    return True


def end(session: Session, job: ModelRow, status: Literal["failed", "canceled"], error: dict[str, Any] | None) -> bool:
    """End an attempt without a model; False if it was taken back."""
    change = _attempt(job).values(**_ended(status), error=error)
    return session.scalars(change.returning(ModelRow.id)).first() is not None


def take_back(session: Session, job: ModelRow, error: dict[str, Any] | None) -> bool:
    """Take an attempt back: the job is queued again, or ends if it was to stop or has used up its attempts.

    ``error`` is what went wrong; with None nothing did, and the job is queued again however many attempts it had.
    False if the attempt in ``job`` has ended, or has sent a heartbeat since ``job`` was read.
    """
    lost = _attempt(job).where(ModelRow.beat == job.beat)
    # The row decides, not ``job``: the request to stop may have arrived a moment ago.
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
    """Cancel a queued job at once, and ask the worker of a running one to stop it."""
    session.execute(
        update(ModelRow).where(ModelRow.id == model, ModelRow.status == "queued").values(**_ended("canceled"))
    )
    session.execute(
        update(ModelRow)
        .where(ModelRow.id == model, ModelRow.status == "running", ModelRow.cancel.is_(False))
        .values(cancel=True, seq=ModelRow.seq + 1)
    )


def _attempt(job: ModelRow) -> Any:
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
