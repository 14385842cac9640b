"""The tables. Times are seconds since 1970 (UTC); they are shown, and never decide when something is due."""

from typing import Any, TypeVar

from sqlalchemy import JSON, BigInteger, Float, ForeignKey, Index, Integer, MetaData, String, UniqueConstraint, false
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

from treestroke.store.scope import Authored, Owned

_NAMES = {
    "pk": "pk_%(table_name)s",
    "uq": "uq_%(table_name)s_%(column_0_name)s",
    "ix": "ix_%(table_name)s_%(column_0_name)s",
    "fk": "fk_%(table_name)s_%(column_0_name)s",
}
NUMBER = BigInteger().with_variant(Integer, "sqlite")


class Table(DeclarativeBase):
    """Base of all tables."""

    metadata = MetaData(naming_convention=_NAMES)
    type_annotation_map = {  # noqa: RUF012
        dict[str, Any]: JSON(none_as_null=True),
        list[dict[str, Any]]: JSON(none_as_null=True),
        list[str]: JSON(none_as_null=True),
        float: Float,
    }


class Aged:
    """A row that is removed by age.

    ``seen`` is when a sweep first saw the row in its present state, kept or deleted, by the store's own clock
    (`StoreClock`); None until then.
    """

    seen: Mapped[float | None]


class Uploaded(Authored):
    """A row of an uploaded photo or clip, whose file is a blob; of a photo, upright sRGB pixels without metadata."""

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    sha256: Mapped[str] = mapped_column(String(64))
    """SHA-256 of the uploaded bytes."""
    width: Mapped[int]
    height: Mapped[int]
    blob: Mapped[str] = mapped_column(String(64))
    bytes: Mapped[int] = mapped_column(NUMBER, insert_default=0, server_default="0")
    """Size of the blob, which may be many times that of the upload."""
    warnings: Mapped[list[dict[str, Any]]] = mapped_column(insert_default=list, server_default="[]")
    """What was mended or left out when it was read: code, stroke and detail of each."""
    created: Mapped[float]


class PhotoRow(Uploaded, Aged, Table):
    """A photo by itself."""

    __tablename__ = "photos"

    deleted: Mapped[float | None]


class ClipRow(Uploaded, Aged, Table):
    """A video of one tree: its file as it was sent, and the size and number of its frames as they are used."""

    __tablename__ = "clips"

    name: Mapped[str] = mapped_column(String(200))
    frames: Mapped[int]
    frames_per_second: Mapped[float]
    media_type: Mapped[str] = mapped_column(String(40))
    deleted: Mapped[float | None]


class UploadRow(Authored, Aged, Table):
    """A clip that is on its way here; what has arrived is a file of this id, or pieces (`PieceRow`).

    It names the clip once it is whole.
    """

    __tablename__ = "uploads"

    id: Mapped[str] = mapped_column(String(40), primary_key=True)
    name: Mapped[str] = mapped_column(String(200))
    clip: Mapped[str | None] = mapped_column(String(40))
    created: Mapped[float]


class PieceRow(Owned, Table):
    """A piece of an upload that has arrived, where web processes share a bucket: where it begins, and its blob."""

    __tablename__ = "upload_pieces"

    upload: Mapped[str] = mapped_column(ForeignKey("uploads.id", ondelete="CASCADE"), primary_key=True)
    start: Mapped[int] = mapped_column(BigInteger, primary_key=True)
    bytes: Mapped[int]
    blob: Mapped[str] = mapped_column(String(64))


class Job(Authored):
    """A row that is work for a worker: it waits, is under way, or is done. A message only says that it waits.

    ``attempt`` is the fence: each change made by a worker names its attempt, and is refused once another attempt has
    the job. ``beat`` rises while that attempt lives. ``seq`` rises with every change that viewers are shown.
    """

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    engine: Mapped[str] = mapped_column(String(40))
    """Engine that it was accepted for: workers of this engine alone take it."""
    fingerprint: Mapped[str] = mapped_column(String(64))
    """Digest of all that decides over the result, except the engine: equal ones have equal results."""
    status: Mapped[str] = mapped_column(String(12))
    phase: Mapped[str | None] = mapped_column(String(12))
    phase_fraction: Mapped[float]
    progress: Mapped[float]
    seq: Mapped[int]
    attempt: Mapped[int]
    beat: Mapped[int]
    claim: Mapped[str | None] = mapped_column(String(80))
    worker: Mapped[str | None] = mapped_column(String(120))
    cancel: Mapped[bool] = mapped_column(server_default=false())
    error: Mapped[dict[str, Any] | None]
    created: Mapped[float]
    started: Mapped[float | None]
    finished: Mapped[float | None]


