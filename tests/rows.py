"""Rows written by hand, without a service."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import select

from treestroke.codec.inputs import part_of
from treestroke.store.database import Database
from treestroke.store.leases import Holder, claim_next
from treestroke.store.queries import new_id
from treestroke.store.tables import CapturePhoto, CaptureRow, JobRow, ModelPart, ModelRow, PhotoRow, SolveRow
from treestroke.store.webhook_tables import DeliveryRow, WebhookRow
from treestroke.webhook_schemas import JOB_EVENTS

PARTS = {"photo": "a" * 64, "strokes": "b" * 64}


def model_row(**values: Any) -> ModelRow:
    """Give the row of a queued model."""
    usual: dict[str, Any] = {
        "id": new_id("mdl"),
        "name": "",
        "photo": "pho_1",
        "settings": {},
        "seed": 0,
        "engine": "treestroke",
        "fingerprint": "f" * 64,
        "status": "queued",
        "phase_fraction": 0.0,
        "progress": 0.0,
        "seq": 1,
        "attempt": 0,
        "beat": 0,
        "cancel": False,
        "created": time.time(),
    }
    return ModelRow(**{**usual, **values})


def add_model(database: Database, parts: Mapping[str, str] = PARTS, **values: Any) -> ModelRow:
    """Write the row of a queued model, and those of its ``parts``, blobs by name; return the model's."""
    row = model_row(**values)
    with database.writing() as session:
        session.add(row)
        session.flush()
        for name, blob in parts.items():
            session.add(ModelPart(model=row.id, name=name, blob=blob, media_type=part_of(name).formats[0].media_type))
    return row


def photo_row(blob: str, size: int) -> PhotoRow:
    """Give the row of a photo whose file has so many bytes."""
    return PhotoRow(id=new_id("pho"), sha256=blob, blob=blob, width=8, height=8, bytes=size, created=time.time())


def add_capture(database: Database, blobs: Sequence[str] = (), **values: Any) -> CaptureRow:
    """Write the row of a capture, and those of photos of it that are these blobs; return the capture's."""
    usual: dict[str, Any] = {"id": new_id("cap"), "name": "", "seq": 1, "created": time.time()}
    row = CaptureRow(**{**usual, **values})
    with database.writing() as session:
        session.add(row)
        session.flush()
        for number, blob in enumerate(blobs):
            names = {"name": f"{number}.jpg", "sent_name": f"{number}.jpg"}
            size: dict[str, Any] = {"width": 64, "height": 64, "bytes": 10, "created": 0.0}
            session.add(CapturePhoto(id=new_id("cph"), capture=row.id, sha256=blob, blob=blob, **names, **size))
    return row


def add_solve(database: Database, capture: str, **values: Any) -> SolveRow:
    """Write the row of a queued solve of a capture, and return it."""
    usual: dict[str, Any] = {
        "id": new_id("slv"),
        "engine": "treestroke",
        "fingerprint": "f" * 64,
        "status": "queued",
        "phase_fraction": 0.0,
        "progress": 0.0,
        "seq": 1,
        "attempt": 0,
        "beat": 0,
        "cancel": False,
        "created": time.time(),
    }
    row = SolveRow(capture=capture, **{**usual, **values})
    with database.writing() as session:
        session.add(row)
    return row


def claim(database: Database, row: JobRow, token: str = "token", worker: str = "worker") -> JobRow:
    """Claim the job that is next, which is to be that of a row."""
    with database.writing() as session:
        job = claim_next(session, Holder(token, worker, row.engine))
    assert job is not None
    assert job.id == row.id
    assert isinstance(job, type(row))
    return job


class Messages:
    """The queue's messages, of which ``taken`` have been taken by workers."""

    def __init__(self) -> None:
        self.sent = self.taken = 0

    def waiting(self) -> int:
        return self.sent - self.taken

    def send(self) -> None:
        self.sent += 1


def find(database: Database, id: str) -> ModelRow:
    """Return a model's row."""
    with database.reading() as session:
        return session.query(ModelRow).filter_by(id=id).one()


def add_webhook(database: Database, **values: Any) -> WebhookRow:
    """Write the row of a webhook that is told of everything, and return it."""
    usual: dict[str, Any] = {"id": new_id("hook"), "url": f"https:{'//'}hooks.example/", "salt": "s", "created": 0.0}
    row = WebhookRow(**{**usual, "events": list(JOB_EVENTS), **values})
    with database.writing() as session:
        session.add(row)
    return row


def deliveries(database: Database) -> Sequence[DeliveryRow]:
    """Return all messages to webhooks, the first one first."""
    with database.reading() as session:
        return session.scalars(select(DeliveryRow).order_by(DeliveryRow.number)).all()
