"""Links to models, and tags of models."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"


def upgrade() -> None:
    """Make the change."""
    number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    op.add_column("models", sa.Column("tags", sa.JSON(none_as_null=True), server_default="[]", nullable=False))
    op.create_table(
        "shares",
        sa.Column("number", number, autoincrement=True, nullable=False),
        sa.Column("team", sa.String(length=40), server_default="local", nullable=False),
        sa.Column("maker", sa.String(length=40), server_default="local", nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("model", sa.String(length=40), nullable=False),
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("photo", sa.Boolean(), nullable=False),
        sa.Column("download", sa.Boolean(), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("expires", sa.Float(), nullable=False),
        sa.Column("revoked", sa.Float(), nullable=True),
        sa.ForeignKeyConstraint(["model"], ["models.id"], name="fk_shares_model", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("number", name="pk_shares"),
        sa.UniqueConstraint("id", name="uq_shares_id"),
        sa.UniqueConstraint("digest", name="uq_shares_digest"),
    )
    op.create_index("ix_shares_model", "shares", ["model", "number"])
