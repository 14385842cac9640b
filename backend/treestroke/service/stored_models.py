"""Stored models: accepted, found, named, stopped, deleted and restored."""

import hashlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import structlog
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from treestroke.codec.inputs import PARTS, Inputs, file_name, part_of
from treestroke.service.drawn_over import Base, base_of
from treestroke.service.engine_version import engine_version
from treestroke.service.fingerprints import digest
from treestroke.service.makers import Maker, makers_of
from treestroke.service.model_request import ModelOrder
from treestroke.service.photos import NotFound, Resources
from treestroke.service.quotas import admit_model
from treestroke.store import leases, queries
from treestroke.store.database import Database
from treestroke.store.objects import Damaged
from treestroke.store.outbox import note_ended
from treestroke.store.search import Search, search
from treestroke.store.tables import File, ModelPart, ModelRow, PhotoRow, Replay

RESTORABLE_SECONDS = 24 * 3600.0
_ALL = Search()
log = structlog.get_logger()


class KeyReused(Exception):
    """An Idempotency-Key was sent again with another request."""


class Version(NamedTuple):
    """The values that change whenever a model's viewers are to be shown something new."""

    seq: int
    queue_position: int | None
    eta_s: float | None


@dataclass(frozen=True)
class StoredModel:
    """A model as it is stored and shown: its row, parts and files, its place in the queue and its remaining seconds.

    ``maker`` is None where nobody signs in.
    """

    row: ModelRow
    parts: dict[str, ModelPart]
    files: dict[str, File]
    queue_position: int | None
    eta_s: float | None
    maker: Maker | None = None

    @property
    def id(self) -> str:
        """The model's id."""
        return self.row.id

    @property
    def inputs(self) -> Inputs[ModelPart]:
        """The tree's inputs, as stored files."""
        return Inputs.of(self.parts)

    @property
    def drawings(self) -> dict[str, ModelPart]:
        """The parts that the person drew, by the names of their files."""
        drawn = (self.parts[name] for name, part in PARTS.items() if part.drawn and name in self.parts)
        return {file_name(part.name, part.media_type): part for part in drawn}

    @property
    def version(self) -> Version:
        """The version of what viewers are shown."""
        return Version(self.row.seq, self.queue_position, self.eta_s)


def accept_model(
    resources: Resources, order: ModelOrder, key: str | None, sent_photo: PhotoRow | None = None
) -> StoredModel:
    """Check, store and queue a model; one whose inputs were made into a tree before gets that tree's files at once.

    ``key`` is the Idempotency-Key: sent again with the same request, it returns the model that it returned first.
    ``sent_photo`` is a photo that came with the request; it is kept only where a new model is made from it.

    Raises
    ------
    NotFound, TreestrokeError, KeyReused
        There is no such photo, capture or clip; something in the request cannot be used, or the capture is not solved;
        the key was used for another request.
    QuotaExceeded
        As `quotas.admit_model`.
    Damaged
        The file of the photo or the clip is damaged.
    OSError
        The disk is full.
    """
    if (order.capture or order.clip) and (before := _repeated(resources, order, key)) is not None:
        return before
    photo = sent_photo or (None if order.photo is None else _photo_for(resources, order.photo, key))
    base = base_of(resources, order, photo)
    inputs = Inputs.of({**base.parts, **sent_parts(resources, order)})
    row = new_row(order, photo, _fingerprint(order, base, inputs))
    request = _request_digest(order, row, photo)
    equal = finished_model(resources, row)
    with resources.database.writing() as session:
        answered = _claim_key(session, key, request, row.id) if key else None
        if answered is None:
            admit_model(session, resources.quotas, equal is None, 0 if sent_photo is None else sent_photo.bytes)
            session.add_all([row, sent_photo] if sent_photo else [row])
            session.flush()  # parts and files refer to the row
            for part in inputs.parts.values():
                part.model = row.id
                session.add(part)
            if equal is not None:
                copy_files(session, equal, row)
    # What the queue and the files tell needs no lock.
    return find_model(resources.database, (answered or row).id, deleted=True)


def find_model(database: Database, id: str, deleted: bool = False) -> StoredModel:
    """Find a model; a deleted one only where ``deleted``.

    Raises
    ------
    NotFound
        There is no such model.
    """
    with database.reading() as session:
        (found,) = _stored(session, [_row(session, id, deleted)])
        return found


