"""The tables. Times are seconds since 1970 (UTC); they are shown, and nothing waits by them."""

from typing import Any

from sqlalchemy import JSON, BigInteger, Float, ForeignKey, Index, Integer, MetaData, String, false
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

_NAMES = {
    "pk": "pk_%(table_name)s",
    "uq": "uq_%(table_name)s_%(column_0_name)s",
    "ix": "ix_%(table_name)s_%(column_0_name)s",
    "fk": "fk_%(table_name)s_%(column_0_name)s",
}
PARTS = ("photo", "strokes", "front", "side", "leaf", "fruit")
_NUMBER = BigInteger().with_variant(Integer, "sqlite")


class Table(DeclarativeBase):
    """What all tables share."""

    metadata = MetaData(naming_convention=_NAMES)
    type_annotation_map = {  # noqa: RUF012
        dict[str, Any]: JSON(none_as_null=True),
        list[dict[str, Any]]: JSON(none_as_null=True),
        float: Float,
    }


class Aged:
    """A row whose age counts.

    ``seen`` is when a sweep first saw the row as it is now, kept or deleted, by the store's own clock (`StoreClock`);
    None until then.
    """

    seen: Mapped[float | None]


class PhotoRow(Aged, Table):
    """An uploaded photo: upright sRGB pixels in a blob, without metadata."""

    __tablename__ = "photos"

    number: Mapped[int] = mapped_column(_NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    sha256: Mapped[str] = mapped_column(String(64))
    """Of the bytes that were uploaded."""
    width: Mapped[int]
    height: Mapped[int]
    blob: Mapped[str] = mapped_column(String(64))
    bytes: Mapped[int] = mapped_column(insert_default=0, server_default="0")
    """Of the blob, which may be many times as large as what was uploaded."""
    warnings: Mapped[list[dict[str, Any]]] = mapped_column(insert_default=list, server_default="[]")
    """What was mended when it was read: code, stroke and detail of each."""
    created: Mapped[float]
    deleted: Mapped[float | None]


class ModelRow(Aged, Table):
    """A tree that was asked for, is being made, or is made. This row is the job; a queue message is a hint to it.

    ``attempt`` is the fence: what works on the job says which attempt it is, and nothing of another attempt is
    taken. ``beat`` rises as long as that attempt lives. ``seq`` rises with all that a viewer is told.
    """

    __tablename__ = "models"

    number: Mapped[int] = mapped_column(_NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    name: Mapped[str] = mapped_column(String(200))
    photo: Mapped[str | None] = mapped_column(String(40))
    photo_blob: Mapped[str | None] = mapped_column(String(64))
    strokes_blob: Mapped[str | None] = mapped_column(String(64))
    front_blob: Mapped[str | None] = mapped_column(String(64))
    front_ending: Mapped[str | None] = mapped_column(String(4))
    """Of the file that the blob is: json or png."""
    side_blob: Mapped[str | None] = mapped_column(String(64))
    side_ending: Mapped[str | None] = mapped_column(String(4))
    leaf_blob: Mapped[str | None] = mapped_column(String(64))
    fruit_blob: Mapped[str | None] = mapped_column(String(64))
    settings: Mapped[dict[str, Any]]
    seed: Mapped[int] = mapped_column(BigInteger)
    engine: Mapped[str] = mapped_column(String(40))
    """Of the worker that grew it, or grows it; until then of the web process."""
    fingerprint: Mapped[str] = mapped_column(String(64))
    """Of photo, drawings, settings and seed: what the tree is made of."""
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
    report: Mapped[dict[str, Any] | None]
    preview_seq: Mapped[int | None]
    created: Mapped[float]
    started: Mapped[float | None]
    finished: Mapped[float | None]
    deleted: Mapped[float | None]

    @property
    def parts(self) -> dict[str, str]:
        """Give the blobs of what the tree is made of, by part: photo, strokes, front, side, leaf, fruit."""
        blobs = {part: getattr(self, f"{part}_blob") for part in PARTS}
        return {part: blob for part, blob in blobs.items() if blob is not None}

    @property
    def drawings(self) -> dict[str, str]:
        """Give the blobs of what was drawn, by the name of the file that each is."""
        names = {"strokes": "strokes.json", "front": f"front.{self.front_ending}", "side": f"side.{self.side_ending}"}
        return {names[part]: blob for part, blob in self.parts.items() if part in names}


class File(Table):
    """A file of a model: its name outside, and the blob that holds it."""

    __tablename__ = "files"

    model: Mapped[str] = mapped_column(ForeignKey("models.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[str] = mapped_column(String(40), primary_key=True)
    blob: Mapped[str] = mapped_column(String(64))
    bytes: Mapped[int]


class Replay(Aged, Table):
    """An Idempotency-Key: what it was used for, and what it gave."""

    __tablename__ = "replays"

    key: Mapped[str] = mapped_column(String(255), primary_key=True)
    fingerprint: Mapped[str] = mapped_column(String(64))
    model: Mapped[str] = mapped_column(String(40))
    created: Mapped[float]


class Worker(Table):
    """A worker that said it lives: how many models it grows at once, and its own beat."""

    __tablename__ = "workers"

    id: Mapped[str] = mapped_column(String(120), primary_key=True)
    slots: Mapped[int]
    beat: Mapped[int]


class StoreClock(Table):
    """The one row of the clock that ages are told by: it counts the seconds in which sweeps watched the store."""

    __tablename__ = "store_clock"

    id: Mapped[int] = mapped_column(primary_key=True)
    age_s: Mapped[float]
    wall: Mapped[float]
    """The latest that the clock on the wall ever said when ``age_s`` was written."""


class Stray(Table):
    """A file among the blobs that no row referred to when a sweep saw it."""

    __tablename__ = "strays"

    folder: Mapped[str] = mapped_column(String(2), primary_key=True)
    name: Mapped[str] = mapped_column(String(80), primary_key=True)
    state: Mapped[str] = mapped_column(String(60))
    """Changes when the file is written anew."""
    seen: Mapped[float]
    """By the store's own clock, and in this state."""


REFERENCES = (PhotoRow.blob, *(getattr(ModelRow, f"{part}_blob") for part in PARTS), File.blob)
"""Every column that names a blob."""

Index("ix_models_queue", ModelRow.status, ModelRow.number)
Index("ix_models_twins", ModelRow.fingerprint, ModelRow.engine, ModelRow.status)
Index("ix_models_times", ModelRow.status, ModelRow.started, ModelRow.finished)
for _table in (ModelRow, PhotoRow):
    Index(f"ix_{_table.__tablename__}_seen", _table.seen)
    Index(f"ix_{_table.__tablename__}_deleted", _table.seen, sqlite_where=_table.deleted.is_not(None))
Index("ix_photos_stored", PhotoRow.blob, PhotoRow.bytes)
Index("ix_replays_seen", Replay.seen)
Index("ix_photos_blob", PhotoRow.blob)
Index("ix_files_blob", File.blob)
for _column in REFERENCES[1:-1]:
    Index(f"ix_models_{_column.key}", _column, sqlite_where=_column.is_not(None))
