"""The lease on a job: claimed, kept by heartbeats, taken back or ended. Each change applies to one attempt only.

queued -> running -> succeeded | failed | canceled        running -> queued where an attempt was lost

Whatever ends a job tells the outbox in the same transaction (`store.outbox`).
"""

import time
from typing import Any, Literal, NamedTuple

from sqlalchemy import ColumnElement, select, update
from sqlalchemy.orm import Session

from treestroke.store.outbox import note_ended
from treestroke.store.tables import JOBS, UNFINISHED, AnyJob, File, ModelRow
from treestroke.store.turns import next_job, note_turn, wait_for_turn

MAX_ATTEMPTS = 3
Ending = Literal["succeeded", "failed", "canceled"]


class Holder(NamedTuple):
    """Who claims a job: a token of the attempt, the worker's id, and the engine whose jobs it does."""

    token: str
    worker: str
    engine: str


def claim_next(session: Session, holder: Holder, most_running: int = 0) -> AnyJob | None:
    """Start one more attempt of the queued job that is next (`store.turns`) and return its row; None if none waits.

    Only jobs of the holder's engine count, and of teams that have fewer than ``most_running`` under way, unless it is
    0.
    """
    all_turns = wait_for_turn(session)
    job = next_job(session, holder.engine, most_running)
    if job is not None:
        note_turn(session, all_turns, job)
        _start(job, holder)
        session.flush()
    return job


def heartbeat(session: Session, job: AnyJob, phase: str | None, phase_fraction: float, progress: float) -> bool | None:
    """Record a heartbeat and the progress; return whether the attempt is to stop, or None if it was taken back."""
    table = type(job)
    change = _attempt(job).values(
        beat=table.beat + 1, seq=table.seq + 1, phase=phase, phase_fraction=phase_fraction, progress=progress
    )
    # Without RETURNING the statement, and its lock, ends as soon as SQLite returns.
    if session.connection().execute(change).rowcount == 0:
        return None
    return session.scalar(select(table.cancel).where(table.id == job.id))


def add_file(session: Session, job: ModelRow, name: str, blob: str, size: int, **values: Any) -> bool:
    """Publish a file of a running job and set ``values`` of its row; False if the attempt was taken back."""
    if session.scalars(_attempt(job).values(seq=ModelRow.seq + 1, **values).returning(ModelRow.id)).first() is None:
        return False
    session.merge(File(team=job.team, model=job.id, name=name, blob=blob, bytes=size))
    return True


def succeed(session: Session, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]) -> bool:
    """Publish a model and its files, (blob, bytes) by name; False if the attempt was taken back or is to stop."""
    if not complete(session, job, report=report):
        return False
    for name, (blob, size) in files.items():
        session.merge(File(team=job.team, model=job.id, name=name, blob=blob, bytes=size))
    return True


def complete(session: Session, job: AnyJob, **result: Any) -> bool:
    """End an attempt with its result, by columns; False if it was taken back or is to stop."""
    table = type(job)
    change = _attempt(job).where(table.cancel.is_(False)).values(**_ended(table, "succeeded"), progress=1.0, **result)
    return _end_by(session, table, change)


def end(session: Session, job: AnyJob, status: Literal["failed", "canceled"], error: dict[str, Any] | None) -> bool:
    """End an attempt without a result; False if it was taken back."""
    table = type(job)
    return _end_by(session, table, _attempt(job).values(**_ended(table, status), error=error))


def take_back(session: Session, job: AnyJob, error: dict[str, Any] | None) -> bool:
    """Take an attempt back: the job is queued again, or ends if it was to stop or has used up its attempts.

    ``error`` is what went wrong; with None nothing did, and the job is queued again however many attempts it had.
    False if the attempt in ``job`` has ended, or has sent a heartbeat since ``job`` was read.
    """
    table = type(job)
    lost = _attempt(job).where(table.beat == job.beat)
    # The row decides, not ``job``: the request to stop may have arrived a moment ago. None comes while it is locked.
    session.execute(select(table.id).where(table.id == job.id).with_for_update())
    stopped = lost.where(table.cancel.is_(True)).values(**_ended(table, "canceled"))
    if _end_by(session, table, stopped):
        return True
    if error is not None and job.attempt >= MAX_ATTEMPTS:
        return _end_by(session, table, lost.values(**_ended(table, "failed"), error=error))
    change = lost.values(**_queued(table))
    return session.scalars(change.returning(table.id)).first() is not None


def queue_running(session: Session) -> None:
    """Queue all running jobs again, or end those that were to stop: none of their workers is there any more."""
    for table in JOBS:
        running = update(table).where(table.status == "running")
        session.execute(running.where(table.cancel.is_(True)).values(**_ended(table, "canceled")))
        session.execute(running.values(**_queued(table)))


def change_engine(session: Session, old: str, new: str) -> None:
    """Let another engine do all queued jobs that were accepted for an old one."""
    for table in JOBS:
        waiting = update(table).where(table.status == "queued", table.engine == old)
        session.execute(waiting.values(engine=new, seq=table.seq + 1))


def cancel(session: Session, table: type[AnyJob], *chosen: ColumnElement[bool]) -> None:
    """Cancel the chosen jobs of a table that are queued at once, and ask the workers of running ones to stop them."""
    # Locked first: one that is taken back between the two statements would be missed by both.
    session.execute(select(table.id).where(*chosen, table.status.in_(UNFINISHED)).with_for_update())
    _end_by(session, table, update(table).where(*chosen, table.status == "queued").values(**_ended(table, "canceled")))
    session.execute(
        update(table)
        .where(*chosen, table.status == "running", table.cancel.is_(False))
        .values(cancel=True, seq=table.seq + 1)
    )


def _start(job: AnyJob, holder: Holder) -> None:
    job.status, job.claim, job.worker, job.started = "running", holder.token, holder.worker, time.time()
    job.phase, job.phase_fraction, job.progress = None, 0.0, 0.0
    job.attempt, job.beat, job.seq = job.attempt + 1, job.beat + 1, job.seq + 1


def _attempt(job: AnyJob) -> Any:
    table = type(job)
    return update(table).where(table.id == job.id, table.status == "running", table.attempt == job.attempt)


def _queued(table: type[AnyJob]) -> dict[str, Any]:
    no_attempt = {"claim": None, "worker": None, "phase": None, "phase_fraction": 0.0, "progress": 0.0}
    return {"status": "queued", "seq": table.seq + 1, **no_attempt}


def _end_by(session: Session, table: type[AnyJob], change: Any) -> bool:
    """End jobs by a statement, and tell the outbox; return whether there were any."""
    ended = session.scalars(change.returning(table.id)).all()
    note_ended(session, table, ended)
    return bool(ended)


def _ended(table: type[AnyJob], status: Ending) -> dict[str, Any]:
    return {
        "status": status,
        "seq": table.seq + 1,
        "claim": None,
        "worker": None,
        "phase": None,
        "phase_fraction": 0.0,
        "finished": time.time(),
    }
