"""Turns of those whose jobs wait, the engine of each worker, and indexes by which the next job is found."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"


def upgrade() -> None:
    """Make the change."""
    op.add_column("workers", sa.Column("engine", sa.String(length=40), server_default="unknown", nullable=False))
    turns = op.create_table(
        "turns",
        *(sa.Column(name, sa.String(length=40), nullable=False) for name in ("team", "maker", "kind")),
        sa.Column("last", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.PrimaryKeyConstraint("team", "maker", "kind", name="pk_turns"),
    )
    op.bulk_insert(turns, [{"team": "", "maker": "", "kind": "", "last": 0}])
    for table in ("models", "solves"):
        op.create_index(f"ix_{table}_line", table, ["status", "engine", "team", "maker", "number"])
