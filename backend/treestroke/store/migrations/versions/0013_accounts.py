"""Teams, their members, their keys and sessions."""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    """Make the change."""
    op.create_table(
        "teams",
        sa.Column("team", sa.String(length=40), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.PrimaryKeyConstraint("team", name="pk_teams"),
    )
    op.create_table(
        "members",
        _id(),
        _team(),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("role", sa.String(length=10), nullable=False),
        sa.Column("issuer", sa.String(length=255), nullable=True),
        sa.Column("subject", sa.String(length=255), nullable=True),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("removed", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_members"),
        sa.UniqueConstraint("issuer", "subject", name="uq_members_issuer"),
    )
    op.create_index("ix_members_team", "members", ["team", "created"])
    _add_keys()
    _add_sessions()


def _add_keys() -> None:
    op.create_table(
        "keys",
        _id(),
        _team(),
        _member(),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("beginning", sa.String(length=12), nullable=False),
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("scopes", sa.String(length=80), nullable=False),
        sa.Column("read_only", sa.Boolean(), server_default=sa.false(), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("expires", sa.Float(), nullable=False),
        sa.Column("last_used", sa.Float(), nullable=True),
        sa.Column("revoked", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_keys"),
        sa.UniqueConstraint("digest", name="uq_keys_digest"),
        sa.ForeignKeyConstraint(["member"], ["members.id"], name="fk_keys_member", ondelete="CASCADE"),
    )
    op.create_index("ix_keys_member", "keys", ["member"])
    op.create_index("ix_keys_team", "keys", ["team", "created"])


def _add_sessions() -> None:
    op.create_table(
        "sessions",
        _id(),
        _team(),
        _member(),
        sa.Column("key", sa.String(length=40), nullable=True),
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("expires", sa.Float(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_sessions"),
        sa.UniqueConstraint("digest", name="uq_sessions_digest"),
        sa.ForeignKeyConstraint(["member"], ["members.id"], name="fk_sessions_member", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["key"], ["keys.id"], name="fk_sessions_key", ondelete="CASCADE"),
    )
    op.create_index("ix_sessions_member", "sessions", ["member"])
    op.create_index("ix_sessions_key", "sessions", ["key"])
    op.create_index("ix_sessions_expires", "sessions", ["expires"])


def _id() -> sa.Column[str]:
    return sa.Column("id", sa.String(length=40), nullable=False)


def _team() -> sa.Column[str]:
    return sa.Column("team", sa.String(length=40), server_default="local", nullable=False)


def _member() -> sa.Column[str]:
    return sa.Column("member", sa.String(length=40), nullable=False)