def list_models(
    database: Database, cursor: str | None, limit: int, wanted: Search = _ALL
) -> tuple[Sequence[StoredModel], str | None]:
    """Return a page of the models that are looked for, newest first, and the cursor of the next page: decimal digits.

    A page of a search may be empty where more follow (`store.search.search`).
    """
    with database.reading() as session:
        if wanted == _ALL:
            rows, next_cursor = queries.page(session, ModelRow, cursor, limit)
        else:
            rows, next_cursor = search(session, wanted, cursor, limit)
        return _stored(session, rows), next_cursor


def find_changed(database: Database, versions: Mapping[str, Version | None]) -> dict[str, StoredModel | None]:
    """Return the models whose version has changed; None for one that was removed for good."""
    with database.reading() as session:
        rows = session.execute(
            select(ModelRow.id, ModelRow.number, ModelRow.seq, ModelRow.status, ModelRow.progress).where(
                ModelRow.id.in_(versions)
            )
        ).all()
        waits = queries.waits(session, ModelRow, rows)
        changed = [row.id for row in rows if Version(row.seq, *waits[row.number]) != versions[row.id]]
        found = session.scalars(select(ModelRow).where(ModelRow.id.in_(changed))).all() if changed else ()
        removed = dict.fromkeys(versions.keys() - {row.id for row in rows})
        return {**removed, **{model.row.id: model for model in _stored(session, found)}}


def change(database: Database, id: str, changes: Mapping[str, object]) -> StoredModel:
    """Give a model a new name or new tags, by the columns of its row.

    Raises
    ------
    NotFound
        There is no such model.
    """
    with database.writing() as session:
        _row(session, id)
        session.execute(update(ModelRow).where(ModelRow.id == id).values(**changes, seq=ModelRow.seq + 1))
    return find_model(database, id)


def cancel(database: Database, id: str) -> StoredModel:
    """Stop a model that is not finished; a finished one stays as it is.

    Raises
    ------
    NotFound
        There is no such model.
    """
    with database.writing() as session:
        _row(session, id)
        leases.cancel(session, ModelRow, ModelRow.id == id)
    return find_model(database, id, deleted=True)


def delete(database: Database, id: str) -> None:
    """Delete a model; it is stopped if it is not finished, and can be restored for a day.

    Raises
    ------
    NotFound, NotYours
        There is no such model, or it may not be deleted by whom the session is for.
    """
    with database.writing() as session:
        if not queries.mark_deleted(session, ModelRow, id):
            raise NotFound("model")
        leases.cancel(session, ModelRow, ModelRow.id == id)


def restore(database: Database, id: str) -> StoredModel:
    """Undo a model's deletion.

    Raises
    ------
    NotFound, NotYours
        There is no such model, or it was removed for good; or it may not be restored by whom the session is for.
    """
    with database.writing() as session:
        if not queries.mark_restored(session, ModelRow, id):
            raise NotFound("model")
    return find_model(database, id)


def _photo_for(resources: Resources, id: str, key: str | None) -> PhotoRow:
    """Find the photo that a request names; a deleted one only where the request may have been sent before."""
    with resources.database.reading() as session:
        repeated = key is not None and queries.replay(session, key) is not None
        photo = queries.photo(session, id, deleted=repeated)
    if photo is None:
        raise NotFound("photo")
    return photo


def sent_parts(resources: Resources, order: ModelOrder) -> dict[str, ModelPart]:
    """Store the parts' files that came with the request."""
    return {
        name: ModelPart(
            name=name, blob=resources.blobs.put(content), media_type=part_of(name).format_of(content).media_type
        )
        for name, content in order.parts.items()
    }


def new_row(order: ModelOrder, photo: PhotoRow | None, fingerprint: str) -> ModelRow:
    """Return the row of a new model, which waits."""
    return ModelRow(
        id=queries.new_id("mdl"),
        name=order.name,
        photo=None if photo is None else photo.id,
        capture=order.capture,
        clip=order.clip,
        settings=order.settings,
        seed=order.seed,
        engine=engine_version(),
        fingerprint=fingerprint,
        status="queued",
        phase_fraction=0.0,
        progress=0.0,
        seq=1,
        attempt=0,
        beat=0,
        cancel=False,
        created=time.time(),
    )


