"""Clips: videos of one tree, their uploads, and models that are made of them."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"


def upgrade() -> None:
    """Make the change."""
    number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    op.create_table(
        "clips",
        sa.Column("number", number, autoincrement=True, nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("width", sa.Integer(), nullable=False),
        sa.Column("height", sa.Integer(), nullable=False),
        sa.Column("frames", sa.Integer(), nullable=False),
        sa.Column("frames_per_second", sa.Float(), nullable=False),
        sa.Column("blob", sa.String(length=64), nullable=False),
        sa.Column("bytes", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), server_default="0", nullable=False),
        sa.Column("media_type", sa.String(length=40), nullable=False),
        sa.Column("warnings", sa.JSON(), server_default="[]", nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("deleted", sa.Float(), nullable=True),
        sa.Column("seen", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("number", name="pk_clips"),
        sa.UniqueConstraint("id", name="uq_clips_id"),
    )
    op.create_index("ix_clips_stored", "clips", ["blob", "bytes"])
    op.create_index("ix_clips_blob", "clips", ["blob"])
    op.create_index("ix_clips_seen", "clips", ["seen"])
    deleted = sa.text("deleted IS NOT NULL")
    op.create_index("ix_clips_deleted", "clips", ["seen"], sqlite_where=deleted, postgresql_where=deleted)
    op.create_table(
        "uploads",
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("clip", sa.String(length=40), nullable=True),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("seen", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_uploads"),
    )
    op.create_index("ix_uploads_seen", "uploads", ["seen"])
    op.add_column("models", sa.Column("clip", sa.String(length=40), nullable=True))
