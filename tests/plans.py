"""How SQLite means to answer the statements that are sent to it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy import Engine, event


@contextmanager
def planned() -> Iterator[list[str]]:
    """Collect the steps of the plans of all statements that any database is sent meanwhile."""
    steps: list[str] = []

    def explain(_: Any, cursor: Any, statement: str, parameters: Any, *__: Any) -> None:
        if statement.lstrip().startswith(("SELECT", "UPDATE", "DELETE")):
            found = cursor.connection.execute(f"EXPLAIN QUERY PLAN {statement}", parameters)
            steps.extend(str(row[3]) for row in found.fetchall())

    event.listen(Engine, "before_cursor_execute", explain)
    try:
        yield steps
    finally:
        event.remove(Engine, "before_cursor_execute", explain)


def scans(steps: list[str]) -> list[str]:
    """Give the steps that read a whole table."""
    tables = (
        "models",
        "model_parts",
        "photos",
        "files",
        "replays",
        "blobs",
        "workers",
        "captures",
        "capture_photos",
        "solves",
        "members",
        "keys",
        "sessions",
        "deliveries",
    )
    return [step for step in steps if any(step == f"SCAN {table}" for table in tables)]