def _fingerprint(order: ModelOrder, base: Base, inputs: Inputs[ModelPart]) -> str:
    """Return a digest of all that decides over the tree and its report, except the engine."""
    blobs = {name: part.blob for name, part in inputs.parts.items()}
    return digest([blobs.pop("photo", None), blobs, order.settings, order.seed, *base.warnings])


def _request_digest(order: ModelOrder, row: ModelRow, photo: PhotoRow | None) -> str:
    """Return a digest of what was asked for."""
    if order.capture is not None or order.clip is not None:
        return _named_request_digest(order)
    return digest([row.fingerprint, order.name, None if photo is None else photo.sha256])


def _named_request_digest(order: ModelOrder) -> str:
    """Return a digest of what was asked for; a capture or a clip counts by its id: it may be another or gone by now."""
    parts = {name: hashlib.sha256(content).hexdigest() for name, content in order.parts.items()}
    return digest([order.capture or order.clip, parts, order.settings, order.seed, order.name])


def _repeated(resources: Resources, order: ModelOrder, key: str | None) -> StoredModel | None:
    """Find the model that a request for one of a capture or a clip was answered with when it was sent before.

    Raises
    ------
    KeyReused
        The key was used for another request.
    """
    with resources.database.reading() as session:
        row = _answered_before(session, key, _named_request_digest(order))
    return None if row is None else find_model(resources.database, row.id, deleted=True)


def _answered_before(session: Session, key: str | None, request: str) -> ModelRow | None:
    """Find the model that an Idempotency-Key has returned; None where the key is new or the model was removed.

    Raises
    ------
    KeyReused
        The key was used for another request.
    """
    replay = queries.replay(session, key) if key else None
    if replay is None:
        return None
    if replay.fingerprint != request:
        raise KeyReused
    return queries.model(session, replay.model, deleted=True)


def _claim_key(session: Session, key: str, request: str, model: str) -> ModelRow | None:
    """Note that an Idempotency-Key gets a new model; return the one that it got before, if that is still there.

    Raises
    ------
    KeyReused
        The key was used for another request.
    """
    replay = queries.locked_replay(session, Replay(key=key, fingerprint=request, model=model, created=time.time()))
    if replay.fingerprint != request:
        raise KeyReused
    before = None if replay.model == model else queries.model(session, replay.model, deleted=True)
    if before is None:
        replay.model, replay.created, replay.seen = model, time.time(), None
    return before


def finished_model(resources: Resources, row: ModelRow) -> ModelRow | None:
    """Find a model that this engine has made from equal inputs; None also where one of its files is damaged."""
    with resources.database.reading() as session:
        equal = queries.finished(session, ModelRow, row.fingerprint, row.engine)
        files = {} if equal is None else queries.files(session, [equal.id])[equal.id]
    try:
        for file in files.values():
            resources.blobs.check(file.blob)
    except Damaged as error:
        log.error("file_damaged", file=str(error))
        return None
    return equal


def copy_files(session: Session, equal: ModelRow, row: ModelRow) -> None:
    """Finish a model with the files of an equal one, which would be the same, unless these were just removed."""
    files = queries.files(session, [equal.id])[equal.id]
    if files:
        row.status, row.progress, row.finished = "succeeded", 1.0, time.time()
        row.report, row.preview_seq = equal.report, 1
        session.add_all(File(model=row.id, name=name, blob=file.blob, bytes=file.bytes) for name, file in files.items())
        note_ended(session, ModelRow, [row.id])


def _row(session: Session, id: str, deleted: bool = False) -> ModelRow:
    row = queries.model(session, id, deleted)
    if row is None:
        raise NotFound("model")
    return row


def _stored(session: Session, rows: Sequence[ModelRow]) -> list[StoredModel]:
    """Read what belongs to rows, by as many queries for many rows as for one."""
    ids = [row.id for row in rows]
    parts, files, waits = (
        queries.parts(session, ids),
        queries.files(session, ids),
        queries.waits(session, ModelRow, rows),
    )
    makers = makers_of(session, rows)
    return [StoredModel(row, parts[row.id], files[row.id], *waits[row.number], makers.get(row.maker)) for row in rows]
