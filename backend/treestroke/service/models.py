"""Models: asked for, found, named, stopped, deleted and restored."""

import hashlib
import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import structlog
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from treestroke.codec.image import StoredPhoto
from treestroke.codec.project import VIEWS, Project, sketch_ending
from treestroke.service import model_request, tracer
from treestroke.service.engine import engine
from treestroke.service.model_request import ModelOrder
from treestroke.service.photos import NotFound, Shelf
from treestroke.store import leases, queries
from treestroke.store.blobs import Blobs, Damaged
from treestroke.store.database import Database
from treestroke.store.tables import File, ModelRow, PhotoRow, Replay

RESTORABLE_SECONDS = 24 * 3600.0
log = structlog.get_logger()


class KeyReused(Exception):
    """An Idempotency-Key came again with another request."""


class Mark(NamedTuple):
    """By what it is told whether a model looks as it did: its row's ``seq``, its place and its remaining seconds."""

    seq: int
    queue_position: int | None
    eta_s: float | None


@dataclass(frozen=True)
class Seen:
    """A model as its readers see it: the row, its files, its place in the queue and its remaining seconds."""

    row: ModelRow
    files: dict[str, File]
    queue_position: int | None
    eta_s: float | None

    @property
    def mark(self) -> Mark:
        """What a viewer is shown changes only together with this."""
        return Mark(self.row.seq, self.queue_position, self.eta_s)


def read_order(shelf: Shelf, body: bytes) -> ModelOrder:
    """Read a request for a model, in a tracing process since it may be large or hostile.

    Raises
    ------
    TreestrokeError
        It is no such request.
    """
    return shelf.tracers("", model_request.read_order, body)


def read_form(shelf: Shelf, fields: dict[str, bytes], brings_photo: bool = True) -> ModelOrder:
    """Read a request for a model from a form's fields but the photo, as `read_order` does.

    Raises
    ------
    TreestrokeError
        It is no such request.
    """
    return shelf.tracers("", model_request.read_form, fields, brings_photo)


def ask_for_model(shelf: Shelf, order: ModelOrder, key: str | None, brought: PhotoRow | None = None) -> Seen:
    """Accept a model: checked, stored and queued, or answered from the one that was made of the same input.

    ``key`` is the Idempotency-Key: with the same request it gives the model that it gave first. A photo that the
    request ``brought`` is kept only where a new model is made of it.

    Raises
    ------
    NotFound, TreestrokeError, KeyReused
        There is no such photo; something in the request cannot be used; the key was used for something else.
    Damaged
        The photo's file is damaged.
    OSError
        The disk is full.
    """
    photo = brought or (None if order.photo is None else _photo_for(shelf, order.photo, key))
    blob = None if photo is None else photo.blob
    place = None if blob is None else shelf.blobs.path(blob)
    shelf.tracers(blob or "", tracer.check_drawing, place, order.drawing, order.within)
    parts = {part: shelf.blobs.put(content) for part, content in order.parts.items()}
    row = _new_row(photo, order, parts)
    used = _digest([row.fingerprint, order.name, None if photo is None else photo.sha256])
    twin = _twin(shelf, row)
    with shelf.database.writing() as session:
        first = session.get(Replay, key) if key else None
        if first is not None and first.fingerprint != used:
            raise KeyReused
        made = None if first is None else queries.model(session, first.model, deleted=True)
        if made is None:
            session.add_all([row, brought] if brought else [row])
            if twin is not None:
                _answer_from(session, twin, row)
            if key:
                session.merge(Replay(key=key, fingerprint=used, model=row.id, created=time.time(), seen=None))
    # What readers are told besides needs no lock.
    return see(shelf.database, (made or row).id, deleted=True)


def see(database: Database, id: str, deleted: bool = False) -> Seen:
    """Find a model; a deleted one only where ``deleted``.

    Raises
    ------
    NotFound
        There is none.
    """
    with database.reading() as session:
        return _seen(session, _found(session, id, deleted))


def list_models(database: Database, cursor: str | None, limit: int) -> tuple[Sequence[Seen], str | None]:
    """Give a page of models, newest first, and the cursor of the next page: decimal digits."""
    with database.reading() as session:
        rows, following = queries.page(session, ModelRow, cursor, limit)
        return _all_seen(session, rows), following


def see_changed(database: Database, marks: Mapping[str, Mark | None]) -> dict[str, Seen | None]:
    """Look at many models at once; give those that no longer bear their mark, None for one that is gone for good."""
    with database.reading() as session:
        rows = session.execute(
            select(ModelRow.id, ModelRow.number, ModelRow.seq, ModelRow.status, ModelRow.progress).where(
                ModelRow.id.in_(marks)
            )
        ).all()
        waits = _waits(session, rows)
        changed = [row.id for row in rows if Mark(row.seq, *waits[row.number]) != marks[row.id]]
        found = session.scalars(select(ModelRow).where(ModelRow.id.in_(changed))).all() if changed else ()
        gone = dict.fromkeys(marks.keys() - {row.id for row in rows})
        return {**gone, **{seen.row.id: seen for seen in _all_seen(session, found)}}


