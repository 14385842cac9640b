"""Which of several web processes on one database does what only one may do."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from psycopg import Connection

IDLE_SECONDS = 6
"""The server ends the connection of a leader that has sent nothing for this time: it was stopped, or its machine."""
_ANSWER_SECONDS = 2
_LEADING = 0x7472_6564
"""Number of the advisory lock that the leader holds."""


class LeadLost(Exception):
    """The database is away, so that nobody leads."""


class Leadership:
    """The lead, by an advisory lock of Postgres that lives as long as one connection.

    The server ends a connection whose process died, or sent nothing for `IDLE_SECONDS`; so does whoever loses the
    database. Without a URL the database is a file, whose folder only one launcher uses, and its web process leads.
    """

    def __init__(self, url: str) -> None:
        self._url = url
        self._connection: Connection | None = None
        self._leads = not url

    def held(self) -> bool:
        """Tell whether this process leads, and take the lead where nobody has it. To be asked again within seconds.

        Raises
        ------
        LeadLost
            The database is away; the lead, if this process had it, is lost.
        """
        if not self._url:
            return True
        from psycopg import Error

        try:
            self._leads = self._ask()
        except Error as error:
            self.release()
            raise LeadLost(str(error)) from error
        return self._leads

    def _ask(self) -> bool:
        self._connection = self._connection or self._connect()
        ask = "SELECT true" if self._leads else f"SELECT pg_try_advisory_lock({_LEADING})"
        found = self._connection.execute(ask).fetchone()
        return found is not None and bool(found[0])

    def release(self) -> None:
        """Give up the lead, if this process has it."""
        if self._connection is not None:
            self._connection.close()
        self._connection, self._leads = None, not self._url

    def _connect(self) -> "Connection":
        import psycopg

        limits = {"idle_session_timeout": IDLE_SECONDS, "statement_timeout": _ANSWER_SECONDS}
        return psycopg.connect(
            self._url,
            autocommit=True,
            connect_timeout=_ANSWER_SECONDS,
            options=" ".join(f"-c {name}={seconds}s" for name, seconds in limits.items()),
            fallback_application_name="treestroke dispatcher",
            keepalives_idle=5,
            keepalives_interval=2,
            keepalives_count=3,
            tcp_user_timeout=1000 * IDLE_SECONDS,
        )
