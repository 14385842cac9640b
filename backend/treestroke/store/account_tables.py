"""The tables of teams, their members, and what these sign in with. Of keys and sessions only digests are kept."""

from sqlalchemy import ForeignKey, Index, String, UniqueConstraint, false
from sqlalchemy.orm import Mapped, mapped_column

from treestroke.store.scope import Owned
from treestroke.store.tables import Table


class TeamRow(Owned, Table):
    """A team: the only row of its scope in this table."""

    __tablename__ = "teams"

    team: Mapped[str] = mapped_column(String(40), primary_key=True)
    """The team's id."""
    name: Mapped[str] = mapped_column(String(200))
    created: Mapped[float]


class MemberRow(Owned, Table):
    """A person of a team. Who was removed stays as a row, so that what they made still has their name."""

    __tablename__ = "members"
    __table_args__ = (UniqueConstraint("issuer", "subject"),)

    id: Mapped[str] = mapped_column(String(40), primary_key=True)
    name: Mapped[str] = mapped_column(String(200))
    role: Mapped[str] = mapped_column(String(10))
    issuer: Mapped[str | None] = mapped_column(String(255))
    """Who vouches for this person when they sign in without a key, and by what name: ``subject``."""
    subject: Mapped[str | None] = mapped_column(String(255))
    created: Mapped[float]
    removed: Mapped[float | None]


class KeyRow(Owned, Table):
    """A key of a member."""

    __tablename__ = "keys"

    id: Mapped[str] = mapped_column(String(40), primary_key=True)
    member: Mapped[str] = mapped_column(ForeignKey("members.id", ondelete="CASCADE"))
    name: Mapped[str] = mapped_column(String(200))
    beginning: Mapped[str] = mapped_column(String(12))
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    scopes: Mapped[str] = mapped_column(String(80))
    """Names with blanks between them."""
    read_only: Mapped[bool] = mapped_column(server_default=false())
    created: Mapped[float]
    expires: Mapped[float]
    last_used: Mapped[float | None]
    revoked: Mapped[float | None]


class SessionRow(Owned, Table):
    """A browser in which a member has signed in: by a key, whose end is the session's, or without one."""

    __tablename__ = "sessions"

    id: Mapped[str] = mapped_column(String(40), primary_key=True)
    member: Mapped[str] = mapped_column(ForeignKey("members.id", ondelete="CASCADE"))
    key: Mapped[str | None] = mapped_column(ForeignKey("keys.id", ondelete="CASCADE"))
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    created: Mapped[float]
    expires: Mapped[float]


Index("ix_members_team", MemberRow.team, MemberRow.created)
Index("ix_keys_member", KeyRow.member)
Index("ix_keys_team", KeyRow.team, KeyRow.created)
Index("ix_sessions_member", SessionRow.member)
Index("ix_sessions_key", SessionRow.key)
Index("ix_sessions_expires", SessionRow.expires)