class ModelRow(Job, Aged, Table):
    """A tree that was asked for, is being made, or is made."""

    __tablename__ = "models"

    name: Mapped[str] = mapped_column(String(200))
    tags: Mapped[list[str]] = mapped_column(insert_default=list, server_default="[]")
    photo: Mapped[str | None] = mapped_column(String(40))
    capture: Mapped[str | None] = mapped_column(String(40))
    clip: Mapped[str | None] = mapped_column(String(40))
    settings: Mapped[dict[str, Any]]
    seed: Mapped[int] = mapped_column(BigInteger)
    report: Mapped[dict[str, Any] | None]
    preview_seq: Mapped[int | None]
    deleted: Mapped[float | None]


class ModelPart(Owned, Table):
    """One of the files that a model is made of: the name of its part, the blob that holds it, and its media type."""

    __tablename__ = "model_parts"

    model: Mapped[str] = mapped_column(ForeignKey("models.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[str] = mapped_column(String(220), primary_key=True)
    blob: Mapped[str] = mapped_column(String(64))
    media_type: Mapped[str] = mapped_column(String(40))


class File(Owned, Table):
    """A file of a model: its public name, and the blob that holds it."""

    __tablename__ = "files"

    model: Mapped[str] = mapped_column(ForeignKey("models.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[str] = mapped_column(String(40), primary_key=True)
    blob: Mapped[str] = mapped_column(String(64))
    bytes: Mapped[int] = mapped_column(NUMBER)


class Share(Authored, Table):
    """A link by which anybody sees a model; who has its token has the link, so that the token itself is not kept.

    Unlike all other times, ``expires`` decides: the link does nothing from then on, by the wall clock.
    """

    __tablename__ = "shares"

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    model: Mapped[str] = mapped_column(ForeignKey("models.id", ondelete="CASCADE"))
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    """SHA-256 of the token."""
    photo: Mapped[bool]
    """Whether the photo is shown."""
    download: Mapped[bool]
    """Whether the tree is offered for download."""
    created: Mapped[float]
    expires: Mapped[float]
    revoked: Mapped[float | None]


class AuditRow(Owned, Table):
    """An act that a team may have to account for (`store.audit`). It is never changed; Postgres may enforce that."""

    __tablename__ = "audit"

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    at: Mapped[float]
    who: Mapped[str | None] = mapped_column(String(40))
    """A member's id; None: whoever runs the service, or somebody who is not known."""
    credential: Mapped[str] = mapped_column(String(40))
    """Id of the key or session that they came with."""
    action: Mapped[str] = mapped_column(String(40))
    subject: Mapped[str] = mapped_column(String(40))
    details: Mapped[dict[str, Any]]
    address: Mapped[str] = mapped_column(String(64))
    request_id: Mapped[str] = mapped_column(String(64))


class CaptureRow(Authored, Aged, Table):
    """Photos of one tree from several places; ``seq`` rises with every change of their number."""

    __tablename__ = "captures"

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    seq: Mapped[int]
    created: Mapped[float]
    deleted: Mapped[float | None]


class CapturePhoto(Uploaded, Table):
    """A photo of a capture, whose name none of its others has."""

    __tablename__ = "capture_photos"
    __table_args__ = (UniqueConstraint("capture", "name"),)

    capture: Mapped[str] = mapped_column(ForeignKey("captures.id", ondelete="CASCADE"))
    name: Mapped[str] = mapped_column(String(200).with_variant(String(200, collation="C"), "postgresql"))
    sent_name: Mapped[str] = mapped_column(String(200))
    """The name it was sent by: ``name`` unless another photo of the capture had that already."""
    focal_length_px: Mapped[float | None]
    """Focal length, px, as its camera wrote it."""


class SolveRow(Job, Table):
    """Finding the cameras of a capture's photos; it belongs to those photos, told by its fingerprint."""

    __tablename__ = "solves"

    capture: Mapped[str] = mapped_column(ForeignKey("captures.id", ondelete="CASCADE"))
    structure: Mapped[str | None] = mapped_column(String(64))
    """Blob of what was found."""


class Replay(Authored, Aged, Table):
    """An Idempotency-Key of one person: the digest of the request that used it, and the model that it got."""

    __tablename__ = "replays"
    __table_args__ = (UniqueConstraint("team", "maker", "key"),)

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    key: Mapped[str] = mapped_column(String(255))
    fingerprint: Mapped[str] = mapped_column(String(64))
    model: Mapped[str] = mapped_column(String(40))
    created: Mapped[float]


class Worker(Table):
    """A running worker: how many jobs it does at once, by which engine, and its own beat."""

    __tablename__ = "workers"

    id: Mapped[str] = mapped_column(String(120), primary_key=True)
    slots: Mapped[int]
    beat: Mapped[int]
    engine: Mapped[str] = mapped_column(String(40), server_default="unknown")


class Turn(Table):
    """When a person's jobs of one kind were served last: the number of that claim, of all claims ever.

    The row without team, person and kind counts all claims.
    """

    __tablename__ = "turns"

    team: Mapped[str] = mapped_column(String(40), primary_key=True)
    maker: Mapped[str] = mapped_column(String(40), primary_key=True)
    kind: Mapped[str] = mapped_column(String(40), primary_key=True)
    """Name of the jobs' table."""
    last: Mapped[int] = mapped_column(NUMBER)


class StoreClock(Table):
    """The clock that ages are measured by, one row: it counts the seconds in which sweeps watched the store."""

    __tablename__ = "store_clock"

    id: Mapped[int] = mapped_column(primary_key=True)
    age_s: Mapped[float]
    wall: Mapped[float]
    """The latest wall-clock time at which ``age_s`` was written."""


class BlobRow(Owned, Table):
    """A blob of a team (`store.blobs`): what a row refers to by its SHA-256, or may be about to refer to."""

    __tablename__ = "blobs"

    team: Mapped[str] = mapped_column(String(40), primary_key=True)
    sha256: Mapped[str] = mapped_column(String(64), primary_key=True)
    """Its name; of what a process that died has left half written, the name of that file."""
    bytes: Mapped[int] = mapped_column(BigInteger)
    created: Mapped[float]
    seen: Mapped[float | None]
    """When a sweep first saw that no row refers to it, by the store's own clock; None where one does."""


AnyJob = ModelRow | SolveRow
JobRow = TypeVar("JobRow", ModelRow, SolveRow)
JOBS: tuple[type[ModelRow] | type[SolveRow], ...] = (ModelRow, SolveRow)
"""Every table whose rows are work for a worker."""
UNFINISHED = ("queued", "running")
TERMINAL = ("succeeded", "failed", "canceled")
UPLOADED: tuple[type[PhotoRow] | type[CapturePhoto] | type[ClipRow], ...] = (PhotoRow, CapturePhoto, ClipRow)
"""Every table of uploaded photos and clips."""
REFERENCES = (*(table.blob for table in UPLOADED), ModelPart.blob, File.blob, SolveRow.structure, PieceRow.blob)
"""Every column that names a blob."""

for _job in JOBS:
    Index(f"ix_{_job.__tablename__}_queue", _job.status, _job.number)
    Index(f"ix_{_job.__tablename__}_line", _job.status, _job.engine, _job.team, _job.maker, _job.number)
    Index(f"ix_{_job.__tablename__}_fingerprint", _job.fingerprint, _job.team, _job.engine, _job.status)
    Index(f"ix_{_job.__tablename__}_times", _job.status, _job.started, _job.finished)
for _uploaded in UPLOADED:
    Index(f"ix_{_uploaded.__tablename__}_stored", _uploaded.team, _uploaded.blob, _uploaded.bytes)
    Index(f"ix_{_uploaded.__tablename__}_blob", _uploaded.blob)
Index("ix_solves_capture", SolveRow.capture, SolveRow.fingerprint, SolveRow.number)
Index("ix_solves_structure", SolveRow.structure)
for _table in (ModelRow, PhotoRow, CaptureRow, ClipRow):
    Index(f"ix_{_table.__tablename__}_seen", _table.seen)
    _deleted = _table.deleted.is_not(None)
    Index(f"ix_{_table.__tablename__}_deleted", _table.seen, sqlite_where=_deleted, postgresql_where=_deleted)
for _listed in (ModelRow, CaptureRow):
    Index(f"ix_{_listed.__tablename__}_team", _listed.team, _listed.number)
Index("ix_audit_team", AuditRow.team, AuditRow.number)
Index("ix_shares_model", Share.model, Share.number)
Index("ix_replays_seen", Replay.seen)
Index("ix_uploads_seen", UploadRow.seen)
Index("ix_model_parts_blob", ModelPart.blob)
Index("ix_files_blob", File.blob)
Index("ix_upload_pieces_blob", PieceRow.blob)
Index("ix_files_team", File.team, File.model, File.bytes)
Index("ix_models_day", ModelRow.team, ModelRow.created)
