"""Captures: photos of one tree from several places, and finding their cameras."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"


def upgrade() -> None:
    """Make the change."""
    op.create_table(
        "captures",
        *_numbered(),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("deleted", sa.Float(), nullable=True),
        sa.Column("seen", sa.Float(), nullable=True),
        *_keys("captures"),
    )
    op.create_index("ix_captures_seen", "captures", ["seen"])
    deleted = sa.text("deleted IS NOT NULL")
    op.create_index("ix_captures_deleted", "captures", ["seen"], sqlite_where=deleted, postgresql_where=deleted)
    _create_photos()
    _create_solves()


def _create_photos() -> None:
    op.create_table(
        "capture_photos",
        *_numbered(),
        _capture(),
        sa.Column("name", _by_code_points(200), nullable=False),
        sa.Column("sent_name", sa.String(length=200), nullable=False),
        sa.Column("focal_length_px", sa.Float(), nullable=True),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("width", sa.Integer(), nullable=False),
        sa.Column("height", sa.Integer(), nullable=False),
        sa.Column("blob", sa.String(length=64), nullable=False),
        sa.Column("bytes", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), server_default="0", nullable=False),
        sa.Column("warnings", sa.JSON(), server_default="[]", nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        *_keys("capture_photos", "capture"),
        sa.UniqueConstraint("capture", "name", name="uq_capture_photos_capture"),
    )
    op.create_index("ix_capture_photos_stored", "capture_photos", ["blob", "bytes"])
    op.create_index("ix_capture_photos_blob", "capture_photos", ["blob"])


def _create_solves() -> None:
    op.create_table(
        "solves",
        *_numbered(),
        _capture(),
        sa.Column("engine", sa.String(length=40), nullable=False),
        sa.Column("fingerprint", sa.String(length=64), nullable=False),
        sa.Column("structure", sa.String(length=64), nullable=True),
        sa.Column("status", sa.String(length=12), nullable=False),
        sa.Column("phase", sa.String(length=12), nullable=True),
        sa.Column("phase_fraction", sa.Float(), nullable=False),
        sa.Column("progress", sa.Float(), nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("beat", sa.Integer(), nullable=False),
        sa.Column("claim", sa.String(length=80), nullable=True),
        sa.Column("worker", sa.String(length=120), nullable=True),
        sa.Column("cancel", sa.Boolean(), server_default=sa.false(), nullable=False),
        sa.Column("error", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("started", sa.Float(), nullable=True),
        sa.Column("finished", sa.Float(), nullable=True),
        *_keys("solves", "capture"),
    )
    op.create_index("ix_solves_queue", "solves", ["status", "number"])
    op.create_index("ix_solves_fingerprint", "solves", ["fingerprint", "engine", "status"])
    op.create_index("ix_solves_times", "solves", ["status", "started", "finished"])
    op.create_index("ix_solves_capture", "solves", ["capture", "fingerprint", "number"])
    op.create_index("ix_solves_structure", "solves", ["structure"])


def _by_code_points(length: int) -> sa.types.TypeEngine[str]:
    """Return the type of a text that is put in the same order everywhere, whatever language the database has."""
    return sa.String(length=length).with_variant(sa.String(length=length, collation="C"), "postgresql")


def _numbered() -> tuple[sa.Column[int], sa.Column[str]]:
    number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    return (
        sa.Column("number", number, autoincrement=True, nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
    )


def _capture() -> sa.Column[str]:
    return sa.Column("capture", sa.String(length=40), nullable=False)


def _keys(table: str, parent: str = "") -> list[sa.Constraint]:
    """Return a table's keys: its number, its id, and the capture that its rows belong to."""
    keys: list[sa.Constraint] = [
        sa.PrimaryKeyConstraint("number", name=f"pk_{table}"),
        sa.UniqueConstraint("id", name=f"uq_{table}_id"),
    ]
    if parent:
        keys.append(sa.ForeignKeyConstraint([parent], ["captures.id"], name=f"fk_{table}_{parent}", ondelete="CASCADE"))
    return keys
