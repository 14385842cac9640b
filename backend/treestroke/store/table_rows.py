"""All rows of a database as files of JSON lines, one a table, and back; of any revision, on SQLite and Postgres."""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from sqlalchemy import JSON, Column, Connection, MetaData, Select, Table, delete, func, inspect, select, text
from sqlalchemy.types import TypeEngine

from treestroke.core.progress import Report
from treestroke.store.queries import used
from treestroke.store.tables import REFERENCES, BlobRow, PieceRow

LEFT_OUT = frozenset({"alembic_version", "workers", "sessions", "uploads", PieceRow.__tablename__})
"""Tables whose rows end with the service that they were written by."""
ENDING = ".jsonl"
_ROWS = 200
"""Rows that are in memory at once: some hold a report of many kilobytes."""
_KEPT = used(column for column in REFERENCES if column.class_.__tablename__ not in LEFT_OUT)


@dataclass(frozen=True)
class TableFile:
    """A file of a table's rows: how many, and its SHA-256."""

    rows: int
    sha256: str


def dump(connection: Connection, folder: Path, report: Report) -> dict[str, TableFile]:
    """Write the rows of all tables but `LEFT_OUT` into a folder and return the files by the tables' names.

    Of blobs only those are written that a row refers to.
    """
    tables, files = _tables(connection), dict[str, TableFile]()
    for done, table in enumerate(tables):
        report("rows", done / len(tables))
        rows = connection.execute(_all_of(table), execution_options={"yield_per": _ROWS})
        files[table.name] = _write(folder / f"{table.name}{ENDING}", (dict(row) for row in rows.mappings()))
    return files


def fill(connection: Connection, folder: Path, names: Iterable[str], report: Report) -> dict[str, int]:
    """Insert the rows of a folder into tables of the same revision, in place of theirs; return how many each then has.

    What the tables held was put there by migrations.
    """
    wanted, counts = set(names), dict[str, int]()
    tables = [table for table in _tables(connection) if table.name in wanted]
    for table in reversed(tables):
        connection.execute(delete(table))
    for done, table in enumerate(tables):
        report("rows", done / len(tables))
        rows = read(folder, table.name)
        while some := list(islice(rows, _ROWS)):
            connection.execute(table.insert(), some)
        counts[table.name] = connection.scalar(select(func.count()).select_from(table)) or 0
        if connection.dialect.name == "postgresql":
            _set_sequences(connection, table)
    return counts


def read(folder: Path, name: str) -> Iterator[dict[str, Any]]:
    """Yield the rows of a table from its file in a folder."""
    with (folder / f"{name}{ENDING}").open(encoding="utf-8") as lines:
        yield from map(json.loads, lines)


def _tables(connection: Connection) -> list[Table]:
    """Return the tables as they are there, each after those that it refers to."""
    inspector = inspect(connection)
    names = [name for name, _ in inspector.get_sorted_table_and_fkc_names() if name is not None]
    return [
        Table(name, MetaData(), *(_column(told["name"], told["type"]) for told in inspector.get_columns(name)))
        for name in names
        if name not in LEFT_OUT
    ]


def _column(name: str, kind: TypeEngine[Any]) -> Column[Any]:
    if isinstance(kind, JSON):
        kind.none_as_null = True
    return Column(name, kind)


def _all_of(table: Table) -> Select[Any]:
    if table.name != BlobRow.__tablename__:
        return select(table)
    blobs = BlobRow.__table__
    return select(blobs).where(_KEPT).order_by(BlobRow.team, BlobRow.sha256)


def _write(path: Path, rows: Iterable[dict[str, Any]]) -> TableFile:
    count, found = 0, hashlib.sha256()
    with path.open("xb") as file:
        for row in rows:
            line = json.dumps(row, separators=(",", ":")).encode() + b"\n"
            found.update(line)
            file.write(line)
            count += 1
        file.flush()
        os.fsync(file.fileno())
    return TableFile(count, found.hexdigest())


def _set_sequences(connection: Connection, table: Table) -> None:
    """Let numbers that the database gives go on after the greatest."""
    for column in table.columns:
        sequence = connection.scalar(
            text("SELECT pg_get_serial_sequence(:table, :column)"), {"table": table.name, "column": column.name}
        )
        greatest = connection.scalar(select(func.max(column))) if sequence else None
        if greatest is not None:
            connection.execute(text("SELECT setval(CAST(:name AS regclass), :at)"), {"name": sequence, "at": greatest})
