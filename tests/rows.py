"""Rows written by hand, without a service."""

import time
from typing import Any

from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.store.tables import ModelRow


def add_model(database: Database, **values: Any) -> ModelRow:
    """Write the row of a queued model and give it."""
    usual: dict[str, Any] = {
        "id": new_id("mdl"),
        "name": "",
        "photo": "pho_1",
        "photo_blob": "a" * 64,
        "strokes_blob": "b" * 64,
        "settings": {},
        "seed": 0,
        "engine": "treestroke",
        "fingerprint": "f" * 64,
        "status": "queued",
        "phase_fraction": 0.0,
        "progress": 0.0,
        "seq": 1,
        "attempt": 0,
        "beat": 0,
        "cancel": False,
        "created": time.time(),
    }
    row = ModelRow(**{**usual, **values})
    with database.writing() as session:
        session.add(row)
    return row


def find(database: Database, id: str) -> ModelRow:
    """Read a model's row."""
    with database.reading() as session:
        return session.query(ModelRow).filter_by(id=id).one()
