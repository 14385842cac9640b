"""Every row belongs to a team, and tells who made it; what was there is the only team's of a service without keys."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
_OWNED = ("model_parts", "files")
_AUTHORED = ("photos", "clips", "uploads", "models", "captures", "capture_photos", "solves")
_LOCAL = "local"


def upgrade() -> None:
    """Make the change."""
    for table in (*_OWNED, *_AUTHORED):
        op.add_column(table, _name("team"))
    for table in _AUTHORED:
        op.add_column(table, _name("maker"))
    for table in ("models", "solves"):
        op.drop_index(f"ix_{table}_fingerprint", table)
        op.create_index(f"ix_{table}_fingerprint", table, ["fingerprint", "team", "engine", "status"])
    for table in ("models", "captures"):
        op.create_index(f"ix_{table}_team", table, ["team", "number"])
    _key_replays_by_person()


def _name(column: str) -> sa.Column[str]:
    return sa.Column(column, sa.String(length=40), server_default=_LOCAL, nullable=False)


def _key_replays_by_person() -> None:
    """Make the table of Idempotency-Keys again: a key is one person's."""
    kept = "key, fingerprint, model, created, seen"
    op.drop_index("ix_replays_seen", "replays")
    op.execute("ALTER TABLE replays RENAME TO old_replays")
    number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    op.create_table(
        "replays",
        sa.Column("number", number, autoincrement=True, nullable=False),
        _name("team"),
        _name("maker"),
        sa.Column("key", sa.String(length=255), nullable=False),
        sa.Column("fingerprint", sa.String(length=64), nullable=False),
        sa.Column("model", sa.String(length=40), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("seen", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("number", name="pk_numbered_replays"),
        sa.UniqueConstraint("team", "maker", "key", name="uq_replays_team"),
    )
    op.execute(f"INSERT INTO replays ({kept}) SELECT {kept} FROM old_replays")
    op.drop_table("old_replays")
    op.create_index("ix_replays_seen", "replays", ["seen"])