def rename(database: Database, id: str, name: str) -> Seen:
    """Give a model a name.

    Raises
    ------
    NotFound, TreestrokeError
        There is no such model, or the name cannot be used.
    """
    with database.writing() as session:
        _found(session, id)
        session.execute(update(ModelRow).where(ModelRow.id == id).values(name=name, seq=ModelRow.seq + 1))
    return see(database, id)


def cancel(database: Database, id: str) -> Seen:
    """Stop a model that is not finished; one that is stays as it is.

    Raises
    ------
    NotFound
        There is none.
    """
    with database.writing() as session:
        _found(session, id)
        leases.cancel(session, id)
    return see(database, id, deleted=True)


def delete(database: Database, id: str) -> None:
    """Delete a model; it is stopped where it is not finished, and can be restored for a day.

    Raises
    ------
    NotFound
        There is none.
    """
    with database.writing() as session:
        _found(session, id)
        leases.cancel(session, id)
        session.execute(update(ModelRow).where(ModelRow.id == id).values(deleted=time.time(), seen=None))


def restore(database: Database, id: str) -> Seen:
    """Take a model's deletion back.

    Raises
    ------
    NotFound
        There is none, or its files are gone.
    """
    with database.writing() as session:
        row = _found(session, id, deleted=True)
        if row.deleted is not None:
            row.deleted = row.seen = None
    return see(database, id)


def project_from(blobs: Blobs, row: ModelRow) -> Project:
    """Read what a model is made of."""
    contents = {part: blobs.get(blob) for part, blob in row.parts.items()}
    photo = StoredPhoto(contents.pop("photo")) if "photo" in contents else None
    return Project(photo, contents.pop("strokes", None), {**row.settings, "seed": row.seed}, **contents)


def _photo_for(shelf: Shelf, id: str, key: str | None) -> PhotoRow:
    """Find the photo that a request names; a deleted one only where the request may be a repetition."""
    with shelf.database.reading() as session:
        repeated = key is not None and session.get(Replay, key) is not None
        photo = queries.photo(session, id, deleted=repeated)
    if photo is None:
        raise NotFound("photo")
    return photo


def _found(session: Session, id: str, deleted: bool = False) -> ModelRow:
    row = queries.model(session, id, deleted)
    if row is None:
        raise NotFound("model")
    return row


def _seen(session: Session, row: ModelRow) -> Seen:
    (seen,) = _all_seen(session, [row])
    return seen


def _all_seen(session: Session, rows: Sequence[ModelRow]) -> list[Seen]:
    """Show rows with as few questions for many as for one."""
    files, waits = queries.files(session, [row.id for row in rows]), _waits(session, rows)
    return [Seen(row, files[row.id], *waits[row.number]) for row in rows]


def _waits(session: Session, rows: Sequence[Any]) -> dict[int, tuple[int | None, float | None]]:
    """Say for each row, by number, its place in the queue and the seconds until it is finished."""
    places = queries.queue_positions(session, [row.number for row in rows if row.status == "queued"])
    unfinished = [row for row in rows if row.status not in leases.TERMINAL]
    usual_s = queries.usual_seconds(session) if unfinished else 0.0
    waits: dict[int, tuple[int | None, float | None]] = {row.number: (None, None) for row in rows}
    for row in unfinished:
        place = places.get(row.number)
        waits[row.number] = place, usual_s * (1.0 - row.progress + (place or 1) - 1)
    return waits


def _new_row(photo: PhotoRow | None, order: ModelOrder, parts: Mapping[str, str]) -> ModelRow:
    blob, mended = (None, []) if photo is None else (photo.blob, photo.warnings)
    endings = {view: sketch_ending(order.parts[view]) for view in VIEWS if view in parts}
    return ModelRow(
        id=queries.new_id("mdl"),
        name=order.name,
        photo=None if photo is None else photo.id,
        photo_blob=blob,
        **{f"{part}_blob": blob for part, blob in parts.items()},
        **{f"{view}_ending": ending for view, ending in endings.items()},
        settings=order.settings,
        seed=order.seed,
        engine=engine(),
        fingerprint=_digest([blob, parts, order.settings, order.seed, *mended]),
        status="queued",
        phase_fraction=0.0,
        progress=0.0,
        seq=1,
        attempt=0,
        beat=0,
        cancel=False,
        created=time.time(),
    )


def _twin(shelf: Shelf, row: ModelRow) -> ModelRow | None:
    """Find a model that was made of the same input, by the same engine; one whose files are damaged is made anew."""
    with shelf.database.reading() as session:
        twin = queries.twin(session, row.fingerprint, row.engine)
        files = {} if twin is None else queries.files(session, [twin.id])[twin.id]
    try:
        for file in files.values():
            shelf.blobs.check(file.blob)
    except Damaged as error:
        log.error("file_damaged", file=str(error))
        return None
    return twin


def _answer_from(session: Session, twin: ModelRow, row: ModelRow) -> None:
    """Take the files of a twin, unless it is gone by now: they would come out the same."""
    files = queries.files(session, [twin.id])[twin.id]
    if files:
        row.status, row.progress, row.finished = "succeeded", 1.0, time.time()
        row.report, row.preview_seq = twin.report, 1
        session.add_all(File(model=row.id, name=name, blob=one.blob, bytes=one.bytes) for name, one in files.items())


def _digest(value: object) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
