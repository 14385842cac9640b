"""Ages by the store's own clock, strays that were seen, and indexes for what is asked often."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
_PARTS = ("photo", "strokes", "front", "side", "leaf", "fruit")


def upgrade() -> None:
    """Make the change."""
    op.create_table(
        "store_clock",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("age_s", sa.Float(), nullable=False),
        sa.Column("wall", sa.Float(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_store_clock"),
    )
    op.create_table(
        "strays",
        sa.Column("folder", sa.String(length=2), nullable=False),
        sa.Column("name", sa.String(length=80), nullable=False),
        sa.Column("state", sa.String(length=60), nullable=False),
        sa.Column("seen", sa.Float(), nullable=False),
        sa.PrimaryKeyConstraint("folder", "name", name="pk_strays"),
    )
    for table in ("models", "photos", "replays"):
        op.add_column(table, sa.Column("seen", sa.Float(), nullable=True))
    op.drop_index("ix_models_fingerprint", "models")
    op.create_index("ix_models_twins", "models", ["fingerprint", "engine", "status"])
    op.create_index("ix_models_times", "models", ["status", "started", "finished"])
    for table in ("models", "photos"):
        op.create_index(f"ix_{table}_seen", table, ["seen"])
        _index_some(f"ix_{table}_deleted", table, "seen", "deleted IS NOT NULL")
    op.create_index("ix_replays_seen", "replays", ["seen"])
    op.create_index("ix_photos_blob", "photos", ["blob"])
    op.create_index("ix_photos_stored", "photos", ["blob", "bytes"])
    op.create_index("ix_files_blob", "files", ["blob"])
    for part in _PARTS:
        _index_some(f"ix_models_{part}_blob", "models", f"{part}_blob", f"{part}_blob IS NOT NULL")


def _index_some(name: str, table: str, column: str, where: str) -> None:
    op.create_index(name, table, [column], sqlite_where=sa.text(where), postgresql_where=sa.text(where))
