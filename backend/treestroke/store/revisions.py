"""The revision that the tables of a database have."""

from sqlalchemy import Connection, inspect


def revisions_of(connection: Connection) -> set[str]:
    """Return the revision of the tables; nothing where there are none."""
    if not inspect(connection).has_table("alembic_version"):
        return set()
    return set(connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalars())
